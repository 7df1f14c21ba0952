"""Closed forms of the INS/GNSS error budget: steady state, outage, shares by source.

- `steady_state`: the filter that has settled ([T-3] to [T-7]).
- `discrete`: the same filter with its sawtooth, just before and just after a fix ([T-8]).
- `coast`: growth after the fixes stop ([T-9] to [T-12]).
- `refined_coast`: the same with Earth rotation, Schuler and gravity-gradient terms ([T-17]).
- `sensitivity`: shares by source and exact logarithmic derivatives ([T-18]).
"""

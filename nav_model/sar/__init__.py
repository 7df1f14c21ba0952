"""From navigation error to image quality, for a broadside synthetic-aperture radar.

- `geometry`: aperture, wavelength, window constants, line of sight ([S-1], [S-3]).
- `phase`: the phase-error budget by source ([T-13] to [T-15], [S-2], [S-4] to [S-6]).
- `impulse_response`: what a phase error does to a point target.
"""

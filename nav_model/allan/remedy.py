"""The log that would resolve a coefficient that this one does not show.

For a coefficient that is merely hidden the answer is a length. At frequency f the term's density is c²/f^a (a
1 for flicker, 2 for the rate random walk, 3 for the ramp's power in a log) under a rival 1/f^r (r 0 for white
noise). The few coefficients at f about 1/T carry the information, so the bound on c falls as T^(-(a - r)/2):
a log 2^(2/(a - r)) times as long halves it. Quantization shows at the top of the band, against white noise,
where the same count gives a bound that falls as the interval to the power 3/4: 2^(4/3) times the rate halves
it.
"""

from collections.abc import Collection
from typing import Final, Literal

Cause = Literal["constant", "repeating", "disturbed", "filtered", "vibrating", "saturated", "hidden"]

_SLOPE: Final = {"random_walk": 0, "bias_instability": 1, "rate_random_walk": 2, "ramp": 3}
_RATE_FACTOR: Final = 2.0 ** (4.0 / 3.0)
_BY_CAUSE: Final[dict[str, str]] = {
    "constant": "a log of a sensor that is connected, at a resolution finer than its noise",
    "repeating": "an original log of a live sensor, without copied stretches",
    "disturbed": "a log at rest on a solid base, nothing running or walking near it, for an hour or more",
    "filtered": "raw samples from before the sensor's digital filter, at its full internal rate",
    "saturated": "a log at a wider range of the sensor, which its signal does not reach",
    "vibrating": "a log at rest on a base isolated from the vibration",
}


def what_would_resolve(
    cause: Cause, term: str, resolved: Collection[str], duration_s: float, interval_s: float
) -> str:
    """The log to take, in words, for a coefficient that is not resolved.

    Parameters
    ----------
    cause : Cause
        Why it is not.
    term : str
        Of `noise_terms.TERMS`.
    resolved : collection of str
        Terms that the log does show: the slowest of them hides the rest.
    duration_s, interval_s : float
        Of the log that does not show it [s].
    """
    if cause != "hidden":
        return _BY_CAUSE[cause]
    if term == "quantization":
        rate = _RATE_FACTOR / interval_s
        return f"unfiltered samples at {rate:.3g} Hz would halve the detection limit"
    if term == "random_walk":
        return "a log sampled faster and longer, so that other noise leaves a stretch of slope -1/2"
    rivals = {name: _SLOPE[name] for name in resolved if name in _SLOPE} or {"random_walk": 0}
    rival = max(rivals, key=lambda name: rivals[name])
    gap = _SLOPE[term] - rivals[rival]
    if gap <= 0:
        return (
            f"a log with less {rival.replace('_', ' ')} (steady temperature, warmed up); a longer one shows no more"
        )
    return f"a log of {_span(duration_s * 2.0 ** (2.0 / gap))} would halve the detection limit"


def _span(seconds: float) -> str:
    """A duration in words."""
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.2g} h" if seconds < 360_000.0 else f"{seconds / 86_400.0:.0f} days"

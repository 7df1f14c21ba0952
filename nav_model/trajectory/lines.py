"""The lines of a flight against the limits on their image figures."""

import numpy as np
from numpy.typing import NDArray

from nav_model.trajectory.result import STATE_AXES, LineResult, Processed
from nav_model.trajectory.specification import CovarianceSpec, Line

FloatArray = NDArray[np.float64]


def judge(spec: CovarianceSpec, time_s: FloatArray, chosen: Processed) -> tuple[LineResult, ...]:
    """Each line against the limits, in the processing that is judged. Without lines the whole flight is one."""
    lines = spec.lines or (Line("flight", 0.0, spec.study.duration),)
    return tuple(_judged(line, spec, time_s, chosen) for line in lines)


def along(start: float, stop: float, spec: CovarianceSpec, time_s: FloatArray, *, image: bool) -> NDArray[np.bool_]:
    """Which times count for a line from `start` to `stop` [s], (outputs).

    An `image`'s aperture lies within its line as far as the line is long enough for one. Of a line so short that no
    time lies on it, the nearest to its middle counts; of one that is not flown, none.
    """
    half = 0.5 * spec.inputs.aperture if image else 0.0
    middle, margin = 0.5 * (start + stop), min(half, 0.5 * (stop - start))
    inside: NDArray[np.bool_] = (time_s >= start + margin - 1e-9) & (time_s <= stop - margin + 1e-9)
    if not inside.any() and start < spec.study.duration:
        away = np.abs(time_s - middle)
        inside = (away == away.min()) & (away <= spec.study.every)
    return inside


def _judged(line: Line, spec: CovarianceSpec, time_s: FloatArray, chosen: Processed) -> LineResult:
    start, duration, aperture = line.start, spec.study.duration, spec.inputs.aperture
    stop = min(line.stop, duration) if start < duration else line.stop
    most = dict(spec.most) | dict(line.most)
    worst, mean, within, failing = {}, {}, {}, []
    for name in dict.fromkeys([*(name for name in chosen.figures if name not in STATE_AXES), *most]):
        values = chosen.figures[name][along(start, stop, spec, time_s, image=name not in STATE_AXES)]
        values = values[np.isfinite(values)]
        if values.size:
            worst[name], mean[name] = float(values.max()), float(np.sqrt(np.mean(values**2)))
        if name in most:
            within[name] = float(np.mean(values <= most[name])) if values.size else 0.0
            if within[name] < 1.0:
                failing.append(name)
    reason = ""
    if start >= duration:
        reason = f"is not flown, as the flight ends at {duration:.0f} s"
    elif stop - start < aperture or not worst.keys() >= set(failing):
        reason = f"has no room for an aperture of {aperture:.3g} s"
    return LineResult(line.name, start, stop, worst, mean, most, within, tuple(failing), reason)

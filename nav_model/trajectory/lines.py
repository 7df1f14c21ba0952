"""The lines of a flight against their limits: the figures of each, and when and why one fails."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import format_quantity, time_in_words
from nav_model.budget.verdict import WHOLE_FLIGHT
from nav_model.design.figures import FIGURES, figure_in_sentence
from nav_model.design.processing import REAL_TIME
from nav_model.trajectory.result import STATE_AXES, LineResult, Processed
from nav_model.trajectory.specification import CovarianceSpec, FlightLine

FloatArray = NDArray[np.float64]
MOST_RESERVE = 1200.0
"""Seconds by which a line is made longer at most: a reserve of this is one of at least this."""


def judge(
    spec: CovarianceSpec, time_s: FloatArray, chosen: Processed, sources: tuple[str, ...]
) -> tuple[LineResult, ...]:
    """Each line against the limits, in the processing that is judged. Without lines the whole flight is one.

    Parameters
    ----------
    spec : CovarianceSpec
        Lines and limits.
    time_s : array (outputs,)
        Seconds.
    chosen : Processed
        Figures of that processing.
    sources : tuple of str
        Names of the sources.
    """
    lines = spec.lines or (FlightLine(WHOLE_FLIGHT, 0.0, spec.study.duration),)
    return tuple(_judged(line, spec, time_s, chosen, sources) for line in lines)


def length_in_words(line: LineResult) -> str:
    """Longest length of a line, in words; empty where that is not solved."""
    if line.longest_s is None or line.reserve_s is None:
        return ""
    if line.reserve_s >= MOST_RESERVE:
        return f"may be more than {time_in_words(MOST_RESERVE)} longer"
    if line.closes:
        return f"may be {time_in_words(line.reserve_s)} longer"
    return f"up to {time_in_words(line.longest_s)}" if line.longest_s else "no line is short enough"


def along(start: float, stop: float, spec: CovarianceSpec, time_s: FloatArray, *, image: bool) -> NDArray[np.bool_]:
    """Mask of the times that count for a line, (outputs).

    An image's aperture lies within its line as far as the line is long enough for one. Of a line so short that no
    time lies on it, the nearest to its middle counts; of one that is not flown, none.

    Parameters
    ----------
    start, stop : float
        Of the line, s.
    spec : CovarianceSpec
        The study.
    time_s : array (outputs,)
        Seconds.
    image : bool
        True for a figure of an aperture.
    """
    half = 0.5 * spec.inputs.aperture if image else 0.0
    middle, margin = 0.5 * (start + stop), min(half, 0.5 * (stop - start))
    inside: NDArray[np.bool_] = (time_s >= start + margin - 1e-9) & (time_s <= stop - margin + 1e-9)
    if not inside.any() and start < spec.study.duration:
        away = np.abs(time_s - middle)
        inside = (away == away.min()) & (away <= spec.study.every)
    return inside


def _judged(
    line: FlightLine, spec: CovarianceSpec, time_s: FloatArray, chosen: Processed, sources: tuple[str, ...]
) -> LineResult:
    start, duration = line.start, spec.study.duration
    stop = min(line.stop, duration) if start < duration else line.stop
    most = dict(spec.most) | dict(line.most)
    first, worst, worst_s, mean, within, failing = {}, {}, {}, {}, {}, []
    beyond: list[tuple[float, float, str, int, bool]] = []
    for name, figure in chosen.figures.items():
        on = along(start, stop, spec, time_s, image=name not in STATE_AXES)
        outputs = np.flatnonzero(on & np.isfinite(figure))
        values = figure[outputs]
        if values.size:
            first[name], worst[name] = float(values[0]), float(values.max())
            worst_s[name] = float(time_s[outputs[values.argmax()]])
            mean[name] = float(np.sqrt(np.mean(values**2)))
        if name in most:
            over = np.flatnonzero(values > most[name])
            within[name] = 1.0 - len(over) / len(values) if values.size else 0.0
            if over.size:
                failing.append(name)
                there = int(over[0])
                near = slice(there - 1, there + 1)  # it passes on a straight line between two outputs
                at = np.interp(most[name], values[near], time_s[outputs][near]) - start if there else 0.0
                to_the_end = len(over) == len(values) - there
                beyond.append((float(at), -worst[name] / most[name], name, int(outputs[there]), to_the_end))
    reason, refused = _refused(start, stop, spec, most, chosen, worst)
    because = fails_by = ""
    beyond = [fails for fails in beyond if fails[2] not in refused]
    fails_at = None
    if beyond:
        fails_at, _, fails_by, output, to_the_end = min(beyond)
        shares = chosen.shares[fails_by][:, output]
        cause = f"{'mainly from' if shares.max() > 0.5 else 'largest part from'} {sources[int(shares.argmax())]}"
        because = f"{_passed(fails_by, most[fails_by], fails_at, None if to_the_end else within[fails_by])}; {cause}"
    return LineResult(
        name=line.name,
        start_s=start,
        stop_s=stop,
        first=first,
        worst=worst,
        worst_s=worst_s,
        mean=mean,
        limits=most,
        within=within,
        failing=tuple(name for name in failing if name not in refused),
        refused=refused,
        reason=reason,
        fails_at_s=fails_at,
        fails_by=fails_by,
        because=because,
        remark=_lacking(stop, spec),
    )


def _lacking(stop: float, spec: CovarianceSpec) -> str:
    """Words on the fixes after a line that ends at `stop` [s] for which its smoother waits in vain."""
    if spec.processing == REAL_TIME or stop > spec.study.duration:
        return ""
    after = spec.study.duration + spec.flown_further - stop
    if after >= spec.smoother_waits - spec.study.gnss.interval:
        return ""
    return f"no fixes for {time_in_words(spec.smoother_waits)} after it: fly on"


def _refused(
    start: float, stop: float, spec: CovarianceSpec, most: Mapping[str, float], chosen: Processed,
    worst: Mapping[str, float],
) -> tuple[str, tuple[str, ...]]:  # fmt: skip
    """Why a line gives no value of some of the limited figures, after its name in a sentence, and their names."""
    duration, aperture = spec.study.duration, float(spec.inputs.aperture)
    unknown = tuple(name for name in most if name not in chosen.figures)
    images = tuple(name for name in most if name not in STATE_AXES and name not in unknown)
    missing = tuple(name for name in most if name not in worst and name not in unknown)
    if most and start >= duration:
        return f"is not flown, as the flight ends at {duration:.0f} s", tuple(most)
    if unknown:
        return f"has no {figure_in_sentence(unknown[0])}, which no flight tells", unknown
    if images and stop - start < aperture:
        return f"is too short for an aperture of {aperture:.3g} s", images
    if missing:
        return f"has no {figure_in_sentence(missing[0])}, as no aperture lies within it", missing
    return "", ()


def _passed(name: str, limit: float, fails_at: float, within: float | None) -> str:
    """Words on a figure that passes its limit, and when; `within` it for a share of the line, None where it stays
    beyond."""
    figure = FIGURES[name]
    unit, spread = DIMENSIONS[figure.dimension].default_unit, "1σ" if figure.scaled else "90 %"
    level = f"{format_quantity(limit, unit, figure.dimension, 3)} ({spread})"
    if within is not None:
        first = f"after {time_in_words(fails_at)}" if fails_at else "at its start"
        share = f"{max(1.0 - within, 0.01):.0%}".replace("%", " %")
        return f"{figure_in_sentence(name)} exceeds {level} for {share} of the line, first {first}"
    if fails_at == 0.0:
        return f"{figure_in_sentence(name)} exceeds {level} from the start"
    return f"{figure_in_sentence(name)} exceeds {level} after {time_in_words(fails_at)}"

"""The covariance along a flight as blocks: the verdict, and a table by line."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from app.document.blocks import Answer, Cell, Row, TableBlock, numbers, table
from app.document.numbers import NONE, percent
from app.document.verdict import SAID, verdict_along
from app.subjects.trajectory.figures import FIGURES, factor, show_value, spread_of
from app.work.flight import Followed
from nav_model.base.units import clock, time_in_words
from nav_model.design.figures import figure_in_sentence
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

if TYPE_CHECKING:
    from nav_model.trajectory.result import LineResult, TrajectoryResult


_MOMENT = "An image's aperture lies within its line. Position, velocity, tilt and heading are"


def verdict(followed: Followed) -> Answer:
    """The verdict of the design with this flight, as every page has it; that of a study is open."""
    if followed.study:
        return _of_study(followed)
    budget, result = followed.budget, followed.result
    answer = verdict_along(budget.verdict)
    if not budget.design.trajectory.planned:
        flown = f"No plan: the charts show a straight flight of {time_in_words(result.spec.study.duration)}"
        return replace(answer, sentences=(*answer.sentences, f"{flown}; what a straight leg tells is judged there."))
    failing = [line for line in result.lines if not line.closes]
    if failing:
        worst = max(failing, key=lambda line: (bool(line.reason), line.excess[1]))
        why = failure(followed, worst)
        return replace(answer, sentences=(*answer.sentences, f"{why[:1].upper()}{why[1:]}."))
    return answer


def _of_study(followed: Followed) -> Answer:
    """The lines within the limits of a flight that is not the design's, as a remark."""
    result = followed.result
    lines, good = len(result.lines), sum(line.closes for line in result.lines)
    if not any(line.limits for line in result.lines):
        word = "no limit along the flight"
    elif result.spec.lines:
        word = f"{good} of {lines} line{'' if lines == 1 else 's'} within the limits"
    else:
        word = f"{percent(min(result.lines[0].within.values()))} of the flight within the limits"
    return Answer(
        f"Study: {word} {SAID[result.spec.processing]}",
        "open",
        (f"The flight of {followed.file} is not the design's: its verdict does not have this.",),
    )


def failure(followed: Followed, line: LineResult) -> str:
    """The reason why a line fails: no image of it can be taken, or a figure passes its limit."""
    if line.reason:
        return f"{line.name} {line.reason}"
    return f"{line.name}: {figure_in_sentence(line.fails_by)} {_excess(followed, line)}"


def _excess(followed: Followed, line: LineResult, *, listed: bool = False) -> str:
    """For how much of a line its first figure to fail is over the limit, since when, at worst, and by what; `listed`
    where value and limit are beside it."""
    name, result = line.fails_by, followed.result
    assert line.fails_at_s is not None
    most = line.limits[name]
    level = show_value(followed.design, name, most, given=True)
    worst = show_value(followed.design, name, line.worst[name], like=most)
    share, where = 1.0 - line.within[name], "the line" if result.spec.lines else "the flight"
    at = int(np.searchsorted(result.time_s, line.start_s + line.fails_at_s - 1e-9))
    shares = result.chosen.shares[name][:, min(at, len(result.time_s) - 1)]
    cause = f"{'mainly' if shares.max() > 0.5 else 'largest part'} from {result.sources[int(shares.argmax())]}"
    if share < 1.0:
        over = f"for {percent(share)} of {where}, first at {time_in_words(line.fails_at_s)}"
    else:
        over = f"all along {where}"
    return f"{over}, {cause}" if listed else f"over {level} {over}; worst {worst}, {cause}"


def line_list(followed: Followed, name: str) -> TableBlock:
    """The verdict of each line: when and why it fails, or the figure that decides, `name` where no limit does; and
    how long it may be, once that is solved."""
    result = followed.result
    lengths = [_length(line) for line in result.lines]
    rows: list[Row] = []
    for place, (line, length) in enumerate(zip(result.lines, lengths, strict=True), 1):
        figure = FIGURES[line.fails_by or line.excess[0] or name]
        worst, limit = line.worst.get(figure.name), line.limits.get(figure.name)
        other = _worst_otherwise(result, line, figure.name)
        fails = "✗\u00a0fails", "bad"
        sign, tone = (("✓\u00a0keeps", "good") if limit else ("no limit", "")) if line.closes else fails
        label = line.name if not result.spec.lines or line.name == f"line {place}" else f"{place}  {line.name}"
        why = line.reason or (f"{figure.label} {_excess(followed, line, listed=True)}" if line.fails_by else "")
        why = "; ".join(filter(None, (why, line.remark))) or figure.label
        texts = (
            f"{why[:1].upper()}{why[1:]}",
            *(
                NONE if value is None else show_value(followed.design, figure.name, value, like=limit)
                for value in (worst, other)
            ),
            NONE if limit is None else show_value(followed.design, figure.name, limit, given=True),
        )
        rows.append(
            (
                label,
                Cell(sign, tone="" if followed.study else tone),
                *texts,
                *([length or NONE] if any(lengths) else []),
            )
        )
    return table(
        "trajectory-verdicts",
        f"Verdict by line, {result.spec.processing}, {spread_of(followed.design)}",
        (
            "Line",
            "Limits",
            ("Decides", 1.5),
            *numbers("Worst", _other(result).capitalize(), "Limit"),
            *(["Length"] if any(lengths) else []),
        ),
        rows,
        f"{result.heading.in_words(factor(followed.design, 'heading'))} {_swath(result)}".strip(),
    )


def _other(result: TrajectoryResult) -> str:
    """The processing that is not judged."""
    return POST_PROCESSED if result.spec.processing == REAL_TIME else REAL_TIME


def _worst_otherwise(result: TrajectoryResult, line: LineResult, name: str) -> float | None:
    """The worst of a figure on a line in the processing that is not judged; None where that has none."""
    from nav_model.trajectory.lines import along
    from nav_model.trajectory.result import STATE_AXES

    values = result.on_lines.figures[_other(result)].figures.get(name)
    if values is None:
        return None
    on = along(line.start_s, line.stop_s, result.spec, result.time_s, image=name not in STATE_AXES)
    known = values[on & np.isfinite(values)]
    return float(known.max()) if known.size else None


def _swath(result: TrajectoryResult) -> str:
    """Near and far range; empty where they are not solved."""
    from nav_model.trajectory.swath import swath_in_words

    return swath_in_words(result.swath)


def _length(line: LineResult) -> str:
    """Longest length of a line; empty where that is not solved."""
    from nav_model.trajectory.lines import length_in_words

    return length_in_words(line)


def line_table(followed: Followed, name: str) -> TableBlock:
    """Each line: the figure `name` and those with a limit, their rms, worst and share of the line within it."""
    result = followed.result
    having_one = [key for line in result.lines for key in line.limits]
    figures = [FIGURES[key] for key in dict.fromkeys([*having_one, name])]
    from nav_model.trajectory.result import beside_budget
    from nav_model.trajectory.trust import too_much_trust

    rows: list[Row] = []
    for line in result.lines:
        span = f"{line.name}: {clock(line.start_s)} to {clock(line.stop_s)} min"
        why = line.reason or (failure(followed, line) if line.fails_by else "")
        rows.append(("; ".join(filter(None, (span, why, line.remark, _length(line)))),))
        for figure in figures:
            within = line.within.get(figure.name)
            limited: tuple[str | Cell, ...] = (NONE, NONE)
            if within is not None:
                sign, tone = ("✗", "bad") if figure.name in line.failing else ("✓", "good")
                limit = show_value(followed.design, figure.name, line.limits[figure.name], given=True)
                limited = limit, Cell(percent(within), sign, "" if followed.study else tone)
            values = (part.get(figure.name) for part in (line.first, line.mean, line.worst))
            like = line.limits.get(figure.name)
            texts = (
                NONE if value is None else show_value(followed.design, figure.name, value, like=like)
                for value in values
            )
            rows.append((figure.label, *texts, *limited))
    return table(
        "trajectory-lines",
        f"Figures by line, {result.spec.processing}, {spread_of(followed.design)}",
        ("Quantity", *numbers("At start", "Rms", "Worst", "Limit", "Within")),
        rows,
        " ".join(
            (f"{_MOMENT} {result.moment}.", *beside_budget(result.spec), *too_much_trust(result.spec), _swath(result))
        ).strip(),
    )

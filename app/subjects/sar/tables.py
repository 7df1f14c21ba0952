"""The strategies as blocks: which to use and why, their errors and parts, the impulse responses.

Closed forms follow the current budget; results of runs use the wavelength of their study. Where there are no
runs yet, their cells say so.
"""

import math
from collections.abc import Callable, Iterable
from types import EllipsisType

import numpy as np

from app.document.blocks import Answer, Block, Bullets, Cell, Row, TableBlock, Text, numbers, table
from app.document.numbers import NONE, hundredths, number
from app.document.verdict import check_words, verdict_strip, where_judged
from nav_model.aperture.geometry import metres_to_phase
from nav_model.budget import Budget
from nav_model.budget.verdict import STRAIGHT_LEG, Check, Verdict, decisive
from nav_model.design.figures import DETRENDED, label_of
from nav_model.sar.advice import Recommendation, left_by, recommendation
from nav_model.sar.agreement import agreement, agreement_sentence
from nav_model.sar.decomposition import MedianBand
from nav_model.sar.design_case import able, flight_cautions, judged, study_cautions
from nav_model.sar.design_study import ClosedForms, SarStudy
from nav_model.sar.strategies import NAMES, STRATEGIES, STRATEGY_KEYS, Strategy

_NOT_RUN = "…"
_ENGINES = {"fast": "runs of the error model", "simulator": "flights of the simulator"}
_BANDS = "Median of the runs, 5 to 95 % in brackets."
FORMULAS = f"Formulas [T-15], [T-16], [S-6], [S-7] with the turn [S-8], {NAMES['9']} [P-3], [P-5]"
"""Where the formulas of the strategies come from."""
_SIDE_LOBES = (
    "Fixed: outside the null-to-null lobe of the error-free response, where a shoulder counts as a side lobe. Nulls: "
    "outside the minima found."
)


def strategies_of(budget: Budget) -> list[tuple[int, Strategy]]:
    """Row in a study and strategy; without an outage before the aperture, INS after outage is INS from filter."""
    outage = budget.design.coast.before_aperture > 0
    return [(row, strategy) for row, strategy in enumerate(STRATEGIES) if outage or strategy.key != "3"]


def answer(budget: Budget, closed: ClosedForms, study: SarStudy | None) -> Answer:
    """The design's verdict, the detrended phase where something else decides, and what the strategies can do."""
    verdict, check = budget.verdict, _check(budget.verdict)
    phase: tuple[str, ...] = ()
    if check is None:
        phase = (f"{label_of(DETRENDED)} has no limit.",) if verdict.checks else ()
    elif check.known and (check is not verdict.tightest or verdict.state == "open"):
        words = check_words(budget.design, check)
        phase = (f"{label_of(DETRENDED)}{where_judged(check)} {words.value}, limit {words.limit}.",)
    return verdict_strip(budget).more(*phase, advised(budget, closed, study))


def advised(budget: Budget, closed: ClosedForms, study: SarStudy | None) -> str:
    """Sentence on the best strategy; of a straight leg, which is said where a flight judges the phase."""
    check = _check(budget.verdict)
    leg = "" if check is None or check.judged == STRAIGHT_LEG else "On a straight leg: "
    return f"{leg}{recommended(budget, closed, study).sentence}"


def reasons(closed: ClosedForms, study: SarStudy | None) -> tuple[Block, ...]:
    """Why a strategy is advised, by the runs where there are some and by the formulas."""
    runs = () if study is None else (Text(f"By the runs: {study.sentence}"),)
    return (
        *runs,
        Text(closed.advice.sentence),
        Text(f"Why: {closed.advice.because}"),
        Text(f"What would change it: {closed.advice.would_change}"),
    )


def recommended(budget: Budget, closed: ClosedForms, study: SarStudy | None) -> Recommendation:
    """The strategy to use on a straight leg, of the runs where there are some, otherwise of the formulas; the one in
    use with the phase that is checked."""
    design, in_use, check = budget.design, judged(budget.design), _check(budget.straight_leg())
    confidence, limit = decisive(design, DETRENDED)
    to_phase = confidence * float(metres_to_phase(1.0, budget.sar.wavelength))
    formulas = {key: to_phase * value for key, value in closed.detrended.items() if value is not None}
    phase = formulas if study is None else {key: to_phase * study.residual(key) for key in STRATEGY_KEYS}
    smoothed = phase.get("9")
    # Beyond the limits of an autofocus the check is of a phase that nothing focuses.
    unfocused = {"phase_before_autofocus", "path_before_autofocus"} & set(budget.straight_leg().failing)
    if check is not None and not unfocused:
        phase[in_use] = check.value
    known = {key: phase[key] for key in able(design) if key in phase}
    return recommendation(known, in_use, design.processing.mode, limit, confidence, smoothed=smoothed)


def _check(verdict: Verdict) -> Check | None:
    """The check that decides on the detrended phase, if any: one that fails, else one that is not known."""
    checks = [check for check in verdict.checks if check.on == DETRENDED]
    failing = [check for check in checks if check.state == "not met"]
    unknown = [check for check in checks if not check.known]
    return min(failing or unknown or checks, key=lambda check: check.margin, default=None)


def judged_along(budget: Budget) -> str:
    """Sentence on the phase that is judged, and on the row that is the budget's."""
    return (
        "Requirements are checked along the line of sight as it turns, as on the Budget page. "
        f"The formula of {NAMES[judged(budget.design)]} is the Budget page's value. "
        "Formulas start as on the Budget page; runs start just after a fix."
    )


def runs_in_words(study: SarStudy) -> str:
    """Runs and their number, in words."""
    return f"{study.runs} {_ENGINES[study.engine]}, seed {study.seed}"


def cautions(budget: Budget, study: SarStudy | None) -> Bullets:
    """Cautions for a careful reader."""
    flown = flight_cautions(study.budget) if study is not None and study.engine == "simulator" else ()
    return Bullets((*study_cautions(budget), *flown), "Assumptions and cautions")


def error_table(budget: Budget, closed: ClosedForms, study: SarStudy | None, key: str) -> TableBlock:
    """One row per strategy: closed form and runs, at the confidence of the limit."""
    rows, unfocused = [], budget.design.autofocus.works
    confidence, _ = decisive(budget.design, DETRENDED)
    for index, strategy in strategies_of(budget):
        form = closed.detrended.get(strategy.key)
        cells = [NONE, NONE] if form is None else [_number(confidence * scale * form) for scale in _scales(budget)]
        if study is None:
            cells += [_NOT_RUN] * (4 if unfocused else 3)
        else:
            millimetres, degrees = (confidence * scale for scale in _scales(study.budget))
            cells += [_number(scale * float(study.residuals[index])) for scale in (millimetres, degrees)]
            band = study.parts["residual_rms"]
            whole_band = MedianBand(*(study.composed(DETRENDED, x) for x in (band.median, band.low, band.high)))
            cells += [_banded(whole_band, index, degrees)]
            if unfocused:
                whole = _number(degrees * float(study.composed(DETRENDED, study.unfocused)[index]))
                cells += [f"{whole}, not removed" if study.beyond[index] else whole]
        rows.append((strategy.name, kind_of(strategy), *cells))
    runs = "" if study is None else f"{runs_in_words(study)}. {_BANDS} "
    return table(
        f"{key}-sar-errors",
        f"Detrended phase by strategy: rms over the aperture {left_by(budget)}"
        f"{'' if confidence == 1 else f', at {confidence:g}σ'}",
        (
            ("Strategy", 1.75),
            ("Kind", 1.3),
            *numbers("[mm]", "[°]", width=0.8, group="Formula"),
            *numbers("[mm]", "[°]", width=0.8, group="Runs, rms"),
            *numbers("[°]", width=1.3, group="Runs, median"),
            *(numbers("[°]", width=1.1, group="Runs, without autofocus") if unfocused else ()),
        ),
        rows,
        f"{runs}{judged_along(budget)} {FORMULAS}. Degrees are two-way phase [T-13].",
    )


def run_tables(study: SarStudy, beside: SarStudy | None, key: str) -> tuple[TableBlock, ...]:
    """Measures of the runs: parts of the error, impulse responses, and a comparison of the engines."""
    engines = () if beside is None else (_agreement_table(study, beside, key),)
    return (_parts_table(study, key), *_response_tables(study, key), *engines)


def _parts_table(study: SarStudy, key: str) -> TableBlock:
    """Parts of each residual in degrees; the largest residual in millimetres; the jumps of the filter."""
    millimetres, degrees = _scales(study.budget)
    parts = (
        ("Largest residual [mm]", "detrended_max", millimetres), ("Quadratic [°]", "quadratic", degrees),
        ("Along-track quadratic [°]", "along_track_quadratic", degrees), ("Cubic [°]", "cubic", degrees),
        ("Higher orders [°]", "higher_rms", degrees), ("High frequency [°]", "high_frequency_rms", degrees),
    )  # fmt: skip
    return _by_strategy(
        study,
        f"{key}-sar-parts",
        "Parts of the error by strategy",
        tuple(title for title, *_ in parts),
        lambda index: tuple(_banded(study.parts[name], index, scale) for _, name, scale in parts),
        f"{_BANDS} Quadratic and cubic: coefficients at the aperture's ends, before autofocus [S-5], [S-6]. "
        f"Along-track: what the turning line of sight adds [S-2]. Others: rms [T-14]. "
        f"{NAMES['4']} jumps at the fixes by {_banded(study.jump_rms, ..., millimetres)} mm rms.",
    )


def _response_tables(study: SarStudy, key: str) -> tuple[TableBlock, TableBlock]:
    """The impulse response of each strategy: lobe, then side lobes integrated, both ways."""
    cell, r = study.budget.sar.cell_length, study.responses

    def response(index: int, *cells: str) -> tuple[str, ...]:
        if math.isfinite(float(r["width_cells"].median[index])):
            return cells
        return ("not focused", *(NONE for _ in cells[1:]))

    def to_hundredths(index: int, *names: str) -> tuple[str, ...]:
        return tuple(_bracketed(*map(hundredths, _of(r[name], index))) for name in names)

    def lobe(index: int) -> tuple[str, ...]:
        widths = (_banded(r["width_cells"], index, scale) for scale in (1.0, cell))
        return response(index, *widths, *to_hundredths(index, "pslr_fixed_db", "pslr_null_db", "peak_loss_db"))

    def integrated(index: int) -> tuple[str, ...]:
        ratios = to_hundredths(index, "islr_fixed_db", "islr_null_db", "islr_fixed_ten_db")
        shift = _bracketed(*(hundredths(value, sign="+") for value in _of(r["shift_cells"], index)))
        return response(index, *ratios, shift)

    return (
        _by_strategy(
            study,
            f"{key}-sar-lobe",
            "Azimuth impulse response by strategy: width, peak side lobe, peak loss",
            ("Width [cells]", "Width [m]", "PSLR, fixed [dB]", "PSLR, nulls [dB]", "Peak loss [dB]"),
            lobe,
            f"{_BANDS} Width at −3 dB, {study.budget.sar.window} window, cell {number(cell)} m [S-3]. PSLR: peak "
            f"side lobe ratio. {_SIDE_LOBES}",
        ),
        _by_strategy(
            study,
            f"{key}-sar-islr",
            "Azimuth impulse response by strategy: integrated side lobes, shift",
            ("ISLR, fixed [dB]", "ISLR, nulls [dB]", "ISLR, fixed, ten nulls [dB]", "Shift [cells]"),
            integrated,
            f"{_BANDS} ISLR: integrated side lobe ratio, over the whole line unless said otherwise. {_SIDE_LOBES}",
        ),
    )


def _agreement_table(study: SarStudy, beside: SarStudy, key: str) -> TableBlock:
    """Flights of the simulator beside the error model: the two engines, strategy by strategy."""
    pairs = agreement(study, beside)
    scales = _scales(study.budget)
    rows: Iterable[Row] = (
        (
            NAMES[pair.key],
            *(_number(scale * sigma) for sigma in (pair.flown, pair.fast) for scale in scales),
            f"{number(pair.ratio, 4)} ± {number(pair.error, 2)}",
            "✓ agrees" if pair.agrees else Cell("✗ differs", tone="warn"),
        )
        for pair in pairs
    )
    return table(
        f"{key}-sar-engines",
        "Simulator and error model compared",
        (
            ("Strategy", 1.5),
            *numbers("[mm]", "[°]", width=1, group="Simulator"),
            *numbers("[mm]", "[°]", width=1, group="Error model"),
            *numbers("Ratio", width=1),
            ("Within three standard errors", 1),
        ),
        rows,
        f"{agreement_sentence(pairs)} Residual after autofocus, rms over {study.runs} flights and over {beside.runs} "
        "runs; ± one standard error of the ratio.",
    )


def _by_strategy(
    study: SarStudy, key: str, caption: str, titles: tuple[str, ...], row: Callable[[int], tuple[str, ...]], note: str
) -> TableBlock:
    return table(
        key,
        caption,
        (("Strategy", 1.5), *numbers(*titles, width=1)),
        ((strategy.name, *row(index)) for index, strategy in strategies_of(study.budget)),
        note,
    )


def _scales(budget: Budget) -> tuple[float, float]:
    """Millimetres, and degrees of two-way phase, of a metre of line of sight."""
    return 1000.0, math.degrees(float(metres_to_phase(1.0, budget.sar.wavelength)))


def kind_of(strategy: Strategy) -> str:
    """When a strategy is known, and whether it reconstructs the path."""
    if strategy.key == "1":
        return "reference"
    return strategy.timing + (", reconstruction" if strategy.reconstruction else "")


def _number(value: float) -> str:
    return "0" if abs(value) < 1e-9 else number(value)  # of the ideal, rounding of the transform is left


def _of(band: MedianBand, index: int | EllipsisType) -> tuple[float, float, float]:
    median, low, high = (float(np.asarray(part)[index]) for part in (band.median, band.low, band.high))
    return median, low, high


def _banded(band: MedianBand, index: int | EllipsisType, scale: float) -> str:
    return _bracketed(*(_number(scale * value) for value in _of(band, index)))


def _bracketed(median: str, low: str, high: str) -> str:
    """Median and band; the band stays in one piece where a cell breaks."""
    if low == median == high:
        return median
    return f"{median} ({low}\u00a0to\u00a0{high})"

"""The key figures of a budget, each with its limit, for page, report and command alike."""

from app.document.blocks import KeyFigure, KeyFigures
from app.document.display import AS_REQUIRED, Display
from app.document.numbers import show
from app.document.verdict import check_words, displayed_check, where_judged
from app.document.wording import MOMENTS
from app.subjects.budget.tables import PARTS, parted
from nav_model.aperture.geometry import phase_to_metres
from nav_model.budget import Budget
from nav_model.budget.navigation import steady_marks
from nav_model.budget.verdict import STRAIGHT_LEG, Check
from nav_model.design.figures import FIGURES, Figure, Kind, of_kind
from nav_model.design.processing import REAL_TIME

_KINDS: tuple[Kind, ...] = ("steady", "outage", "phase", "place")


def key_figures(
    budget: Budget, display: Display = AS_REQUIRED, was: KeyFigures | None = None, last: Budget | None = None
) -> KeyFigures:
    """The main figures of the design's processing, each with its kind and limit; and every other check.

    Parameters
    ----------
    budget : Budget
    display : Display
    was : KeyFigures, optional
        What they are compared with: they keep its units.
    last : Budget, optional
        That of the last flight, which has the values of what is open.
    """
    display = display.of(budget.design)
    checks = {check.name: check for check in budget.verdict.checks}
    before = {check.name: check for check in last.verdict.checks if check.known} if last else {}
    entered = {contributor.enters for contributor in budget.design.contributors}
    names = [name for kind in _KINDS for name in of_kind(kind) if FIGURES[name].tile or name in entered]
    units = {figure.label: figure.amount for figure in was.items} if was else {}

    def tile(name: str) -> KeyFigure:
        figure, amount = FIGURES[name], budget.figure(name).sigma
        detail = _detail(budget, figure, amount, display)
        if name in checks:
            return limited(checks[name], detail)
        spread, like = display.named(pair=figure.pair), units.get(figure.label)
        if not figure.scaled:  # a percentage
            value = display.plain(amount, figure.dimension, like=like)
            return KeyFigure(figure.label, value, figure.mark, "no limit", amount=amount)
        value = display.show(amount, figure.dimension, pair=figure.pair, like=like)
        return KeyFigure(figure.label, value, detail, f"{spread}, no limit" if spread != "1σ" else "", amount=amount)

    def limited(check: Check, detail: str) -> KeyFigure:
        displayed = check if check.known else before.get(check.name, check)
        value, *_ = displayed_check(budget.design, displayed, display)
        *_, beside = displayed_check(budget.design, check, display)
        limit, known = _limit_text(budget, check, display), check.known
        amount, used = (check.sigma, 1 - check.margin) if known else (None, None)
        if check.judged != STRAIGHT_LEG:
            detail = check_words(budget.design, check).figure
        if not known:
            detail = check.reason + (f"; last flight: {value}" if displayed.known else "")
        return KeyFigure(
            check.label, value, detail, limit, check.state, amount, used, beside, last=displayed.known and not known
        )

    others = tuple(
        limited(check, check_words(budget.design, check).figure)
        for check in budget.verdict.checks
        if check.name not in names
    )
    title = f"Key figures, {display.spread}{display.scaled}"
    return KeyFigures(title, (*map(tile, names), *(others or (_width(budget, display, units),))))


def _detail(budget: Budget, figure: Figure, amount: float, display: Display) -> str:
    """Words below a figure: how it is known, and what belongs beside it."""
    smoothed, spread = budget.post_processed, display.named(pair=figure.pair)

    def text_of(name: str, moment: str = "") -> str:
        sigma = budget.composed(name, REAL_TIME, moment=moment).sigma
        return display.show(sigma, figure.dimension, pair=FIGURES[name].pair)

    if figure.kind == "steady":
        if smoothed:
            return f"{spread}, smoothed [P-3]; in real time {text_of(figure.name)} [T-8]"
        chosen, mark = budget.design.requirements.steady_state, steady_marks(budget.design)["vertical" in figure.name]
        if chosen == "closed":
            return f"{spread}, {MOMENTS[chosen]} {mark}"
        at = ", where the error is largest" if chosen == "prior" else ", where it is least"
        return f"{spread}, {MOMENTS[chosen]}{at} [T-8]; average {text_of(figure.name, 'closed')} {mark}"
    if figure.kind == "outage":
        vertical = figure.name.replace("horizontal", "vertical")
        beside = f"; vertical {text_of(vertical)}" if figure.pair and vertical in FIGURES else ""
        return f"after {show(budget.coast.duration, 'time', given=True)}, in real time {figure.mark}{beside}"
    how = f"formula {figure.mark}" if not smoothed else f"smoothed {figure.smoothed_mark or figure.mark}"
    if figure.kind == "phase" and figure.dimension == "angle" and figure.scaled:
        sight = float(phase_to_metres(amount, budget.sar.wavelength))
        # The quadratic phase is what autofocus has not taken yet.
        before = ", before autofocus" if "quadratic" in figure.name and budget.sar.autofocus_order > 1 else ""
        removed = "rms after a line is removed, " if figure.name == "detrended_phase" else ""
        whole = f"{removed}{display.show(sight, 'length')} along the line of sight, {how}{before}"
        if not parted(figure.name):
            return whole
        across, along = (
            display.show(budget.figure(f"{part}_{figure.name}").sigma, figure.dimension) for part in PARTS
        )
        return f"{whole}; along the line of sight {across}, along the track {along}"
    return f"{spread}, {how}"


def _width(budget: Budget, display: Display, units: dict[str, float | None]) -> KeyFigure:
    """The azimuth width of the response with the quadratic phase."""
    sar, extent, label = budget.sar, budget.half_power_extent, "Azimuth width"
    if extent is None:
        return KeyFigure(label, "not focused", f"ideal {display.plain(sar.cell_length, 'length')}")
    width = extent * sar.cell_length
    detail = (
        f"with 1σ quadratic; aperture {display.plain(sar.aperture_time, 'time')}, "
        f"{display.plain(sar.aperture_length, 'length')} [S-3]"
    )
    return KeyFigure(label, display.plain(width, "length", like=units.get(label)), detail, amount=width)


def _limit_text(budget: Budget, check: Check, display: Display) -> str:
    """A limit with the line that decides, and with its spread unless that is 1σ or chosen, which is told above the
    charts; after an outage, a smoothed budget's is of real time."""
    _, limit, at, _ = displayed_check(budget.design, check, display)
    if at != " at 1σ" and display.required:
        limit += at
    if check.known:
        limit += where_judged(check)
    outage = check.on in FIGURES and FIGURES[check.on].kind == "outage"
    return f"{limit}, real time" if budget.post_processed and outage else limit

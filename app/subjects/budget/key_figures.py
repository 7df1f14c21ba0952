"""The key figures of a budget, each with its limit, for page, report and command alike."""

from app.document.blocks import KeyFigure, KeyFigures
from app.document.display import ONE_SIGMA, Display
from app.document.numbers import show
from app.document.verdict import check_words, shown_check
from app.document.wording import MOMENTS
from nav_model.aperture.geometry import phase_to_metres
from nav_model.budget import Budget
from nav_model.budget.provenance import steady_marks
from nav_model.budget.result import Check

_WITH_TILE = {
    "horizontal_position", "vertical_position", "horizontal_velocity", "tilt", "coast_horizontal_position",
    "quadratic_phase", "detrended_phase",
}  # fmt: skip
"""Checks that always have a tile."""


def key_figures(budget: Budget, display: Display = ONE_SIGMA, was: KeyFigures | None = None) -> KeyFigures:
    """The main figures of the design's processing, each with its kind and limit; the tightest of the other checks.

    Parameters
    ----------
    budget : Budget
    display : Display
    was : KeyFigures, optional
        What they are compared with: they keep its units.
    """
    coast, sar, smoothed = budget.coast, budget.sar, budget.smoothed
    checks = {check.name: check for check in budget.verdict.checks}
    units = {figure.label: figure.amount for figure in was.items} if was else {}
    image = smoothed or sar
    extent = image.half_power_extent
    autofocus = "" if sar.autofocus_order == 1 else ", before autofocus"
    level, upright = steady_marks(budget.design)
    fields = (
        ("Horizontal position", "position_horizontal", "length", "horizontal_position", level),
        ("Vertical position", "position_vertical", "length", "vertical_position", upright),
        ("Horizontal velocity", "velocity_horizontal", "speed", "horizontal_velocity", level),
        ("Tilt", "tilt", "angle", "tilt", level),
    )

    def figure(label: str, amount: float, dimension: str, detail: str, name: str = "") -> KeyFigure:
        pair = "horizontal" in name
        check = checks.get(name)
        like = units.get(label)
        value = (
            display.show(amount, dimension, pair=pair, like=like)
            if name
            else display.plain(amount, dimension, like=like)
        )
        told = display.named(pair=pair)
        if check is None:
            return KeyFigure(
                label, value, detail, f"{told}, no limit" if name and told != "1σ" else "", amount=amount
            )
        limit = _limit_said(budget, check, display)
        return KeyFigure(label, value, detail, limit, check.met, amount, 1 - check.margin)

    def settled(label: str, field: str, dimension: str, name: str, mark: str) -> KeyFigure:
        chosen = budget.design.requirements.steady_state
        moment, average = budget.steady_state.checked(chosen), budget.steady_state.checked("closed")
        pair = "horizontal" in name
        told = display.named(pair=pair)

        def shown(sigmas: object) -> str:
            return display.show(getattr(sigmas, field), dimension, pair=pair)

        if smoothed is not None:
            detail = f"{told}, smoothed [P-3]; in real time {shown(moment)} [T-8]"
            return figure(label, getattr(smoothed.sigmas, field), dimension, detail, name)
        which = f"{MOMENTS[chosen]} {mark if chosen == 'closed' else '[T-8]'}"
        if chosen != "closed":
            which += f"; average {shown(average)} {mark}"
        return figure(label, getattr(moment, field), dimension, f"{told}, {which}", name)

    def phase(label: str, field: str, name: str, mark: str, note: str = "") -> KeyFigure:
        amount = getattr(image, field)
        sight = f"{display.show(float(phase_to_metres(amount, sar.wavelength)), 'length')} along the line of sight"
        how = f"formula {mark}" if smoothed is None else "smoothed [P-5]"
        return figure(label, amount, "angle", f"{sight}, {how}{note}", name)

    last = KeyFigure("Azimuth width", "not focused", f"ideal {display.plain(sar.cell_length, 'length')}")
    others = [check for check in budget.verdict.checks if check.name not in _WITH_TILE]
    if others:
        last = _tightest_of(others, budget, display)
    elif extent is not None:
        last = figure(
            "Azimuth width",
            extent * sar.cell_length,
            "length",
            f"with 1σ quadratic; aperture {display.plain(sar.aperture_time, 'time')}, "
            f"{display.plain(sar.aperture_length, 'length')} [S-3]",
        )
    return KeyFigures(
        f"Key figures, {display.spread}{'' if display.spread == '1σ' else ', limits scaled'}",
        (
            *(settled(*names) for names in fields),
            figure(
                "Horizontal position after the outage",
                coast.checked["coast_horizontal_position"].sigma,
                "length",
                f"after {show(coast.duration, 'time', given=True)}, in real time [T-17]; "
                f"vertical {display.show(coast.checked['coast_vertical_position'].sigma, 'length')}",
                "coast_horizontal_position",
            ),
            phase("Quadratic phase", "quadratic", "quadratic_phase", "[S-5]", autofocus),
            phase("Detrended phase", "detrended", "detrended_phase", "[T-15]"),
            last,
        ),
    )


def _tightest_of(checks: list[Check], budget: Budget, display: Display) -> KeyFigure:
    """The check that has the least margin, and how the others stand."""
    first, *rest = sorted(checks, key=lambda check: check.margin)
    value, *_ = shown_check(budget.design, first, display)
    more = sum(not check.met for check in rest)
    detail = check_words(budget.design, first).figure
    for check in rest:
        other, its_limit, _ = shown_check(budget.design, check, display)
        detail += f"; {check.label} {other}, limit {its_limit}, {'met' if check.met else 'not met'}"
    limit = _limit_said(budget, first, display) + (f"; {more} more not met" if more else "")
    return KeyFigure(first.label, value, detail, limit, first.met, first.sigma, 1 - first.margin)


def _limit_said(budget: Budget, check: Check, display: Display) -> str:
    """A limit, with its spread unless one is chosen, which is told above the charts; after an outage, a smoothed
    budget's is of real time."""
    _, limit, at = shown_check(budget.design, check, display)
    if display.spread == "1σ":
        limit += at
    return f"{limit}, real time" if budget.smoothed and check.on.startswith("coast_") else limit

"""The key figures of a budget, each with its limit, for page, report and command alike."""

from __future__ import annotations

from app.document.blocks import KeyFigure, KeyFigures
from app.document.display import ONE_SIGMA, SI, Display
from app.document.numbers import show
from app.document.verdict import limit_in_words
from nav_model.aperture.geometry import phase_to_metres
from nav_model.budget import Budget
from nav_model.budget.provenance import steady_marks

_MOMENTS = {"prior": "worst point between fixes", "posterior": "just after a fix", "closed": "rms over the fix cycle"}


def key_figures(budget: Budget, display: Display = ONE_SIGMA) -> KeyFigures:
    """The main figures of the design's processing, each with its kind and limit."""
    coast, sar, smoothed = budget.coast, budget.sar, budget.smoothed
    checks = {check.name: check for check in budget.verdict.checks}
    image = smoothed or sar
    extent = image.half_power_extent
    autofocus = "" if sar.autofocus_order == 1 else ", before autofocus"
    level, upright = steady_marks(budget.design)
    fields = (
        ("Position, horizontal", "position_horizontal", "length", "horizontal_position", level),
        ("Position, vertical", "position_vertical", "length", "vertical_position", upright),
        ("Velocity, horizontal", "velocity_horizontal", "speed", "horizontal_velocity", level),
        ("Roll, pitch", "tilt", "angle", "tilt", level),
    )

    def figure(label: str, amount: float, dimension: str, detail: str, name: str = "") -> KeyFigure:
        pair = "horizontal" in name
        check = checks.get(name)
        value = display.show(amount, dimension, pair=pair) if name else display.plain(amount, dimension)
        told = display.named(pair=pair)
        if check is None:
            return KeyFigure(
                label, value, detail, f"{told}, no limit" if name and told != "1σ" else "", amount=amount
            )
        in_si = display.units == SI
        limit = display.in_si(check.limit, dimension, given=True) if in_si else limit_in_words(budget.design, check)
        if told != f"{budget.verdict.confidence:g}σ":  # the figure beside it is another multiple
            limit = f"{limit} at {budget.verdict.confidence:g}σ{'' if told == '1σ' else f'; value as {told}'}"
        return KeyFigure(label, value, detail, limit, check.met, amount, 1 - check.margin)

    def settled(label: str, field: str, dimension: str, name: str, mark: str) -> KeyFigure:
        chosen = budget.design.requirements.steady_state
        moment, average = getattr(budget.steady_state, chosen), budget.steady_state.closed
        pair = "horizontal" in name
        told = display.named(pair=pair)

        def shown(sigmas: object) -> str:
            return display.show(getattr(sigmas, field), dimension, pair=pair)

        if smoothed is not None:
            detail = f"{told}, smoothed [P-3]; in real time {shown(moment)} [T-8]"
            return figure(label, getattr(smoothed.sigmas, field), dimension, detail, name)
        which = f"{_MOMENTS[chosen]} {mark if chosen == 'closed' else '[T-8]'}"
        if chosen != "closed":
            which += f"; average {shown(average)} {mark}"
        return figure(label, getattr(moment, field), dimension, f"{told}, {which}", name)

    def phase(label: str, field: str, name: str, mark: str, note: str = "") -> KeyFigure:
        amount = getattr(image, field)
        sight = f"{display.show(float(phase_to_metres(amount, sar.wavelength)), 'length')} along the line of sight"
        how = f"formula {mark}" if smoothed is None else "smoothed [P-5]"
        return figure(label, amount, "angle", f"{sight}, {how}{note}", name)

    width = KeyFigure("Azimuth width", "not focused", f"ideal {display.plain(sar.cell_length, 'length')}")
    if extent is not None:
        width = figure(
            "Azimuth width",
            extent * sar.cell_length,
            "length",
            f"with 1σ quadratic; aperture {display.plain(sar.aperture_time, 'time')}, "
            f"{display.plain(sar.aperture_length, 'length')} [S-3]",
        )
    return KeyFigures(
        "Key figures, one sigma",
        (
            *(settled(*names) for names in fields),
            figure(
                f"Position after {show(coast.duration, 'time', given=True)}",
                coast.end_refined_horizontal,
                "length",
                f"horizontal, without fixes, in real time [T-17]; "
                f"vertical {display.show(coast.end_refined_vertical, 'length')}",
                "coast_horizontal_position",
            ),
            phase("Quadratic phase", "quadratic", "quadratic_phase", "[S-5]", autofocus),
            phase("Detrended phase", "detrended", "detrended_phase", "[T-15]"),
            width,
        ),
    )

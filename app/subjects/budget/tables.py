"""The tables of a budget, for page, report and command alike."""

import math
from collections.abc import Callable

import numpy as np

from app.document.blocks import Cell, Row, Table, Text, numbers, table
from app.document.display import ONE_SIGMA, Display
from app.document.numbers import NONE, decibels, degrees, millimetres, number, percent, show, show_in
from app.document.verdict import SAID, check_words, met_cell
from app.document.wording import best_of, printable
from nav_model.budget import Budget, analyse
from nav_model.budget.provenance import provenance, steady_marks
from nav_model.budget.result import Check
from nav_model.design.contributors import label_of
from nav_model.design.parts import declaration_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.processing.paired_echo import NOTHING

ALONG_TRACK = "along-track"
"""What the along-track phase is called beside the sources across it."""
CONTRIBUTORS_ENTER = (
    "Random contributors add in quadrature, systematic ones linearly, each with its allowance. A length along the "
    "line of sight enters a phase by 4π/λ. What enters CE90 or LE90 is given as a 90 % value."
)
"""How the design's own contributors enter its figures."""
_FRACTIONS = (0.0, 0.1, 0.2, 0.5, 1.0)  # of the outage, in its table


def requirement_table(budget: Budget, key: str = "d") -> Table | Text:
    """Every requirement with its figure, limit, margin and what dominates it."""
    verdict = budget.verdict
    if not verdict.checks:
        return Text("The design has no requirement; nothing was checked.")

    def row(check: Check) -> Row:
        words = check_words(budget.design, check)
        main = f"{check.sensor}, {words.share}"
        return check.label, words.value, words.limit, words.margin, met_cell(check), words.figure, main

    return table(
        f"{key}-verdict",
        f"Requirements at {verdict.confidence:g}σ",
        (
            ("Requirement", 1.5),
            *numbers(f"{verdict.confidence:g}σ value", "Limit", "Margin"),
            "Verdict",
            ("Checked", 1.25),
            ("Main error source", 1.25),
        ),
        map(row, verdict.checks),
        "Margin = (limit − value) / limit. Shares are of the variance; the initial tilt is attributed to the "
        "sensors that cause it [T-18].",
    )


def processing_table(budget: Budget, key: str = "budget") -> Table:
    """The figures of the image in real time and post-processed, beside each other."""
    sar, smoothed = budget.sar, budget.post_processed
    free, placed = budget.placement, budget.post_processed_placement
    rows = (
        ("Quadratic phase", "angle", sar.quadratic, smoothed.quadratic, "[S-5]", "[P-5]"),
        ("Cubic phase", "angle", sar.cubic, smoothed.cubic, "[S-6]", "[P-5]"),
        ("Detrended phase", "angle", sar.detrended, smoothed.detrended, "[S-6]", "[P-5]"),
        ("Along-track quadratic phase", "angle", sar.along_track_quadratic, smoothed.along_track_quadratic, "[S-2]",
         "[P-5]"),
        ("Azimuth shift", "length", free.azimuth, placed.azimuth, "[P-7]", "[P-7]"),
        ("Range shift", "length", free.range, placed.range, "[P-7]", "[P-7]"),
        ("CE90", "length", free.ce90, placed.ce90, "[P-7]", "[P-7]"),
        ("LE90", "length", free.le90, placed.le90, "[P-7]", "[P-7]"),
    )  # fmt: skip
    closes = {
        verdict.processing: Cell("✓ closes", tone="good") if verdict.closes else Cell("✗ does not close", tone="bad")
        for verdict in (budget.verdict, budget.other_verdict)
        if verdict.checks
    }
    answers = (("Verdict", closes[REAL_TIME], closes[POST_PROCESSED]),) if closes else ()
    return table(
        f"{key}-both-processings",
        "Real time and post-processed, 1σ",
        (("Quantity", 1.5), *numbers("Real time", "Post-processed")),
        (
            *answers,
            *(
                (label, f"{show(now, kind)} {mark}", f"{show(later, kind)} {other}")
                for label, kind, now, later, mark, other in rows
            ),
        ),
        "Real time: a free INS from the last fix. Post-processed: a smoother with the fixes before, in and after the "
        "aperture [P-3]. CE90 and LE90 hold 90 %. "
        f"Requirements are checked for {budget.verdict.processing}.",
    )


_STEADY = (
    ("position_horizontal", "horizontal_position", "Horizontal position, per axis"),
    ("position_vertical", "vertical_position", "Vertical position"),
    ("velocity_horizontal", "horizontal_velocity", "Horizontal velocity, per axis"),
    ("velocity_vertical", "vertical_velocity", "Vertical velocity"),
    ("tilt", "tilt", "Tilt (roll and pitch, each)"),
)


def steady_table(budget: Budget, key: str, display: Display = ONE_SIGMA) -> Table:
    """Standard deviations while fixes come in: over the cycle, before and after a fix."""
    steady, sources = budget.steady_state, provenance(budget)
    moments = (steady.closed, steady.prior, steady.posterior)

    def row(field: str, requirement: str, label: str) -> Row:
        source, share = best_of(steady.shares[requirement])
        pair, dimension = "horizontal" in requirement, declaration_of(f"requirements.{requirement}").dimension
        sigmas = (getattr(moment, field) for moment in moments)
        shown = (
            show_in(sigma, budget.design.unit(f"requirements.{requirement}"), dimension)
            if display == ONE_SIGMA
            else display.show(sigma, dimension, pair=pair)
            for sigma in sigmas
        )
        told = display.named(pair=pair)
        if display.factor(pair=pair) != display.factor():
            label = label.replace("per axis", "radius")
        name = label if display == ONE_SIGMA else f"{label}, {told}"
        return name, *shown, f"{source}, {percent(share)}"

    cycle = ", ".join(dict.fromkeys(steady_marks(budget.design)))
    moments_said = f"Average between fixes {cycle}", "Before a fix [T-8]", "After a fix [T-8]"
    closed = sources["steady_state.position_sigma_m.horizontal"]
    prior = sources["steady_state.discrete.prior"]
    return table(
        f"{key}-steady-table",
        f"Errors in real time while fixes come in, {display.spread}",
        (("Error", 1.5), *numbers(*moments_said), ("Largest share [T-18]", 1.2)),
        (row(*names) for names in _STEADY),
        f"Average between fixes: {closed.method}, {closed.note}. Before and after a fix: {prior.method}. "
        f"Gyro dominance κ = {number(steady.gyro_dominance)} [T-6]; λ Δt = {number(steady.lambda_dt)} [T-8].",
    )


def outage_table(budget: Budget, key: str) -> Table:
    """Standard deviations at a few times after the last fix."""
    coast = analyse(budget.design, budget.coast.duration * np.array(_FRACTIONS)).coast
    columns = (
        ("Horizontal [m] [T-9]", coast.position_horizontal),
        ("hor., all terms [m] [T-17]", coast.refined_horizontal),
        ("Vertical [m] [T-10]", coast.position_vertical),
        ("vert., all terms [m] [T-17]", coast.refined_vertical),
        ("Velocity hor. [m/s]", coast.velocity_horizontal),
        ("Velocity vert. [m/s]", coast.velocity_vertical),
        ("Tilt [°] [T-9]", np.degrees(coast.tilt)),
        ("Yaw growth [°] [T-5]", np.degrees(coast.yaw_growth)),
    )
    return table(
        f"{key}-coast",
        "Standard deviations after the last fix, 1σ",
        (*numbers("Time [s]"), *numbers(*(title for title, _ in columns), width=1)),
        (
            (number(time, given=True), *(number(curve[i]) for _, curve in columns))
            for i, time in enumerate(coast.time)
        ),
        "Residual biases in quadrature. "
        "Requirements after the last fix are checked with Schuler and Coriolis terms [T-17].",
    )


def phase_lines(budget: Budget) -> list[tuple[str, float, float, float, float]]:
    """Each source of phase over the aperture, of the design's processing: its quadratic phase and its share of that,
    its detrended phase and its share of that."""
    smoothed = budget.smoothed
    if smoothed is None:
        return [(x.source, x.quadratic, x.share, x.detrended, x.detrended_share) for x in budget.sar.lines]
    (quadratic, first), (detrended, second) = (
        (smoothed.sizes[name], smoothed.shares[name]) for name in ("quadratic_phase", "detrended_phase")
    )
    return [
        (x, quadratic.get(x, 0.0), first.get(x, 0.0), detrended.get(x, 0.0), second.get(x, 0.0))
        for x in dict.fromkeys((*quadratic, *detrended))
    ]


def phase_table(budget: Budget, key: str) -> Table:
    """The phase budget of the aperture by source, of the design's processing."""
    sar, smoothed = budget.sar, budget.smoothed
    image = smoothed or sar

    def row(label: str, quadratic: float, share: str, detrended: float, left_share: str) -> Row:
        given = not math.isnan(detrended)
        return (
            label,
            degrees(quadratic),
            millimetres(quadratic, sar.wavelength),
            share,
            degrees(detrended) if given else NONE,
            millimetres(detrended, sar.wavelength) if given else NONE,
            left_share,
        )

    makers = ", ".join(f"{source} {percent(share)}" for source, share in sar.tilt_shares.items())
    return table(
        f"{key}-phase-table",
        f"Phase budget of the aperture by source, {SAID[budget.verdict.processing]}, 1σ, in phase and in "
        "line-of-sight millimetres",
        (
            ("Source", 1.7),
            *numbers("Quadratic phase [°]", width=1.15),
            *numbers("[mm]", "Share", width=0.8),
            *numbers("Detrended phase [°]", width=1.15),
            *numbers("[mm]", "Share", width=0.8),
        ),
        (
            *(
                row(source, quadratic, percent(share), left, percent(left_share))
                for source, quadratic, share, left, left_share in phase_lines(budget)
                if quadratic > 0 or left > 0
            ),
            row("total in quadrature", image.quadratic, "100 %", image.detrended, "100 %"),
            row(ALONG_TRACK, image.along_track_quadratic, NONE, math.nan, NONE),
        ),
        f"Shares are of the variance [S-5], [T-15], [S-6]; along-track [S-2]. The initial tilt comes from {makers} "
        "[T-18]."
        if smoothed is None
        else "Smoothed with every fix [P-3]; shares of the variance [P-4]; phases [P-5].",
    )


def contributor_table(budget: Budget, key: str) -> Table:
    """The contributors that the design gives itself: what each is and what it enters."""
    return table(
        f"{key}-contributors",
        "Contributors given in the design",
        (("Contributor", 1.3), ("Enters", 1.3), *numbers("Value, 1σ"), *numbers("Allowance", width=0.9),
         "Kind", "Processing", ("Owner", 1), ("Source", 1.3)),
        (
            tuple(
                printable(text)
                for text in (
                    one.name, label_of(one.enters), one.show(6), percent(one.allowance), one.kind, one.processing,
                    one.owner or NONE, one.source or NONE,
                )
            )
            for one in budget.design.contributors
        ),
        CONTRIBUTORS_ENTER,
    )  # fmt: skip


def echo_table(budget: Budget, key: str) -> Table | Text:
    """Paired echoes of the design's lines, and what its fast phase errors scatter."""
    spectral, wavelength = budget.spectral, budget.sar.wavelength
    if not budget.has_fast_sources:
        return Text("The design has no uncompensated vibration, no unsensed motion and no oscillator noise.")

    def level(amplitude: float) -> str:
        return decibels(20 * math.log10(amplitude)) if amplitude > NOTHING else "none"

    shares = ", ".join(f"{source} {percent(share)}" for source, share in spectral.shares["islr"].items() if share)
    scattered = f"{level(spectral.levels['islr'])} ({shares})" if shares else "none"
    return table(
        f"{key}-echoes",
        "Paired echoes of vibration, beside a target",
        (("Source", 1.3), *numbers("Line [Hz]", "Phase, peak [°]", "[mm]", "Level [P-9]", "Distance [P-9]")),
        tuple(
            (
                echo.source,
                number(echo.frequency, given=True),
                degrees(echo.phase),
                millimetres(echo.phase, wavelength),
                level(echo.level),
                show(echo.offset, "length"),
            )
            for echo in spectral.echoes
        )
        or (("no line beyond the main lobe", *(NONE,) * 5),),
        f"After the IMU's compensation [P-8]. Energy scattered out of the main lobe, over the target's: {scattered} "
        f"[P-11]; peak loss {decibels(-10 * math.log10(spectral.stays))} [P-11]. The same in real time and "
        "post-processed.",
    )


def image_table(budget: Budget, key: str) -> Table:
    """The aperture, and the azimuth response with the quadratic phase."""
    sar, sources = budget.sar, provenance(budget)
    smoothed, phases = budget.smoothed, budget.smoothed or budget.sar
    response = phases.impulse_response

    def image(name: str, show_value: Callable[[float], str], scale: float = 1.0) -> str:
        return "no image: more than 1000 rad" if response is None else show_value(scale * getattr(response, name))

    rows = (
        ("Wavelength", show(sar.wavelength, "length"), "sar.wavelength_m"),
        ("Aperture time", show(sar.aperture_time, "time"), "sar.aperture_time_s"),
        ("Aperture length", show(sar.aperture_length, "length"), "sar.aperture_length_m"),
        ("Quadratic phase, 1σ", f"{degrees(phases.quadratic)}°", "sar.quadratic_phase_sigma_rad"),
        ("Cubic phase, 1σ", f"{degrees(phases.cubic)}°", "sar.cubic_phase_sigma_rad"),
        ("Detrended phase, 1σ", f"{degrees(phases.detrended)}°", "sar.detrended_phase_sigma_rad"),
        (
            "Response width",
            image("half_power_extent_cells", lambda width: show(width, "length"), sar.cell_length),
            "sar.impulse_response",
        ),
        ("Peak side-lobe ratio", image("pslr_fixed_db", decibels), "sar.impulse_response"),
        ("Integrated side-lobe ratio", image("islr_fixed_db", decibels), "sar.impulse_response"),
        ("Peak loss", image("peak_loss_db", decibels), "sar.impulse_response"),
    )

    def equation(name: str) -> str:
        known = sources[name].equation
        if smoothed is None:
            return known
        return "[P-5]" if "phase" in name else known.replace("[S-5]", "[P-5]")

    def origin(name: str) -> str:
        source = sources[name]
        if smoothed is not None and "phase" in name:
            return "smoothed"
        stated = name == "sar.aperture_time_s" and budget.design.radar.aperture_time is not None
        return "stated in the design" if stated else ", ".join(filter(None, (source.method, source.note)))

    return table(
        f"{key}-image",
        f"Aperture and azimuth impulse response, {SAID[budget.verdict.processing]}",
        (("Quantity", 1.3), *numbers("Value", width=1), ("Equation", 0.8), ("Method", 1.7)),
        ((label, value, equation(name), origin(name)) for label, value, name in rows),
        "Width between the outermost half-power points; side lobes outside the error-free main lobe, whole line.",
    )

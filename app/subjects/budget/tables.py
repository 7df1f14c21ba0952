"""The tables of a budget, for page, report and command alike."""

import math
from collections.abc import Callable

import numpy as np

from app.document.blocks import Cell, Row, TableBlock, Text, numbers, table
from app.document.display import ONE_SIGMA, Display
from app.document.numbers import NONE, decibels, degrees, millimetres, number, percent, show, show_in
from app.document.verdict import SAID, check_words, closes_cell, met_cell
from app.document.wording import best_of, printable
from nav_model.aperture.phase import INITIAL_TILT
from nav_model.budget import Budget, analyse
from nav_model.budget.navigation import steady_marks
from nav_model.budget.provenance import provenance
from nav_model.budget.verdict import Check, flies
from nav_model.design.figures import DETRENDED, FIGURES, QUADRATIC, REQUIRED, STEADY, label_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.processing.paired_echo import NOTHING

PARTS = {"line_of_sight": "line of sight", "along_track": "along-track"}
"""Names of the parts of the image's phase beside its sources."""
CONTRIBUTORS_ENTER = (
    "Random contributors add in quadrature, systematic ones linearly, each with its allowance. A length along the "
    "line of sight enters a phase by 4π/λ. What enters a position lasts through the outage. What enters CE90 or LE90 "
    "is given as a 90 % value."
)
"""Sentence on how the design's own contributors enter its figures."""
_OF_LEG = " Values are those of a straight leg; the verdict is that of the flight."
_FRACTIONS = (0.0, 0.1, 0.2, 0.5, 1.0)  # of the outage, in its table


def parted(name: str) -> bool:
    """True for a phase of the whole image, which has `PARTS`."""
    return all(f"{part}_{name}" in FIGURES for part in PARTS)


def requirement_table(budget: Budget, key: str = "d") -> TableBlock | Text:
    """Every requirement with its figure, limit, margin and what dominates it."""
    verdict = budget.verdict
    if not verdict.checks:
        return Text("The design has no requirement; nothing was checked.")

    def row(check: Check) -> Row:
        words = check_words(budget.design, check)
        main = f"{check.dominant}, {words.share}" if check.shares else NONE
        return check.label, words.value, words.limit, words.margin, met_cell(check, verdict), words.figure, main

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
        "Margin = (limit − value) / limit. Shares are of the variance [T-18].",
    )


def processing_table(budget: Budget, key: str = "budget") -> TableBlock:
    """Every figure that a requirement may limit and post-processing changes, in both processings."""
    names = [name for name in REQUIRED if FIGURES[name].smoothed_mark]

    def row(name: str) -> Row:
        figure, both = FIGURES[name], (budget[name, processing] for processing in (REAL_TIME, POST_PROCESSED))
        return figure.label, *(f"{show(sigma.sigma, figure.dimension)} {sigma.mark}" for sigma in both)

    def parts(name: str) -> Row:
        """The two parts of a phase under the whole, in one quiet line."""

        def value(part: str, processing: str) -> str:
            return show(budget[f"{part}_{name}", processing].sigma, FIGURES[name].dimension)

        texts = (" · ".join(value(part, mode) for part in PARTS) for mode in (REAL_TIME, POST_PROCESSED))
        return tuple(Cell(text, tone="quiet") for text in (" · ".join(PARTS.values()), *texts))

    closes = {
        verdict.processing: closes_cell(verdict)
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
            *(line for name in names for line in (row(name), *([parts(name)] if parted(name) else []))),
        ),
        "Real time: a free INS from the last fix. Post-processed: a smoother with the fixes before, in and after the "
        "aperture [P-3]. CE90, LE90: 90 % values. Parts of a phase need not add up to the whole. "
        f"Requirements are checked for {budget.verdict.processing}.{_OF_LEG if flies(budget.design) else ''}",
    )


def steady_table(budget: Budget, key: str, display: Display = ONE_SIGMA) -> TableBlock:
    """Standard deviations while fixes come in: over the cycle, before and after a fix."""
    steady, sources = budget.steady_state, provenance(budget)
    moments = (steady.closed, steady.prior, steady.posterior)

    def row(name: str) -> Row:
        figure, (source, share) = FIGURES[name], best_of(budget[name, REAL_TIME].shares)
        pair, spread = figure.pair, display.named(pair=figure.pair)
        texts = (
            show_in(moment[name], budget.design.unit(f"requirements.{name}"), figure.dimension)
            if display == ONE_SIGMA
            else display.show(moment[name], figure.dimension, pair=pair)
            for moment in moments
        )
        radius = display.factor(pair=pair) != display.factor()
        label = f"{figure.label}, {'radius' if radius else 'per axis'}" if pair else figure.label
        return label if display == ONE_SIGMA else f"{label}, {spread}", *texts, f"{source}, {percent(share)}"

    cycle = ", ".join(dict.fromkeys(steady_marks(budget.design)))
    moments_text = f"Average between fixes {cycle}", "Before a fix [T-8]", "After a fix [T-8]"
    closed = sources["steady_state.position_sigma_m.horizontal"]
    prior = sources["steady_state.discrete.prior"]
    return table(
        f"{key}-steady-table",
        f"Errors in real time while fixes come in, {display.spread}",
        (("Error", 1.5), *numbers(*moments_text), ("Largest share [T-18]", 1.2)),
        map(row, STEADY),
        f"Average between fixes: {closed.method}, {closed.note}. Before and after a fix: {prior.method}. "
        f"Gyro dominance κ = {number(steady.gyro_dominance)} [T-6]; λ Δt = {number(steady.lambda_dt)} [T-8].",
    )


def outage_table(budget: Budget, key: str) -> TableBlock:
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
        ("Heading growth [°] [T-5]", np.degrees(coast.yaw_growth)),
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


def phase_table(budget: Budget, key: str) -> TableBlock:
    """The phase budget of the aperture by source, of the design's processing."""
    sar, real_time = budget.sar, not budget.post_processed

    def row(label: str, quadratic: float, share: str, detrended: float, detrended_share: str) -> Row:
        given = not math.isnan(detrended)
        return (
            label,
            degrees(quadratic),
            millimetres(quadratic, sar.wavelength),
            share,
            degrees(detrended) if given else NONE,
            millimetres(detrended, sar.wavelength) if given else NONE,
            detrended_share,
        )

    def total(label: str, prefix: str, share: str) -> Row:
        quadratic, detrended = (budget.figure(f"{prefix}{name}").sigma for name in (QUADRATIC, DETRENDED))
        return row(label, quadratic, share, detrended, share)

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
                row(line.source, line.quadratic, percent(line.share), line.detrended, percent(line.detrended_share))
                for line in budget.phase_lines(budget.processing)
                if line.quadratic > 0 or line.detrended > 0
            ),
            total("total", "", "100 %"),
            *(total(label, f"{part}_", NONE) for part, label in PARTS.items()),
        ),
        f"Along the line of sight as it turns [{'S-8' if real_time else 'P-5'}]; shares of the variance [T-18]. "
        "Parts of the total: along the line of sight of mid-aperture, and of errors along the track alone [S-2]."
        + (by_tilt(budget) if real_time else " Smoothed with every fix [P-3]."),
    )


def by_tilt(budget: Budget) -> str:
    """The share of the tilt at the last fix in the quadratic phase along the line of sight, and the sensors behind
    it, in a sentence after others."""
    tilt = next(line for line in budget.sight_lines() if line.source == INITIAL_TILT)
    makers = ", ".join(f"{source} {percent(share)}" for source, share in budget.tilt_shares.items() if share)
    return (
        f" The tilt at the last fix makes {percent(tilt.share)} of the quadratic phase along the line of sight of "
        f"mid-aperture [S-5]; it comes from {makers} [T-18]."
    )


def contributor_table(budget: Budget, key: str) -> TableBlock:
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
                    c.name, label_of(c.enters), c.show(6), percent(c.allowance), c.kind, c.processing,
                    c.owner or NONE, c.source or NONE,
                )
            )
            for c in budget.design.contributors
        ),
        CONTRIBUTORS_ENTER,
    )  # fmt: skip


def echo_table(budget: Budget, key: str) -> TableBlock | Text:
    """Paired echoes of the design's lines, and what its fast phase errors scatter."""
    spectral, wavelength = budget.spectral, budget.sar.wavelength
    if not budget.has_fast_sources:
        return Text("The design has no uncompensated vibration, no unsensed motion and no oscillator noise.")

    def level(amplitude: float) -> str:
        return decibels(20 * math.log10(amplitude)) if amplitude > NOTHING else "none"

    islr = budget.figure("islr")
    shares = ", ".join(f"{source} {percent(share)}" for source, share in islr.shares.items() if share)
    scattered = f"{level(islr.sigma)} ({shares})" if shares else "none"
    return table(
        f"{key}-echoes",
        "Paired echoes of vibration around a target",
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
        f"[P-11]; peak loss {decibels(-10 * math.log10(spectral.power_at_target))} [P-11]. The same in real time and "
        "post-processed.",
    )


def image_table(budget: Budget, key: str) -> TableBlock:
    """The aperture, and the azimuth response with the quadratic phase."""
    sar, sources = budget.sar, provenance(budget)
    response = budget.response(budget.processing)

    def image(name: str, show_value: Callable[[float], str], scale: float = 1.0) -> str:
        return "no image: more than 1000 rad" if response is None else show_value(scale * getattr(response, name))

    rows = (
        ("Wavelength", show(sar.wavelength, "length"), "sar.wavelength_m"),
        ("Aperture time", show(sar.aperture_time, "time"), "sar.aperture_time_s"),
        ("Aperture length", show(sar.aperture_length, "length"), "sar.aperture_length_m"),
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
        return known.replace("[S-8]", "[P-5]") if budget.post_processed else known

    def origin(name: str) -> str:
        source = sources[name]
        stated = name == "sar.aperture_time_s" and budget.design.radar.aperture_time is not None
        return "stated in the design" if stated else ", ".join(filter(None, (source.method, source.note)))

    return table(
        f"{key}-image",
        f"Aperture and azimuth impulse response, {SAID[budget.verdict.processing]}",
        (("Quantity", 1.3), *numbers("Value", width=1), ("Equation", 0.8), ("Method", 1.7)),
        ((label, value, equation(name), origin(name)) for label, value, name in rows),
        "Width between the outermost half-power points; side lobes outside the error-free main lobe, whole line.",
    )

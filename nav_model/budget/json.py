"""A budget as plain JSON-ready data, with the names of the contract. SI throughout."""

import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from operator import attrgetter, methodcaller
from typing import Any

from nav_model.aperture.impulse_response import ImpulseResponse
from nav_model.budget.allocation import Allocation
from nav_model.budget.contributors import size_of
from nav_model.budget.provenance import cautions, provenance
from nav_model.budget.result import Budget
from nav_model.budget.verdict import Check, Verdict
from nav_model.design.contributors import Contributor
from nav_model.design.figures import FIGURES, OF_BUDGET, PARTS_OF_PHASES, PHASES, QUADRATIC
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.processing.paired_echo import NOTHING


def to_json(budget: Budget) -> dict[str, Any]:
    """Every number of the budget under the contract's keys, and where each comes from."""
    design, steady, coast, sar, verdict = (
        budget.design,
        budget.steady_state,
        budget.coast,
        budget.sar,
        budget.verdict,
    )
    ends = [budget[name, REAL_TIME] for name in ("coast_horizontal_position", "coast_vertical_position")]
    return {
        "design": {"name": design.name, "content_hash": design.content_hash, "inputs": dict(design.items())},
        "steady_state": {
            **_sigmas(steady.closed),
            "gyro_dominance": steady.gyro_dominance,
            "lambda_dt": steady.lambda_dt,
            "asymptote": dict(
                zip(("position_sigma_m", "velocity_sigma_m_s", "tilt_sigma_rad"), steady.asymptote, strict=True)
            ),
            "shares": {name: _model_shares(budget, name) for name in steady.closed},
            "discrete": {"prior": _sigmas(steady.prior), "posterior": _sigmas(steady.posterior)},
        },
        "coast": {
            "time_s": coast.time.tolist(),
            "position_sigma_m": _pair(coast.position_horizontal, coast.position_vertical),
            "velocity_sigma_m_s": _pair(coast.velocity_horizontal, coast.velocity_vertical),
            "tilt_sigma_rad": coast.tilt.tolist(),
            "yaw_growth_rad": coast.yaw_growth.tolist(),
            "refined_position_sigma_m": _pair(coast.refined_horizontal, coast.refined_vertical),
            "perfect_start_position_sigma_m": _pair(coast.perfect_start_horizontal, coast.perfect_start_vertical),
            "initial_tilt_position_sigma_m": coast.initial_tilt.tolist(),
            "end": {
                "time_s": coast.duration,
                "refined_position_sigma_m": _pair(*(end.sigma for end in ends)),
                "shares": _pair(*(dict(end.shares) for end in ends)),
            },
        },
        "sar": {
            "wavelength_m": sar.wavelength,
            "aperture_time_s": sar.aperture_time,
            "aperture_length_m": sar.aperture_length,
            "cell_length_m": sar.cell_length,
            "autofocus_order": sar.autofocus_order,
            **_phases(budget, REAL_TIME),
            "lines": [
                {
                    "source": line.source,
                    **{FIGURES[name].column: getattr(line, name.removesuffix("_phase")) for name in PHASES},
                    "share": line.share,
                    "detrended_share": line.detrended_share,
                }
                for line in budget.sight_lines()
            ],
            "initial_tilt_shares": dict(budget.tilt_shares),
            "impulse_response": _response(budget.response(REAL_TIME), sar.cell_length),
            "impulse_response_after_autofocus": _response(budget.response_after_autofocus(), sar.cell_length),
        },
        "processing": {"mode": verdict.processing},
        "post_processed": _post_processed(budget),
        "geolocation": {
            "real_time": _placement(budget, REAL_TIME),
            "post_processed": _placement(budget, POST_PROCESSED),
        },
        "spectral": _spectral(budget),
        "figures": {
            "real_time": _sigmas_of(budget, REAL_TIME, *OF_BUDGET),
            "post_processed": _sigmas_of(budget, POST_PROCESSED, *OF_BUDGET),
        },
        "contributors": [_contributor(contributor, sar.wavelength) for contributor in design.contributors],
        "verdict": verdict_json(verdict),
        "other_verdict": verdict_json(budget.other_verdict),
        "cautions": list(cautions(budget)),
        "provenance": {
            **{key: asdict(entry) for key, entry in provenance(budget).items()},
            **{
                f"figures.{processing.replace(' ', '_').replace('-', '_')}.{FIGURES[name].column}": {
                    "equation": mark,
                    "method": basis,
                    "note": "with contributors",
                }
                for name, processing in budget
                for basis, mark in (budget.origin(name, processing),)
            },
        },
    }


def allocation_json(allocation: Allocation) -> dict[str, Any]:
    """An allocation under the contract's keys."""
    entries = [asdict(entry) | {"margin": entry.margin} for entry in allocation.entries]
    return asdict(allocation) | {"closes": allocation.closes, "entries": entries}


def verdict_json(verdict: Verdict) -> dict[str, Any]:
    """A verdict and its checks."""
    return {
        "processing": verdict.processing,
        "state": verdict.state,
        "closes": verdict.closes,
        "confidence": verdict.confidence,
        "tightest": verdict.tightest.name if verdict.tightest else None,
        "requirements": [_check(check) for check in verdict.checks],
    }


def _sigmas_of(budget: Budget, processing: str, *names: str) -> dict[str, float]:
    """Figures with contributors under their columns' names, SI."""
    return {FIGURES[name].column: budget[name, processing].sigma for name in names}


def _phases(budget: Budget, processing: str) -> dict[str, float]:
    """Phases of the image, and its parts: those along the line of sight of mid-aperture without a prefix."""
    parts = {FIGURES[name].column: budget[name, processing].sigma for name in PARTS_OF_PHASES}
    image = {f"image_{FIGURES[name].column}": budget[name, processing].sigma for name in PHASES}
    return {key.removeprefix("line_of_sight_"): sigma for key, sigma in parts.items()} | image


def _model_shares(budget: Budget, name: str) -> dict[str, float]:
    """Shares in the variance of a figure of real time without contributors."""
    return dict(budget[name, REAL_TIME].of_model)


def _post_processed(budget: Budget) -> dict[str, Any]:
    figures = {name: budget[name, POST_PROCESSED] for name in OF_BUDGET}
    sigmas = {name: figure.sigma for name, figure in figures.items()}
    return {
        **_sigmas(sigmas),
        **_phases(budget, POST_PROCESSED),
        "detrended_phase_by_order_sigma_rad": {
            str(order): budget.beside(methodcaller("sight_detrended", order)) for order in (1, 2, 3)
        },
        "image_detrended_phase_by_order_sigma_rad": {
            str(order): sigmas[f"detrended_phase_{order}"] for order in (1, 2, 3)
        },
        f"turning_{FIGURES[QUADRATIC].column}": figures[QUADRATIC].model,
        "turning_detrended_phase_by_order_sigma_rad": {
            str(order): figures[f"detrended_phase_{order}"].model for order in (1, 2)
        },
        "azimuth_shift_sigma_m": budget.beside(attrgetter("slope_shift")),
        "method": "state space",
        "lines": [
            {"source": source, "share": share}
            for source, share in figures[f"line_of_sight_{QUADRATIC}"].shares.items()
            if share
        ],
    }


def _placement(budget: Budget, processing: str) -> dict[str, Any]:
    azimuth, across, both = budget.ground(processing)
    return {
        "range_m": budget["range_shift", processing].sigma,
        "azimuth_m": budget["azimuth_shift", processing].sigma,
        "ground_covariance_m2": [[azimuth, both], [both, across]],
        **_sigmas_of(budget, processing, "ce90", "cep", "le90"),
    }


_CHECK = (
    *(item.name for item in fields(Check) if item.name not in ("unit", "shares")),
    *("met", "dominant", "dominant_share"),
)


def _check(check: Check) -> dict[str, Any]:
    """A check under the contract's names, where its basis is called "figure"; levels in decibels, null what is not
    known."""
    content: dict[str, Any] = {"figure" if name == "basis" else name: getattr(check, name) for name in _CHECK}
    content |= {"sensor": check.dominant, "sensor_share": check.dominant_share}  # the sources are sensors
    if check.dimension == "level":
        content |= {name: _decibels(content[name]) for name in ("value", "sigma", "limit")}
    return {name: None if value != value else value for name, value in content.items()}


def _spectral(budget: Budget) -> dict[str, Any]:
    spectral, islr = budget.spectral, budget["islr", REAL_TIME]
    return {
        "echoes": [
            {
                "source": echo.source,
                "frequency_hz": echo.frequency,
                "phase_rad": echo.phase,
                "level_db": _decibels(echo.level),
                "offset_m": echo.offset,
            }
            for echo in spectral.echoes
        ],
        "islr_db": _decibels(islr.model),
        "peak_loss_db": _decibels(math.sqrt(spectral.power_at_target)),
        "islr_shares": _model_shares(budget, "islr"),
    }


def _contributor(entry: Contributor, wavelength: float) -> dict[str, Any]:
    """A contributor with its 1σ in the figure that it enters, allowance included; zero for none."""
    dimension, sigma = FIGURES[entry.enters].dimension, float(size_of(entry, wavelength))
    if dimension == "level":
        sigma = _decibels(max(sigma, NOTHING))
    unit = {"angle": "rad", "length": "m", "speed": "m/s", "level": "dB", "loss": "dB"}[dimension]
    return {"name": entry.name, "enters": entry.enters, "sigma": sigma, "unit": unit, "owner": entry.owner}


def _decibels(amplitude: float) -> float:
    return 20 * math.log10(amplitude)


def _sigmas(sigmas: Mapping[str, float]) -> dict[str, Any]:
    return {
        "position_sigma_m": _pair(sigmas["horizontal_position"], sigmas["vertical_position"]),
        "velocity_sigma_m_s": _pair(sigmas["horizontal_velocity"], sigmas["vertical_velocity"]),
        "tilt_sigma_rad": sigmas["tilt"],
    }


def _pair(horizontal: Any, vertical: Any) -> dict[str, Any]:
    plain = (value.tolist() if hasattr(value, "tolist") else value for value in (horizontal, vertical))
    return dict(zip(("horizontal", "vertical"), plain, strict=True))


def _response(response: ImpulseResponse | None, cell: float) -> dict[str, Any] | None:
    """Width between the outermost half-power points; side lobes outside the error-free main lobe ("fixed").

    Both choices are the cautious ones: a split lobe counts whole, a shoulder counts as a side lobe.
    """
    if response is None:
        return None
    width = float(response.half_power_extent_cells)
    return {
        "width_cells": width,
        "width_m": width * cell,
        "pslr_db": response.pslr_fixed_db,
        "islr_db": response.islr_fixed_db,
        "pslr_null_db": response.pslr_null_db,
        "islr_null_db": response.islr_null_db,
        "islr_ten_nulls_db": response.islr_fixed_ten_db,
        "peak_loss_db": response.peak_loss_db,
    }

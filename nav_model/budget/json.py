"""A budget as plain JSON-ready data, with the names of the contract. SI throughout."""

import math
from dataclasses import asdict, fields
from typing import Any

from nav_model.aperture.impulse_response import ImpulseResponse
from nav_model.budget.allocation import Allocation
from nav_model.budget.contributors import size_of
from nav_model.budget.provenance import cautions, provenance
from nav_model.budget.result import Budget, Check, Placement, PostProcessed, Sigmas, Spectral, Verdict
from nav_model.design.contributors import BY_ORDER, COASTING, ENTERED, Contributor
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
    ends = [coast.checked[name] for name in COASTING]
    return {
        "design": {"name": design.name, "content_hash": design.content_hash, "inputs": dict(design.items())},
        "steady_state": {
            **_sigmas(steady.closed),
            "gyro_dominance": steady.gyro_dominance,
            "lambda_dt": steady.lambda_dt,
            "asymptote": dict(
                zip(("position_sigma_m", "velocity_sigma_m_s", "tilt_sigma_rad"), steady.asymptote, strict=True)
            ),
            "shares": {kind: dict(shares) for kind, shares in steady.shares.items()},
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
            "quadratic_phase_sigma_rad": sar.quadratic,
            "cubic_phase_sigma_rad": sar.cubic,
            "detrended_phase_sigma_rad": sar.detrended,
            "lines": [
                {
                    "source": line.source,
                    "quadratic_phase_sigma_rad": line.quadratic,
                    "cubic_phase_sigma_rad": line.cubic,
                    "detrended_phase_sigma_rad": line.detrended,
                    "share": line.share,
                    "detrended_share": line.detrended_share,
                }
                for line in sar.lines
            ],
            "initial_tilt_shares": dict(sar.tilt_shares),
            "along_track_quadratic_phase_sigma_rad": sar.along_track_quadratic,
            "impulse_response": _response(sar.impulse_response, sar.cell_length),
            "impulse_response_after_autofocus": _response(sar.after_autofocus, sar.cell_length),
        },
        "processing": {"mode": verdict.processing},
        "post_processed": _post_processed(budget.post_processed),
        "geolocation": {
            "real_time": _placement(budget.placement),
            "post_processed": _placement(budget.post_processed_placement),
        },
        "spectral": _spectral(budget.spectral),
        "contributors": [_contributor(one, sar.wavelength) for one in design.contributors],
        "verdict": verdict_json(verdict),
        "other_verdict": verdict_json(budget.other_verdict),
        "cautions": list(cautions(budget)),
        "provenance": {key: asdict(entry) for key, entry in provenance(budget).items()},
    }


def allocation_json(found: Allocation) -> dict[str, Any]:
    """An allocation under the contract's keys."""
    entries = [asdict(entry) | {"margin": entry.margin} for entry in found.entries]
    return asdict(found) | {"closes": found.closes, "entries": entries}


def verdict_json(verdict: Verdict) -> dict[str, Any]:
    """A verdict and its checks."""
    return {
        "processing": verdict.processing,
        "closes": verdict.closes,
        "confidence": verdict.confidence,
        "tightest": verdict.tightest.name if verdict.tightest else None,
        "requirements": [_check(check) for check in verdict.checks],
    }


def _post_processed(smoothed: PostProcessed) -> dict[str, Any]:
    shares = smoothed.shares["quadratic_phase"]
    return {
        **_sigmas(smoothed.sigmas),
        "quadratic_phase_sigma_rad": smoothed.quadratic,
        "cubic_phase_sigma_rad": smoothed.cubic,
        "detrended_phase_sigma_rad": smoothed.detrended,
        "detrended_phase_by_order_sigma_rad": {str(BY_ORDER[name]): left for name, left in smoothed.by_order.items()},
        "along_track_quadratic_phase_sigma_rad": smoothed.along_track_quadratic,
        "turning_quadratic_phase_sigma_rad": smoothed.turning_quadratic,
        "turning_detrended_phase_by_order_sigma_rad": {
            str(n): left for n, left in enumerate(smoothed.turning_by_order, 1)
        },
        "azimuth_shift_sigma_m": smoothed.azimuth_shift,
        "method": "state space",
        "lines": [{"source": source, "share": share} for source, share in shares.items()],
    }


def _placement(placement: Placement) -> dict[str, Any]:
    azimuth, across, both = placement.ground
    return {
        "range_m": placement.range,
        "azimuth_m": placement.azimuth,
        "ground_covariance_m2": [[azimuth, both], [both, across]],
        "ce90_m": placement.ce90,
        "cep_m": placement.cep,
        "le90_m": placement.le90,
    }


_CHECK = (
    *(item.name for item in fields(Check) if item.name not in ("shares", "tilt_shares")),
    *("dominant", "dominant_share", "sensor", "sensor_share"),
)


def _check(check: Check) -> dict[str, Any]:
    """A check under the contract's names, where its basis is called "figure"; levels in decibels."""
    said: dict[str, Any] = {"figure" if name == "basis" else name: getattr(check, name) for name in _CHECK}
    if check.dimension == "level":
        said |= {name: _decibels(said[name]) for name in ("value", "sigma", "limit")}
    return said


def _spectral(spectral: Spectral) -> dict[str, Any]:
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
        "islr_db": _decibels(spectral.levels["islr"]),
        "peak_loss_db": _decibels(math.sqrt(spectral.stays)),
        "islr_shares": dict(spectral.shares["islr"]),
    }


def _contributor(one: Contributor, wavelength: float) -> dict[str, Any]:
    """A contributor with its 1σ in the figure that it enters, allowance included; zero for none."""
    dimension, sigma = ENTERED[one.enters], float(size_of(one, wavelength))
    if dimension == "level":
        sigma = _decibels(max(sigma, NOTHING))
    unit = {"angle": "rad", "length": "m", "speed": "m/s", "level": "dB", "loss": "dB"}[dimension]
    return {"name": one.name, "enters": one.enters, "sigma": sigma, "unit": unit, "owner": one.owner}


def _decibels(amplitude: float) -> float:
    return 20 * math.log10(amplitude)


def _sigmas(sigmas: Sigmas) -> dict[str, Any]:
    return {
        "position_sigma_m": _pair(sigmas.position_horizontal, sigmas.position_vertical),
        "velocity_sigma_m_s": _pair(sigmas.velocity_horizontal, sigmas.velocity_vertical),
        "tilt_sigma_rad": sigmas.tilt,
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

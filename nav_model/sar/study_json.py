"""A study of the strategies as plain JSON-ready data, SI throughout; missing values are null."""

import math
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.budget.json import verdict_json
from nav_model.design.figures import QUADRATIC
from nav_model.sar.agreement import agreement, agreement_sentence
from nav_model.sar.decomposition import MedianBand
from nav_model.sar.design_case import flight_cautions, judged, study_cautions
from nav_model.sar.design_map import DesignMap, arw_map, gnss_map
from nav_model.sar.design_study import ClosedForms, SarStudy
from nav_model.sar.strategies import STRATEGIES

_JSON_MAP_POINTS = 40


def to_json(study: SarStudy, beside: SarStudy | None = None) -> dict[str, Any]:
    """Every number of the study, and its cautions.

    ``beside``: for a study of flights, the fast engine's study of the same design, for comparison.
    """
    budget = study.budget
    sar = budget.sar
    compared = {} if beside is None else {"agreement": _agreement(study, beside)}
    flown = flight_cautions(budget) if study.engine == "simulator" else ()
    return {
        "design": {"name": budget.design.name, "content_hash": budget.design.content_hash},
        "engine": study.engine,
        "runs": study.runs,
        "seed": study.seed,
        "wavelength_m": sar.wavelength,
        "aperture_time_s": sar.aperture_time,
        "cell_length_m": sar.cell_length,
        "coast_before_aperture_s": budget.design.coast.before_aperture,
        "squint_rad": budget.design.radar.squint_angle,
        "processing": {"mode": budget.design.processing.mode, "leg_after_s": budget.design.processing.leg_after},
        "autofocus_order": sar.autofocus_order,
        "window": sar.window,
        "fixes_in_aperture": study.fixes,
        "slow_gnss_error": "estimated by the filter" if budget.design.gnss.correlated else "off",
        "verdict": verdict_json(budget.verdict),
        "judged_strategy": judged(budget.design),
        "advice": advice(study.closed),
        "ensemble_sentence": study.sentence,
        "strategies": [_strategy(study, index) for index in range(len(STRATEGIES))],
        "jump_rms_m": _band(study.jump_rms, ...),
        "tuning": asdict(study.tuning),
        "typical_run": {
            "time_s": study.time.tolist(),
            "residual_m": {s.key: study.typical.residual[i].tolist() for i, s in enumerate(STRATEGIES)},
            "residual_rms_over_runs_m": {s.key: study.spread[i].tolist() for i, s in enumerate(STRATEGIES)},
        },
        "maps": {
            "gnss_position_noise_m": _map(gnss_map(budget, _JSON_MAP_POINTS)),
            "angle_random_walk_rad_sqrt_s": _map(arw_map(budget, _JSON_MAP_POINTS)),
        },
        "cautions": [*study_cautions(budget), *flown],
        **compared,
    }


def _agreement(study: SarStudy, beside: SarStudy) -> dict[str, Any]:
    agreements = agreement(study, beside)
    return {
        "with": {"engine": beside.engine, "runs": beside.runs, "seed": beside.seed},
        "sentence": agreement_sentence(agreements),
        "strategies": [
            {
                "key": row.key,
                "flown_residual_rms_m": row.flown,
                "fast_residual_rms_m": row.fast,
                "ratio": row.ratio,
                "ratio_standard_error": row.error,
                "agrees": row.agrees,
            }
            for row in agreements
        ],
    }


def advice(closed: ClosedForms) -> dict[str, Any]:
    """The advice of the closed forms."""
    text = closed.advice
    return {
        "strategy": text.strategy,
        "sentence": text.sentence,
        "because": text.because,
        "would_change": text.would_change,
        "break_even_aperture_s": text.break_even_aperture,
        "break_even_gnss_sigma_m": text.break_even_gnss_sigma,
        "required_phase_rad": closed.required_phase,
    }


def _strategy(study: SarStudy, index: int) -> dict[str, Any]:
    strategy = STRATEGIES[index]
    key = strategy.key
    return {
        "key": key,
        "name": strategy.name,
        "causal": strategy.causal,
        "timing": strategy.timing,
        "reconstruction": strategy.reconstruction,
        "source": strategy.source,
        "closed_form": {
            "residual_rms_m": study.closed.detrended.get(key),
            "quadratic_sigma_m": study.closed.quadratic.get(key),
        },
        "residual_rms_over_runs_m": float(study.residuals[index]),
        "residual_rms_over_runs_standard_error_m": float(study.rms_error[index]),
        "quadratic_sigma_m": float(study.composed(QUADRATIC, study.quadratic_rms)[index]),
        "quadratic_sigma_standard_error_m": float(study.quadratic_rms_error[index]),
        "parts_m": {name: _band(values, index) for name, values in study.parts.items()},
        "impulse_response": {name: _band(values, index) for name, values in study.responses.items()},
        "fix_rate_harmonics_m": _band(study.fix_harmonics, index),
    }


def _band(values: MedianBand, index: Any) -> dict[str, Any]:
    return {
        "median": _plain(values.median[index]),
        "p5": _plain(values.low[index]),
        "p95": _plain(values.high[index]),
    }


def _plain(value: NDArray[np.float64]) -> Any:
    if value.ndim:
        return [_plain(item) for item in value]
    return float(value) if math.isfinite(value) else None


def _map(drawn: DesignMap) -> dict[str, Any]:
    return {
        "aperture_time_s": drawn.aperture_time.tolist(),
        "values": drawn.other.tolist(),
        "winner": [[drawn.strategies[i] for i in row] for row in drawn.winner],
        "detrended_phase_rad": drawn.phase.tolist(),
    }

"""The study in words and as JSON, and the paper's readable numbers for comparison."""

import numpy as np

from nav_model.base.arrays import Array
from nav_model.suborbital.channels import height_e_folding_time
from nav_model.suborbital.errors import CLASSES
from nav_model.suborbital.study import GRAVITY_ROW, Study

PAPER_FINAL_M: dict[str, dict[str, tuple[float, float]]] = {
    "accelerometer bias": {"height": (20000, 20000), "y": (8000, 8000), "x": (10500, 10500)},
    "accelerometer instability": {"height": (6000, 6000), "y": (4000, 4000), "x": (3700, 3700)},
    "accelerometer total": {"height": (14000, 14000), "y": (12000, 12000), "x": (7300, 7300)},
    "gyro bias": {"height": (20000, 20000), "y": (7500, 7500), "x": (10500, 10500)},
    "gyro instability": {"height": (500, 500), "y": (200, 500), "x": (600, 600)},
    "gyro total": {"height": (20500, 20500), "y": (7500, 7500), "x": (11100, 11100)},
    "initial position and velocity": {"height": (460, 480), "y": (260, 280), "x": (220, 250)},
    "improvement by the star tracker": {"height": (9000, 9000), "y": (3000, 3000), "x": (3000, 3000)},
}
"""Final error sizes as read from [B], (low, high) m. Its sensors and trajectory are lost: for comparison
only."""


def _size(vector: Array) -> float:
    return float(np.linalg.norm(vector))


def _metres(value: float) -> str:
    """Three digits in the unit that suits them.

    >>> _metres(9713.0), _metres(560.2), _metres(0.75), _metres(0.0002)
    ('9.71 km', '560 m', '75.0 cm', '< 1 mm')
    """
    for unit, size in (("km", 1e3), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)):
        if abs(value) >= size:
            return f"{f'{value / size:#.3g}'.rstrip('.')} {unit}"
    return "< 1 mm"


def final_total(study: Study) -> tuple[Array, Array]:
    """Final position error of the INS alone and with the tracker, (3,) m each, root of the squares of the sum of the
    signed errors and of white noise."""
    pure, aided = study.final_m("all")
    noise, aided_noise = study.pure_noise.position_sigma_m[-1], study.aided_noise.position_sigma_m[-1]
    return np.hypot(pure, noise), np.hypot(aided, aided_noise)


def explain(study: Study) -> str:
    """Sentences on what the tracker did and did not repair, made from the numbers of the study."""
    flight, end = study.flight, study.flight.time_s[-1]
    pure, aided = ({name: study.final_m(name)[which] for name in study.names} for which in (0, 1))
    whole, left_over = final_total(study)
    before, after = _size(whole), _size(left_over)
    if not np.any(study.used):
        return (
            f"The star tracker gives no frame on this flight, so it corrects nothing. After {end:.0f} s the "
            f"position error is {_metres(before)} ({_metres(float(whole[2]))} in height)."
        )
    parts: list[str] = []
    ratio = after / before if before > 0.0 else 1.0
    change = "brings it to" if ratio < 0.98 else "leaves it at" if ratio < 1.02 else "raises it to"
    parts.append(
        f"After {end:.0f} s the position error of the INS alone is {_metres(before)} "
        f"({_metres(float(whole[2]))} in height), white noise included; the star tracker {change} {_metres(after)} "
        f"({_metres(float(left_over[2]))} in height)."
    )
    forcing = [_size(pure[n]) for n in ("gyro total", "initial attitude")]
    remaining = [_size(aided[n]) for n in ("gyro total", "initial attitude")]
    if max(forcing) < 1.0:
        parts.append("Attitude errors hardly matter on this flight.")
    else:
        share = sum(remaining) / sum(forcing)
        verbs = ((0.05, "removes"), (0.98, "reduces"), (1.02, "does not change"), (np.inf, "adds to"))
        verb = next(word for limit, word in verbs if share < limit)
        parts.append(
            f"It {verb} errors that come through attitude: gyro errors go from {_metres(forcing[0])} to "
            f"{_metres(remaining[0])}, initial alignment from {_metres(forcing[1])} to {_metres(remaining[1])}."
        )
    first = float(flight.time_s[int(np.argmax(study.used))])
    if flight.burnout_s is not None and first > flight.step_s:
        if first >= flight.burnout_s:
            parts.append(
                f"Its first frame comes at {first:.0f} s, after burn-out at {flight.burnout_s:.0f} s: without thrust "
                "attitude does not matter, so it is too late to help."
            )
        else:
            parts.append(
                f"Its first frame comes at {first:.0f} s of a boost of {flight.burnout_s:.0f} s. Errors from "
                "attitude before that remain."
            )
    of_camera = _size(sum((aided[n] for n in ("star tracker misalignment", "star tracker latency")), np.zeros(3)))
    if of_camera >= 1.0:
        parts.append(f"Its own misalignment and latency cost {_metres(of_camera)}.")
    unaffected = [
        (name, _size(aided[name]))
        for name in ("accelerometer total", "initial position and velocity")
        if _size(aided[name]) >= 1.0
    ]
    believed = study.inputs.ins_gravity
    if believed != flight.gravity:
        unaffected.append((f"{GRAVITY_ROW} ({flight.gravity} truth, {believed} INS)", _size(aided[GRAVITY_ROW])))
    if unaffected:
        parts.append(
            "It cannot reduce errors that do not come through attitude: "
            + ", ".join(f"{name} {_metres(size)}" for name, size in unaffected)
            + "."
        )
    slow = float(height_e_folding_time(np.mean(flight.height_m)))
    parts.append(
        f"It does not stabilise the height: an unaided height error grows by a factor e about every {slow:.0f} s."
    )
    return " ".join(parts)


def by_channel(values: Array) -> dict[str, float]:
    """A position error under the names of its axes."""
    return dict(zip(("north", "east", "up"), map(float, values), strict=True))


def to_json(study: Study) -> dict[str, object]:
    """The contract's JSON of `navbudget suborbital`: final errors by class in metres, pure and aided; with
    the single sources, the gravity row, white noise, the flight and where each number came from beside
    them."""
    flight = study.flight
    apogee_time, apogee_height = flight.apogee

    def both(pure: Array, aided: Array) -> dict[str, dict[str, float]]:
        return {"final_m": by_channel(pure), "aided_final_m": by_channel(aided)}

    rows = {name: both(*study.final_m(name)) for name in study.names}
    return {
        "final_m": {name: rows[name]["final_m"] for name in CLASSES},
        "aided_final_m": {name: rows[name]["aided_final_m"] for name in CLASSES},
        "sources": {name: row for name, row in rows.items() if name not in CLASSES},
        "white_noise_sigma_m": both(study.pure_noise.position_sigma_m[-1], study.aided_noise.position_sigma_m[-1]),
        "flight": {
            "name": flight.name,
            "duration_s": float(flight.time_s[-1]),
            "apogee_time_s": apogee_time,
            "apogee_height_m": apogee_height,
            "burnout_s": flight.burnout_s,
            "source": flight.source,
        },
        "summary": explain(study),
        "provenance": dict(zip(study.names, study.marks, strict=True)),
    }

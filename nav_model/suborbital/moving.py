"""A study at other inputs without integrating again: its curves moved by the linear sensitivity matrix [B-4].

Sizes of sensor, initial and tracker errors move with the matrices of the study's run; other periods, or frames at
other instants, need other ones (`renewed`). Another flight or another gravity needs a new study.
"""

from dataclasses import replace

import numpy as np

from nav_model.base.arrays import Array
from nav_model.earth.sphere import local_axes
from nav_model.suborbital.aiding import frame_steps
from nav_model.suborbital.channels import decoupled_response
from nav_model.suborbital.errors import ErrorSet
from nav_model.suborbital.navigation_errors import NavigationErrors, along_track
from nav_model.suborbital.sensitivity import Sensitivity, noise_parts, sensitivity
from nav_model.suborbital.study import LinearParts, Study, SuborbitalInputs, case_parameters


def _periods(errors: ErrorSet) -> tuple[float, ...]:
    return tuple(
        period for s in (errors.accelerometers, errors.gyros) for period in (s.bias_period_s, s.matrix_period_s)
    )


def _same(study: Study, inputs: SuborbitalInputs) -> tuple[bool, bool]:
    """Two flags: new inputs leave the periods as they are, and the instants of frames."""
    before = study.inputs
    frames, frames_before = (frame_steps(study.flight, each.aiding) for each in (inputs, before))
    return _periods(before.errors) == _periods(inputs.errors), np.array_equal(frames, frames_before)


def needs_other_matrices(study: Study, inputs: SuborbitalInputs) -> bool:
    """True if `moved` has to compute other `LinearParts` first: tenths of a second."""
    return not all(_same(study, inputs))


def renewed(study: Study, inputs: SuborbitalInputs) -> LinearParts:
    """The linear parts at other periods, or at other instants of the frames of a perfect camera."""
    flight, every, parts = study.flight, study.every, study.linear
    same_periods, same_frames = _same(study, inputs)
    if not same_frames:
        used = frame_steps(flight, inputs.aiding)
        parts = replace(parts, used=used, aided_noise=noise_parts(flight, used, None, every))
    if not same_periods:
        parts = replace(
            parts,
            pure=sensitivity(flight, inputs.errors, every=every),
            channel_response=decoupled_response(flight, inputs.errors, every=every),
        )
    if not (same_periods and same_frames):
        parts = replace(parts, aided=sensitivity(flight, inputs.errors, parts.used, every))
    return parts


def moved(study: Study, inputs: SuborbitalInputs, linear: LinearParts | None = None) -> Study:
    """The study with other errors and another aiding: error histories by the linear sensitivity matrix [B-4], white
    noise and decoupled channels exactly.

    linear: from `renewed` where that was done elsewhere. At the study's own inputs the answer is the exact one;
    away from them the gap is of second order (`position_gap`). The gravity row does not move.
    """
    new, old = linear or renewed(study, inputs), study.linear
    _, parameters = case_parameters(inputs.errors, inputs.aiding)
    return replace(
        study,
        inputs=replace(study.inputs, errors=inputs.errors, aiding=inputs.aiding),
        parameters=parameters,
        marks=tuple(
            mark if kind == "gravity" else f"{mark}; moved by the sensitivity matrix [B-4]"
            for mark, kind in zip(study.marks, study.kinds, strict=True)
        ),
        pure=_moved_errors(study, study.pure, parameters, new.pure, old.pure),
        aided=_moved_errors(study, study.aided, parameters, new.aided, old.aided),
        linear=new,
    )


def _moved_errors(
    study: Study, exact: NavigationErrors, parameters: Array, new: Sensitivity, old: Sensitivity
) -> NavigationErrors:
    """The last exact run + S p - S_0 p_0, for every history."""
    path = study.flight.position_i[:: study.every]

    def change(name: str) -> Array:
        after = np.einsum("mip,cp->cmi", getattr(new, name), parameters)
        return np.asarray(after - np.einsum("mip,cp->cmi", getattr(old, name), study.parameters))

    moved_by, rotation_by = change("position"), change("attitude")
    position = exact.position_m + moved_by
    # A wrong position turns the local axes: their error is dr/r, and the navigation attitude carries it.
    shift = moved_by / np.linalg.norm(path, axis=-1)[:, None]
    tangent = np.tan(study.flight.latitude_rad[:: study.every])
    transport = np.stack([shift[..., 1], -shift[..., 0], -shift[..., 1] * tangent], axis=-1)
    local = np.einsum("mji,cmj->cmi", local_axes(path), rotation_by) - transport
    down_range, cross_range = along_track(position, study.flight.track_rad[:: study.every])
    return NavigationErrors(
        time_s=exact.time_s,
        position_m=position,
        velocity_m_s=exact.velocity_m_s + change("velocity"),
        down_range_m=down_range,
        cross_range_m=cross_range,
        attitude_inertial_rad=exact.attitude_inertial_rad + rotation_by,
        attitude_navigation_rad=exact.attitude_navigation_rad + local,
        source=f"{exact.source}; moved by the sensitivity matrix [B-4]",
    )

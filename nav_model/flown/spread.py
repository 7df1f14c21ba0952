"""Covariances of sums of errors over time along a flight, and degrees of freedom. [P-18]

The error of a filter's output goes from a point i of the flight to a later one j by the closed-loop transition
Ψ(j, i), a product of Φ and I - K H. With P the filter's covariance, and Λ that of what later fixes tell (Bryson and
Frazier's adjoint, 0 at the end of the flight), the errors at two points have the covariance

    output         P_i Ψ'
    smoothed       P_i Ψ' (I - Λ_j P_j)
    difference     P_i Ψ' Λ_j P_j          output less smoothed

A pass from the end of the flight, before the fix at i, has the error of later fixes alone, of covariance B, and

    Λ = (P + B)⁻¹

The filter is taken at its word here: what it does not know changes sizes, not which values stand for themselves.
Sizes come from the covariance along the flight, by source; from here come the freedom, and the image of a filter's
output, which has the steps of its fixes. Sources: Bryson and Ho, *Applied Optimal Control*, ch. 13; Satterthwaite,
"An approximate distribution of estimates of variance components", 1946.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import interpolated
from nav_model.budget.inputs import Inputs
from nav_model.trajectory.aperture import Apertures, steps_of, sums_of
from nav_model.trajectory.errors import ErrorModel
from nav_model.trajectory.passes import FilterRun, transitions

FloatArray = NDArray[np.float64]
Error = Literal["output", "smoothed", "difference"]
_START = 100.0  # variances of the filter, of a pass from the end where it begins


class Sums(NamedTuple):
    """Sums of a filter's errors, q at a time: the first node of each, increasing, and weights (sums, nodes, q, m) on
    the errors at the nodes from there on, before the fix and after it."""

    first: NDArray[np.int64]
    before: FloatArray
    after: FloatArray


def of_states(model: ErrorModel, outputs: NDArray[np.int64]) -> Sums:
    """Position, velocity and roll, pitch, yaw after the fix at some of the outputs of a flight: q is 9."""
    rows = model.output_rows[outputs][:, None, :, : model.states.estimated]
    return Sums(model.outputs[outputs], np.zeros_like(rows), rows)


def of_images(model: ErrorModel, x: Inputs, apertures: Apertures) -> Sums:
    """The sums of apertures: q is COLUMNS. Of a step, its beginning is after a fix and its end before one."""
    m, shape = model.states.estimated, apertures.weights.shape
    both = np.zeros((2, *shape[:3], m))
    middle = apertures.begin + 0.5 * x.aperture
    velocity = interpolated(middle, model.time_s, model.truth.velocity)
    ends = (apertures.first, apertures.last, apertures.begin)
    for step, on, of_ends in steps_of(model.time_s, *ends, float(x.aperture), sums_of(velocity, x)[0]):
        both[0, on, step, :, :6] += of_ends[0]
        both[1, on, step + 1, :, :6] += of_ends[1]
    return Sums(apertures.first, both[1], both[0])


def later_fixes(model: ErrorModel, run: FilterRun) -> FloatArray:
    """Λ after the fix at every node, (k, m, m)."""
    m, last = model.states.estimated, len(model.time_s) - 1
    adjoint = np.zeros((last + 1, m, m))
    for node, phi in zip(range(last, 0, -1), transitions(model, m, back=True), strict=False):
        adjoint[node - 1] = phi.T @ _before(model, run, adjoint[node], node) @ phi
    return adjoint


def _before(model: ErrorModel, run: FilterRun, adjoint: FloatArray, node: int) -> FloatArray:
    """Λ before the fix at a node, of that after it."""
    if not model.is_fix[node]:
        return adjoint
    rows = model.rows[node, :, : len(adjoint)]
    update = np.eye(len(adjoint)) - run.gain[node] @ rows
    return np.asarray(update.T @ adjoint @ update + run.weight[node] @ rows)


def covariance_of(model: ErrorModel, run: FilterRun, adjoint: FloatArray, sums: Sums, error: Error) -> FloatArray:
    """Covariance of all sums with each other, (sums, q, sums, q).

    Parameters
    ----------
    model : ErrorModel
    run : FilterRun
        Its filter.
    adjoint : array (k, m, m)
        As `later_fixes` gives it.
    sums : Sums
    error : str
        Whose: "output", "smoothed" or "difference".
    """
    (count, nodes, q, m), first = sums.before.shape, sums.first
    identity, start, stop = np.eye(m), int(first[0]), int(first[-1]) + nodes
    A = np.zeros((count, q, m))  # covariance of what each sum has so far with the errors at this point
    C = np.zeros((count, q, count, q))
    P = run.covariance[max(start - 1, 0)]
    for node in range(start, min(stop, len(model.time_s))):
        end = int(np.searchsorted(first, node, side="right"))
        on = np.arange(np.searchsorted(first, node - nodes + 1), end)
        # To this node, whose fix is still to come.
        if node:
            phi = np.zeros((m, m))
            phi[9:, 9:] = np.diag(model.decay_factor[node - 1, : m - 9])
            phi[:9] = model.phi[node - 1, :, :m]
            A[:end] = A[:end] @ phi.T
            P = phi @ P @ phi.T + model.filter_noise[node - 1]
        L = _before(model, run, adjoint[node], node)
        for weights in (sums.before, sums.after):
            if weights is sums.after:
                if model.is_fix[node]:
                    A[:end] -= (A[:end] @ model.rows[node, :, :m].T) @ run.gain[node].T
                P, L = run.covariance[node], adjoint[node]
            W = weights[on, node - first[on]]
            if not W.any():
                continue
            # What these sums take here, with all that any sum has so far and with itself.
            of_error = {"output": identity, "smoothed": identity - L @ P, "difference": L @ P}[error]
            taken = of_error @ W.reshape(-1, m).T
            block = (A[:end].reshape(-1, m) @ taken).reshape(end, q, len(on), q)
            C[:end, :, on] += block
            C[on, :, :end] += block.transpose(2, 3, 0, 1)
            alone = ((W @ P).reshape(-1, m) @ taken).reshape(len(on), q, len(on), q)
            C[on[:, None], :, on[None, :]] += alone.swapaxes(1, 2)  # the two lists of sums come first there
            A[on] += W @ P
    return C


def part_of_passes(model: ErrorModel, run: FilterRun, adjoint: FloatArray, outputs: NDArray[np.int64]) -> FloatArray:
    """Part that a filter's error has in the mean square of its difference to a pass from the end of the flight: of
    position, velocity and roll, pitch, yaw at some of the outputs together, (9,).

    Parameters
    ----------
    model : ErrorModel
    run : FilterRun
    adjoint : array (k, m, m)
        As `later_fixes` gives it.
    outputs : array of int
    """
    nodes, m = model.outputs[outputs], model.states.estimated
    rows, P = model.output_rows[outputs][:, :, :m], run.covariance[nodes]
    sigma = np.sqrt(np.diagonal(P, axis1=1, axis2=2))
    scale = sigma[:, :, None] * sigma[:, None, :]
    both = scale * np.linalg.inv(scale * adjoint[nodes] + np.eye(m) / _START)
    alone, apart = (np.einsum("nqi,nij,nqj->q", rows, part, rows) for part in (P, both))
    return np.asarray(alone / apart)


def freedom(C: FloatArray, factors: FloatArray) -> float:
    """Degrees of freedom of the mean square of some sums, each with its factor (q,): by Satterthwaite that of the
    chi-square of the same mean and variance, 0 where there is nothing."""
    mean = float(np.einsum("aqaq,q->", C, factors))
    square = float(np.einsum("aqbr,q,r->", C**2, factors, factors, optimize=True))
    return mean**2 / square if square > 0.0 else 0.0


def mean_square(C: FloatArray) -> FloatArray:
    """Mean square of each of the q sums, (q,)."""
    return np.asarray(np.einsum("aqaq->q", C) / len(C))

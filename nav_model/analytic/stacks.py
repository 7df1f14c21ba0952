"""Algebra of thousands of small matrices, (n, m, ...), with the designs on the last axes: faster than NumPy's own."""

from __future__ import annotations

from functools import cache

import numpy as np

from nav_model.base.arrays import Array

_FEW = 400  # elements; with fewer, NumPy's own functions are faster


def times(*factors: Array) -> Array:
    """Product of each row's matrices, from the right."""
    *rest, product = factors
    for factor in reversed(rest):
        if factor.ndim == product.ndim and (product.size < _FEW or np.iscomplexobj(product)):
            product = (product.T @ factor.T).T
        else:
            product = np.einsum("ij...,jk...->ik...", factor, product)
    return product


def turned(matrix: Array) -> Array:
    """Transposes."""
    return matrix.swapaxes(0, 1)


def matrices_last(stack: Array) -> Array:
    """The stack as NumPy's linear algebra takes it, (..., n, m)."""
    return np.moveaxis(stack, (0, 1), (-2, -1))


def even(matrix: Array) -> Array:
    """The symmetric part, to remove rounding from matrices that should be symmetric."""
    return (matrix + turned(matrix)) * 0.5


def plus_one(matrix: Array) -> Array:
    """One plus each matrix."""
    return matrix + _one(len(matrix), matrix.ndim)


@cache
def _one(size: int, axes: int) -> Array:
    return np.eye(size).reshape(size, size, *(1,) * (axes - 2))


def solved(matrix: Array, right: Array) -> Array:
    """Solution of each row's equations by elimination without a choice of pivots.

    Pivots are not needed where all minors are positive, as for one plus the product of a covariance of position,
    velocity and acceleration with the information of later fixes.
    """
    if matrix.size < _FEW:
        a, b = matrix.T.swapaxes(-1, -2), right.T.swapaxes(-1, -2)
        return np.asarray(np.linalg.solve(a, b).swapaxes(-1, -2).T, matrix.dtype)
    a, b = matrix.copy(), right.copy()
    size = len(a)
    for k in range(size):
        for i in range(k + 1, size):
            part = a[i, k] / a[k, k]
            a[i, k + 1 :] -= part * a[k, k + 1 :]
            b[i] -= part * b[k]
    for k in range(size - 1, -1, -1):
        for j in range(k + 1, size):
            b[k] -= a[k, j] * b[j]
        b[k] /= a[k, k]
    return b

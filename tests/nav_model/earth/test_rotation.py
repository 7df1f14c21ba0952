"""Rotations against SciPy's."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from nav_model.earth.rotation import (
    matrix_from_euler,
    matrix_from_vector,
    skew,
    vector_from_matrix,
    write_matrix,
)

DRAWN = Rotation.random(500, random_state=3)
MATRICES = DRAWN.as_matrix()
SCALAR_FIRST = np.roll(DRAWN.as_quat(), 1, axis=-1)


def test_euler_angles():
    yaw, pitch, roll = DRAWN.as_euler("ZYX").T
    np.testing.assert_allclose(matrix_from_euler(roll, pitch, yaw), MATRICES, atol=1e-14)
    assert matrix_from_euler(0.1, np.zeros((4, 1)), np.zeros(3)).shape == (4, 3, 3, 3)


def test_the_kernel_writes_the_same_matrix():
    written = np.empty((3, 3))
    for quaternion, matrix in zip(SCALAR_FIRST[:20], MATRICES[:20], strict=True):
        write_matrix(quaternion, written)
        np.testing.assert_allclose(written, matrix, atol=1e-15)


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-6, 1.0, 3.1])
def test_rotation_vectors(size):
    direction = DRAWN.as_rotvec() / DRAWN.magnitude()[:, None]
    vector = size * direction
    cross = skew(vector)
    np.testing.assert_allclose(matrix_from_vector(vector), [expm(each) for each in cross], atol=1e-14)
    np.testing.assert_allclose(vector_from_matrix(matrix_from_vector(vector)), vector, atol=1e-13)


def test_skew_is_the_cross_product():
    a, b = np.random.default_rng(1).standard_normal((2, 7, 3))
    np.testing.assert_array_equal(np.einsum("nij,nj->ni", skew(a), b).round(14), np.cross(a, b).round(14))

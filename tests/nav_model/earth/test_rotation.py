"""Rotations against SciPy's."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nav_model.earth.rotation import (
    matrix_from_euler,
    matrix_from_quaternion,
    matrix_from_vector,
    quaternion_from_matrix,
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


def test_quaternions_have_either_sign():
    found = quaternion_from_matrix(MATRICES)
    np.testing.assert_allclose(np.abs(np.sum(found * SCALAR_FIRST, axis=-1)), 1.0, atol=1e-14)
    np.testing.assert_allclose(matrix_from_quaternion(SCALAR_FIRST), MATRICES, atol=1e-14)
    half_turns = np.array([np.diag([1.0, -1.0, -1.0]), np.diag([-1.0, 1.0, -1.0]), np.diag([-1.0, -1.0, 1.0])])
    np.testing.assert_allclose(np.abs(quaternion_from_matrix(half_turns)), np.eye(4)[1:], atol=1e-15)


def test_the_kernel_writes_the_same_matrix():
    written = np.empty((3, 3))
    for quaternion, matrix in zip(SCALAR_FIRST[:20], matrix_from_quaternion(SCALAR_FIRST[:20]), strict=True):
        write_matrix(quaternion, written)
        np.testing.assert_array_equal(written, matrix)


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-6, 1.0, 3.1])
def test_rotation_vectors(size):
    direction = DRAWN.as_rotvec() / DRAWN.magnitude()[:, None]
    vector = size * direction
    np.testing.assert_allclose(matrix_from_vector(vector), Rotation.from_rotvec(vector).as_matrix(), atol=1e-14)
    np.testing.assert_allclose(vector_from_matrix(matrix_from_vector(vector)), vector, atol=1e-13)


def test_skew_is_the_cross_product():
    a, b = np.random.default_rng(1).standard_normal((2, 7, 3))
    np.testing.assert_array_equal(np.einsum("nij,nj->ni", skew(a), b).round(14), np.cross(a, b).round(14))

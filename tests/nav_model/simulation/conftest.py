"""Instruments the tests share, in the units of their data sheets."""

import math
from collections.abc import Callable

import pytest

from nav_model.simulation.specification import ImuModel, TriadModel

MakeImu = Callable[..., ImuModel]


@pytest.fixture(scope="session")
def make_imu() -> MakeImu:
    """make_imu(angle deg/sqrt(h), velocity m/s/sqrt(h), gyro deg/h, accelerometer mg, ...) -> ImuModel."""

    def make(
        angle: float,
        velocity: float,
        gyro: float = 0.0,
        accelerometer: float = 0.0,
        gyro_time: float = 1000.0,
        accelerometer_time: float = 3600.0,
        gyro_turn_on: float = 0.0,
        accelerometer_turn_on: float = 0.0,
    ) -> ImuModel:
        return ImuModel(
            gyro=TriadModel(
                random_walk=math.radians(angle) / 60.0,
                bias_instability=math.radians(gyro) / 3600.0,
                turn_on_bias=math.radians(gyro_turn_on) / 3600.0,
                correlation_time=gyro_time,
            ),
            accelerometer=TriadModel(
                random_walk=velocity / 60.0,
                bias_instability=accelerometer * 9.80665e-3,
                turn_on_bias=accelerometer_turn_on * 9.80665e-3,
                correlation_time=accelerometer_time,
            ),
        )

    return make


@pytest.fixture(scope="session")
def paper_imu(make_imu: MakeImu) -> ImuModel:
    """[A] table 1: 0.5 deg/sqrt(h), 0.05 m/s/sqrt(h)."""
    return make_imu(0.5, 0.05)

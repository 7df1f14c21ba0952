"""Recorded places that jump: no manoeuvre that shows the heading, and no manoeuvre that is taken for a jump."""

import math
from pathlib import Path

import numpy as np
import pytest

from nav_model.design import Design
from nav_model.design.file import parse_design
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import along_flight, plan_like
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.jumps import without_jumps
from nav_model.trajectory.files.reader import FlightFile, parse_file

METRE = math.degrees(1.0 / 6_371_000.0)
EXAMPLE = Path(__file__).parents[3] / "app/examples/mems_x_band.toml"
GRAVITY = 9.80665


def rows(north: np.ndarray, east: np.ndarray, step: float = 1.0, noise: float = 0.01) -> np.ndarray:
    place = np.column_stack([north, east, np.full(len(north), 1000.0)])
    place += noise * np.random.default_rng(7).normal(size=place.shape)
    lat, lon = 47.0 + METRE * place[:, 0], 8.0 + METRE * place[:, 1] / math.cos(math.radians(47.0))
    return np.column_stack([step * np.arange(len(north)), lat, lon, place[:, 2]])


def recording(east: np.ndarray) -> FlightFile:
    table = rows(60.0 * np.arange(len(east)), east)
    lines = [f"{t:.3f},{lat:.10f},{lon:.10f},{up:.4f}" for t, lat, lon, up in table]
    return parse_file("\n".join(["time_s,lat_deg,lon_deg,height_m", *lines]).encode(), "a.csv")


def off(*places: int, by: float = 50.0) -> np.ndarray:
    east = np.zeros(150)
    east[[*places]] = by
    return east


@pytest.fixture(scope="module")
def design() -> Design:
    changes = ["filter.initial_yaw=2°", "gnss.position_noise=2 cm", "gnss.vertical_position_noise=2 cm"]
    return parse_design(EXAMPLE.read_text("utf-8"), "design", changes)


RUNS = [([70], "1 place"), ([30, 90], "2 places"), ([70, 71, 72], "3 places"), ([*range(70, 90)], "20 places")]


@pytest.mark.long
@pytest.mark.parametrize(("places", "count"), RUNS)
def test_a_jump_shows_no_heading(design: Design, places: list[int], count: str) -> None:
    plain, jumping = recording(off()), recording(off(*places))
    assert "left out" not in plain.note
    assert f"{count} of the recording left out, beside the others by 50" in jumping.note
    straight, freed = (
        covariance(along_flight(design, file.flown(plan_like(design)))).real_time.attitude[-1, 2]
        for file in (plain, jumping)
    )
    assert math.degrees(straight) > 1.7  # a straight flight does not show the heading
    assert freed == pytest.approx(straight, rel=1e-3)


def test_a_step_that_stays_is_named() -> None:
    assert "the places of the recording step by 50" in recording(off(*range(70, 150))).note
    assert " m at 69.0 s, flown as if it were a manoeuvre" in recording(off(*range(70, 150))).note
    # The flight of a step of a metre and less is not different from that of its noise.
    assert "step" not in recording(off(*range(70, 150), by=0.5)).note


def turning(rate: np.ndarray, speed: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    course = np.cumsum(rate) * step
    return np.cumsum(speed * np.cos(course)) * step, np.cumsum(speed * np.sin(course)) * step


@pytest.mark.parametrize("noise", [0.0, 0.01, 1.0])
@pytest.mark.parametrize("step", [0.1, 1.0])
def test_manoeuvres_are_flown_as_recorded(step: float, noise: float) -> None:
    fine = np.arange(0.0, 300.0, 0.02)
    bank = np.radians(45.0) * np.sign(np.sin(fine / 8.0)) * (np.abs(np.sin(fine / 8.0)) > 0.3)
    speed = 60.0 + 0.0 * fine
    for rate, fast in (
        (GRAVITY * np.tan(bank) / speed, speed),  # turns one after the other, rolled into at once
        (np.where(np.sin(fine / 5.0) > 0.95, 1.2, 0.0), 8.0 + 0.0 * fine),  # a small aircraft around corners
        (0.0 * fine, 6.0 * np.clip(5.0 * np.sin(fine / 7.0), -1.0, 1.0)),  # to and fro, with 0.4 g
    ):
        north, east = turning(rate, fast, 0.02)
        every = round(step / 0.02)
        track = rows(north[::every], east[::every], step, noise)
        notes = Heights("a.csv")
        assert len(without_jumps(track, "track", notes)) == len(track)
        assert notes.notes == []


def test_places_held_between_fixes_and_last_digits_are_no_jumps() -> None:
    held = rows(60.0 * np.floor(np.arange(500) / 10.0), np.zeros(500), 0.1, 0.0)
    hover = rows(np.round(np.random.default_rng(1).normal(size=500)) * 0.11, np.zeros(500), 0.1, 0.0)
    hover[:, 3] = np.round(1000.0 + np.sin(np.arange(500) / 40.0))
    for track in (held, hover):
        notes = Heights("a.csv")
        assert len(without_jumps(track, "track", notes)) > 0.8 * len(track)
        assert "step" not in " ".join(notes.notes)


def test_fixes_of_another_kind_among_others_are_no_turn() -> None:
    brought = Path("/work/shared/data/brought/76_single_among_fixed.pos")
    if not brought.exists():
        pytest.skip("../shared/data/brought is absent")
    file = parse_file(brought.read_bytes().replace(b"  5  14", b"  1  14"), brought.name)
    assert file.flight is not None
    assert "places of the recording left out, beside the others by" in file.note
    yaw = np.degrees(np.frombuffer(file.flight.trajectory.samples).reshape(-1, 7)[:, 6])
    assert yaw == pytest.approx(45.0, abs=0.5)  # a straight flight to the north-east

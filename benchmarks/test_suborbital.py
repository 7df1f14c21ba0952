"""Speed of the suborbital study against issue 5: all cases 2 s, sliders 100 ms, 15000 star frames 20 s."""

from dataclasses import replace

import pytest

from app.serving.server import first_design
from app.session import Session
from app.subjects.suborbital.page import SuborbitalPage
from app.subjects.suborbital.views import VIEWS
from nav_model.suborbital.errors import ErrorSet, InitialErrors
from nav_model.suborbital.flight import reference_flight
from nav_model.suborbital.moving import moved
from nav_model.suborbital.noise_ensemble import fly_noise
from nav_model.suborbital.sensitivity import sensitivity
from nav_model.suborbital.settings import DEFAULTS
from nav_model.suborbital.sky import hipparcos_sky
from nav_model.suborbital.star_camera import StarCamera, track_stars
from nav_model.suborbital.study import run_study
from nav_model.suborbital.survey import run_survey


@pytest.fixture(scope="module")
def page():
    """The page with its first answer, as a person has it before touching a slider."""
    page = SuborbitalPage(Session(first_design()))
    page.run.take(run_survey(DEFAULTS))
    return page


def test_full_set_of_cases(benchmark):
    study = run_study()
    benchmark(run_study)
    benchmark.extra_info["cases_pure_and_aided"] = 2 * len(study.names)
    benchmark.extra_info["goal_s"] = 2.0


def test_slider(benchmark):
    study = run_study()
    errors = replace(study.inputs.errors, initial=InitialErrors(position_m=(1.0, 2.0, 3.0)))
    benchmark(moved, study, replace(study.inputs, errors=errors))
    benchmark.extra_info["goal_s"] = 0.1


def test_sensitivity_matrix(benchmark):
    flight = reference_flight()
    benchmark(sensitivity, flight, ErrorSet())


def test_star_frames_of_a_flight(benchmark):
    flight, sky = reference_flight(), hipparcos_sky()
    benchmark.pedantic(track_stars, args=(flight, StarCamera(), sky), rounds=3, warmup_rounds=1)
    benchmark.extra_info["frames"] = flight.steps + 1
    benchmark.extra_info["goal_s"] = 20.0


def test_survey(benchmark):
    """All that one exact run of the page computes: the cases, noise, star frames, methods, gravity models."""
    run_survey(DEFAULTS)
    benchmark.pedantic(run_survey, args=(DEFAULTS,), rounds=3)


def test_noise_ensemble_of_100(benchmark):
    study = run_study()
    benchmark.pedantic(fly_noise, args=(study, 100), rounds=3)


@pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style':PendingDeprecationWarning")
@pytest.mark.parametrize("view", [view.name for view in VIEWS])
def test_slider_to_fed_figures(benchmark, page, view):
    """Work of the server for one step of a slider with a view on the screen."""
    page.study.views.chosen = view
    places = iter(range(10**9))

    def step():
        page.inputs.put("initial.velocity", (0.1 + 1e-4 * next(places), 0.1, -0.1))

    benchmark.pedantic(step, rounds=20, warmup_rounds=2)
    benchmark.extra_info["goal_s"] = 0.1

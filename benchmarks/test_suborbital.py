"""Speed of the suborbital study against issue 5: all cases 2 s, sliders 100 ms, 15000 star frames 20 s."""

from dataclasses import replace

from nav_model.suborbital.errors import ErrorSet, InitialErrors
from nav_model.suborbital.flight import golden_flight
from nav_model.suborbital.sensitivity import sensitivity
from nav_model.suborbital.sky import hipparcos_sky
from nav_model.suborbital.star_camera import StarCamera, track_stars
from nav_model.suborbital.study import run_study, slide


def test_full_set_of_cases(benchmark):
    study = run_study()
    benchmark(run_study)
    benchmark.extra_info["cases_pure_and_aided"] = 2 * len(study.names)
    benchmark.extra_info["goal_s"] = 2.0


def test_slider(benchmark):
    study = run_study()
    moved = replace(study.inputs.errors, initial=InitialErrors(position_m=(1.0, 2.0, 3.0)))
    benchmark(slide, study, moved)
    benchmark.extra_info["goal_s"] = 0.1


def test_sensitivity_matrix(benchmark):
    flight = golden_flight()
    benchmark(sensitivity, flight, ErrorSet())


def test_star_frames_of_a_flight(benchmark):
    flight, sky = golden_flight(), hipparcos_sky()
    benchmark.pedantic(track_stars, args=(flight, StarCamera(), sky), rounds=3, warmup_rounds=1)
    benchmark.extra_info["frames"] = flight.steps + 1
    benchmark.extra_info["goal_s"] = 20.0

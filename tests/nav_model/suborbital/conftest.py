import pytest

from nav_model.suborbital.flight import TrueFlight, reference_flight
from nav_model.suborbital.sky import Sky, hipparcos_sky
from nav_model.suborbital.study import Study, run_study


@pytest.fixture(scope="session")
def flight() -> TrueFlight:
    return reference_flight()


@pytest.fixture(scope="session")
def study() -> Study:
    return run_study()


@pytest.fixture(scope="session")
def sky() -> Sky:
    return hipparcos_sky()

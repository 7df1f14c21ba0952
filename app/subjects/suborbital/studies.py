"""Studies for the page: flown in a process and kept for whoever asks the same; the usual one before anybody asks."""

from collections.abc import Callable
from contextlib import suppress

from app.subjects.suborbital.inputs import Trajectory
from app.work.cancellable import RunLost, run_alone, until_asked
from app.work.result_cache import cached, keep
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.suborbital.settings import DEFAULTS, Settings, from_design
from nav_model.suborbital.survey import Survey, run_survey

_KEPT = 4  # studies of 12 MB each


def asked(settings: Settings) -> tuple[str, str]:
    """All that a study of the reference flight follows from: its key for `app.work.result_cache`."""
    return "suborbital", repr(sorted(settings.values.items()))


async def fly_study(settings: Settings, trajectory: Trajectory, progress: Callable[[float, str], None]) -> Survey:
    """Fly a study and keep it, unless its flight is a file's.

    Raises
    ------
    InputError, RunLost
        As `run_alone`.
    """
    survey: Survey = await run_alone(run_survey, settings, trajectory, progress=progress)
    if trajectory is None:
        keep(survey, *asked(settings), most=_KEPT)
    return survey


async def fly_ahead(design: Design) -> None:
    """Have the usual study of a design, and a process that has loaded what the next needs; nobody waits for it."""
    settings = from_design(DEFAULTS, design)
    if cached(*asked(settings)) is None:
        with suppress(InputError, RunLost):  # whoever asks runs it again, and is told
            await until_asked(fly_study(settings, None, lambda *_: None))

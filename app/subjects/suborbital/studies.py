"""Studies for the page: flown in a process and kept for whoever asks the same; the usual one before anybody asks."""

import asyncio
from collections.abc import Callable
from contextlib import suppress

from app.subjects.suborbital.inputs import Trajectory
from app.work.alone import RunLost, run_alone
from app.work.kept import keep, kept
from nav_model.design import Design
from nav_model.suborbital.settings import DEFAULTS, Settings, from_design
from nav_model.suborbital.survey import Survey, run_survey

_KEPT = 4  # studies of 12 MB each

_Told = Callable[[float, str], None]


_begun: dict[str, tuple[asyncio.Task[Survey], list[_Told]]] = {}
"""Studies under way that nobody had asked for yet when they began, and who is told how far they are."""


def kept_study(settings: Settings) -> Survey | None:
    """What this server still has of the same study, of the reference flight."""
    survey: Survey | None = kept("suborbital", _asked(settings))
    return survey


async def fly_study(settings: Settings, trajectory: Trajectory, progress: _Told) -> Survey:
    """Fly a study, or wait for the same one that is under way already.

    Raises
    ------
    ValueError, RunLost
        As `run_alone`.
    """
    begun = _begun.get(_asked(settings)) if trajectory is None else None
    if begun is not None:
        task, told = begun
        told.append(progress)
        return await asyncio.shield(task)
    return await _flown(settings, trajectory, progress)


async def fly_ahead(design: Design) -> None:
    """Have the usual study of a design, and a process that has loaded what the next needs.

    Cancelled, it ends what is under way, unless somebody waits for it by now.
    """
    settings = from_design(DEFAULTS, design)
    asked, told = _asked(settings), list[_Told]()
    if asked in _begun or kept_study(settings) is not None:
        return

    def tell(share: float, what: str) -> None:
        for progress in told:
            progress(share, what)

    task = asyncio.ensure_future(_flown(settings, None, tell))
    _begun[asked] = task, told
    task.add_done_callback(lambda _: _begun.pop(asked))
    try:
        with suppress(ValueError, RunLost):  # whoever asks runs it again, and is told
            await asyncio.shield(task)
    except asyncio.CancelledError:
        if not told:
            task.cancel()
        raise


async def _flown(settings: Settings, trajectory: Trajectory, progress: _Told) -> Survey:
    survey: Survey = await run_alone(run_survey, settings, trajectory, progress=progress)
    if trajectory is None:
        keep(survey, "suborbital", _asked(settings), most=_KEPT)
    return survey


def _asked(settings: Settings) -> str:
    """All that a study of the reference flight follows from."""
    return repr(sorted(settings.values.items()))

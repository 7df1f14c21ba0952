"""Holds a flown solution against the budget of a design, for a worker process."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.work.flight import File
from nav_model.design import Design

if TYPE_CHECKING:
    from nav_model.flown.result import FlownResult
    from nav_model.flown.solution import Solution

FloatArray = NDArray[np.float64]
_LONGEST = 100  # characters of a name
_MOST = 2000  # samples of a series, as the screen has no more pixels


@dataclass(frozen=True)
class Source:
    """A file that a study was of: its name, and the hash of its content."""

    name: str
    sha256: str


@dataclass(frozen=True, eq=False)
class FlownFlight:
    """A flown flight beside the budget of its design.

    result: with every n-th sample of its series and solution, without the reference. data: the result as
    `nav_model.flown.result.to_json` gives it, of all samples. north, east: of the track from its first place [m], at
    the times of the solution that the result has.
    """

    design: Design
    result: FlownResult
    data: Mapping[str, Any]
    sources: tuple[Source, ...]
    north: FloatArray
    east: FloatArray

    @property
    def name(self) -> str:
        """The solution's name."""
        return self.sources[0].name

    @property
    def start_s(self) -> float:
        """When it begins, by the solution's clock [s]."""
        return float(self.result.solution.time_s[0])


def hold(
    design: Design,
    solution: Sequence[File],
    reference: Sequence[File] = (),
    relation: str = "",
    kind: str = "",
    remove_lag: bool = True,
    *,
    progress: Callable[[float, str], None] = lambda share, what: None,
) -> FlownFlight:
    """Read the files of a flight and hold its solution against the budget.

    Parameters
    ----------
    design : Design
    solution, reference : sequence of File
        Of each solution its file, and that of its accuracies if they have a second one.
    relation, kind : str
        As `nav_model.flown.study.flown_study` takes them; empty: as the files tell.
    remove_lag : bool
    progress : callable
        Called with the share done and with what is being done.

    Raises
    ------
    InputError
        Naming the file, or what cannot be compared.
    ArithmeticError
        Where the covariance along the track is not finite.
    """
    from nav_model.earth.wgs84 import metres_per_radian
    from nav_model.flown.result import to_json
    from nav_model.flown.study import flown_study

    sources: list[Source] = []
    progress(0.0, f"reading {solution[0].name}")
    x = _read(solution, sources)
    y = None
    if reference:
        progress(0.0, f"reading {reference[0].name}")
        y = _read(reference, sources)
    chosen: Any = relation or None
    result = flown_study(
        design, x, y, relation=chosen, kind=kind, remove_lag=remove_lag,
        progress=lambda what, share: progress(share, what),
    )  # fmt: skip
    data, result = to_json(result), _thinned(result)
    place = result.solution.place
    north, east = metres_per_radian(place[0, 0], place[0, 2])
    return FlownFlight(
        design, result, data, tuple(sources), north * (place[:, 0] - place[0, 0]), east * (place[:, 1] - place[0, 1])
    )


def _read(files: Sequence[File], sources: list[Source]) -> Solution:
    """The solution of a file and of what belongs to it, noting name and hash of each."""
    from nav_model.flown.files.reader import read_solution

    for file in files:
        with file.path.open("rb") as content:
            sources.append(Source(file.name, hashlib.file_digest(content, "sha256").hexdigest()))
    # Under their own names, which messages have; an SBET stays on the disk, whatever its size.
    beside = files[0].path.parent
    with tempfile.TemporaryDirectory(dir=beside, ignore_cleanup_errors=True) as folder:
        named = [
            Path(folder) / f"{number}" / (Path(file.name).name[-_LONGEST:] or "file")
            for number, file in enumerate(files)
        ]
        for place, file in zip(named, files, strict=True):
            place.parent.mkdir()
            place.hardlink_to(file.path)
        return read_solution(named[0], named[1:])


def _thinned(result: FlownResult) -> FlownResult:
    """A result with as many samples as are drawn: a solution of an hour has 100 MB."""
    compared = result.compared
    if compared is not None:
        at = _some(len(compared.time_s))
        compared = replace(
            compared, time_s=compared.time_s[at], position=compared.position[at], velocity=None, attitude=None,
            track=compared.track[at],
        )  # fmt: skip
    return replace(result, solution=_thin(result.solution), reference=None, compared=compared)


def _thin(solution: Solution) -> Solution:
    at = _some(len(solution.time_s))
    claims = solution.claims
    if claims is not None:
        position = None if claims.position is None else claims.position[at]
        claims = replace(claims, position=position, velocity=None, attitude=None)
    return replace(
        solution, time_s=solution.time_s[at], place=solution.place[at], claims=claims, velocity=None, attitude=None,
        fix=None,
    )  # fmt: skip


def _some(count: int) -> slice:
    return slice(None, None, max(1, -(-count // _MOST)))

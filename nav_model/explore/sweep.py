"""Runs a sweep: parts in parallel, each written completely or not at all, then joined into one file.

A part is written beside its place, flushed to the disk and renamed into it, so a process killed at any moment
leaves only whole parts. Its name holds its digest, which is checked before it is used again and when it is joined:
starting again computes what is missing or was changed. Parts depend on nothing but the plan, so one process, many
processes and a Dask cluster write the same file.
"""

import fcntl
import functools
import hashlib
import io
import itertools
import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, under
from nav_model.base.processes import worker_pool
from nav_model.base.text.csv_text import csv_text
from nav_model.budget.figures import figures
from nav_model.budget.inputs import VARIABLES, inputs_of
from nav_model.budget.verdict import flown_names
from nav_model.design import Design, Value
from nav_model.design.figures import FIGURES, REQUIRED, of_kind
from nav_model.explore.margins import limits, worst
from nav_model.explore.sweep_flight import fly
from nav_model.explore.sweep_plan import SweepPlan

SUFFIXES = (".csv", ".parquet")
Column = list[Value] | np.ndarray[Any, Any]
ProgressCallback = Callable[[int, int], None]


def run_sweep(
    plan: SweepPlan,
    output: str | Path,
    workers: int = 1,
    scheduler: str | None = None,
    progress: ProgressCallback = lambda done, total: None,
) -> int:
    """Evaluate every row of a plan into one file; returns how many rows an earlier run had already done.

    Parameters
    ----------
    plan : Plan
    output : path
        Ending in .csv or .parquet (needs pyarrow, the extra ``sweep``). Parts are in ``OUTPUT.parts`` until the end.
    workers : int
        Local processes; with one, the work is done here.
    scheduler : str, optional
        Address of a Dask scheduler (extra ``cluster``), whose workers do the work instead.
    progress : callable
        Called with rows done and rows in all.

    Raises
    ------
    InputError
        For another ending, a file that the plan was made from, a folder that cannot be written, an output that
        another sweep is writing, parts that belong to another sweep or are links, and a part that changes during the
        run.
    """
    target = Path(output)
    if target.suffix not in SUFFIXES:
        raise InputError(str(target), f"must end in {' or '.join(SUFFIXES)}")
    if target.is_file() and any(file.is_file() and target.samefile(file) for file in plan.files):
        raise InputError(str(target), "is a file that the sweep reads; name another output")
    if target.suffix == ".parquet":
        _arrow()
    with _open_parts(plan, target) as parts:
        return _run(plan, target, parts, workers, scheduler, progress)


def _run(
    plan: SweepPlan, target: Path, parts: Path, workers: int, scheduler: str | None, progress: ProgressCallback
) -> int:
    ready = _ready(plan, parts, target.suffix)
    missing = [n for n in range(plan.parts) if n not in ready]
    stored = plan.rows - sum(_size(plan, n) for n in missing)
    done = stored
    progress(done, plan.rows)
    with _executor(workers, scheduler) as (executor, at_once):
        for n, content in _results(executor, at_once, plan, missing, target.suffix):
            ready[n] = parts / f"{n:08d}-{_digest(plan, n, content)}{target.suffix}"
            _write(ready[n], content)
            done += _size(plan, n)
            progress(done, plan.rows)
    _join(plan, ready, target)
    shutil.rmtree(parts)
    return stored


def _size(plan: SweepPlan, n: int) -> int:
    return min(plan.rows_per_part, plan.rows - n * plan.rows_per_part)


def _digest(plan: SweepPlan, n: int, content: bytes) -> str:
    """SHA-256 of a part, of its place and of its plan, so that no part passes for another."""
    return hashlib.sha256(f"{plan.identity} {n}\n".encode() + content).hexdigest()


def _ready(plan: SweepPlan, parts: Path, suffix: str) -> dict[int, Path]:
    """The parts of an earlier run that are as they were written."""
    ready = {}
    for path in parts.glob(f"*{suffix}"):
        number, _, digest = path.stem.partition("-")
        if path.is_symlink() or not path.is_file():
            raise InputError(str(path), "is not a file but a link or a folder; remove it")
        if number.isdecimal() and digest == _digest(plan, int(number), path.read_bytes()):
            ready[int(number)] = path
    return ready


@contextmanager
def _open_parts(plan: SweepPlan, target: Path) -> Iterator[Path]:
    """The folder of parts, new or of the same plan, for this sweep alone: another would remove it in the end.

    The lock is the system's, which releases it even where a process dies: the file alone means nothing.
    """
    parts = target.with_name(target.name + ".parts")
    manifest, lock = parts / "plan.json", parts / "lock"
    stated = json.dumps({"identity": plan.identity, "rows": plan.rows, "rows_per_part": plan.rows_per_part}).encode()
    with ExitStack() as stack:
        try:
            parts.mkdir(exist_ok=True)
            if parts.is_symlink():
                raise InputError(str(parts), "is a link; remove it, or choose another output")
            file = stack.enter_context(lock.open("w"))
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if not os.path.samestat(os.fstat(file.fileno()), lock.stat()):
                raise BlockingIOError
            if not manifest.exists():
                _write(manifest, stated)
            elif manifest.read_bytes() != stated:
                raise InputError(
                    str(parts),
                    "holds parts of another sweep, or its plan.json is damaged; remove it, or choose another output",
                )
        except (BlockingIOError, FileNotFoundError) as error:  # the other has removed the folder just now
            if not parts.parent.is_dir():
                raise InputError(str(parts), f"cannot be written: {error.strerror}") from error
            raise InputError(
                str(target), "another sweep is writing it; wait until that has ended, or choose another output"
            ) from error
        except OSError as error:
            raise InputError(str(parts), f"cannot be written: {error.strerror}") from error
        yield parts


def _write(path: Path, content: bytes) -> None:
    """Write a file completely or not at all, even if this process is killed."""
    beside = path.with_name(path.name + ".tmp")
    try:
        with beside.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def _executor(workers: int, scheduler: str | None) -> Iterator[tuple[Executor | None, int]]:
    """The executor, and how many parts to submit at once."""
    if scheduler is not None:
        from nav_model.simulation.cluster import cluster_pool

        with ExitStack() as stack:
            with under("--scheduler"):
                pool, threads = stack.enter_context(cluster_pool(scheduler))
            yield pool, 4 * threads
    elif workers > 1:
        with worker_pool(workers) as executor:
            yield executor, 4 * workers
    else:
        yield None, 1


def _results(
    executor: Executor | None, at_once: int, plan: SweepPlan, missing: list[int], suffix: str
) -> Iterator[tuple[int, bytes]]:
    """Parts as they are done; only a few wait at a time, so that memory does not grow with the sweep."""
    if executor is None:
        yield from ((n, compute_part(plan, n, suffix)) for n in missing)
        return
    waiting: dict[Future[bytes], int] = {}
    todo = iter(missing)
    while True:
        for n in todo:
            waiting[executor.submit(compute_part, plan, n, suffix)] = n
            if len(waiting) >= at_once:
                break
        if not waiting:
            return
        for future in wait(waiting, return_when=FIRST_COMPLETED).done:
            yield waiting.pop(future), future.result()


def compute_part(plan: SweepPlan, n: int, suffix: str) -> bytes:
    """One part of a sweep's file: importable and picklable, so that any worker can do it."""
    start = n * plan.rows_per_part
    columns = evaluate(plan, start, start + _size(plan, n))
    return to_parquet(columns) if suffix == ".parquet" else to_csv(columns)


def evaluate(plan: SweepPlan, start: int, stop: int) -> dict[str, Column]:
    """The rows from `start` to `stop` as columns.

    ``row``; every input varied (SI); ``processing.mode``, for which the results are; one sigma of every result; the
    margin of every requirement given; whether the design closes (empty when it has no requirement); the names of
    requirements that only a flight can judge, and which therefore have no part in that, where there are any; what
    `nav_model.explore.sweep_flight.fly` found, where the plan says how to fly.
    """
    places = plan.indices(start, stop)
    columns: dict[str, Column] = {"row": np.arange(start, stop)}
    for axis, place in zip(plan.axes, places, strict=True):
        columns[axis.key] = [axis.values[k] for k in place]
    columns.setdefault("processing.mode", [plan.design.processing.mode] * (stop - start))
    names = list(limits(_varied(plan.design, ())))
    limited = [name for name in REQUIRED if name in names or f"requirements.{name}" in columns]
    limited += [limit.name for limit in plan.design.limits if limit.name in names]
    results = {name: np.empty(stop - start) for name in plan.results}
    margins = {name: np.empty(stop - start) for name in limited}
    slow = [i for i, axis in enumerate(plan.axes) if axis.key not in VARIABLES]
    groups = np.stack([places[i] for i in slow], axis=-1) if slow else np.zeros((stop - start, 0), int)
    for group in np.unique(groups, axis=0):
        rows = np.flatnonzero((groups == group).all(axis=1))
        design = _varied(
            plan.design, tuple(tuple(plan.axes[i].changes[k].items()) for i, k in zip(slow, group, strict=True))
        )
        fast = {
            axis.key: np.array([axis.values[k] for k in place[rows]], float)
            for axis, place in zip(plan.axes, places, strict=True)
            if axis.key in VARIABLES
        }
        sigmas = figures(inputs_of(design, fast), {*plan.results, *limited})
        for name in plan.results:
            results[name][rows] = sigmas[name]
        for name, limit in limits(design).items():
            margins[name][rows] = 1 - sigmas[name] / limit
    limit_columns = {limit.name: limit.column for limit in plan.design.limits}
    columns |= {limit_columns.get(name) or FIGURES[name].column: values for name, values in results.items()}
    columns |= {f"{name}_margin": values for name, values in margins.items()}
    columns["closes"] = list(worst({n: -m for n, m in margins.items()}) <= 0) if margins else [None] * (stop - start)
    varied = (name for name in of_kind("flight") if f"requirements.{name}" in columns)
    if decided := dict.fromkeys((*flown_names(plan.design), *varied)):
        columns["before_flight"] = ["; ".join(decided)] * (stop - start)
    if plan.flight is not None:
        flown = [fly(plan.flight, design) for design in _designs(plan, start, stop)]
        columns |= {name: [row[name] for row in flown] for name in flown[0]}
    return columns


def whole_sweep(
    plan: SweepPlan, *, progress: Callable[[float, str], None] = lambda share, what: None
) -> dict[str, Column]:
    """Every row of a plan as columns, as `evaluate` gives them, in memory.

    Parameters
    ----------
    plan : Plan
    progress : callable
        Called with the share done and a description of the progress.

    Examples
    --------
    >>> columns = whole_sweep(parse_plan(text))
    >>> columns["closes"]
    """
    columns_of_chunks: list[dict[str, Column]] = []
    for n in range(plan.parts):
        start = n * plan.rows_per_part
        progress(start / plan.rows, f"{start} of {plan.rows} designs")
        columns_of_chunks.append(evaluate(plan, start, start + _size(plan, n)))
    return {
        name: np.concatenate([part[name] for part in columns_of_chunks])
        if isinstance(column, np.ndarray)
        else [value for part in columns_of_chunks for value in part[name]]
        for name, column in columns_of_chunks[0].items()
    }


def _designs(plan: SweepPlan, start: int, stop: int) -> Iterator[Design]:
    """The designs of these rows, one by one."""
    for places in zip(*plan.indices(start, stop), strict=True):
        changes = (axis.changes[k].items() for axis, k in zip(plan.axes, places, strict=True))
        yield _varied(plan.design, tuple(tuple(items) for items in changes))


@functools.lru_cache(maxsize=512)
def _varied(design: Design, changes: tuple[tuple[tuple[str, Value], ...], ...]) -> Design:
    """The design with what cannot be an array: choices, presets, limits."""
    for change in changes:
        design = design.replace(dict(change))
    return design


def sweep_ratios(columns: Mapping[str, Column]) -> Array:
    """The worst requirement of every row, as a multiple of its limit; ValueError without any requirement."""
    return worst(
        {name: 1 - np.asarray(column, float) for name, column in columns.items() if name.endswith("_margin")}
    )


def least_demanding(plan: SweepPlan, columns: Mapping[str, Column]) -> NDArray[np.bool_]:
    """The Pareto front of a grid, for each row: it passes, and none that passes is as easy in every input and easier
    in one. A number is easier towards the side on which most designs come nearer to their limits; names are not
    compared."""
    if plan.together:
        return np.zeros(plan.rows, bool)
    ratios = sweep_ratios(columns).reshape([len(axis.values) for axis in plan.axes])
    passing, orders = ratios <= 1, {}
    for place, axis in enumerate(plan.axes):
        if len(axis.values) > 1 and all(isinstance(value, float) for value in axis.values):
            order = np.argsort(np.array(axis.values, float))
            rise = np.diff(np.take(ratios, order[[0, -1]], place), axis=place)
            orders[place] = order if np.median(np.sign(rise)) >= 0 else order[::-1]
    sides = np.ix_(*(orders.get(place, np.arange(length)) for place, length in enumerate(ratios.shape)))
    easier = passing[sides]  # each input from demanding to easy
    front = easier.copy()
    for place in orders:
        flipped = np.flip(easier, place)
        easier = np.flip(np.maximum.accumulate(flipped, place), place)  # here or further on, some design passes
    for place in orders:
        beyond = np.roll(easier, -1, place)
        np.moveaxis(beyond, place, 0)[-1] = False
        front &= ~beyond
    result = np.empty_like(front)
    result[sides] = front
    return result.ravel()


def to_csv(columns: Mapping[str, Column]) -> bytes:
    """Columns as a CSV file with a head, numbers in full precision."""
    return csv_text((columns, *zip(*columns.values(), strict=True))).encode()


def to_parquet(columns: Mapping[str, Column]) -> bytes:
    """Columns as a Parquet file. InputError where pyarrow is missing."""
    arrow, parquet = _arrow()
    sink = io.BytesIO()
    parquet.write_table(arrow.table({name: arrow.array(values) for name, values in columns.items()}), sink)
    return sink.getvalue()


def _arrow() -> tuple[Any, Any]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise InputError("output", 'Parquet needs pyarrow; install "navbudget[sweep]", or write .csv') from error
    return pyarrow, pyarrow.parquet


def _join(plan: SweepPlan, parts: Mapping[int, Path], target: Path) -> None:
    """All parts, in order, into the output."""
    beside = target.with_name(target.name + ".tmp")
    contents = (_checked(plan, n, parts[n]) for n in range(plan.parts))
    try:
        if target.suffix == ".parquet":
            _, parquet = _arrow()
            tables = (parquet.read_table(io.BytesIO(content)) for content in contents)
            first = next(tables)
            with parquet.ParquetWriter(beside, first.schema) as writer:
                for table in itertools.chain([first], tables):
                    writer.write_table(table)
        else:
            with beside.open("wb") as whole:
                for n, content in enumerate(contents):
                    # The header is written once.
                    whole.write(content[content.index(b"\n") + 1 :] if n else content)
        with beside.open("rb") as whole:
            os.fsync(whole.fileno())
        os.replace(beside, target)
    finally:
        beside.unlink(missing_ok=True)


def _checked(plan: SweepPlan, n: int, path: Path) -> bytes:
    """A part's content; InputError unless it is as it was written, with every row of the plan."""
    content = path.read_bytes()
    if _digest(plan, n, content) != path.stem.partition("-")[2]:
        raise InputError(str(path), "was changed while the sweep ran; the same command computes it again")
    rows = (
        content.count(b"\n") - 1 if path.suffix == ".csv" else _arrow()[1].read_metadata(io.BytesIO(content)).num_rows
    )
    if rows != _size(plan, n):
        raise InputError(str(path), f"holds {rows} rows instead of {_size(plan, n)}; remove it, and start again")
    return content

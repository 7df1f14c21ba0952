"""Many runs, split into chunks that are flown here, in other processes or on a cluster, and summed in run order.

A chunk is one call of `run_chunk`, a top-level function of picklable arguments, so any
`concurrent.futures.Executor` can take it: a spawned process pool, a thread pool (the kernels release the
interpreter lock), or a Dask cluster's (`cluster.cluster_pool`). Where the chunks are cut depends on the study
alone and they are merged in order, so the result is the same to the last bit wherever they ran.
"""

import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nav_model.base.processes import worker_pool
from nav_model.simulation.result import ClosedForm, SimulationResult, summarise
from nav_model.simulation.single_run import POSTERIOR, fly, fly_without_errors
from nav_model.simulation.specification import SimulationSpec, refused
from nav_model.simulation.statistics import Statistics

FloatArray = NDArray[np.float64]
SAMPLES_PER_CHUNK: Final = 1_500_000
"""About half a second of work: short enough to cancel at once, long enough that passing it on costs nothing."""


def chunks(spec: SimulationSpec) -> list[tuple[int, int]]:
    """The runs as (first, one past last), which depend on the study alone."""
    size = max(1, min(64, SAMPLES_PER_CHUNK // spec.steps))
    return [(start, min(start + size, spec.runs)) for start in range(0, spec.runs, size)]


def run_chunk(spec: SimulationSpec, scale: FloatArray, start: int, stop: int) -> Statistics:
    """Fly runs start .. stop - 1 and sum them.

    Parameters
    ----------
    spec : SimulationSpec
        The study.
    scale : array
        As in `Statistics`.
    start, stop : int
        Runs.
    """
    statistics = Statistics.empty(scale)
    for run in range(start, stop):
        statistics.add(fly(spec, run), spec.keep_runs)
    return statistics


def local_pool(workers: int) -> Executor:
    """A pool of this machine's processes (spawned, so safe beside threads). Shut it down after use."""
    if workers < 1:
        raise refused("workers", workers, "must be 1 or more")
    return worker_pool(workers)


def _in_pool(spec: SimulationSpec, scale: FloatArray, pool: Executor, in_flight: int) -> Iterator[Statistics]:
    """Chunks in run order. At most `in_flight` are out or waiting for an earlier one, so memory stays flat."""
    waiting = deque(chunks(spec))
    flying: deque[Future[Statistics]] = deque()
    try:
        while waiting or flying:
            while waiting and len(flying) < in_flight:
                flying.append(pool.submit(run_chunk, spec, scale, *waiting.popleft()))
            yield flying.popleft().result()
    finally:
        for future in flying:
            future.cancel()


def simulate(
    spec: SimulationSpec,
    *,
    workers: int = 1,
    pool: Executor | None = None,
    closed_form: ClosedForm | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> SimulationResult:
    """Fly every run of `spec` and compare with the filter and, where given, with the closed form.

    Parameters
    ----------
    spec : SimulationSpec
        The study.
    workers : int, optional
        1 flies in this thread; more start as many processes for this study, unless there is a `pool`.
    pool : Executor, optional
        Used and left open; `workers` is then how many it has.
    closed_form : ClosedForm, optional
        Sigmas to compare with.
    progress : callable, optional
        Called in this thread with runs done and runs in all.

    Raises
    ------
    ValueError
        For a study that cannot be flown.
    BrokenProcessPool
        Where a worker process dies.
    """
    began = time.perf_counter()
    if workers < 1:
        raise refused("workers", workers, "must be 1 or more")
    nominal = fly_without_errors(spec)
    scale = nominal.filter_sigma[POSTERIOR]
    total = Statistics.empty(scale)
    own_pool = local_pool(workers) if pool is None and workers > 1 else None
    chosen = pool or own_pool
    try:
        here = (run_chunk(spec, scale, *piece) for piece in chunks(spec))
        for part in here if chosen is None else _in_pool(spec, scale, chosen, 2 * workers):
            total.merge(part)
            if progress is not None:
                progress(total.runs, spec.runs)
    finally:
        if own_pool is not None:
            own_pool.shutdown(wait=False, cancel_futures=True)
    if total.runs != spec.runs:
        raise RuntimeError(f"{total.runs} runs arrived of {spec.runs}")
    return summarise(spec, total, nominal, closed_form, time.perf_counter() - began)

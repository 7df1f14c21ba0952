"""Chunks of runs on a Dask distributed cluster (the `cluster` extra)."""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from nav_model.base.compiled import room_digest
from nav_model.base.errors import InputError


@contextmanager
def cluster_pool(address: str, timeout: float = 30.0) -> Iterator[tuple[Executor, int]]:
    """A pool for `simulate(pool=..., workers=...)` on the scheduler at `address`, and its number of threads.

    A chunk that is lost with its worker is flown again by another; each result counts once. Raises InputError where
    no scheduler answers or it has no workers, where a worker's simulator is not the same as this one, and where the
    `cluster` extra is not installed.
    """
    try:
        import distributed
    except ImportError as error:
        raise InputError(
            "scheduler", "needs the 'cluster' extra: pip install 'navbudget[cluster]'", address
        ) from error
    connect: Any = distributed.Client
    try:
        client: Any = connect(address, timeout=timeout, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError("scheduler", f"no Dask scheduler answers at {address!r} ({error})", address) from error
    with client:
        threads = sum(client.nthreads().values())
        if threads == 0:
            raise InputError("scheduler", f"{address!r} has no workers", address)
        strangers = [worker for worker, digest in client.run(room_digest).items() if digest != room_digest()]
        if strangers:
            raise InputError(
                "scheduler", f"worker {strangers[0]} has another version of nav_model.simulation; update it", address
            )
        yield client.get_executor(pure=False, retries=3), threads

"""The same study on a Dask cluster over real sockets, one worker process killed midway."""

import os
import signal

import numpy as np
import pytest

from nav_model.simulation.cluster import cluster_pool
from nav_model.simulation.monte_carlo import simulate
from nav_model.simulation.result import to_arrays
from nav_model.simulation.specification import SimulationSpec

pytestmark = pytest.mark.long


@pytest.mark.slow
def test_a_killed_worker_loses_no_run_and_repeats_none(paper_imu):
    distributed = pytest.importorskip("distributed", reason="needs the cluster extra")
    spec = SimulationSpec(paper_imu, runs=240, duration=100.0, every=10.0, keep_runs=True)
    killed = []
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, protocol="tcp://"
        ) as cluster,
        cluster_pool(cluster.scheduler_address) as (pool, threads),
    ):
        victim = next(iter(cluster.workers.values())).pid

        def progress(done: int, total: int) -> None:
            if done >= 60 and not killed:
                os.kill(victim, signal.SIGKILL)
                killed.append(done)

        result = simulate(spec, pool=pool, workers=threads, progress=progress)
    assert threads == 2
    assert killed
    assert killed[0] < 240
    expected = to_arrays(simulate(spec))
    arrays = to_arrays(result)
    for name, values in expected.items():
        assert np.array_equal(values, arrays[name]), name

"""Compiling ahead of use: a flight of a second that goes through every kernel.

Light to import, so that a server can hand `warm_up` to a worker without loading the compiler itself.
"""

import time


def warm_up() -> float:
    """Have every kernel compiled and, where a directory is writable, cached on disk; seconds it took.

    About half a minute of one processor on the first use of an installation, under a second afterwards.
    """
    from nav_model.simulation.single_run import fly
    from nav_model.simulation.specification import ImuModel, SimulationSpec, TriadModel

    began = time.perf_counter()
    imu = ImuModel(TriadModel(random_walk=1e-4), TriadModel(random_walk=1e-3))
    fly(SimulationSpec(imu, duration=1.0), 0)
    return time.perf_counter() - began


if __name__ == "__main__":
    print(f"simulator ready after {warm_up():.1f} s")

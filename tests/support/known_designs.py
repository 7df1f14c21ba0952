"""The designs that come with the product: their files, and the budget of one with other values."""

from pathlib import Path

from app.examples import EXAMPLES, example
from nav_model.budget import Budget, analyse

ROOT = Path(__file__).parents[2]
MEMS, TACTICAL, L_BAND = (str(ROOT / "examples" / f"{name}.toml") for name in EXAMPLES)


def changed(**changes: object) -> Budget:
    """The budget of the MEMS example with other values; ``imu__rate`` is imu.rate."""
    return analyse(example("mems_x_band").replace({key.replace("__", "."): x for key, x in changes.items()}))

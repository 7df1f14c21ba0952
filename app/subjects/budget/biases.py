"""Residual biases of the design, for the strip: zero, in-run of the data sheet, or what was entered."""

from app.document.wording import input_in_words
from nav_model.design import Design, Value
from nav_model.design.presets import entry_of

ZERO, IN_RUN = "Residual biases 0", "in-run of data sheet"
_KEYS = ("imu.accelerometer_bias", "imu.gyro_bias")


def bias_choices(design: Design) -> tuple[dict[str, dict[str, Value]], dict[str, str], str]:
    """What each button says -> the values that it gives, the units of the data sheet's, and the choice in force."""
    entry = entry_of(design, "imu")
    sheet = {f"imu.{name}": item for name, item in entry.in_run.items()} if entry else {}
    choices: dict[str, dict[str, Value]] = {ZERO: dict.fromkeys(_KEYS, 0.0)}
    if sheet:
        choices[IN_RUN] = {key: item.value for key, item in sheet.items()}
    own = {key: float(design[key]) for key in _KEYS}  # type: ignore[arg-type]
    if not any(values.items() <= own.items() for values in choices.values()):
        choices[" and ".join(input_in_words(design, key, size) for key, size in own.items() if size)] = dict(own)
    in_force = next(name for name, values in choices.items() if values.items() <= own.items())
    return choices, {key: item.unit for key, item in sheet.items()}, in_force

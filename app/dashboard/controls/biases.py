"""The residual biases of the IMU as one choice: none, or the in-run biases of the catalogue's data sheet."""

from app.dashboard.controls.design_input import DesignInput
from app.ui.input_sheet import Row, choice_row
from nav_model.base.errors import InputError
from nav_model.design.catalogue import SourcedValue
from nav_model.design.presets import entry_of

_KEYS = ("imu.accelerometer_bias", "imu.gyro_bias")
_NONE, _IN_RUN, _ENTERED = "none", "in-run", ""


class BiasInput(DesignInput[None]):
    """Sets both residual biases at once; what is typed below it counts as entered."""

    def row(self) -> Row:
        """Label, help and the three choices: as entered, none, of the data sheet."""
        options = [(_ENTERED, "as entered below"), (_NONE, "none"), (_IN_RUN, "data-sheet in-run")]
        text = "None: fully estimated before the last fix. Data-sheet in-run: as the catalogue has it for the IMU."
        return choice_row("Residual bias", text, options)

    def value(self) -> object:
        """Both biases in force, SI."""
        return tuple(self.session.design[key] for key in _KEYS)

    def current(self) -> Row:
        """The choice that gives the biases in force."""
        design = self.session.design
        sizes = {key: float(design[key]) for key in _KEYS}  # type: ignore[arg-type]
        text = _ENTERED
        if not any(sizes.values()):
            text = _NONE
        elif sizes == {key: item.value for key, item in self._data_sheet().items()}:
            text = _IN_RUN
        return {"text": text}

    def take(self, text: str) -> InputError | None:
        """Put a choice in force."""
        if text == _NONE:
            return self.session.change(dict.fromkeys(_KEYS, 0.0))
        sheet = self._data_sheet()
        if text == _IN_RUN and not sheet:
            return InputError(self.key, "choose an IMU whose data sheet has in-run biases, or type them below")
        if text == _IN_RUN:
            values = {key: item.value for key, item in sheet.items()}
            return self.session.change(values, {key: item.unit for key, item in sheet.items()})
        return None

    def _data_sheet(self) -> dict[str, SourcedValue]:
        entry = entry_of(self.session.design, "imu")
        return {f"imu.{name}": item for name, item in entry.in_run.items()} if entry else {}

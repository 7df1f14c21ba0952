"""The inputs of the study on its page: controls by group, and where a study comes from and goes to."""

from collections.abc import Callable
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import declared, required
from app.document.blocks import Text
from app.document.pane import html_of
from app.session import Session
from app.subjects.suborbital.controls import StudyInput
from app.ui.downloads import download
from app.ui.html_pane import html_pane
from app.ui.input_sheet import Group, InputSheet
from app.ui.upload import upload
from app.ui.view import View
from app.work.pool import read_in_pool
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.suborbital.flight_file import BOUNDS
from nav_model.suborbital.input_table import GROUPS
from nav_model.suborbital.settings import DEFAULTS, Settings, Value, follow_design, follows_design, from_design
from nav_model.suborbital.study_file import MAX_BYTES as MAX_STUDY
from nav_model.suborbital.study_file import format_study, from_link, parse_study, to_link

Trajectory = tuple[str, bytes] | None
_OPEN = 1  # gyros: what the tracker replaces
_PLAIN = to_link(from_design(DEFAULTS, Design()))  # of a study that nobody changed
_LOOK: dict[str, Any] = {"margin": 2, "variant": "text"}
_FILE_HELP = (
    '<p class="know quiet">CSV with time_s, latitude_deg, longitude_deg, height_m, roll_deg, pitch_deg, yaw_deg; '
    f"at most {BOUNDS.most_bytes // 1_000_000} MB, rows a second apart or less during thrust.</p>"
)


class InputPanel(View):
    """Settings and trajectory in force, and the column that changes them."""

    session = required(Session)
    settings: Settings = declared(param.ClassSelector(class_=Settings, default=DEFAULTS, instantiate=False))
    trajectory: Trajectory = declared(
        param.Parameter(doc="Name and content of the file flown; None: the reference flight.")
    )

    def __init__(self, session: Session) -> None:
        super().__init__(session=session, settings=from_design(DEFAULTS, session.design))
        groups = [
            Group(title, [StudyInput(each.key, lambda: self.settings, self.put) for each in some], index == _OPEN)
            for index, (title, some) in enumerate(GROUPS.items())
        ]
        self.sheet = InputSheet(groups)
        self.notice = pmui.Alert(object="", severity="error", closeable=True, visible=False, margin=(4, 14))
        self._view = self._layout()
        self._follow_link()

    @param.depends("session.study_link", watch=True)
    def _follow_link(self) -> None:
        link, design = self.session.study_link, self.session.design
        if link and link != to_link(self.settings) and (problem := self.adopt(lambda: from_link(link, design))):
            self.say(f"The link's study was not used. {problem}")

    def follow(self, design: Design) -> None:
        """Take the inertial unit of another design, where the study has it from the design."""
        settings = follow_design(self.settings, design)
        if dict(settings.values) != dict(self.settings.values) or settings.origin != self.settings.origin:
            self.adopt(lambda: settings)

    def say(self, text: str) -> None:
        """A message above the page, until the next one; empty: none."""
        self.notice.param.update(object=escape(text), visible=bool(text), closed=False)

    # --- layout ----------------------------------------------------------------------------------------

    def _layout(self) -> pn.Column:
        self._imu = html_pane("", margin=(2, 12))
        self._say_imu()
        return pn.Column(
            self._imu,
            pn.FlexBox(*self._sources(), margin=(0, 4)),
            pn.Column(self.sheet, self._flight_file(), sizing_mode="stretch_both", styles={"overflow": "auto"}),
            sizing_mode="stretch_both",
        )

    def _say_imu(self) -> None:
        follows = follows_design(self.settings)
        source = (
            f"IMU noise and constant biases are those of the design: {escape(self.session.design.name)}. "
            "All other inputs are here."
            if follows
            else "IMU noise and biases are the study's own, not those of the design."
        )
        self._imu.object = f"<p>{source}</p>"

    def _sources(self) -> list[pn.viewable.Viewable]:
        self.file = upload(
            "Open study", ".toml", MAX_STUDY, self.open, lambda reason: self.say(f"Not opened: {reason}."),
            icon="folder_open", **_LOOK,
        )  # fmt: skip
        name, now = "suborbital-study.toml", lambda: format_study(self.settings, self.trajectory)
        save = download("Save study", name, now, icon="save", **_LOOK)

        take = pmui.Button(
            label="Use IMU of the design", icon="input", on_click=lambda _: self._take_design(), **_LOOK
        )
        reset = pmui.Button(
            label="Reset to the reference flight", icon="restart_alt",
            on_click=lambda _: self.adopt(lambda: DEFAULTS), **_LOOK,
        )  # fmt: skip
        return [self.file, save, take, reset]

    def _take_design(self) -> None:
        problem = self.adopt(lambda: from_design(self.settings, self.session.design))
        self.say(f"The design's IMU was not used. {problem}" if problem else "")

    def _flight_file(self) -> pn.viewable.Viewable:
        self.trajectory_file = upload(
            "Trajectory from a file", ".csv", BOUNDS.most_bytes, lambda *flown: setattr(self, "trajectory", flown),
            lambda reason: self.say(f"Trajectory not used: {reason}."), **_LOOK,
        )  # fmt: skip
        reset = pmui.Button(
            label="Reset to reference flight", visible=self.param.trajectory.rx.is_not(None),
            on_click=lambda _: self.param.update(trajectory=None), **_LOOK,
        )  # fmt: skip
        self._file_note = html_pane(_FILE_HELP, margin=(0, 12))
        return pn.Column(pn.FlexBox(self.trajectory_file, reset, margin=(4, 4, 0, 4)), self._file_note)

    # --- what a person does ------------------------------------------------------------------------------

    def put(self, key: str, value: Value) -> InputError | None:
        """Put one input in force; returns what is wrong with it, if anything."""
        return self.adopt(lambda: self.settings.change({key: value}, "you"))

    def adopt(self, make: Callable[[], Settings]) -> InputError | None:
        """Put settings in force; returns what is wrong with them, if anything."""
        try:
            settings = make()
        except InputError as error:
            return error
        with pn.io.hold():
            self.settings = settings
        return None

    @param.depends("settings", watch=True)
    def _show(self) -> None:
        link = to_link(self.settings)
        self.session.study_link = "" if link == _PLAIN else link
        self._say_imu()
        self.sheet.follow()

    async def open(self, name: str, content: bytes) -> None:
        """Put a study file in force, whole or not at all; a trajectory in it may have megabytes."""
        try:
            study = await read_in_pool(parse_study, content, name)
        except InputError as error:
            self.say(f"Not opened. {error}")
            return
        self.say("")
        with pn.io.hold():
            self.param.update(settings=study.settings, trajectory=study.trajectory)

    def refuse(self, flown: Trajectory, reason: str) -> None:
        """Go back to the trajectory flown before and say why."""
        self.say(f"Trajectory not used. {reason}")
        self.trajectory = flown

    @param.depends("trajectory", watch=True)
    def _describe_flight(self) -> None:
        flown = self.trajectory
        flight = f"Flown: {flown[0]}. Links do not include it; save the study to share it." if flown else ""
        self._file_note.object = html_of(Text(flight)) if flight else _FILE_HELP

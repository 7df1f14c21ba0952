"""The answer of the suborbital study, for page and report: the plain sentence, how exact it is, the key figures."""

from __future__ import annotations

from app.charts.kinds import Array
from app.document.blocks import Answer, KeyFigure, KeyFigures
from app.document.numbers import percent, show
from app.subjects.suborbital.charts.shown import Shown
from nav_model.suborbital.settings import Settings
from nav_model.suborbital.summary import explain

WAITING = Answer(
    "Star tracker on a suborbital flight",
    "open",
    ("The first run is under way: every error source is integrated with and without the star tracker.",),
)
_CARDS = {
    "all": "Everything",
    "gyro total": "Gyros",
    "accelerometer total": "Accelerometers",
    "initial position and velocity": "Initial position and velocity",
    "initial attitude": "Initial attitude",
}


def answer(shown: Shown, settings: Settings) -> tuple[Answer, KeyFigures]:
    """What the tracker repairs at the settings in force, in words and in figures."""
    said = (explain(shown.study), _exactness(shown))
    return Answer("What the star tracker did and did not repair", "open", said), _figures(shown, settings)


def _exactness(shown: Shown) -> str:
    if not shown.exact:
        return "Moved by the linear sensitivity matrix [B-4] from the last exact run; recompute exactly for the gap."
    if shown.gap is None:
        return "Exact: integrated at these inputs."
    gap = shown.gap
    k = gap.names.index("all")
    pure, aided = (
        f"{_metres(float(metres[k]))} ({percent(float(share[k]))})"
        for metres, share in ((gap.pure_m, gap.pure_share), (gap.aided_m, gap.aided_share))
    )
    return f"Exact. Before, the linear answer was off by {pure} for the INS alone and {aided} with the tracker."


def _figures(shown: Shown, settings: Settings) -> KeyFigures:
    study = shown.study
    figures = []
    for case, label in _CARDS.items():
        k = study.case(case)
        pure, aided = study.pure.position_m[k, -1], study.aided.position_m[k, -1]
        figures.append(_figure(label, pure, aided, f"INS: {_channels(pure)}; with tracker: {_channels(aided)}"))
    images = "star images" if settings["camera.frames"] == "star images" else "a perfect camera"
    frames = f"in addition to the errors above; {int(study.used.sum())} frames from {images}"
    spreads = (study.pure_noise.position_sigma_m[-1], study.aided_noise.position_sigma_m[-1])
    figures.append(_figure("White noise, 1σ", *spreads, frames))
    return KeyFigures("Final position error, INS alone → with star tracker", tuple(figures))


def _figure(label: str, pure: Array, aided: Array, detail: str) -> KeyFigure:
    before, after = (_metres(float((error @ error) ** 0.5)) for error in (pure, aided))
    return KeyFigure(label, f"{before} → {after}", detail)


def _channels(error: Array) -> str:
    return ", ".join(f"{axis}\u00a0{_metres(float(value))}" for axis, value in zip("NEH", error, strict=True))


def _metres(value: float) -> str:
    """A length that no line breaks; what is below a millimetre says only that."""
    return (show(value, "length") if abs(value) >= 1e-3 else "< 1 mm").replace(" ", "\u00a0")

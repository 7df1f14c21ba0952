"""The answer of the suborbital study, for page and report: the plain sentence, how exact it is, the key figures."""

from app.charts.kinds import Array
from app.document.blocks import Answer, KeyFigure, KeyFigures
from app.document.numbers import show
from app.subjects.suborbital.charts.content import Content
from nav_model.suborbital.summary import final_total

WAITING = Answer(
    "Running the first study",
    "open",
    ("Every error source is integrated with and without the star tracker. This takes a few seconds.",),
)
_HELPS = 0.98  # of the error without a tracker
_UNDER = "INS alone → with tracker"
_CARDS = {
    "gyro total": "Gyros",
    "accelerometer total": "Accelerometers",
    "initial position and velocity": "Initial position and velocity",
    "initial attitude": "Initial attitude",
}


def answer(page: Content) -> tuple[Answer, KeyFigures]:
    """Effect of the tracker, in a line and in figures."""
    study = page.study
    before, after = map(_size, final_total(study))
    what = f"from {_metres(before)} to {_metres(after)}"
    if not study.used.any():
        word, tone = "The star tracker gives no frame on this flight", "warn"
    elif after < _HELPS * before:
        word, tone = f"The star tracker cuts the final position error {what}", "open"
    else:
        word, tone = f"The star tracker hardly changes the final position error: {what}", "warn"
    remaining = {label: _size(study.aided.position_m[study.case(case), -1]) for case, label in _CARDS.items()}
    remaining["White noise"] = _size(study.aided_noise.position_sigma_m[-1])
    largest = max(remaining, key=lambda label: remaining[label])
    cancel = ", more than the total: signed errors partly cancel" if remaining[largest] > after else ""
    sentence = f"Largest remaining source: {largest.lower()}, {_metres(remaining[largest])}{cancel}."
    exact = "From the full simulation." if page.exact else "Linearised from the last full simulation [B-4]."
    return Answer(word, tone, (sentence, exact)), _figures(page)


def _size(error: Array) -> float:
    return float((error @ error) ** 0.5)


def _figures(page: Content) -> KeyFigures:
    study = page.study
    pure, aided = final_total(study)
    signed = f"signed errors, which partly cancel, and white noise; INS: {_channels(pure)}"
    figures = [_figure("Everything", pure, aided, f"{signed}; with tracker: {_channels(aided)}")]
    for case, label in _CARDS.items():
        k = study.case(case)
        pure, aided = study.pure.position_m[k, -1], study.aided.position_m[k, -1]
        figures.append(_figure(label, pure, aided, f"INS: {_channels(pure)}; with tracker: {_channels(aided)}"))
    images = "star images" if page.settings["camera.frames"] == "star images" else "a perfect camera"
    frames = f"part of everything; {int(study.used.sum())} frames from {images}"
    spreads = (study.pure_noise.position_sigma_m[-1], study.aided_noise.position_sigma_m[-1])
    figures.append(_figure("White noise, 1σ", *spreads, frames))
    return KeyFigures("Final position error, INS alone → with star tracker", tuple(figures))


def _figure(label: str, pure: Array, aided: Array, detail: str) -> KeyFigure:
    return KeyFigure(label, f"{_metres(_size(pure))} → {_metres(_size(aided))}", detail, _UNDER)


def _channels(error: Array) -> str:
    return ", ".join(f"{axis}\u00a0{_metres(float(value))}" for axis, value in zip("NEH", error, strict=True))


def _metres(value: float) -> str:
    """A length that no line breaks; what is below a millimetre says only that."""
    return (show(value, "length") if abs(value) >= 1e-3 else "< 1 mm").replace(" ", "\u00a0")

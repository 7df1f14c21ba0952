"""What stands on top of the Suborbital page: the plain sentence, how exact it is, and the key figures."""

from __future__ import annotations

from html import escape
from typing import Any

from app.document.numbers import show as figure
from app.document.prose import prose
from app.subjects.suborbital.charts import Shown
from nav_model.suborbital.settings import Settings
from nav_model.suborbital.study import Gap
from nav_model.suborbital.summary import explain


def waiting() -> str:
    """Before the first answer."""
    return (
        '<div class="strip open" role="status"><h2>Star tracker on a suborbital flight</h2>'
        "<p>The first run is under way; every error source is integrated with and without the star tracker.</p></div>"
    )


def answer(shown: Shown, settings: Settings, gap: Gap | None) -> str:
    """The plain sentence, how exact it is, and the key figures."""
    return _strip(shown, gap) + _cards(shown, settings)


def _strip(shown: Shown, gap: Gap | None) -> str:
    if shown.exact:
        state = "Exact: integrated at these inputs."
        if gap is not None:
            k = gap.names.index("all")
            state = (
                f"Exact. Before, the linear answer was off by {figure(float(gap.pure_m[k]), 'length')} "
                f"({100 * gap.pure_share[k]:.2g} %) for the INS alone and {figure(float(gap.aided_m[k]), 'length')} "
                f"({100 * gap.aided_share[k]:.2g} %) with the tracker."
            )
    else:
        state = "Moved by the linear sensitivity matrix [B-4] from the last exact run; recompute exactly for the gap."
    return (
        '<div class="strip open" role="status"><h2>What the star tracker did and did not repair</h2>'
        f'<p>{prose(explain(shown.study))}</p><p class="quiet">{prose(state)}</p></div>'
    )


def _metres(value: float) -> str:
    """A length as shown; what is below a millimetre says only that."""
    return figure(value, "length").replace("-", "−") if abs(value) >= 1e-3 else "&lt; 1 mm"


def _both(pure: Any, aided: Any) -> str:
    """Length of the error without and with tracker; breaks between the two on a narrow card."""
    before, after = (f'<span class="num">{_metres(float((v @ v) ** 0.5))}</span>' for v in (pure, aided))
    return f'<dd class="big">{before} → {after}</dd>'


def _cards(shown: Shown, settings: Settings) -> str:
    study = shown.study

    def channels(values: Any) -> str:
        named = zip(("N", "E", "H"), values, strict=True)
        return " ".join(f'<span class="nw">{name} {_metres(float(v))}</span>' for name, v in named)

    def card(label: str, name: str) -> str:
        k = study.case(name)
        pure, aided = study.pure.position_m[k, -1], study.aided.position_m[k, -1]
        return (
            f'<div class="card"><dt>{escape(label)}</dt>{_both(pure, aided)}'
            f'<dd class="fine quiet">alone: {channels(pure)}</dd>'
            f'<dd class="fine quiet">tracker: {channels(aided)}</dd></div>'
        )

    noise = (study.pure_noise.position_sigma_m[-1], study.aided_noise.position_sigma_m[-1])
    frames = int(study.used.sum())
    images = "star images" if settings["camera.frames"] == "star images" else "a perfect camera"
    cards = [
        card("Everything, INS → with tracker", "all"),
        card("Gyros", "gyro total"),
        card("Accelerometers", "accelerometer total"),
        card("Initial position and velocity", "initial position and velocity"),
        card("Initial attitude", "initial attitude"),
        f'<div class="card"><dt>White noise, 1σ</dt>{_both(*noise)}'
        f'<dd class="fine quiet">beside the errors above; {frames} frames from {images}</dd></div>',
    ]
    return f'<dl class="cards" aria-label="Final position errors: north, east, height">{"".join(cards)}</dl>'

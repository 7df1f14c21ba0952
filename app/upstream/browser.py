"""Overrides in the browser: the scripts of this folder, by an invisible part of the page."""

from pathlib import Path

from app.upstream.plain_script import PlainScript

_SCRIPTS = ("layouts", "select_keys", "back_button")


def _script(name: str) -> str:
    return Path(__file__).with_name(f"{name}.js").read_text(encoding="utf-8")


class Repairs(PlainScript):
    """Must be on the page once, outside hidden parts; each script sees this part as `view`."""

    _esm = (
        "export function render({ view }) {\n"
        + "if (!window.navbudget_repaired) {\nwindow.navbudget_repaired = true\n"
        + "".join(f"{{\n{_script(name)}}}\n" for name in _SCRIPTS)
        + '}\nreturn document.createElement("span")\n}\n'
    )

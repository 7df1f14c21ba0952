"""Colour, dash and width of each quantity by its key, in every chart on screen and in print."""

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path


@dataclass(frozen=True)
class Style:
    """Colour, dash (a key of `DASHES`) and width [px].

    Any two lines of one chart differ by dash, or by half again the width, or by much lightness, so that they can be
    told apart in grey and by colour-blind people; each has contrast with white and with the dark page.
    """

    colour: str
    dash: str = "solid"
    width: float = 2.0


DASHES: dict[str, str] = {
    "solid": "",
    "dashed": "6 4",
    "dotted": "2 3",
    "dotdash": "2 4 6 4",
    "dashdot": "9 3 2 3 2 3",
}
"""Dash and gap in pixels, the last a dash and two dots: with one dot it would be the one before, shifted."""

# After Okabe and Ito's palette, made darker and lighter so that each has a contrast of three and more on a white
# page and on the dark one, and of 2.7 for eyes that lack a colour: that leaves lightness from 44 to 61, blue and red
# at its lower end, the rest above.
_COLOURS = {
    "blue": "#1f72b0", "orange": "#e4741a", "green": "#009e73", "purple": "#b86a97", "sky": "#3c9bd4",
    "red": "#d64545", "grey": "#7b8794",
}  # fmt: skip
GREY, INK = _COLOURS["grey"], "#3a4652"
"""Of what is no curve: a shaded stretch, and the ground of a text inside a frame."""

STYLES: dict[str, Style] = {
    name: Style(_COLOURS.get(colour, colour), dash, width)
    for name, (colour, dash, width) in tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8")).items()
}
"""Colour and dash by quantity, everywhere alike."""


@cache
def behind_text(colour: str) -> str:
    """A curve's colour, darker where white text on it would have a contrast below 4.5, for the text's ground.

    >>> behind_text("#e4741a"), behind_text("#1f72b0")
    ('#b25c12', '#1f72b0')
    """
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    while _luminance(red, green, blue) > _DARK:
        red, green, blue = (round(part * 0.97) for part in (red, green, blue))
    return f"#{red:02x}{green:02x}{blue:02x}"


_DARK = 1.05 / 4.55 - 0.05


def _luminance(*parts: int) -> float:
    """Relative luminance of WCAG 2.1 of red, green, blue from 0 to 255."""
    linear = (p / 12.92 if (p := part / 255) <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for part in parts)
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))

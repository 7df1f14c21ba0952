"""Colour, dash and width of each quantity by its key, in every chart on screen and in print."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache


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
BLUE, ORANGE, GREEN, PURPLE = "#1f72b0", "#e4741a", "#009e73", "#b86a97"
SKY, RED, GREY = "#3c9bd4", "#d64545", "#7b8794"
INK = "#3a4652"
"""Ground of a text inside a frame that belongs to no curve."""

STYLES: dict[str, Style] = {
    "horizontal": Style(BLUE, "solid", 3.0),
    "horizontal refined": Style(BLUE, "dashed", 2.4),
    "vertical": Style(ORANGE, "solid", 1.8),
    "vertical refined": Style(ORANGE, "dashed", 1.5),
    "perfect start": Style(GREEN, "dotted", 1.6),
    "initial tilt": Style(PURPLE, "dotdash", 1.6),
    "tilt": Style(PURPLE, "solid", 2.5),
    "tilt, real time": Style(PURPLE, "dotdash", 2.0),
    "tilt refined": Style(PURPLE, "dashed", 3.0),
    "yaw": Style(GREEN, "dashed", 2.0),
    "limit": Style(RED, "dashdot", 1.8),
    "closes": Style(GREEN, "solid", 2.0),
    "does not close": Style(RED, "dashed", 2.0),
    "exact": Style(BLUE, "solid", 2.5),
    "asymptote": Style(ORANGE, "dashed", 2.0),
    "reference": Style(GREY, "dotted", 1.8),
    "quadratic": Style(BLUE, "solid", 2.5),
    "with cubic": Style(ORANGE, "dashed", 2.0),
    "compared": Style(BLUE, "solid", 1.2),
    "this design": Style(ORANGE, "solid", 3.0),
    "accelerometers": Style(BLUE, "solid", 2.2),
    "accelerometer bias": Style(BLUE, "solid", 2.2),
    "accelerometer instability": Style(SKY, "dashed", 2.0),
    "gyros": Style(ORANGE, "solid", 1.4),
    "gyro bias": Style(ORANGE, "solid", 1.4),
    "gyro instability": Style(ORANGE, "dotted", 2.0),
    "initial position and velocity": Style(GREEN, "dashdot", 2.0),
    "initial attitude": Style(PURPLE, "dotdash", 2.0),
    "everything": Style(GREY, "solid", 3.5),
    "INS alone": Style(ORANGE, "solid", 2.5),
    "INS with tracker": Style(BLUE, "dashed", 2.5),
    "decoupled, holds": Style(GREEN, "dotdash", 2.5),
    "decoupled, fails": Style(RED, "dotted", 3.2),
    "closed form, holds": Style(SKY, "dashdot", 2.0),
    "closed form, fails": Style(PURPLE, "dotted", 1.2),
    "INS alone, ensemble": Style(RED, "dotted", 2.5),
    "INS with tracker, ensemble": Style(GREEN, "dotted", 1.6),
    "axis x": Style(BLUE, "solid", 2.0),
    "axis y": Style(ORANGE, "dashed", 2.0),
    "axis z": Style(GREEN, "dotdash", 2.0),
    "axis x, tracker": Style(SKY, "dotted", 1.2),
    "axis y, tracker": Style(RED, "dotted", 2.0),
    "axis z, tracker": Style(GREY, "dotted", 3.2),
    "path": Style(BLUE, "solid", 2.5),
    "mark": Style(ORANGE, "solid", 2.0),
    "star": Style(BLUE, "solid", 1.5),
    "measured star": Style(ORANGE, "solid", 1.5),
    "simulated": Style(BLUE, "solid", 2.5),
    "simulated, second axis": Style(ORANGE, "solid", 1.6),
    "simulated, tilt": Style(PURPLE, "solid", 2.5),
    "simulated, yaw": Style(GREEN, "solid", 1.6),
    "filter": Style(SKY, "dashed", 2.2),
    "filter, second axis": Style("#c47f00", "dashed", 1.3),
    "closed form": Style(GREY, "dotted", 2.5),
    "closed form, second axis": Style(GREY, "dotted", 1.5),
    "refined": Style(PURPLE, "dotdash", 2.0),
    "worst run": Style(BLUE, "dotted", 1.2),
    "worst run, second axis": Style(ORANGE, "dotdash", 1.2),
    "third axis": Style(GREEN, "dashed", 1.6),
    "design 1": Style(BLUE, "solid", 2.5),
    "design 2": Style(ORANGE, "dashed", 2.0),
    "design 3": Style(GREEN, "dotdash", 2.0),
    "design 4": Style(PURPLE, "dotted", 2.0),
    "design 5": Style(SKY, "dashdot", 2.0),
    "design 6": Style(RED, "solid", 1.2),
    "design 7": Style(GREY, "dashed", 1.2),
    "x": Style(BLUE, "solid", 2.0),
    "y": Style(ORANGE, "dashed", 2.0),
    "z": Style(GREEN, "dashdot", 2.0),
    "fit x": Style(BLUE, "dotted", 1.2),
    "fit y": Style(ORANGE, "dotted", 1.9),
    "fit z": Style(GREEN, "dotted", 3.0),
    "measured": Style(BLUE, "solid", 2.5),
    "quantization": Style(SKY, "dotted", 1.8),
    "random_walk": Style(ORANGE, "dashed", 1.8),
    "bias_instability": Style(GREEN, "dotdash", 1.8),
    "rate_random_walk": Style(PURPLE, "dashdot", 1.8),
    "ramp": Style(GREY, "dotted", 3.0),
    "fit": Style(GREY, "solid", 1.6),
    "strategy 1": Style(GREY, "dotted", 1.8),
    "strategy 2": Style(BLUE, "solid", 2.5),
    "strategy 3": Style(SKY, "dashed", 2.0),
    "strategy 4": Style(ORANGE, "solid", 1.6),
    "strategy 5": Style(GREEN, "solid", 1.6),
    "strategy 5w": Style("#4fa486", "dashdot", 2.0),
    "strategy 6": Style(PURPLE, "dotdash", 2.0),
    "strategy 7": Style("#a6761d", "dashed", 2.0),
    "strategy 8": Style("#b08c14", "solid", 2.5),
    "strategy 9": Style("#c2407f", "dashed", 3.2),
}
"""The same quantity has the same colour and dash everywhere."""


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

"""Origins in earlier design files: lines of the description such as ``imu.rate = 250 Hz: data sheet, page 3``.

Files written today have them in ``[origins]``; only files and links without one are read for such lines.
"""

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import LONGEST_ORIGIN, declaration_of


def noted_origins(design: Design) -> dict[str, str]:
    """Dotted key -> origin, from every line of the description that quotes the value the design has.

    A line that quotes another value is outdated and no origin; any other line is plain text. Of two lines on one key
    the first counts.
    """
    origins: dict[str, str] = {}
    for line in design.description.splitlines():
        key, _, note = line.partition(" = ")
        quoted, _, origin = note.partition(": ")
        try:
            declaration = declaration_of(key)
            if not isinstance(declaration, BaseQuantity) or declaration.read(quoted).value != design[key]:
                continue
        except (KeyError, InputError):
            continue
        if origin.strip() and len(origin) <= LONGEST_ORIGIN:
            origins.setdefault(key, origin)
    return origins

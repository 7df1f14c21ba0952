"""Designs with inputs as a person writes them."""

from collections.abc import Mapping

from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import declaration_of


def entered(design: Design, texts: Mapping[str, str]) -> Design:
    """The design with some inputs, key -> text."""
    values = {}
    for key, text in texts.items():
        declared = declaration_of(key)
        values[key] = declared.read(text).value if isinstance(declared, BaseQuantity) else declared.read(text)
    return design.replace(values)

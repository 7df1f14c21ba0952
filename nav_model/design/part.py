"""Base class of the sections of a design."""

from typing import Any, ClassVar

import param

from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.table import Table

Input = BaseQuantity[Any] | Choice | Table


class Part(param.Parameterized):
    """One section of a design file."""

    section: ClassVar[str] = ""
    title: ClassVar[str] = ""
    optional: ClassVar[bool] = False
    """True if files and reports leave the section out while nothing in it is given."""

    @classmethod
    def inputs(cls) -> dict[str, Input]:
        """Name -> declaration of every input of this part, in the order of declaration."""
        return {
            name: declaration
            for name, declaration in cls.param.objects("existing").items()
            if isinstance(declaration, BaseQuantity | Choice | Table)
        }

    def given(self) -> bool:
        """True if the section is written: always, unless it is optional and all its inputs have their defaults."""
        return not self.optional or any(getattr(self, name) != q.default for name, q in self.inputs().items())


def preset(kind: str) -> Any:
    return param.String(
        default=None,
        allow_None=True,
        constant=True,
        doc=f"Name of {kind} of the catalogue; its values fill the keys that are not given.",
    )

"""Checks of the inputs of the suborbital model."""

from __future__ import annotations


class Misfit(ValueError):
    """Values that are not allowed together; `fields` are the model's names of those that could change."""

    def __init__(self, message: str, fields: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.fields = fields

    def __reduce__(self) -> tuple[type[Misfit], tuple[str, tuple[str, ...]]]:
        """Keep all fields when sent from a worker process."""
        return type(self), (str(self), self.fields)


def require(condition: bool, message: str, *fields: str) -> None:
    """Raise `Misfit` with `message` and `fields` unless the condition holds."""
    if not condition:
        raise Misfit(message, fields)

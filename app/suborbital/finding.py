"""A suborbital study as it is handed on: what is shown, the inputs behind it, how exact it is."""

from __future__ import annotations

from dataclasses import dataclass

from app.charts.suborbital import Shown
from nav_model.suborbital.settings import Settings
from nav_model.suborbital.study import Gap


@dataclass(frozen=True)
class Finding:
    """`shown` at `settings`, which its survey was run at unless the curves were moved; ``gap`` of the moved answer
    before the last exact run (None: not known)."""

    shown: Shown
    settings: Settings
    gap: Gap | None = None

"""A suborbital study for the report: what is shown and its inputs."""

from __future__ import annotations

from dataclasses import dataclass

from app.subjects.suborbital.charts import Shown
from nav_model.suborbital.settings import Settings


@dataclass(frozen=True)
class Finding:
    """`shown` at `settings`, which its survey was run at unless the curves were moved."""

    shown: Shown
    settings: Settings

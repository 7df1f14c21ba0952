"""Navigation error budgets: the physics, without a user interface.

The names below are all that a script needs. Each loads its module when it is first used.

Examples
--------
>>> from nav_model import analyse, parse_design
>>> design = parse_design('''
... [imu]
... angle_random_walk = "0.1 °/√h"
... velocity_random_walk = "0.03 m/s/√h"
... [requirements]
... detrended_phase = "20°"
... ''')
>>> budget = analyse(design)
>>> f"{budget['detrended_phase', 'real time'].sigma:.3f} rad"  # 1 sigma, over the aperture
'0.091 rad'
>>> [(check.name, round(check.margin, 2)) for check in budget.verdict.checks]
[('detrended_phase', 0.74)]
>>> budget.verdict.closes
True
"""

from importlib import import_module
from typing import TYPE_CHECKING

__all__ = ["Budget", "Design", "InputError", "analyse", "format_design", "parse_design", "read_design"]

if TYPE_CHECKING:
    from nav_model.base.errors import InputError
    from nav_model.budget import Budget, analyse
    from nav_model.design import Design
    from nav_model.design.file import format_design, parse_design, read_design
else:
    _HOMES = {
        "Budget": "nav_model.budget",
        "analyse": "nav_model.budget",
        "Design": "nav_model.design",
        "format_design": "nav_model.design.file",
        "parse_design": "nav_model.design.file",
        "read_design": "nav_model.design.file",
        "InputError": "nav_model.base.errors",
    }

    def __getattr__(name: str) -> object:
        """Load a public name when it is first used: `nav_model.suborbital` needs no designs."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(_HOMES[name]), name)

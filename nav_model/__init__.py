"""Navigation error budgets: the physics, without a user interface.

The names below are all that a script needs, a function for each question that the command `navbudget` answers: the
guide is docs/library.md. Each loads its module when it is first used.

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

__all__ = [
    "Budget", "Design", "InputError", "allocate", "analyse", "analyse_log", "catalogue",
    "closing_sets", "flight_covariance", "flown_study", "format_design", "image_study", "invert", "manoeuvres",
    "parse_design", "rank", "read_design", "read_log", "read_solution", "read_uncertain", "search",
    "simulation_study", "solve", "trade_map", "uncertain_verdict", "vendor_table", "with_flight",
]  # fmt: skip

if TYPE_CHECKING:
    from nav_model.allan.log_file import read_log
    from nav_model.allan.static_log import analyse_log
    from nav_model.base.errors import InputError
    from nav_model.budget import Budget, analyse
    from nav_model.budget.allocation import allocate
    from nav_model.design import Design
    from nav_model.design.catalogue import catalogue
    from nav_model.design.file import format_design, parse_design, read_design
    from nav_model.explore.closing import closing_sets
    from nav_model.explore.manoeuvre import manoeuvres
    from nav_model.explore.rank import rank
    from nav_model.explore.search import search
    from nav_model.explore.solve import solve
    from nav_model.explore.trade_map import trade_map
    from nav_model.explore.uncertainty import read_uncertain, uncertain_verdict
    from nav_model.explore.vendor_table import invert, vendor_table
    from nav_model.flown.files.reader import read_solution
    from nav_model.flown.study import flown_study
    from nav_model.sar.design_study import image_study
    from nav_model.simulation.design_study import simulation_study
    from nav_model.trajectory.design_study import flight_covariance
    from nav_model.trajectory.verdict import with_flight
else:
    _HOMES = {
        "Budget": "nav_model.budget",
        "analyse": "nav_model.budget",
        "Design": "nav_model.design",
        "format_design": "nav_model.design.file",
        "parse_design": "nav_model.design.file",
        "read_design": "nav_model.design.file",
        "InputError": "nav_model.base.errors",
        "allocate": "nav_model.budget.allocation",
        "analyse_log": "nav_model.allan.static_log",
        "catalogue": "nav_model.design.catalogue",
        "closing_sets": "nav_model.explore.closing",
        "flight_covariance": "nav_model.trajectory.design_study",
        "flown_study": "nav_model.flown.study",
        "image_study": "nav_model.sar.design_study",
        "invert": "nav_model.explore.vendor_table",
        "manoeuvres": "nav_model.explore.manoeuvre",
        "rank": "nav_model.explore.rank",
        "read_log": "nav_model.allan.log_file",
        "read_solution": "nav_model.flown.files.reader",
        "read_uncertain": "nav_model.explore.uncertainty",
        "search": "nav_model.explore.search",
        "simulation_study": "nav_model.simulation.design_study",
        "solve": "nav_model.explore.solve",
        "trade_map": "nav_model.explore.trade_map",
        "uncertain_verdict": "nav_model.explore.uncertainty",
        "vendor_table": "nav_model.explore.vendor_table",
        "with_flight": "nav_model.trajectory.verdict",
    }

    def __getattr__(name: str) -> object:
        """Load a public name when it is first used: `nav_model.suborbital` needs no designs."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(_HOMES[name]), name)

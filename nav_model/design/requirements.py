"""The requirements of a design: limits on its figures."""

from typing import TYPE_CHECKING, Any, cast

import param

from nav_model.design.declaration import Choice, Quantity
from nav_model.design.figures import FIGURES
from nav_model.design.part import Part


class Requirements(Part):
    """Limits; one not given is not checked. Those of figures are declared with them."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Limit on a figure."""

    section = "requirements"
    title = "Requirements"

    confidence = Quantity(
        default=1.0,
        dimension="",
        unit="",
        short="k",
        bounds=(0.1, 6.0),
        softbounds=(1.0, 3.0),
        label="Confidence",
        doc="Number of sigmas that must stay within a limit.",
        datasheet="From the requirement: its percentage.",
        typical="1 (68 %), 2 (95 %), 3 (99.7 %)",
        variable=False,
    )
    steady_state = Choice(
        default="prior",
        options={"prior": "before a fix", "closed": "average between fixes", "posterior": "after a fix"},
        short="ss",
        label="Check position",
        doc="Which moment is checked: before a fix, where the error is largest, the average (rms) "
        "between fixes, or after a fix.",
    )


for _figure in FIGURES.values():
    if _figure.requirement is not None:
        Requirements.param.add_parameter(_figure.name, cast("param.Parameter[Any]", _figure.requirement))

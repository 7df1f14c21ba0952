"""A budget as sections of a design's report: the requirements first, then what explains them."""

from app.document.allocation import allocation_table
from app.document.blocks import Block, Section, chart_block
from app.document.closing import closing_block
from app.document.display import ONE_SIGMA, Display
from app.subjects.budget import charts, timelines
from app.subjects.budget.tables import (
    contributor_table,
    echo_table,
    image_table,
    outage_table,
    phase_table,
    processing_table,
    requirement_table,
    steady_table,
)
from app.subjects.budget.vendor import vendor_block
from nav_model.budget import Budget
from nav_model.explore.closing import closing_sets


def sections(budget: Budget, key: str, display: Display = ONE_SIGMA) -> tuple[Section, ...]:
    """Requirements, steady state, outage, phase and image, regime.

    The table of the steady state, the curves against time and the phases by source are told as chosen.
    """
    over_time = (timelines.position_chart, timelines.velocity_chart, timelines.attitude_chart)
    position, velocity, attitude = (chart_block(display.timeline(draw(budget)), key) for draw in over_time)
    phase = chart_block(display.bars(charts.phase_chart(budget)), key)
    response, regime = (chart_block(draw(budget), key) for draw in (charts.response_chart, charts.regime_chart))
    echoes = (echo_table(budget, key),) if budget.has_fast_sources else ()
    contributors = (contributor_table(budget, key),) if budget.design.contributors else ()
    split: tuple[Section, ...] = ()
    if budget.design.contributors or budget.design.allocation:
        tables = tuple(allocation_table(budget, check, key) for check in budget.straight_leg().checks)
        split = (Section(f"{key}-allocation", "Allocation", tables),) if tables else ()
    return (
        Section(
            f"{key}-requirements",
            "Requirements",
            (requirement_table(budget, key), *_closing(budget), *contributors),
        ),
        *split,
        Section(f"{key}-processing", "Processing", (processing_table(budget, key),)),
        Section(f"{key}-steady", "Steady state", (steady_table(budget, key, display),)),
        Section(
            f"{key}-growth",
            "Errors against time",
            (position, outage_table(budget, key), velocity, attitude, vendor_block(budget.design, key)),
        ),
        Section(
            f"{key}-phase",
            "Phase and image",
            (phase, phase_table(budget, key), response, image_table(budget, key), *echoes),
        ),
        Section(f"{key}-regime", "Gyro or accelerometer", (regime,)),
    )


def _closing(budget: Budget) -> tuple[Block, ...]:
    """The change that a design needs, where the straight leg fails."""
    if not budget.straight_leg().failing:
        return ()
    return (closing_block(budget, closing_sets(budget.design), buttons=False),)

"""A flown flight as sections of a report."""

from app.document.blocks import Section, Text, chart_block
from app.document.flown import answer
from app.document.wording import identified
from app.subjects.flown.charts import map_chart, timelines
from app.subjects.flown.run import FlownFlight
from app.subjects.flown.tables import (
    flight_blocks,
    jump_block,
    main_figure,
    noise_blocks,
    place_blocks,
    receiver_block,
)
from nav_model.design import Design

_HOW = "The difference of two solutions against the covariance along the flown track [P-13], [P-14], [P-17], [P-18]."


def another_design(study: FlownFlight, design: Design) -> str:
    """The design it was held against, where that is not exactly this one; else nothing."""
    return "" if study.design.input_hash == design.input_hash else identified(study.design)


def sections(study: FlownFlight, key: str) -> tuple[Section, ...]:
    """The verdict, the lines and what was fitted, then the charts."""
    drawn = [map_chart(study), *timelines(study, main_figure(study))]
    tables = (
        *flight_blocks(study, key),
        *place_blocks(study, key),
        jump_block(study, key),
        *noise_blocks(study, key),
        receiver_block(study, key),
    )
    return (
        Section(
            f"{key}-flown", "As flown: did the flight meet the budget?", (answer(study.result), *tables, Text(_HOW))
        ),
        Section(
            f"{key}-flown-charts",
            "As flown: differences along time",
            tuple(chart_block(chart, key) for chart in drawn),
        ),
    )

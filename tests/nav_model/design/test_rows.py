"""Tables of a design: read as text, as pairs and as tables of a file; refused by name."""

import pytest

from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query

G = 9.80665
LINES = ((20.0, 0.1 * G, "acceleration"), (80.0, 2e-5, "length"))


@pytest.mark.parametrize(
    "written",
    [
        '[{frequency = "20 Hz", amplitude = "0.1 g"}, {frequency = "80 Hz", amplitude = "0.02 mm"}]',
        '[["20 Hz", "0.1 g"], ["80 Hz", "0.02 mm"]]',
        '"20 Hz 0.1 g; 0.08 kHz 0.02 mm"',
        '"""\n20 Hz  0.1 g\n80 Hz: 0.02 mm\n"""',
    ],
)
def test_every_way_of_writing_lines(written):
    assert parse_design(f"[motion]\nlines = {written}").motion.lines == LINES


def test_a_curve_in_decibels():
    design = parse_design('[oscillator]\nphase_noise = [["10 Hz", "-80 dBc/Hz"], ["1 kHz", "-120 dBc/Hz"]]')
    assert design.oscillator.phase_noise == ((10.0, 1e-8, "phase noise"), (1000.0, 1e-12, "phase noise"))


def test_file_and_link_bring_the_same_table():
    design = Design(
        {
            "motion.lines": LINES,
            "motion.spectrum": ((5.0, 0.1, "acceleration density"), (9.0, 0.1 / 3, "acceleration density")),
        }
    )
    assert parse_design(format_design(design)) == design
    assert from_query(to_query(design)) == design


def test_a_design_of_before_is_the_same_design():
    text = '[imu]\nangle_random_walk = "0.3 °/√h"\n'
    design = parse_design(text)
    assert design.motion.lines == ()
    assert design.oscillator.phase_noise == ()
    # As computed before there were these inputs.
    before = "1ddf64c8a1ffdf37ffc6ef00d2802fa6027581b36bdf37cbda765da168b4f5fe"
    hint = "saved designs would have another hash: does a new input's declaration lack since=?"
    assert Design().content_hash == before, hint


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("motion.spectrum", "20 Hz 1 g²/Hz; 10 Hz 1 g²/Hz", "10 Hz comes after 20 Hz"),
        ("motion.spectrum", "20 Hz 1 g²/Hz; 20 Hz 2 g²/Hz", "Sort the rows"),
        ("motion.spectrum", "20 Hz 1 g²/Hz", "two rows or more"),
        ("motion.spectrum", "20 Hz -1 g²/Hz; 30 Hz 1 g²/Hz", "-1 g²/Hz at 20 Hz is not allowed"),
        ("motion.spectrum", "20 Hz 0 g²/Hz; 30 Hz 1 g²/Hz", "more than zero"),
        ("motion.unsensed_spectrum", "20 Hz 1 g²/Hz; 30 Hz 1 mm²/Hz", "rows mix"),
        ("motion.lines", "20 Hz -0.1 g", "-0.1 g at 20 Hz is not allowed"),
        ("motion.lines", "-20 Hz 0.1 g", "-20 Hz is not allowed"),
        ("motion.lines", "20 Hz 0.1 s", "is not a unit of acceleration"),
        ("motion.lines", "20 Hz", "is not a row"),
        ("motion.lines", "20 Hz 1e9 g", "at most"),
        ("motion.lines", "; ".join(["20 Hz 0.1 g"] * 61), "61 rows are too many. Give at most 60"),
        ("motion.lines", "x" * 20_000, "longer than"),
        ("oscillator.phase_noise", "1 Hz 90 dBc/Hz; 2 Hz -90 dBc/Hz", "It must be at most 30 dBc/Hz"),
        ("oscillator.phase_noise", "1 Hz -90 dB; 2 Hz -90 dB", "is not a unit of phase noise"),
    ],
)
def test_refused_by_name(key, text, message):
    with pytest.raises(InputError) as caught:
        parse_design('name = "x"', changes=[f"{key}={text}"])
    assert caught.value.key == key
    assert message in caught.value.reason


@pytest.mark.parametrize("content", ["5", "true", '[["20 Hz"]]', "[[20, 1]]", '[{frequency = "20 Hz"}]', "{a = 1}"])
def test_what_is_no_table_in_a_file(content):
    with pytest.raises(InputError) as caught:
        parse_design(f"[motion]\nlines = {content}")
    assert caught.value.key == "motion.lines"

"""Files, links and commands of before with an input that is gone: read, without effect, and a caution says so."""

import pickle

import pytest

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.provenance import cautions
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query

KEY = "processing.leg_before"
FILE = '[imu]\nangle_random_walk = "0.3 °/√h"\n[processing]\nleg_before = "20 s"\nleg_after = "60 s"\n'
ORIGINS = '[origins]\n"processing.leg_before" = "flight plan"\n"processing.leg_after" = "wait"\n'


@pytest.mark.parametrize(
    "read",
    [
        lambda: parse_design(FILE),
        lambda: parse_design(FILE + ORIGINS),
        lambda: parse_design(FILE.replace('leg_before = "20 s"\n', ""), changes=[f"{KEY}=20 s"]),
        lambda: parse_design(FILE, changes=[f"{KEY}=40 s"]),
        lambda: from_query("arw=0.3deg/sqrt(h)&lb=20s&la=60s"),
        lambda: from_query("arw=0.3deg/sqrt(h)&lb=20s&la=60s&origin.lb=flight+plan"),
    ],
    ids=["file", "file with origins", "--set", "--set over a file", "link", "link with origins"],
)
def test_it_is_read_has_no_effect_and_is_said(read):
    design = read()
    same = parse_design(FILE.replace('leg_before = "20 s"\n', ""))
    assert (design, design.content_hash) == (same, same.content_hash)
    assert design.outdated == (KEY,)
    assert KEY not in design.origins
    assert [caution for caution in cautions(analyse(design)) if KEY in caution]
    assert not [caution for caution in cautions(analyse(same)) if KEY in caution]
    assert pickle.loads(pickle.dumps(design)).outdated == (KEY,)
    # what is written from then on does not have it
    assert "leg_before" not in format_design(design)
    assert from_query(to_query(design)).outdated == ()


def test_nobody_else_may_use_it():
    with pytest.raises(InputError, match="unknown"):
        Design({KEY: 20.0})
    with pytest.raises(InputError, match="unknown"):
        parse_design("[coast]\nleg_before = 20")

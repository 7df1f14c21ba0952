"""Receiver classes: a class is the numbers of its sheet, retyped here and brought to one axis by hand."""

import math

import pytest

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.json import to_json
from nav_model.budget.provenance import cautions
from nav_model.design import Design
from nav_model.design.catalogue import catalogue, read_catalogue
from nav_model.design.file import format_design, parse_design, read_design
from nav_model.design.link import from_query, to_query
from nav_model.design.presets import deviations, preset_fill, without_class

# name: rms of both horizontal axes [m], vertical [m], ppm of each (0: no base), correlation time [s]
SHEETS = {
    "Single point, one frequency": (1.5, 1.6, 0, 0, 1100),
    "Single point, two frequencies": (1.2, 1.3, 0, 0, 1100),
    "SBAS": (0.6, 0.63, 0, 0, 100),
    "DGNSS": (0.25, 0.5, 1, 1, 100),
    "Float": (0.2, 0.21, 5, 5.3, 1500),
    "RTK": (8e-3, 15e-3, 1, 1, 115),
    "PPK": (8e-3, 15e-3, 1, 1, 115),
    "PPP": (2.5e-2, 2.7e-2, 0, 0, 1020),
}
EXAMPLE = read_design("examples/mems_x_band.toml")


def typed(name: str, baseline: float) -> Design:
    across, up, slope, slope_up, time = SHEETS[name]
    axis = (across + slope * 1e-6 * baseline) / math.sqrt(2)
    return EXAMPLE.replace({
        "gnss.position_noise": axis, "gnss.vertical_position_noise": up + slope_up * 1e-6 * baseline,
        "gnss.correlated": True, "gnss.correlated_noise": axis, "gnss.correlation_time": time,
        "gnss.vertical_correlated_noise": up + slope_up * 1e-6 * baseline,
    })  # fmt: skip


def chosen(*changes: str) -> Design:
    return parse_design(format_design(EXAMPLE), changes=changes)


def numbers(value: object) -> list[float]:
    if isinstance(value, dict):
        value = [*value.values()]
    if isinstance(value, list | tuple):
        return [number for item in value for number in numbers(item)]
    return [float(value)] if isinstance(value, float) else []


def test_classes_are_those_of_the_sheets() -> None:
    assert set(catalogue("gnss")) == set(SHEETS)


@pytest.mark.parametrize("name", SHEETS)
def test_a_class_gives_the_budget_of_its_numbers_typed_in(name: str) -> None:
    for baseline in (0.0, 10e3, 35e3):
        design = chosen(f"gnss.preset={name}", f"gnss.baseline={baseline} m")
        have, by_hand = (
            numbers([part for key, part in to_json(analyse(variant)).items() if key != "design"])
            for variant in (design, typed(name, baseline))
        )
        assert len(have) > 100
        assert have == pytest.approx(by_hand, rel=1e-9, nan_ok=True)
    if SHEETS[name][2]:  # until the distance is given
        assert chosen(f"gnss.preset={name}").gnss.baseline == 10e3


def test_every_value_says_its_source_or_that_none_is_published() -> None:
    for name, entry in catalogue("gnss").items():
        for key, item in entry.values.items():
            if item.status == "assumed" and key != "baseline":
                assert "no published value" in item.source, (name, key)
            assert len(item.source) > 20, (name, key)
        assert entry.values["position_noise"].confirmed, name


def test_a_typed_value_wins_over_the_class_and_is_named() -> None:
    for changes in (["gnss.position_noise=3 cm", "gnss.preset=RTK"], ["gnss.preset=RTK", "gnss.position_noise=3 cm"]):
        design = chosen(*changes)
        assert design.gnss.position_noise == 0.03
        assert design.gnss.vertical_position_noise == 0.025
        assert deviations(design, "gnss") == {"position_noise"}
    assert deviations(chosen("gnss.preset=RTK", "gnss.baseline=20 km"), "gnss") == frozenset()  # the flight's own
    assert chosen("gnss.preset=RTK", "gnss.correlated=false").gnss.correlated is False


def test_the_base_line_moves_noise_and_slow_error_of_the_class() -> None:
    far = chosen("gnss.preset=RTK").replace({"gnss.baseline": 20e3})
    assert far.gnss.position_noise == far.gnss.correlated_noise == pytest.approx(28e-3 / math.sqrt(2), rel=1e-12)
    assert far.gnss.vertical_position_noise == pytest.approx(35e-3, rel=1e-12)
    assert far.gnss.vertical_correlated_noise == far.gnss.vertical_position_noise
    assert deviations(far, "gnss") == frozenset()
    for design in (far, far.replace({"gnss.correlation_time": 60.0}), chosen("gnss.preset=PPP")):
        for back in (parse_design(format_design(design)), from_query(to_query(design))):
            assert back == design
            assert back.replace({"gnss.baseline": 5e3}) == design.replace({"gnss.baseline": 5e3})


@pytest.mark.parametrize("name", SHEETS)
def test_nothing_of_a_class_stays_without_it(name: str) -> None:
    design = Design({"gnss.velocity_noise": 0.05, "gnss.interval": 0.2})
    values, units = preset_fill("gnss", name)
    filled = design.replace(values, units)
    assert filled.replace(without_class(filled)) == design
    assert without_class(design) == {}


def test_what_was_changed_since_stays_without_the_class() -> None:
    values, units = preset_fill("gnss", "PPK")
    later = Design().replace(values, units).replace({"gnss.correlation_time": 60.0, "gnss.baseline": 20e3})
    without = later.replace(without_class(later))
    assert without == Design({"gnss.correlation_time": 60.0, "gnss.baseline": 20e3})
    growing = {"gnss.position_noise": 15e-3}, {"gnss.position_noise": "mm + 1 ppm"}  # 5 mm + 1 ppm over 10 km
    typed = Design().replace(values, units).replace(*growing)
    assert typed.replace(without_class(typed)) == Design({"gnss.position_noise": 15e-3, "gnss.baseline": 10e3})


def of_class(*changes: str) -> list[str]:
    return [caution for caution in cautions(analyse(chosen(*changes))) if "receiver class" in caution]


def test_a_class_beyond_its_sheet_is_cautioned_by_name() -> None:
    (caution,) = of_class("gnss.preset=PPK")
    assert "PPK are computed after the flight" in caution
    assert "Choose post-processed (processing.mode)" in caution
    (caution,) = of_class("gnss.preset=RTK", "gnss.baseline=100 km")
    assert "RTK holds for a base station up to 30 km away; that of the design is 100 km away" in caution
    late = ("gnss.preset=PPK", "processing.mode=post-processed")
    for changes in (late, ("gnss.preset=RTK", "gnss.baseline=30 km"), ("gnss.preset=PPP",)):
        assert of_class(*changes) == []


def test_a_catalogue_file_says_when_fixes_are_known() -> None:
    rest = 'position_noise = { value = "2 cm", status = "assumed", source = "a web page" }\n'
    (late,) = read_catalogue(f'[[gnss]]\nname = "A"\nprocessing = "post-processed"\n{rest}', "gnss").values()
    assert late.post_processed
    with pytest.raises(InputError, match=r"gnss.A.processing: 'later' is not"):
        read_catalogue(f'[[gnss]]\nname = "A"\nprocessing = "later"\n{rest}', "gnss")


def test_another_class_keeps_the_base_line_and_leaves_nothing_of_the_last() -> None:
    design = parse_design(
        format_design(chosen("gnss.preset=RTK", "gnss.baseline=20 km")), changes=["gnss.preset=SBAS"]
    )
    assert design.gnss.baseline == 20e3
    assert design.gnss.correlation_time == 100
    assert parse_design(format_design(design), changes=["gnss.preset=RTK"]).gnss.position_noise == pytest.approx(
        28e-3 / math.sqrt(2)
    )
    with pytest.raises(InputError, match=r"gnss.preset: 'L5' is not in the catalogue; it has Single point"):
        chosen("gnss.preset=L5")

"""Sets of levers that close a design, against an enumeration of every set."""

import itertools
import json
import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from app.cli import main
from app.examples import example
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design, Value
from nav_model.design.catalogue import read_catalogue
from nav_model.explore.closing import Closing, LeverSet, closing_sets
from nav_model.explore.levers import ASKED_FOR, GROUPS, Lever, levers
from nav_model.explore.margins import ratios_of_trials, worst
from tests.support.known_designs import MEMS


def some_design(seed: int) -> Design:
    """A design that misses some limit by up to a factor of three."""
    random = np.random.default_rng(seed)

    def spread(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    changes: dict[str, Value] = {
        "imu.angle_random_walk": math.radians(spread(0.01, 0.5)) / 60,
        "imu.velocity_random_walk": spread(0.01, 0.3) / 60,
        "gnss.position_noise": spread(0.02, 3),
        "gnss.interval": float(random.choice([0.2, 1.0])),
        "radar.slant_range": spread(4e3, 2e4),
        "radar.azimuth_resolution": spread(0.1, 1),
        "processing.mode": str(random.choice(["real time", "post-processed"])),
        "processing.leg_after": float(random.choice([0.0, 60.0])),
        "coast.before_aperture": spread(0.1, 5),
    }
    if random.random() < 0.3:
        changes["gnss.velocity_noise"] = spread(0.005, 0.2)
    if random.random() < 0.3:
        changes |= {"gnss.correlated": True, "gnss.correlated_noise": spread(0.05, 1)}
    if random.random() < 0.3:
        changes |= {"imu.accelerometer_bias": spread(1e-6, 1e-3)}
    if random.random() < 0.15:
        changes |= {"accelerometer.bias_instability": spread(1e-5, 1e-3)}
    design = example("mems_x_band").replace(changes)
    limits: dict[str, Value] = {}
    for check in analyse(design.replace({f"requirements.{name}": 1.0 for name in _LIMITED})).straight_leg().checks:
        if check.name in _LIMITED and (random.random() < 0.6 or check.name == "tilt"):
            limits[f"requirements.{check.name}"] = max(check.value * spread(0.3, 1.5), 1e-6)
    return design.replace(dict.fromkeys((f"requirements.{name}" for name in _LIMITED), None) | limits)


_LIMITED = ("detrended_phase", "quadratic_phase", "horizontal_position", "coast_horizontal_position", "tilt")


def smallest_by_enumeration(design: Design) -> set[frozenset[str]]:
    """Names of the levers of each smallest set, from the worst ratio of every set of up to three."""
    every = {lever.name: lever for lever in levers(design, [name for name in GROUPS if name not in ASKED_FOR])}
    sets = [
        names
        for size in (1, 2, 3)
        for names in itertools.combinations(every, size)
        if len({every[name].group for name in names}) == size
    ]
    needs = {name: dict(lever.needs) for name, lever in every.items()}
    changes = [changes_of(every[name] for name in names) for names in sets]
    # With its needs, and its needs alone, to see what a lever does by itself.
    alone = [needs[name] | dict(every[name].changes) for name in every]
    everything = [{}, *changes, *alone, *needs.values()]
    ratios = [float(ratio) for ratio in worst(ratios_of_trials(design, everything))]
    today, ratios = ratios[0], ratios[1:]
    if today <= 1:
        return set()
    by_lever, by_needs = (dict(zip(every, part, strict=True)) for part in np.split(np.array(ratios[len(sets) :]), 2))
    good = {name for name in every if by_lever[name] <= 1.001 * by_needs[name]}
    units = sorted((name for name in every if every[name].group == "imu"), key=lambda name: -by_lever[name])
    step = {name: units.index(name) if name in units else lever.step for name, lever in every.items()}
    closing = [
        names
        for names, ratio, made in zip(sets, ratios, changes, strict=False)
        if ratio <= 1
        and good.issuperset(names)
        and all(made.get(key, design[key]) == value for name in names for key, value in needs[name].items())
    ]

    def below(less: tuple[str, ...], more: tuple[str, ...]) -> bool:
        """True if each lever of the one is in the other, or a lesser step of one there."""
        return less != more and all(
            any(every[a].family == every[b].family and step[a] <= step[b] for b in more) for a in less
        )

    return {frozenset(more) for more in closing if not any(below(less, more) for less in closing)}


def changes_of(chosen: Iterable[Lever]) -> dict[str, Value]:
    return {key: value for lever in chosen for key, value in lever.changes.items()}


def closes(design: Design, chosen: Iterable[Lever]) -> bool:
    """The verdict of the whole analysis."""
    return analyse(design.replace(changes_of(chosen))).straight_leg().closes


def compare_with_enumeration(seed: int) -> int:
    """Sets of a random design, compared."""
    design = some_design(seed)
    answer = closing_sets(design)
    sets = {frozenset(lever.name for lever in each.levers) for each in answer.sets}
    assert sets == smallest_by_enumeration(design), seed
    order = [(len(each.levers), max(GROUPS.index(name) for name in each.groups)) for each in answer.sets]
    assert order == sorted(order)
    for each in answer.sets[:5]:
        assert closes(design, each.levers), (seed, each.levers)
        for size in range(len(each.levers)):
            for part in itertools.combinations(each.levers, size):
                whole = all(changes_of(part).get(k, design[k]) == v for lever in part for k, v in lever.needs.items())
                assert not (whole and closes(design, part)), (seed, part)
    assert not (answer.sets and answer.nearest)
    assert not (answer.sets and answer.closes)
    return len(sets)


def test_sets_are_those_of_an_enumeration() -> None:
    assert sum(compare_with_enumeration(seed) for seed in range(6)) > 5


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [range(n, n + 30) for n in range(0, 300, 30)], ids=lambda seeds: str(seeds.start))
def test_sets_of_300_random_designs_are_those_of_an_enumeration(seeds: range) -> None:
    assert sum(map(compare_with_enumeration, seeds)) > 50


@pytest.fixture(scope="module")
def mems() -> Closing:
    return closing_sets(example("mems_x_band"))


def names_of(sets: Iterable[LeverSet]) -> list[list[str]]:
    return [[lever.name for lever in each.levers] for each in sets]


def test_processing_closes_the_mems_design_only_with_velocity_or_a_better_receiver(mems: Closing) -> None:
    # As the worked design of the README has found them by hand.
    assert ["Process after the flight", "Velocity fixes of 3 cm/s, Doppler"] in names_of(mems.sets)
    assert ["Process after the flight", "DGNSS"] in names_of(mems.sets)
    with_dgnss = next(each for each in mems.sets if names_of([each])[0] == ["Process after the flight", "DGNSS"])
    assert {name for _, name in names_of(with_dgnss.greater)} == {"Float", "PPP", "RTK", "PPK"}
    assert not any(each.because == "" for each in mems.alone if each.lever.group in ("processing", "receiver"))
    # Detrended phase over its limit, of the line of sight alone, by the derivation; the image adds to it.
    ratio = {each.lever.name: each.set.worst_ratio for each in mems.alone}
    assert ratio["Process after the flight"] == pytest.approx(1.10, rel=0.05)
    assert ratio["RTK"] == pytest.approx(1.48, rel=0.05)
    assert ratio["PPP"] == pytest.approx(1.52, rel=0.05)


def test_a_lever_that_makes_it_worse_is_listed_and_in_no_set(mems: Closing) -> None:
    worse = {each.lever.name for each in mems.alone if each.because.startswith("worse")}
    assert "MPU-9250" in worse
    assert not worse & {name for names in names_of(mems.sets) for name in names}


def test_what_a_lever_needs_is_another_of_its_set(mems: Closing) -> None:
    assert "PPK" not in {each.lever.name for each in mems.alone}
    locked = closing_sets(example("mems_x_band"), lock=["processing"])
    names = {name for each in (*locked.sets, *locked.sets[0].greater) for name in names_of([each])[0]}
    assert not names & {"PPK", "Process after the flight"}
    flown_to_the_end = closing_sets(example("mems_x_band").replace({"processing.leg_after": 0.0}))
    assert "Process after the flight" not in {each.lever.name for each in flown_to_the_end.alone}


def test_autofocus_is_a_lever_in_a_scene_that_the_design_gives(mems: Closing) -> None:
    assert "autofocus" not in {each.lever.group for each in mems.alone}
    assert levers(example("mems_x_band").replace({"autofocus.scene": "sea"}), ["autofocus"]) == ()
    town = example("mems_x_band").replace({"autofocus.scene": "urban"})
    answer = closing_sets(town)
    first = answer.sets[0]
    assert [lever.name for lever in first.levers] == ["Autofocus by map drift in this scene"]
    assert closes(town, first.levers)
    assert {"phase_before_autofocus", "path_before_autofocus"} <= first.ratios.keys()
    assert not closes(town, [])


def test_locks_and_allowed_groups() -> None:
    design = example("mems_x_band")
    locked = closing_sets(design, lock=["imu.angle_random_walk", "gnss.velocity_noise"])
    assert {each.changes.get("imu.angle_random_walk", design.imu.angle_random_walk) for each in locked.sets} == {
        design.imu.angle_random_walk
    }
    assert {"velocity"}.isdisjoint(group for each in locked.sets for group in each.groups)
    coarser = closing_sets(design, allow=["radar"], lock=["imu"], at_most=1)
    assert names_of(coarser.sets) == [["Resolution 2 × coarser"]]
    nothing = closing_sets(design, lock=["imu", "processing", "velocity"])
    assert nothing.sets == ()
    assert nothing.nearest is not None
    assert names_of([nothing.nearest]) == [["RTK"]]
    assert nothing.nearest.failing
    assert {each.groups[-1] for each in nothing.helps} <= set(GROUPS)
    helped = next(each for each in nothing.helps if "Process after the flight" in names_of([each])[0])
    assert closes(design, helped.levers)


def test_a_reserve_is_a_margin_that_every_set_keeps() -> None:
    answer = closing_sets(example("mems_x_band"), reserve=0.05)
    assert answer.sets
    assert min(each.margin for each in answer.sets) >= 0.05
    assert ["Process after the flight", "DGNSS"] not in names_of(answer.sets)
    strict = closing_sets(example("mems_x_band"), reserve=0.6)  # the Primus 200 alone keeps 51 %
    why = {each.lever.name: each.because for each in strict.alone}
    assert why["LN-100"] == ""
    assert why["Sagem Primus 200"] == "not enough for detrended phase"
    assert closing_sets(example("tactical_x_band"), reserve=0.0).closes


def test_prices_decide_among_units_that_close() -> None:
    unit = """
        [[imu]]
        name = "{name}"
        angle_random_walk = {{ value = "{walk} °/√h", status = "confirmed", source = "offer" }}
        velocity_random_walk = {{ value = "0.01 m/s/√h", status = "confirmed", source = "offer" }}
        price = {{ value = "{price} EUR", status = "confirmed", source = "offer" }}
    """
    text = "".join(unit.format(name=n, walk=w, price=p) for n, w, p in (("dear", 0.001, 90e3), ("fair", 0.01, 9e3)))
    answer = closing_sets(example("mems_x_band"), imus=read_catalogue(text, "imu"), lock=["processing", "velocity"])
    assert names_of(answer.sets)[0] == ["fair"]
    assert (answer.sets[0].price, answer.sets[0].currency) == (9000.0, "EUR")
    assert names_of(answer.sets[0].greater) == [["dear"]]
    taken = example("mems_x_band").replace(answer.sets[0].changes, answer.sets[0].written)
    assert taken.imu.preset is None
    assert analyse(taken).straight_leg().closes


def test_more_units_than_can_be_combined_are_refused() -> None:
    entry = '[[imu]]\nname = "{}"\n' + "".join(
        f'{walk} = {{{{ value = "{value}", status = "assumed", source = "s" }}}}\n'
        for walk, value in (("angle_random_walk", "0.1 °/√h"), ("velocity_random_walk", "0.05 m/s/√h"))
    )
    units = read_catalogue("".join(entry.format(f"unit {n}") for n in range(301)), "imu")
    with pytest.raises(InputError, match="at most 300"):
        closing_sets(example("mems_x_band"), imus=units)


@pytest.mark.parametrize(
    ("key", "value"),
    [("allow", ["rocket"]), ("lock", ["rocket"]), ("at_most", 4), ("reserve", 1.0)],
)
def test_bad_choices_are_named(key: str, value: Any) -> None:
    with pytest.raises(InputError) as error:
        closing_sets(example("mems_x_band"), **{key: value})
    assert error.value.key == key


def test_a_design_without_requirements_is_refused() -> None:
    with pytest.raises(InputError, match="requirements"):
        closing_sets(Design())


def test_velocity_levers_are_better_than_what_the_design_has() -> None:
    design = example("mems_x_band").replace(
        {"gnss.velocity_noise": 0.02, "gnss.vertical_velocity_noise": 0.03, "gnss.velocity_interval": 0.5}
    )
    by_name = {lever.name: lever.changes for lever in levers(design, ["velocity"])}
    assert by_name["Velocity fixes of 1 cm/s, carrier phase"]["gnss.vertical_velocity_noise"] == pytest.approx(0.015)
    assert by_name["Velocity fixes of 1 cm/s, carrier phase, 10 Hz"]["gnss.velocity_interval"] == 0.1
    assert "Velocity fixes of 3 cm/s, Doppler" not in by_name


def test_nobody_is_sent_below_the_ground() -> None:
    design = example("mems_x_band").replace({"flight.altitude": 4000.0, "radar.slant_range": 7000.0})
    nearest = [x.changes["radar.slant_range"] for x in levers(design, ["flight"]) if x.family == "range"]
    assert nearest
    assert min(nearest) >= 4000.0


def test_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explore", "close", MEMS, "--lock", "imu"]) == 0
    answer = json.loads(capsys.readouterr().out)
    first = answer["sets"][0]
    assert first["changes"] == {"processing.mode": "post-processed", "gnss.velocity_noise": 0.03}
    assert first["groups"] == ["processing", "velocity"]
    assert answer["closes"] is False
    assert answer["nearest"] is None
    assert (
        main(["check", MEMS, "--set", "processing.mode=post-processed", "--set", "gnss.velocity_noise=3 cm/s"]) == 0
    )
    capsys.readouterr()
    assert main(["explore", "close", MEMS, "--lock", "imu,processing"]) == 1
    answer = json.loads(capsys.readouterr().out)
    assert answer["sets"] == []
    assert answer["nearest"]["failing"]
    assert answer["nearest"]["would_help"]
    assert main(["explore", "close", MEMS, "--lock", "nonsense"]) == 2
    assert "--lock" in capsys.readouterr().err

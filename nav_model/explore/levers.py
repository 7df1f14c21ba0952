"""Levers: the changes of a design that engineers have, each declared once with its group, its step and its needs.

A group is a kind of decision, in the order of its effort; a family within it is one change in steps, such as velocity
fixes that are ever better. What a lever sets are the inputs of its own group alone.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from nav_model.base.errors import InputError
from nav_model.design import Design, Value
from nav_model.design.autofocus import MAP_DRIFT, NONE, PHASE_GRADIENT, SEA
from nav_model.design.catalogue import OFFERED as OFFER_VALUES
from nav_model.design.catalogue import Entry, SourcedValue, catalogue
from nav_model.design.parts import PRESET_KEYS
from nav_model.design.presets import filled, sheet_filled, values_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.explore.margins import usual_range

Group = Literal["processing", "velocity", "autofocus", "receiver", "imu", "flight", "radar"]
GROUPS: tuple[Group, ...] = get_args(Group)
"""Groups in the order of their effort."""
ASKED_FOR: tuple[Group, ...] = ("flight", "radar")
"""Groups that count only where they are allowed: they change the mission or the image."""
OFFERED = "offer"
"""Origin of a lever that a person has brought, which the product's catalogue has not."""
Biases = Literal["design", "zero", "in-run", "sheet"]
"""Residual biases that every unit is judged with: the design's, zero, or the in-run biases of its own sheet; or, with
the design's, all errors that its sheet prints."""
_RANDOM_WALKS = ("velocity_random_walk", "angle_random_walk")
_BIASES = ("accelerometer_bias", "gyro_bias")
# m/s: `gnss.velocity_noise`
_VELOCITY = {"Velocity fixes of 3 cm/s, Doppler": 0.03, "Velocity fixes of 1 cm/s, carrier phase": 0.01}
_RATE = 0.1  # s between velocity fixes, as receivers give them at most: `gnss.velocity_interval`
_ANTENNAS = {"Two antennas, 1 m apart": math.radians(0.3), "Two antennas, 3 m apart": math.radians(0.1)}
_TYPICAL = "typical value"
_SHORTER, _FASTER, _COARSER = (0.8, 2 / 3, 0.5), (1.25, 1.5), (1.25, 1.5, 2.0)
_ANGLES = (math.radians(10), math.radians(20))


@dataclass(frozen=True)
class Lever:
    """One change of a design.

    ``step`` counts within the ``family``: a greater one costs more. ``changes`` are the inputs (SI) that it sets,
    ``written`` their units, ``needs`` values that other inputs must have; ``origin`` is where they come from.
    ``doubts`` names values that the source
    does not confirm. ``offer`` has price, mass [kg] and power [W] where they are offered, and ``currency`` is the
    price's.
    """

    name: str
    group: Group
    family: str
    step: float
    changes: Mapping[str, Value]
    written: Mapping[str, str] = field(default_factory=dict)
    needs: Mapping[str, Value] = field(default_factory=dict)
    origin: str = ""
    doubts: tuple[str, ...] = ()
    offer: Mapping[str, float] = field(default_factory=dict)
    currency: str = ""

    def changes_in(self, design: Design) -> Mapping[str, Value]:
        """The inputs that it sets and the design has otherwise."""
        return {key: value for key, value in self.changes.items() if design[key] != value}


def levers(
    design: Design,
    groups: Iterable[Group],
    imus: Mapping[str, Entry] | None = None,
    receivers: Mapping[str, Entry] | None = None,
) -> tuple[Lever, ...]:
    """The levers of some groups that change a design.

    Parameters
    ----------
    design : Design
    groups : iterable of str
        Of `GROUPS`.
    imus, receivers : mapping, optional
        Name -> entry; by default the catalogue's. Units whose sheet lacks a random walk are no levers.

    Returns
    -------
    tuple of Lever
        By group, the lesser step of a family first; the steps of units without a price are in the order given.
    """
    units = catalogue("imu") if imus is None else imus
    classes = catalogue("gnss") if receivers is None else receivers
    of_group: Mapping[Group, Callable[[], Iterable[Lever]]] = {
        "processing": lambda: _processing(design),
        "velocity": lambda: velocity_levers(design),
        "autofocus": lambda: _autofocus(design),
        "receiver": lambda: (receiver_lever(design, entry, step) for step, entry in enumerate(classes.values())),
        "imu": lambda: (
            imu_lever(design, entry, step) for step, entry in enumerate(units.values()) if not lacks(entry)
        ),
        "flight": lambda: _flight(design),
        "radar": lambda: _radar(design),
    }
    chosen = set(groups)
    return tuple(lever for name in GROUPS if name in chosen for lever in of_group[name]() if _moves(lever, design))


def _moves(lever: Lever, design: Design) -> bool:
    """True if a lever changes a value, not only the name of where it comes from, and the design may have it."""
    if not any(key not in PRESET_KEYS for key in lever.changes_in(design)):
        return False
    try:
        design.replace({**lever.changes, **lever.needs})
    except InputError:
        return False
    return True


def _processing(design: Design) -> Iterator[Lever]:
    """A smoother is none without fixes after the aperture."""
    if design.processing.mode == REAL_TIME and design.processing.leg_after > 0:
        yield Lever("Process after the flight", "processing", "processing", 0, {"processing.mode": POST_PROCESSED})


def _autofocus(design: Design) -> Iterator[Lever]:
    """Autofocus in the scene that a design gives; without one nobody knows its points."""
    given = design.autofocus
    if given.method != NONE or given.scene == SEA or not given.given():
        return
    for step, method in enumerate((MAP_DRIFT, PHASE_GRADIENT)):
        name = f"Autofocus by {method} in this scene"
        yield Lever(name, "autofocus", "autofocus", step, {"autofocus.method": method})


def velocity_levers(design: Design) -> Iterator[Lever]:
    """Velocity fixes that are better than the design's, by their noise or their rate.

    The values are the typical ones of `gnss.velocity_noise`; a vertical noise stays in its ratio.
    """
    gnss = design.gnss
    had, every = gnss.velocity_noise, gnss.velocity_interval or gnss.interval
    vertical = gnss.vertical_velocity_noise / had if had and gnss.vertical_velocity_noise else None
    step = 0
    for name, noise in _VELOCITY.items():
        changes: dict[str, Value] = {"gnss.velocity_noise": noise}
        changes |= {} if vertical is None else {"gnss.vertical_velocity_noise": vertical * noise}
        for rate in (None, _RATE) if every > _RATE else (None,):
            if had is None or noise < had or (noise == had and rate):
                at = {} if rate is None else {"gnss.velocity_interval": rate}
                full = name + (", 10 Hz" if rate else "")
                yield Lever(full, "velocity", "velocity", step, changes | at, origin=_TYPICAL)
            step += 1


def heading_levers(design: Design) -> Iterator[Lever]:
    """Two antennas that tell the heading along a flight better than the design's, the shorter base first."""
    had = design.trajectory.heading_noise
    for step, (name, noise) in enumerate(_ANTENNAS.items()):
        if had is None or noise < had:
            yield Lever(name, "receiver", "heading", step, {"trajectory.heading_noise": noise}, origin=_TYPICAL)


def receiver_lever(design: Design, entry: Entry, step: float = 0) -> Lever:
    """A receiver class of a catalogue or an offer, at the design's baseline."""
    changes, written = filled(entry, design.baseline)
    items = values_of(entry, design.baseline)
    needs = {"processing.mode": POST_PROCESSED} if entry.post_processed else {}
    return _bought(entry, "receiver", step, changes, written, items, needs)


def imu_lever(design: Design, entry: Entry, step: float = 0, biases: Biases = "design") -> Lever:
    """An inertial unit of a catalogue or an offer, with the design's vibration factor, which no data sheet prints.

    Parameters
    ----------
    design : Design
    entry : Entry
    step : float, optional
        Among the units.
    biases : str, optional
        Residual biases that it is judged with.
    """
    changes, written = filled(entry)
    items = dict(values_of(entry))
    if biases == "in-run":
        items |= entry.in_run
        changes |= {f"imu.{name}": item.value for name, item in entry.in_run.items()}
        written |= {f"imu.{name}": item.unit for name, item in entry.in_run.items()}
    elif biases == "zero":
        changes |= {f"imu.{name}": 0.0 for name in _BIASES}
    if biases == "sheet" or design.imu.sheet:
        values, units = sheet_filled(entry)
        items |= {key: item for key, item in entry.sheet.items() if item.status != "assumed"}
        changes |= {"imu.sheet": True, **values}
        written |= units
    return _bought(entry, "imu", step, changes, written, items)


def _bought(
    entry: Entry,
    group: Group,
    step: float,
    changes: Mapping[str, Value],
    written: Mapping[str, str],
    items: Mapping[str, SourcedValue],
    needs: Mapping[str, Value] | None = None,
) -> Lever:
    """A part of a catalogue; one of the user's own is no preset of the product."""
    shipped = catalogue(entry.kind).get(entry.name) == entry
    if not shipped:
        changes = {**changes, f"{entry.kind}.preset": None}
    doubts = tuple(
        f"{name.replace('_', ' ').replace('.', ' ')} ({item.status})"
        for name, item in items.items()
        if not item.confirmed and name != "correlated"  # its size says it
    )
    return Lever(
        entry.name,
        group,
        group,
        step,
        changes,
        written,
        needs or {},
        "catalogue" if shipped else OFFERED,
        doubts,
        {name: entry.offer[name].value for name in OFFER_VALUES if name in entry.offer},
        entry.offer["price"].unit if "price" in entry.offer else "",
    )


def lacks(entry: Entry, biases: Biases = "design") -> str:
    """Values without which a unit cannot be judged and that its sheet lacks; empty where it has all."""
    missing = [name for name in _RANDOM_WALKS if name not in entry.values]
    if biases == "in-run":
        missing += [f"in-run {name}" for name in _BIASES if name not in entry.in_run]
    return " and ".join(name.replace("_", " ") for name in missing)


def one_currency(entries: Iterable[Entry]) -> str:
    """The one currency of all prices; empty without prices.

    Raises
    ------
    InputError
        If there are several.
    """
    priced = {entry.name: entry.offer["price"].unit for entry in entries if "price" in entry.offer}
    first = next(iter(priced.values()), "")
    for name, currency in priced.items():
        if currency != first:
            raise InputError(
                f"{name}.price", f"is in {currency}, others are in {first}; give every price in one currency"
            )
    return first


def _flight(design: Design) -> Iterator[Lever]:
    """Nearer, faster, flatter or steeper, as far as people fly and the ground allows."""
    distance, speed, grazing = design.radar.slant_range, design.flight.speed, design.radar.grazing_angle
    lowest = max(usual_range("radar.slant_range")[0], design.flight.altitude - design.trajectory.ground)
    for step, part in enumerate(_SHORTER):
        if part * distance >= lowest:
            name = f"Slant range {100 - 100 * part:.0f} % shorter"
            yield Lever(name, "flight", "range", step, {"radar.slant_range": part * distance})
    for step, factor in enumerate(_FASTER):
        if factor * speed <= usual_range("flight.speed")[1]:
            name = f"Speed {100 * factor - 100:.0f} % higher"
            yield Lever(name, "flight", "speed", step, {"flight.speed": factor * speed})
    low, high = usual_range("radar.grazing_angle")
    for step, angle in enumerate(_ANGLES):
        for name, to in (("flatter", grazing - angle), ("steeper", grazing + angle)):
            if low <= to <= high:
                changes = {"radar.grazing_angle": to}
                yield Lever(f"Look {math.degrees(angle):.0f}° {name}", "flight", name, step, changes)


def _radar(design: Design) -> Iterator[Lever]:
    """A coarser image; a design that gives its aperture has a shorter one."""
    given = design.radar.aperture_time
    for step, factor in enumerate(_COARSER):
        changes: dict[str, Value] = (
            {"radar.azimuth_resolution": factor * design.radar.azimuth_resolution}
            if given is None
            else {"radar.aperture_time": given / factor}
        )
        yield Lever(f"Resolution {factor:g} × coarser", "radar", "resolution", step, changes)

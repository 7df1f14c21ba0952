"""The inputs of a design, section by section: bounds, units, defaults, help. A table of declarations.

What must be positive has a lowest value, far below any hardware, above which no equation leaves the range of
floats.
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

import param

from nav_model.inputs import Alternative, BaseQuantity, Choice, OptionalQuantity, Quantity

SPEED_OF_LIGHT = 299792458.0  # m/s, exact by definition of the metre
_DEGREE = math.pi / 180
_ARW = _DEGREE / 60  # 1 °/√h in rad/√s
_VRW = 1 / 60  # 1 m/s/√h in m/s/√s
_MG = 9.80665e-3
_DPH = _DEGREE / 3600


class Part(param.Parameterized):
    """One section of a design file."""

    section: ClassVar[str] = ""
    title: ClassVar[str] = ""

    @classmethod
    def inputs(cls) -> dict[str, BaseQuantity[Any] | Choice]:
        """Name -> declaration of every input of this part, in the order of declaration."""
        return {
            name: declaration
            for name, declaration in cls.param.objects("existing").items()
            if isinstance(declaration, BaseQuantity | Choice)
        }


def _preset(kind: str) -> Any:
    return param.String(
        default=None,
        allow_None=True,
        constant=True,
        doc=f"Name of {kind} of the catalogue; its values fill the keys that are not given.",
    )


class Imu(Part):
    """Inertial measurement unit."""

    section = "imu"
    title = "IMU"

    preset = _preset("an inertial measurement unit")
    velocity_random_walk = Quantity(
        default=0.05 * _VRW,
        dimension="velocity random walk",
        unit="m/s/√h",
        short="vrw",
        bounds=(1e-9 * _VRW, 60 * _VRW),
        softbounds=(1e-3 * _VRW, 1.0 * _VRW),
        label="Velocity random walk",
        doc="White noise of the accelerometers, per axis.",
        datasheet='Accelerometer table: "velocity random walk" or "noise density".',
        typical="navigation 0.003, tactical 0.03, MEMS 0.01 to 0.2 m/s/√h",
    )
    angle_random_walk = Quantity(
        default=0.5 * _ARW,
        dimension="angle random walk",
        unit="°/√h",
        short="arw",
        bounds=(1e-9 * _ARW, 360 * _ARW),
        softbounds=(1e-3 * _ARW, 10.0 * _ARW),
        label="Angle random walk",
        doc="White noise of the gyros, per axis.",
        datasheet='Gyro table: "angle random walk" or "rate noise density".',
        typical="navigation 0.002, tactical 0.1, MEMS 0.1 to 0.7 °/√h",
    )
    accelerometer_bias = Quantity(
        default=0.0,
        dimension="acceleration",
        unit="mg",
        short="ba",
        bounds=(0, 1000 * _MG),
        softbounds=(1e-4 * _MG, 100 * _MG),
        label="Residual accelerometer bias",
        doc="1σ of what the filter has not absorbed at the last fix, per axis.",
        datasheet=(
            "Not printed as such: between the in-run bias stability (a pessimist's choice) and zero, "
            "because in level flight the filter lets tilt cancel a constant bias."
        ),
        typical="tactical in-run 0.05, MEMS in-run 0.003 to 0.1 mg",
    )
    gyro_bias = Quantity(
        default=0.0,
        dimension="angular rate",
        unit="°/h",
        short="bg",
        bounds=(0, 1e5 * _DPH),
        softbounds=(1e-4 * _DPH, 1e3 * _DPH),
        label="Residual gyro bias",
        doc="1σ of what the filter has not absorbed at the last fix, per axis.",
        datasheet="Not printed as such: at most the in-run bias stability of the gyro table.",
        typical="navigation 0.003, tactical 0.5, MEMS 1 to 10 °/h",
    )
    vibration_factor = Quantity(
        default=1.0,
        dimension="",
        unit="",
        short="vib",
        bounds=(0.01, 1000.0),
        softbounds=(1.0, 50.0),
        label="Vibration factor",
        doc="Multiplies both random walks: noise in motion over noise on the bench.",
        datasheet="Not on data sheets. From a log taken in the aircraft; 1 is the bench.",
        typical="real drives show errors 8 to 35 times those bench noise predicts",
    )
    rate = Quantity(
        default=100.0,
        dimension="frequency",
        unit="Hz",
        short="fs",
        bounds=(1.0, 1e5),
        softbounds=(10.0, 1e4),
        label="Sample rate",
        doc="Output rate of the unit; used by the simulator, not by the closed forms.",
        datasheet='"Output data rate".',
        typical="100 to 2000 Hz",
    )


class Gnss(Part):
    """Satellite navigation receiver."""

    section = "gnss"
    title = "GNSS"

    position_noise = Quantity(
        default=1.0,
        dimension="length",
        unit="m",
        short="gn",
        bounds=(1e-6, 1e4),
        softbounds=(1e-3, 30.0),
        label="Position noise",
        doc="One fix, per axis, 1σ, independent from fix to fix.",
        datasheet='Receiver table: "position accuracy"; CEP = 1.18 σ, 2DRMS = 2.83 σ.',
        typical="carrier phase 0.02, differential 0.5, code 1.5 to 3 m",
    )
    vertical_position_noise = OptionalQuantity(
        dimension="length",
        unit="m",
        short="gnv",
        bounds=(1e-6, 1e4),
        softbounds=(1e-3, 30.0),
        label="Vertical position noise",
        doc="If it differs from the horizontal one.",
        datasheet="Usually 1.5 to 2 times the horizontal figure.",
        typical="carrier phase 0.03, code 3 to 5 m",
    )
    interval = Quantity(
        default=1.0,
        dimension="time",
        unit="s",
        short="dt",
        bounds=(1e-3, 3600.0),
        softbounds=(0.02, 10.0),
        label="Fix interval",
        doc="Time between fixes.",
        datasheet='"Update rate": 1 Hz is 1 s.',
        typical="0.05 to 1 s",
        alternative=Alternative("rate", "frequency", "Hz", 1.0),
    )
    correlated = Choice(
        default=False,
        options=[False, True],
        short="gm",
        label="Slow error",
        doc="Add a slow GNSS error (first-order Gauss-Markov) by state augmentation; numerical path only. Off for "
        "carrier phase over a short base line, on for stand-alone code.",
    )
    correlated_noise = Quantity(
        default=1.0,
        dimension="length",
        unit="m",
        short="gms",
        bounds=(1e-6, 1e4),
        softbounds=(1e-2, 30.0),
        label="Slow error, 1σ",
        doc="Standard deviation of the slow error, per axis, on top of the noise; used when switched on.",
        datasheet="Absolute accuracy less the noise: orbit, clock, atmosphere, multipath.",
        typical="differential 0.3, stand-alone 1 to 2 m",
    )
    correlation_time = Quantity(
        default=300.0,
        dimension="time",
        unit="s",
        short="gmt",
        bounds=(0.1, 1e5),
        softbounds=(1.0, 1e4),
        label="Correlation time",
        doc="Time constant of the slow error.",
        datasheet="Not on data sheets; seen in a static receiver log.",
        typical="multipath 30 to 100 s in flight, atmosphere 1000 s and more",
    )


class Flight(Part):
    """Flight condition: straight, level, constant velocity."""

    section = "flight"
    title = "Flight"

    speed = Quantity(
        default=100.0,
        dimension="speed",
        unit="m/s",
        short="v",
        bounds=(0.1, 8000.0),
        softbounds=(10.0, 300.0),
        label="Speed",
        doc="Ground speed along the track.",
        datasheet="Not on data sheets: the flight plan.",
        typical="small UAV 30, turboprop 90, jet 220 m/s",
    )
    altitude = Quantity(
        default=3000.0,
        dimension="length",
        unit="km",
        short="h",
        bounds=(-500.0, 1e5),
        softbounds=(0.0, 15e3),
        label="Altitude",
        doc="Height above the ellipsoid; enters the radius of the Schuler and Coriolis terms.",
        datasheet="Not on data sheets: the flight plan.",
        typical="1 to 14 km",
    )
    latitude = Quantity(
        default=45 * _DEGREE,
        dimension="angle",
        unit="°",
        short="lat",
        bounds=(-90 * _DEGREE, 90 * _DEGREE),
        softbounds=(-90 * _DEGREE, 90 * _DEGREE),
        label="Latitude",
        doc="Geodetic latitude; enters the Coriolis coupling of the refined outage.",
        datasheet="Not on data sheets: the flight plan; take the lowest latitude, where the coupling is largest.",
        typical="where the radar will work",
    )
    heading = Quantity(
        default=0.0,
        dimension="angle",
        unit="°",
        short="hdg",
        bounds=(-360 * _DEGREE, 360 * _DEGREE),
        softbounds=(0.0, 360 * _DEGREE),
        label="Heading",
        doc="Track direction, clockwise from north; enters the Coriolis coupling of the refined outage.",
        datasheet="Not on data sheets: the flight plan.",
        typical="0° is north",
    )
    gravity = Quantity(
        default=9.80665,
        dimension="acceleration",
        unit="m/s²",
        short="g",
        bounds=(0.1, 30.0),
        softbounds=(9.7, 9.9),
        label="Gravity",
        doc="Local gravity of the model; unit conversions always use 9.80665 m/s².",
        datasheet="Not on data sheets: a gravity formula at the latitude.",
        typical="9.780 at the equator, 9.832 m/s² at the poles",
    )


class Coast(Part):
    """Flight without fixes."""

    section = "coast"
    title = "Coast"

    duration = Quantity(
        default=100.0,
        dimension="time",
        unit="s",
        short="out",
        bounds=(0.1, 7200.0),
        softbounds=(1.0, 1000.0),
        label="Outage shown",
        doc="How long the outage curves run after the last fix; coast requirements hold at its end.",
        datasheet="Not on data sheets: the mission's requirement.",
        typical="the longest outage the mission must survive",
    )
    before_aperture = Quantity(
        default=0.0,
        dimension="time",
        unit="s",
        short="tc",
        bounds=(0.0, 3600.0),
        softbounds=(0.1, 300.0),
        label="Coast before aperture",
        doc="Time without fixes between the last fix and the start of the aperture.",
        datasheet="Not on data sheets: the mission's requirement, such as jamming near the scene.",
        typical="0 s when fixes last up to the aperture",
    )


class Radar(Part):
    """Synthetic-aperture radar."""

    section = "radar"
    title = "Radar"

    preset = _preset("a radar")
    frequency = Quantity(
        default=9.6e9,
        dimension="frequency",
        unit="GHz",
        short="f",
        bounds=(1e7, 1e12),
        softbounds=(3e8, 4e10),
        label="Frequency",
        doc="Carrier frequency; a file may give the wavelength instead.",
        datasheet='"Centre frequency".',
        typical="L 1.3, C 5.3, X 9.6, Ku 16.7, Ka 35 GHz",
        alternative=Alternative("wavelength", "length", "cm", SPEED_OF_LIGHT),
    )
    slant_range = Quantity(
        default=7000.0,
        dimension="length",
        unit="km",
        short="r",
        bounds=(1.0, 2e6),
        softbounds=(500.0, 50e3),
        label="Slant range",
        doc="To the scene at the middle of the aperture.",
        datasheet='Radar table: "slant range"; else from height and grazing angle.',
        typical="5 to 30 km",
    )
    grazing_angle = Quantity(
        default=35 * _DEGREE,
        dimension="angle",
        unit="°",
        short="gr",
        bounds=(0.0, 90 * _DEGREE),
        softbounds=(0.0, 90 * _DEGREE),
        label="Grazing angle",
        doc="Between the line of sight and the ground; weighs vertical against cross-track errors [S-1].",
        datasheet='Radar table: "grazing angle" or "depression angle"; 90° less the incidence angle.',
        typical="20 to 65°",
    )
    azimuth_resolution = Quantity(
        default=0.5,
        dimension="length",
        unit="m",
        short="rho",
        bounds=(1e-3, 1e3),
        softbounds=(0.05, 10.0),
        label="Azimuth resolution",
        doc="-3 dB width wanted; sets the aperture unless an aperture time is given [S-3].",
        datasheet='Radar table: "azimuth" or "cross-range resolution".',
        typical="0.1 m spotlight to 3 m strip map",
    )
    window = Choice(
        default="uniform",
        options=["uniform", "hamming", "taylor"],
        short="win",
        label="Window",
        doc="Azimuth weighting: uniform, Hamming, or Taylor (-35 dB, n̄ = 5). A setting of the image processor: "
        "uniform is sharpest, Taylor usual, Hamming lowest in side lobes.",
    )
    squint_angle = Quantity(
        default=0.0,
        dimension="angle",
        unit="°",
        short="sq",
        bounds=(-60 * _DEGREE, 60 * _DEGREE),
        softbounds=(-60 * _DEGREE, 60 * _DEGREE),
        label="Squint angle",
        doc="Of the line of sight in the slant plane, forward positive; lengthens the aperture for a resolution.",
        datasheet='Radar table: "squint".',
        typical="0° strip map, up to 45° spotlight",
    )
    aperture_time = OptionalQuantity(
        dimension="time",
        unit="s",
        short="ta",
        bounds=(1e-3, 3600.0),
        softbounds=(0.1, 100.0),
        label="Aperture time",
        doc="Overrides the aperture from range, speed, resolution and window.",
        datasheet='Radar table: "integration time" or "synthetic aperture time".',
        typical="0.5 to 50 s",
    )
    autofocus_order = Choice(
        default=1,
        options=[1, 2, 3],
        short="af",
        label="Autofocus removes",
        doc="Highest polynomial order of phase removed: 1 line only (no autofocus), 2 quadratic, 3 cubic. A setting "
        "of the image processor; map drift removes 2.",
    )


_LEAST_LIMIT = {"angle": 1e-6 * _DEGREE, "length": 1e-6, "speed": 1e-6}


def _limit(
    dimension: str,
    unit: str,
    short: str,
    upper: float,
    soft: tuple[float, float],
    label: str,
    doc: str,
    typical: str,
) -> Any:
    return OptionalQuantity(
        dimension=dimension,
        unit=unit,
        short=short,
        bounds=(_LEAST_LIMIT[dimension], upper),
        softbounds=soft,
        label=label,
        doc=doc,
        datasheet=_GIVEN,
        typical=typical,
    )


_GIVEN = "Not on data sheets: the requirement of the image product or of the mission."
_REACHED = "reached with 1.5 m fixes at 1 Hz: "
_PHASE = (1 * _DEGREE, 360 * _DEGREE)
_POSITION = (1e-3, 1e3)


class Requirements(Part):
    """Limits; one not given is not checked."""

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
        doc="How many sigmas must stay inside a limit.",
        datasheet="Not on data sheets: the requirement's own percentage.",
        typical="1 (68 %), 2 (95 %), 3 (99.7 %)",
    )
    steady_state = Choice(
        default="prior",
        options=["prior", "closed", "posterior"],
        short="ss",
        label="Steady state checked",
        doc="Just before a fix (prior, the worst of the cycle), cycle rms (closed), just after (posterior). The "
        "prior is the safe side.",
    )
    quadratic_phase: Any = _limit(
        "angle", "°", "qpe", 1e6 * _DEGREE, _PHASE, "Quadratic phase",
        "Limit on quadratic phase error at the aperture's ends: 45° strict, 90° usual [S-4].",
        "45° to 90°; below 1 dB of peak loss up to 90°",
    )  # fmt: skip
    detrended_phase: Any = _limit(
        "angle", "°", "dpe", 1e6 * _DEGREE, _PHASE, "Detrended phase",
        "Limit on rms phase over the aperture after autofocus_order is removed.",
        "6° keeps the integrated side lobes of wide-band phase at −20 dB, 20° costs half a decibel of the peak",
    )  # fmt: skip
    horizontal_position: Any = _limit(
        "length",
        "m",
        "rh",
        1e6,
        _POSITION,
        "Horizontal position",
        "Steady state, per axis, 1σ × confidence.",
        f"{_REACHED}navigation 0.2 to 0.4, tactical 0.4 to 0.7, MEMS 0.5 to 0.8 m",
    )
    vertical_position: Any = _limit(
        "length",
        "m",
        "rv",
        1e6,
        _POSITION,
        "Vertical position",
        "Steady state, 1σ × confidence.",
        f"{_REACHED}navigation 0.1 to 0.3, tactical 0.1 to 0.3, MEMS 0.2 to 0.4 m",
    )
    horizontal_velocity: Any = _limit(
        "speed",
        "m/s",
        "rvh",
        1e4,
        (1e-4, 10.0),
        "Horizontal velocity",
        "Steady state, per axis, 1σ × confidence.",
        f"{_REACHED}navigation 0.003 to 0.01, tactical 0.02 to 0.07, MEMS 0.04 to 0.1 m/s",
    )
    vertical_velocity: Any = _limit(
        "speed",
        "m/s",
        "rvv",
        1e4,
        (1e-4, 10.0),
        "Vertical velocity",
        "Steady state, 1σ × confidence.",
        f"{_REACHED}navigation 0.0005 to 0.006, tactical 0.001 to 0.008, MEMS 0.004 to 0.02 m/s",
    )
    tilt: Any = _limit(
        "angle",
        "°",
        "rt",
        math.pi,
        (1e-4 * _DEGREE, 1 * _DEGREE),
        "Tilt",
        "Roll and pitch in steady state, each.",
        f"{_REACHED}navigation 0.0002 to 0.001, tactical 0.004 to 0.03, MEMS 0.01 to 0.05°",
    )
    coast_horizontal_position: Any = _limit(
        "length",
        "m",
        "rch",
        1e7,
        (1e-2, 1e4),
        "Coast horizontal position",
        "At the end of the outage, per axis.",
        f"after 60 s, {_REACHED}navigation 0.4 to 1, tactical 3 to 13, MEMS 7 to 25 m",
    )
    coast_vertical_position: Any = _limit(
        "length",
        "m",
        "rcv",
        1e7,
        (1e-2, 1e4),
        "Coast vertical position",
        "At the end of the outage.",
        f"after 60 s, {_REACHED}navigation 0.1 to 0.6, tactical 0.2 to 0.8, MEMS 0.4 to 2 m",
    )


PARTS: tuple[type[Part], ...] = (Imu, Gnss, Flight, Coast, Radar, Requirements)
"""The sections of a design, in the order of the file."""

INPUTS: dict[str, dict[str, BaseQuantity[Any] | Choice]] = {part.section: part.inputs() for part in PARTS}
"""Section -> name -> declaration."""

PRESET_KEYS = tuple(f"{part.section}.preset" for part in PARTS if "preset" in part.param)
"""Keys that name an entry of the catalogue."""

TOP_KEYS = ("name", "description")
"""Keys above the sections: plain text."""


def declaration_of(key: str) -> BaseQuantity[Any] | Choice:
    """The declaration of the input under a dotted key.

    Raises
    ------
    KeyError
        If there is none.
    """
    section, _, name = key.rpartition(".")
    return INPUTS[section][name]


def all_keys() -> list[str]:
    """Every dotted key of an input, in the order of the file."""
    return [f"{section}.{name}" for section, names in INPUTS.items() for name in names]

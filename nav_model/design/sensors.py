"""Inputs of the inertial unit and of the receiver."""

from typing import Any

from nav_model.base.constants import DEGREE, DEGREE_PER_HOUR, MILLI_G
from nav_model.design.declaration import SWITCH, Alternative, Choice, OptionalQuantity, Quantity
from nav_model.design.part import Part, preset

_ARW = DEGREE / 60  # 1 °/√h in rad/√s
_VRW = 1 / 60  # 1 m/s/√h in m/s/√s


class Imu(Part):
    """Inertial measurement unit."""

    section = "imu"
    title = "IMU"

    preset = preset("an inertial measurement unit")
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
        slider=True,
        source="accelerometer noise",
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
        slider=True,
        source="gyro noise",
    )
    accelerometer_bias = Quantity(
        default=0.0,
        dimension="acceleration",
        unit="mg",
        short="ba",
        bounds=(0, 1000 * MILLI_G),
        softbounds=(1e-4 * MILLI_G, 100 * MILLI_G),
        label="Residual accelerometer bias",
        doc=(
            "1σ of the constant bias, per axis. On a straight line it settles as a tilt of b/g, which cancels it. "
            "Phase, image shift and outage count the full bias, as after a turn of 60°. After smoothing only the "
            "tilt remains."
        ),
        datasheet="Not on data sheets. At most the in-run bias stability, or the residual turn-on bias.",
        typical="tactical in-run 0.05, MEMS in-run 0.003 to 0.1 mg",
        slider=True,
        source="accelerometer bias",
    )
    gyro_bias = Quantity(
        default=0.0,
        dimension="angular rate",
        unit="°/h",
        short="bg",
        bounds=(0, 1e5 * DEGREE_PER_HOUR),
        softbounds=(1e-4 * DEGREE_PER_HOUR, 1e3 * DEGREE_PER_HOUR),
        label="Residual gyro bias",
        doc=(
            "1σ of the constant bias, per axis. It adds nothing in steady state, where fixes reveal it. Phase, "
            "image shift and outage count the full bias, as after a turn of 60°."
        ),
        datasheet="Not on data sheets. At most the in-run bias stability of the gyro table.",
        typical="navigation 0.003, tactical 0.5, MEMS 1 to 10 °/h",
        slider=True,
        source="gyro bias",
    )
    vibration_factor = Quantity(
        default=1.0,
        dimension="",
        unit="",
        short="vib",
        bounds=(0.01, 1000.0),
        softbounds=(1.0, 50.0),
        label="Vibration factor",
        doc="Multiplies both random walks: the ratio of noise in motion to noise on the bench.",
        datasheet="Not on data sheets. Take it from a log recorded in the aircraft; 1 is bench noise.",
        typical="in road tests, errors were 8 to 35 times what bench noise predicts",
        slider=True,
    )
    sheet = Choice(
        default=False,
        options=SWITCH,
        short="ish",
        label="Whole sheet",
        doc="The catalogue's unit fills what its sheet prints beside the random walks, in the two sections below: "
        "bias instability, with an assumed correlation time, and turn-on bias.",
        since="0.2.0",
    )
    rate = Quantity(
        default=100.0,
        dimension="frequency",
        unit="Hz",
        short="fs",
        bounds=(1.0, 1e5),
        softbounds=(10.0, 1e4),
        label="Sample rate",
        doc="Output rate of the unit; used by the simulator, not by the formulas.",
        datasheet='"Output data rate".',
        typical="100 to 2000 Hz",
        variable=False,
    )
    bandwidth = OptionalQuantity(
        dimension="frequency",
        unit="Hz",
        short="bw",
        bounds=(0.1, 1e6),
        softbounds=(10.0, 1000.0),
        label="IMU bandwidth",
        doc="-3 dB bandwidth of the unit's own low pass. Vibration beyond it is not compensated, the accelerometers "
        "being of first order [P-8]; a log at rest is fitted well below it.",
        datasheet='"Bandwidth" or "-3 dB bandwidth"; the lower of gyros and accelerometers.',
        typical="50 to 500 Hz",
        when_empty="no limit",
        since="0.1.0",
    )


def _lever(short: str, way: str, label: str) -> Any:
    return Quantity(
        default=0.0,
        dimension="length",
        unit="m",
        short=short,
        bounds=(-200.0, 200.0),
        softbounds=(-5.0, 5.0),
        label=f"Antenna {label}",
        doc=f"Antenna relative to the IMU, {way} in body axes; the filter knows it. Used along flights and in runs.",
        datasheet="Measured at installation.",
        typical="0 to 3 m",
        variable=False,
        since="0.2.0",
    )


class Gnss(Part):
    """Satellite navigation receiver."""

    section = "gnss"
    title = "GNSS"

    preset = preset("a receiver class")
    position_noise = Quantity(
        default=1.0,
        dimension="length",
        unit="m",
        short="gn",
        bounds=(1e-6, 1e4),
        softbounds=(1e-3, 30.0),
        label="Position noise",
        doc="1σ of one position fix, per axis, independent from fix to fix.",
        datasheet='Receiver table: "position accuracy"; CEP = 1.18 σ, 2DRMS = 2.83 σ.',
        typical="carrier phase 0.02, differential 0.5, code 1.5 to 3 m",
        slider=True,
        source="GNSS noise",
    )
    vertical_position_noise = OptionalQuantity(
        dimension="length",
        unit="m",
        short="gnv",
        bounds=(1e-6, 1e4),
        softbounds=(1e-3, 30.0),
        label="Vertical position noise",
        doc="1σ of one position fix, vertical, if it differs from the horizontal noise.",
        datasheet="Usually 1.5 to 2 times the horizontal figure.",
        typical="carrier phase 0.03, code 3 to 5 m",
        when_empty="as horizontal",
        instead="position_noise",
        source="GNSS noise",
    )
    baseline = OptionalQuantity(
        dimension="length",
        unit="km",
        short="gbl",
        bounds=(0.0, 1e6),
        softbounds=(100.0, 1e5),
        label="Baseline",
        doc='Distance from the base station, for noise that grows with it: "1 cm + 1 ppm".',
        datasheet="From the flight plan: distance to the base station.",
        typical="1 to 30 km",
        when_empty="not used",
        slider=True,
        variable=False,
        since="0.1.0",
    )
    interval = Quantity(
        default=1.0,
        dimension="interval",
        unit="s",
        short="dt",
        bounds=(1e-3, 3600.0),
        softbounds=(0.02, 10.0),
        label="Fix interval",
        doc="Time between fixes.",
        datasheet='"Update rate": 1 Hz is 1 s.',
        typical="0.05 to 1 s",
        alternative=Alternative("rate", "frequency", "Hz", 1.0),
        slider=True,
    )
    velocity_noise = OptionalQuantity(
        dimension="speed",
        unit="m/s",
        short="gvn",
        bounds=(1e-5, 100.0),
        softbounds=(1e-3, 1.0),
        label="Velocity noise",
        doc="1σ of one velocity fix, per axis, independent from fix to fix. Leave empty to use position only.",
        datasheet='Receiver table: "velocity accuracy".',
        typical="Doppler 0.03 to 0.1, carrier phase 0.01 m/s",
        when_empty="no velocity",
        slider=True,
        since="0.1.0",
        source="GNSS velocity noise",
    )
    vertical_velocity_noise = OptionalQuantity(
        dimension="speed",
        unit="m/s",
        short="gvv",
        bounds=(1e-5, 100.0),
        softbounds=(1e-3, 1.0),
        label="Vertical velocity noise",
        doc="1σ of one velocity fix, vertical, if it differs from the horizontal noise.",
        datasheet="Usually 1.5 to 2 times the horizontal figure.",
        typical="0.02 to 0.2 m/s",
        when_empty="as horizontal",
        since="0.1.0",
        instead="velocity_noise",
        source="GNSS velocity noise",
        needs=("velocity_noise",),
    )
    velocity_interval = OptionalQuantity(
        dimension="time",
        unit="s",
        short="gvt",
        bounds=(1e-3, 3600.0),
        softbounds=(0.02, 10.0),
        label="Velocity interval",
        doc=(
            "Time between velocity fixes, if it differs from the fix interval. Real-time figures use velocity at "
            "each position fix, with its noise scaled to the same density."
        ),
        datasheet='"Velocity update rate": 10 Hz is 0.1 s.',
        typical="as the fix interval",
        when_empty="with each fix",
        since="0.1.0",
        instead="interval",
        needs=("velocity_noise",),
    )
    correlated = Choice(
        default=False,
        options=SWITCH,
        short="gm",
        label="Slow error",
        doc="Adds a slow GNSS error (first-order Gauss-Markov); the steady state is then solved numerically. Off for "
        "carrier phase over a short baseline, on for stand-alone code.",
    )
    correlated_noise = Quantity(
        default=1.0,
        dimension="length",
        unit="m",
        short="gms",
        bounds=(1e-6, 1e4),
        softbounds=(1e-2, 30.0),
        label="Slow error, 1σ",
        doc="Standard deviation of the slow error of a horizontal axis, beside the noise; used when switched on.",
        datasheet="Absolute accuracy less the noise: orbit, clock, atmosphere, multipath.",
        typical="differential 0.3, stand-alone 1 to 2 m",
        source="slow GNSS error",
        needs=("correlated",),
    )
    vertical_correlated_noise = OptionalQuantity(
        dimension="length",
        unit="m",
        short="gmv",
        bounds=(1e-6, 1e4),
        softbounds=(1e-2, 30.0),
        label="Vertical slow error, 1σ",
        doc="Standard deviation of the slow error of heights. Leave empty for the slow error times vertical over "
        "horizontal position noise.",
        datasheet="Absolute vertical accuracy less the noise; usually 1.5 to 2 times the horizontal one.",
        typical="carrier phase 0.025, differential 0.5, stand-alone 1.5 to 3 m",
        when_empty="by noise ratio",
        slider=True,
        since="0.2.0",
        instead="correlated_noise",
        in_ratio=("vertical_position_noise", "position_noise"),
        source="slow GNSS error",
        needs=("correlated",),
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
        datasheet="Not on data sheets. Estimate it from a static receiver log.",
        typical="multipath 30 to 100 s in flight, atmosphere 1000 s and more",
        needs=("correlated",),
    )
    lever_forward = _lever("glf", "positive forward", "forward")
    lever_right = _lever("glr", "positive to the right", "to the right")
    lever_down = _lever("gld", "positive down", "below")

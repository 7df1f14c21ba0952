"""Inputs of fast motion: vibration, motion that the IMU does not sense, and the radar's oscillator."""

from fractions import Fraction

from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.design.declaration import SWITCH, Choice, OptionalQuantity, Quantity
from nav_model.design.part import Part
from nav_model.design.rows import Rows

_MICRO_PER_G = float(Fraction(1, 10**6) / Fraction(str(STANDARD_GRAVITY)))  # 1 µg/g² in s²/m


class Motion(Part):
    """Motion of the antenna along the line of sight, as lines and as spectra."""

    section = "motion"
    title = "Vibration"

    lines = Rows(
        dimensions=("acceleration", "length"),
        short="vl",
        curve=False,
        example="20 Hz 0.1 g; 80 Hz 0.02 g",
        label="Vibration lines",
        doc="Frequency and peak amplitude along the line of sight, in g or mm, of vibration that moves antenna and "
        "IMU alike: rotor, propeller, engine [P-8].",
        since="0.1.0",
    )
    spectrum = Rows(
        dimensions=("acceleration density",),
        short="vd",
        curve=True,
        example="10 Hz 0.001 g²/Hz; 40 Hz 0.01 g²/Hz; 2 kHz 0.001 g²/Hz",
        label="Vibration spectrum",
        doc="The same motion as a one-sided density, straight lines between points on logarithmic axes, as in "
        "environmental test standards; zero outside the table [P-8].",
        since="0.1.0",
    )
    delay = Quantity(
        default=0.0,
        dimension="time",
        unit="ms",
        short="dly",
        bounds=(0.0, 100.0),
        softbounds=(1e-5, 0.1),
        label="Delay to the radar",
        doc="Age of the IMU's data when the radar uses them: filters, transport, time stamps [P-8].",
        datasheet='IMU: "group delay" or "latency"; the rest is the integrator\'s.',
        typical="0.1 to 10 ms",
        since="0.1.0",
        needs=("lines", "spectrum"),
    )
    unsensed_lines = Rows(
        dimensions=("length", "acceleration"),
        short="ul",
        curve=False,
        example="12 Hz 0.05 mm; 30 Hz 0.1 g",
        label="Unsensed lines",
        doc="Frequency and peak amplitude along the line of sight of motion between IMU and antenna, which nothing "
        "compensates: flexure, mount.",
        since="0.1.0",
    )
    unsensed_spectrum = Rows(
        dimensions=("length density", "acceleration density"),
        short="ud",
        curve=True,
        example="1 Hz 0.001 mm²/Hz; 100 Hz 1e-7 mm²/Hz",
        label="Unsensed spectrum",
        doc="The same motion as a one-sided density of displacement or acceleration.",
        since="0.1.0",
    )
    rectification = Quantity(
        default=0.0,
        dimension="vibration rectification",
        unit="µg/g²",
        short="vre",
        bounds=(0.0, 1e6 * _MICRO_PER_G),
        softbounds=(1.0 * _MICRO_PER_G, 1e4 * _MICRO_PER_G),
        label="Vibration rectification",
        doc="Accelerometer bias caused by vibration, per square of its rms, lines and spectrum together [P-12].",
        datasheet='Accelerometer table: "vibration rectification error", "VRE" or "VRC".',
        typical="quartz 10 to 50, MEMS 50 to 1000 µg/g²",
        since="0.1.0",
        source="vibration rectification",
        needs=("lines", "spectrum"),
    )


class Oscillator(Part):
    """The radar's reference oscillator."""

    section = "oscillator"
    title = "Oscillator"

    phase_noise = Rows(
        dimensions=("phase noise",),
        short="lf",
        curve=True,
        example="1 Hz -80 dBc/Hz; 10 Hz -110 dBc/Hz; 1 kHz -140 dBc/Hz",
        label="Phase noise",
        doc="Single-sideband L(f), straight lines between points over the logarithm of frequency; zero outside the "
        "table. Start it below one cycle per aperture [P-10].",
        since="0.1.0",
    )
    frequency = OptionalQuantity(
        dimension="frequency",
        unit="MHz",
        short="of",
        bounds=(1e3, 1e12),
        softbounds=(1e7, 1e9),
        label="Oscillator frequency",
        doc="Frequency at which the phase noise is specified; it is scaled up to the carrier. Empty: at the carrier.",
        datasheet='Oscillator: "nominal frequency".',
        typical="10 or 100 MHz",
        when_empty="at the carrier",
        since="0.1.0",
        needs=("phase_noise",),
    )
    bistatic = Choice(
        default=False,
        options=SWITCH,
        short="bi",
        label="Bistatic",
        doc="Transmitter and receiver use separate oscillators, so slow phase noise does not cancel over the echo "
        "delay. The table is the noise of their difference, 3 dB above one of two equal oscillators [P-10].",
        since="0.1.0",
    )

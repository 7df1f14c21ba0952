"""The vendor's table, out and in."""

import math

import numpy as np
import pytest
import scipy.linalg

from nav_model.base.constants import DEGREE, DEGREE_PER_HOUR, MILLI_G, STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.file import parse_design
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.explore import vendor_table as module
from nav_model.explore.vendor_table import COLUMNS, VendorRow, invert, read_row, vendor_table, with_unit

_UNITS = {"horizontal": "m", "vertical": "m", "velocity": "m/s", "roll and pitch": "°", "heading": "°"}
_WALKS = ("imu.angle_random_walk", "imu.velocity_random_walk")
_INPUTS = (*_WALKS, "imu.gyro_bias", "imu.accelerometer_bias")
_RECEIVERS = (
    {"gnss.position_noise": 1.0},
    {"gnss.position_noise": 0.02, "gnss.vertical_position_noise": 0.03, "gnss.interval": 0.2},
    {"gnss.position_noise": 0.5, "gnss.velocity_noise": 0.03},
)


def printed(row: VendorRow, digits: int = 4, factors: dict[str, float] | None = None) -> str:
    """A row of the table as a data sheet prints it, some entries times a factor."""
    entries = []
    for name, value in row.values.items():
        if value:
            value *= (factors or {}).get(name, 1.0)
            number = math.degrees(value) if _UNITS[name] == "°" else value
            entries.append(f"{name} {number:.{digits - 1 - math.floor(math.log10(number))}f} {_UNITS[name]}")
    return f"{row.outage:g} s: {', '.join(entries)}" if row.outage else f"no outage: {', '.join(entries)}"


def random_unit(rng: np.random.Generator) -> Design:
    """A unit from navigation to consumer grade, with residual biases of its grade, and one of three receivers."""
    grade = rng.uniform(-3, 0)

    def near(value: float) -> float:
        return float(value * 10 ** (grade + rng.uniform(-0.5, 0.5)))

    return Design().replace(
        {
            "imu.angle_random_walk": near(0.7 * DEGREE / 60),
            "imu.velocity_random_walk": near(0.2 / 60),
            "imu.gyro_bias": near(10 * DEGREE_PER_HOUR),
            "imu.accelerometer_bias": near(1 * MILLI_G),
            **_RECEIVERS[rng.integers(3)],
        }
    )


def real_time(design: Design) -> list[VendorRow]:
    return [row for row in vendor_table(design) if row.processing == REAL_TIME]


def test_rows_are_the_figures_of_the_budget() -> None:
    design = random_unit(np.random.default_rng(3))
    budget = analyse(design)
    for row in vendor_table(design):
        for name, column in COLUMNS.items():
            if row.outage == 0 and column.settled:
                assert row.values[name] == pytest.approx(budget[column.settled, row.processing].sigma, rel=1e-9)
            elif row.processing == REAL_TIME and row.outage:
                sigma = budget.composed(column.outage, REAL_TIME, at=row.outage).sigma
                assert row.values[name] == pytest.approx(sigma, rel=1e-9)
    # A smoother that fixes both ends of the outage is better than the free INS at its end.
    free, bridged = (
        next(row for row in vendor_table(design) if (row.processing, row.outage) == (mode, 60.0))
        for mode in (REAL_TIME, POST_PROCESSED)
    )
    assert bridged.values["horizontal"] < free.values["horizontal"] / 3
    assert bridged.values["heading"] is None


def test_outage_of_white_noise_grows_as_its_closed_form() -> None:
    """With perfect fixes: sigma_a² t³/3 + g² sigma_w² t⁵/20 and sigma_w² t, by hand."""
    design = Design().replace({"gnss.position_noise": 1e-6, "gnss.interval": 1e-3, "flight.speed": 1.0})
    a, w, t = design.imu.velocity_random_walk, design.imu.angle_random_walk, 60.0
    row = next(row for row in real_time(design) if row.outage == t)
    by_hand = math.sqrt(a**2 * t**3 / 3 + (9.80665 * w) ** 2 * t**5 / 20)
    assert row.values["horizontal"] == pytest.approx(by_hand, rel=0.04)  # the tilt at the last fix adds 3 %
    assert row.values["heading"] == pytest.approx(w * math.sqrt(t), rel=1e-6)


@pytest.mark.parametrize(
    "count", [pytest.param(20, marks=pytest.mark.long), pytest.param(100, marks=pytest.mark.slow)]
)
def test_table_gives_back_the_noise_that_made_it(count: int) -> None:
    rng = np.random.default_rng(42)
    for _ in range(count):
        design = random_unit(rng)
        inversion = invert(design.replace(dict.fromkeys(_WALKS, 0.0001)), map(printed, real_time(design)))
        assert inversion.agree
        for item in inversion.implied:
            assert item.value == pytest.approx(design[item.key], rel=0.05), (item, design)


def filtered_rows(design: Design) -> list[VendorRow]:
    """Rows in real time by a filter of its own: settled, just before a fix, and after 10 s and 60 s without fixes."""
    imu, gnss, g = design.imu, design.gnss, STANDARD_GRAVITY
    rate = g * imu.angle_random_walk
    bias, drift = imu.accelerometer_bias, imu.gyro_bias
    # Position, velocity, tilt as an acceleration, slow error of the fixes; height has no tilt but gravity's gradient.
    level = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 0], [0, 0, 0, -1 / gnss.correlation_time]])
    upright = level.copy()
    upright[1, 2], upright[1, 0] = 0.0, 2 * g / 6.371e6
    noise = np.diag([0, imu.velocity_random_walk**2, rate**2, 2 * gnss.correlated_noise**2 / gnss.correlation_time])
    kept = {}
    for name, matrix, states in (("level", level, [0, 1, 2, 3]), ("upright", upright, [0, 1, 3])):
        f, q = matrix[np.ix_(states, states)], noise[np.ix_(states, states)]
        h = np.zeros((1, len(states)))
        h[0, [0, -1]] = 1.0

        def over(time: float, f: np.ndarray = f, q: np.ndarray = q) -> tuple[np.ndarray, np.ndarray]:
            """Transition and process noise, by the exponential of Van Loan."""
            n = len(f)
            whole = scipy.linalg.expm(np.block([[-f, q], [np.zeros((n, n)), f.T]]) * time)
            phi = whole[n:, n:].T
            return phi, phi @ whole[:n, n:]

        phi, q_step = over(gnss.interval)
        r = np.array([[gnss.position_noise**2]])
        prior = scipy.linalg.solve_discrete_are(phi.T, h.T, q_step, r)
        gain = prior @ h.T / (h @ prior @ h.T + r)
        rest = np.eye(len(f)) - gain @ h
        posterior = rest @ prior @ rest.T + gain @ r @ gain.T
        kept[name] = [np.diag(prior)] + [
            np.diag(transition @ posterior @ transition.T + added) for transition, added in map(over, (10.0, 60.0))
        ]
    rows = []
    for place, t in enumerate((0.0, 10.0, 60.0)):
        across, up = kept["level"][place], kept["upright"][place]
        variances = {
            "horizontal": across[0] + (bias * t**2 / 2) ** 2 + (g * drift * t**3 / 6) ** 2,
            "vertical": up[0] + (bias * t**2 / 2) ** 2,
            "velocity": across[1] + (bias * t) ** 2 + (g * drift * t**2 / 2) ** 2,
            "roll and pitch": (across[2] + bias**2) / g**2 + (drift * t) ** 2,
            "heading": imu.angle_random_walk**2 * t + (drift * t) ** 2,
        }
        rows.append(VendorRow(REAL_TIME, t, {name: math.sqrt(variance) for name, variance in variances.items()}))
    return rows


@pytest.mark.parametrize("digits", [3, 4])
@pytest.mark.parametrize(
    "count", [pytest.param(4, marks=pytest.mark.long), pytest.param(100, marks=pytest.mark.slow)]
)
def test_table_of_another_filter_is_not_said_to_contradict(count: int, digits: int) -> None:
    """Fixes each 1 to 5 s with slow errors: 22 of 100 such tables were."""
    rng = np.random.default_rng(11)
    for _ in range(count):
        design = random_unit(rng).replace(
            {
                "gnss.vertical_position_noise": None,
                "gnss.velocity_noise": None,
                "gnss.interval": float(rng.choice([1.0, 2.0, 5.0])),
                "gnss.correlated": True,
                "gnss.correlated_noise": float(10 ** rng.uniform(-2, 0.5)),
                "gnss.correlation_time": float(rng.choice([60.0, 200.0, 600.0])),
                "requirements.steady_state": "prior",
            }
        )
        inversion = invert(
            design.replace(dict.fromkeys(_WALKS, 0.0001)), [printed(row, digits) for row in filtered_rows(design)]
        )
        assert inversion.agree, inversion.contradictions
        for item in inversion.implied:
            if item.value is not None and item.factor is not None:
                assert abs(math.log(item.value / design[item.key])) < math.log(item.factor), (item, design)
            else:
                assert item.at_most is None or item.at_most > 0.99 * design[item.key]


def test_an_input_that_the_rows_leave_open_has_the_largest_value_that_fits() -> None:
    """Two digits of a heading bound what a gyro alone may have, by hand; nothing tells its accelerometers."""
    heading = 0.02 * DEGREE * math.exp(0.1)  # half of the digit is 25 %, of which 10 % count
    gyro, accelerometer = {}, {}
    for item in invert(Design(), ["60 s: heading 0.02°"]).implied:
        assert (item.value, item.factor) == (None, None)
        (gyro if item.at_most else accelerometer)[item.key] = item.at_most
    expected = {"imu.angle_random_walk": heading / math.sqrt(60), "imu.gyro_bias": heading / 60}
    assert gyro == pytest.approx(expected, rel=2e-3)
    assert set(accelerometer) == {"imu.velocity_random_walk", "imu.accelerometer_bias"}


@pytest.mark.long
def test_what_an_open_input_may_be_holds_the_unit_that_made_the_rows() -> None:
    """One row leaves much open: no value below the true one, none that alone makes more than a row has."""
    rng, opened = np.random.default_rng(8), 0
    for _ in range(6):
        design = random_unit(rng)
        text = printed(real_time(design)[2])
        entries = read_row(text)
        for item in invert(design, [text]).implied:
            if item.value is None and item.at_most is not None:
                opened += 1
                assert item.at_most > 0.995 * design[item.key], item
                quiet = dict.fromkeys(_INPUTS, 1e-9) | {item.key: 0.98 * item.at_most}
                row = real_time(design.replace(quiet))[2]
                assert all((row.values[e.column] or 0) < e.value * (1 + e.rounding) for e in entries), item
    assert opened >= 6


@pytest.mark.slow
def test_contradictions_are_found() -> None:
    """One entry of a table that some unit has is made two to ten times larger or smaller."""
    rng = np.random.default_rng(7)
    for _ in range(50):
        design = random_unit(rng)
        rows = real_time(design)
        wrong = int(rng.integers(3))
        # The heading before an outage is unknown, so only rows with several headings can contradict in it.
        name = str(rng.choice(["horizontal", "vertical", "velocity", "roll and pitch"]))
        factor = float(rng.uniform(2, 10) ** rng.choice([-1, 1]))
        texts = [printed(row, factors={name: factor} if i == wrong else {}) for i, row in enumerate(rows)]
        inversion = invert(design, texts)
        assert not inversion.agree
        places = [(clash.entry.outage, clash.entry.column) for clash in inversion.contradictions]
        assert (rows[wrong].outage, name) in places
        clash = inversion.contradictions[places.index((rows[wrong].outage, name))]
        assert clash.factor == pytest.approx(factor, rel=0.35)  # the others leave it open a little


def test_a_wrong_entry_of_a_long_table_is_found_by_few_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of fifty entries is three times too large; then nearly every one is wrong."""
    design = random_unit(np.random.default_rng(11))
    budget, outages = analyse(design), np.linspace(10, 100, 10)
    rows = [
        VendorRow(REAL_TIME, float(outage), {
            name: budget.composed(column.outage, REAL_TIME, at=float(outage)).sigma
            for name, column in COLUMNS.items()
        })
        for outage in outages
    ]  # fmt: skip
    evaluations, evaluate = [], module._Fit.model

    def counted(fit: module._Fit, point: np.ndarray) -> np.ndarray:
        evaluations.append(point)
        return evaluate(fit, point)

    monkeypatch.setattr(module._Fit, "model", counted)
    inversion = invert(design, (printed(row, factors={"velocity": 3.0} if row is rows[6] else {}) for row in rows))
    assert [(clash.entry.outage, clash.entry.column) for clash in inversion.contradictions] == [(70.0, "velocity")]
    assert inversion.contradictions[0].factor == pytest.approx(3.0, rel=0.02)
    rng = np.random.default_rng(5)
    texts = [printed(row, factors={name: rng.uniform(0.2, 5) for name in COLUMNS}) for row in rows]
    assert invert(design, texts).several
    assert len(evaluations) < 1000  # 50 entries left out in turn take more than twice as many


def test_bare_bones_of_a_row() -> None:
    text = "60 s: horizontal 0.10 m, vertical 0.07 m, velocity 0.015 m/s, roll and pitch 0.005°, heading 0.010°"
    entries = read_row(text)
    assert [(entry.outage, entry.column) for entry in entries] == [(60.0, name) for name in COLUMNS]
    assert [entry.value for entry in entries] == pytest.approx([0.1, 0.07, 0.015, 0.005 * DEGREE, 0.01 * DEGREE])
    assert [entry.rounding for entry in entries] == pytest.approx([0.05, 0.5 / 7, 0.5 / 15, 0.1, 0.05])
    assert read_row("60 s horizontal 0.10 m, vertical 0.07 m") == entries[:2]
    (cep,) = read_row("no outage: horizontal position 0.1 m CEP")
    assert cep.value == pytest.approx(0.1 / math.sqrt(2 * math.log(2)), rel=1e-6)
    assert cep.outage == 0


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (["horizontal 1 m"], "could not be read"),
        (["60 s 3.0 m 0.6 m 0.08 m/s 0.015 0.08"], "could not be read. Name each value"),
        (["60 s: depth 1 m"], "'depth 1 m' is none of horizontal"),
        (["60 s: horizontal 1 kg"], "length"),
        (["60 m: horizontal 1 m"], "'60 m' is not the time of an outage. Write 60 s or no outage"),
        (["PPK 60 s: horizontal 1 m"], "'PPK 60 s' is not the time of an outage"),
        (["60 s: vertical velocity 1 m/s"], "'vertical velocity 1 m/s' is none of .* Leave other columns out"),
        (["1e9 s: horizontal 1 m"], "is not allowed"),
        (["60 s: horizontal 1 m", "60 s: horizontal 2 m"], "twice"),
        ([], "from one to 10 rows"),
        (["60 s: horizontal 1 m"] * 11, "from one to 10 rows"),
        (["60 s:" + " horizontal 1 m," * 100], "could not be read"),
    ],
)
def test_bad_rows_are_refused(rows: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        invert(Design(), rows)


def test_rows_as_a_manual_prints_them() -> None:
    """SBG Apogee hardware manual 1.5, 2.3.3, RTK: a car with an odometer, which no free INS is after 60 s."""
    rows = [
        "No outage: horizontal position 0.01 m + 1 ppm, vertical position 0.02 m + 1 ppm, roll/pitch 0.008°",
        "10 s: horizontal 5 cm, vertical 5 cm, horizontal velocity 0.02 m/s, roll & pitch 8e-3°, true heading 0.03°",
        "after 60 s: horizontal 0.5 m, vertical 0.3 m, velocity 0.02 m/s, tilt 0.012°, yaw 0.06°",
    ]
    with pytest.raises(InputError, match=r"grows with the baseline\. Give gnss\.baseline"):
        invert(Design(), rows)
    design = parse_design('[gnss]\npreset = "RTK"\nbaseline = "1 km"')
    inversion = invert(design, rows)
    assert [entry.outage for entry in inversion.entries] == 3 * [0.0] + 5 * [10.0] + 5 * [60.0]
    assert inversion.entries[0].value == pytest.approx(0.011)
    assert inversion.several
    worst = min(inversion.contradictions, key=lambda item: item.factor)
    assert (worst.entry.outage, worst.entry.column) == (60.0, "horizontal")
    one_wrong = invert(design, ["10 s: horizontal 0.05 m, velocity 0.9 m/s, heading 0.03°"])
    assert (one_wrong.agree, one_wrong.several) == (False, False)


def test_answer_enters_the_design_with_its_origin() -> None:
    design = random_unit(np.random.default_rng(5))
    inversion = invert(
        Design().replace({"gnss.position_noise": design.gnss.position_noise}), map(printed, real_time(design))
    )
    new = design.replace(*inversion.changes(design))
    for item in inversion.implied:
        taken = new.origins.get(item.key, "").startswith("implied by the vendor's table:")
        assert taken is (item.value is not None)
        assert taken or new[item.key] == design[item.key]
    assert inversion.determined
    assert new.imu.angle_random_walk == pytest.approx(inversion.implied[0].value, rel=0.01)


def test_units_of_the_catalogue() -> None:
    design = Design().replace({"imu.gyro_bias": 1e-6})
    unit = with_unit(design, "ADIS16495-1")
    assert (unit.imu.preset, unit.imu.gyro_bias) == ("ADIS16495-1", 1e-6)
    assert vendor_table(unit) != vendor_table(design)
    with pytest.raises(InputError, match="is not in the catalogue"):
        with_unit(design, "XYZ-1")

"""One reader of trajectory files, for the simulator and for the suborbital study."""

import io

import numpy as np
import pytest
from flight_files import trajectory_table

from nav_model.base.errors import InputError
from nav_model.earth.sphere import ned_to_inertial
from nav_model.earth.trajectory_file import COLUMNS, FileBounds, read_trajectory_table
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.suborbital.flight_file import parse_flight
from nav_model.trajectory.files.reader import parse_file

BOUNDS = FileBounds(fewest_rows=2, most_rows=20, most_bytes=10_000, largest={"pitch_deg": 80.0})
HEADER = ",".join(COLUMNS)
ROWS = [f"{k + 5},{45 + 1e-5 * k},{10 + 2e-5 * k},{1000 + k},1,2,{30 + 0.1 * k}" for k in range(12)]
TEXT = "\n".join([HEADER, *ROWS])


def samples(text: str) -> np.ndarray:
    return read_trajectory_table(text.encode(), "flown.csv", BOUNDS)[0]


def test_a_table_is_what_numpy_reads():
    plain = np.loadtxt(io.StringIO("\n".join(ROWS)), delimiter=",")
    plain[:, 0] -= 5
    np.testing.assert_allclose(np.degrees(samples(TEXT)[:, [1, 2, 4, 5, 6]]), plain[:, [1, 2, 4, 5, 6]], rtol=1e-15)
    np.testing.assert_array_equal(samples(TEXT)[:, [0, 3]], plain[:, [0, 3]])


def test_the_first_line_may_be_written_in_many_ways():
    header = ",".join(reversed(COLUMNS)).upper()
    rows = [",".join([*reversed(row.split(",")), '"text, of any kind"']) for row in ROWS]
    text = "\ufeff# " + header + ", Remark\r\n" + "\r\n".join([rows[0], "", "# a comment", *rows[1:]])
    np.testing.assert_array_equal(samples(text), samples(TEXT))


def test_what_is_written_is_read_again():
    again, lines = read_trajectory_table(trajectory_table(samples(TEXT)), "flown.csv", BOUNDS)
    np.testing.assert_allclose(again, samples(TEXT), atol=1e-11)
    assert lines == list(range(2, 14))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        (TEXT.replace("roll_deg", "bank"), "column roll_deg is missing; found time_s"),
        (TEXT.replace(",1,2,", ",one,2,"), "line 2, column 5: 'one' is not a number"),
        (TEXT.replace(ROWS[3], "8,45,,1,1,1,1"), "line 5: longitude_deg = nan: must be a finite number"),
        (TEXT.replace(ROWS[3], "8,45"), "line 5: 2 columns, 7 in the lines before"),
        (TEXT.replace("30.2", "inf"), "line 4, column 7: 'inf' is not finite"),
        (TEXT.replace(",1,2,30.4", ",1,81,30.4"), "line 6: pitch_deg = 81: must be between -80 and 80"),
        (TEXT.replace("\n9,", "\n8,"), "line 6: time_s = 8.0 must be later than 8.0"),
        ("\n".join([HEADER, ROWS[0]]), "1 rows; at least 2"),
        ("\n".join([HEADER, *ROWS, *ROWS]), "The file has more than 20 rows"),
        (TEXT + "\n# " + 10_000 * "x", "larger than"),
        (TEXT + '\n"' + "\0", "The file is not text."),
    ],
)
def test_a_file_is_refused_by_name_and_line(text, message):
    with pytest.raises(InputError) as caught:
        samples(text)
    assert caught.value.key == "flown.csv"
    assert caught.value.reason.startswith(message)


def test_bytes_that_are_no_text_are_refused():
    with pytest.raises(InputError, match="is not text"):
        read_trajectory_table(b"tim\xff\x01", "flown.csv", BOUNDS)


def test_the_simulator_and_the_suborbital_study_fly_the_same_file():
    content = TEXT.encode()
    flown = plan_trajectory(parse_file(content, "flown.csv").flight.trajectory, 11.0).evaluate(np.arange(12.0))
    flight = parse_flight(content, "flown.csv")
    np.testing.assert_allclose(flight.latitude_rad[::10], flown[:, 0], atol=1e-9)
    np.testing.assert_allclose(flight.longitude_rad[::10], flown[:, 1], atol=1e-9)
    np.testing.assert_allclose(flight.height_m[::10], flown[:, 2], atol=1e-2)
    down = -flight.position_i[0] / np.linalg.norm(flight.position_i[0])
    np.testing.assert_allclose(ned_to_inertial(flown[0, 0], flown[0, 1])[:, 2], down, atol=1e-12)

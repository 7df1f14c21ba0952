"""The reader of number tables, against pandas and against files whose numbers are known."""

import io
import math

import numpy as np
import pandas as pd
import pytest

from nav_model.base.errors import InputError
from nav_model.base.text.file_kind import kind_of
from nav_model.base.text.number_table import Columns, open_table, seconds_of


def read(text: str | bytes, places=(0, 1), times=(), rows: int = 10_000, most_bytes: int = 10**7) -> Columns:
    content = text if isinstance(text, bytes) else text.encode()
    return open_table(content, "table.csv").columns(places, rows, most_bytes, dict.fromkeys(times, seconds_of))


@pytest.mark.parametrize(
    ("delimiter", "decimal"), [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), (" ", "."), (" ", ",")]
)
def test_numbers_are_those_that_pandas_reads(delimiter: str, decimal: str):
    rng = np.random.default_rng(7)
    table = rng.standard_normal((30_000, 4)) * 10.0 ** rng.integers(-9, 12, (30_000, 4))  # in several pieces
    frame = pd.DataFrame(table, columns=["a", "b", "c", "d"])
    if delimiter != " ":  # a blank cannot part an empty field
        frame = frame.mask(rng.random(table.shape) < 0.01)
    text = frame.to_csv(index=False, sep=delimiter, decimal=decimal, lineterminator="\n")
    opened = open_table(text.encode(), "table.csv")
    wanted = pd.read_csv(io.StringIO(text), sep=delimiter, decimal=decimal, usecols=["d", "b"])
    assert opened.headers == (("a", "b", "c", "d"),)
    columns = opened.columns([3, 1], 10**5, 10**8)
    np.testing.assert_array_equal(columns.values, wanted[["d", "b"]].to_numpy())
    np.testing.assert_array_equal(columns.lines, np.arange(2, 30_002))


def test_text_dates_and_nan_in_other_columns_do_no_harm():
    text = "stamp,frame,a,note,b\n" + '2021-11-19 08:36:15.5,imu,1.5,"x, y",NaN\n2021-11-19 08:36:16,imu,2,n/a,-3\n'
    columns = read(text, (2, 4))
    np.testing.assert_array_equal(columns.values, [[1.5, np.nan], [2.0, -3.0]])
    with pytest.raises(InputError, match=r"line 2, column 2: 'imu' is not a number"):
        read(text, (1,))
    stamps = read(text, (0,), times=(0,)).values[:, 0]
    assert stamps.tolist() == [pd.Timestamp(t).timestamp() for t in ("2021-11-19 08:36:15.5", "2021-11-19 08:36:16")]
    assert read("t,a\n23:59:58.250,1\n23:59:59,2\n", times=(0,)).values[:, 0].tolist() == [86398.25, 86399.0]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"])
def test_encodings_of_spreadsheets(encoding: str):
    text = "gyro [°/s];acc [µg]\r\n" + "0,5;1\r\n-1,25;2\r\n" * 40
    opened = open_table(text.encode(encoding), "table.csv")
    assert opened.headers == (("gyro [°/s]", "acc [µg]"),)
    np.testing.assert_array_equal(opened.columns((0, 1), 100, 10**4).values, [[0.5, 1.0], [-1.25, 2.0]] * 40)


def test_lines_are_those_that_an_editor_counts():
    text = "Device;1234\n\n# made today\na;b\n[s];[m]\n1;2\n\n# a pause\n3;4\n"
    opened = open_table(text.encode(), "table.csv")
    assert opened.headers[:2] == (("[s]", "[m]"), ("a", "b"))
    columns = opened.columns((0, 1), 100, 10**4)
    assert columns.values.tolist() == [[1, 2], [3, 4]]
    assert columns.lines.tolist() == [6, 9]


def test_a_recording_that_was_broken_off_loses_its_last_line_alone():
    columns = read("a,b\n1,2\n3,4\n5")
    assert columns.cut
    assert columns.values.tolist() == [[1, 2], [3, 4]]
    assert not read("a,b,\n1,2,\n3,4,\n").cut  # each row ends with a comma


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("a,b\n1,2\n1,2,3\n1,2\n1,2\n", r"line 3: 3 columns, 2 in the lines before"),
        ("a,b\n1,2\n1,x<b>\n", r"line 3, column 2: 'x<b>' is not a number"),
        ("a,b\n1,2\n1,inf\n", r"line 3, column 2: 'inf' is not finite"),
        ("a,b\n1,2\n1,1_0\n", r"line 3, column 2: '1_0' is not a number"),
        ("a;b\n1,5;2\n1.5;2\n", r"line 2: a decimal comma, but line 3 has a decimal point"),
        ("a,b\n0,5,1,25\n0,25,1,5\n", "line 2: 4 numbers under 2 names. These are decimal commas between commas"),
        ("a,b\nc,d\n", "No numbers found"),
        ("x;y\nu;v\n1,2\n", "No numbers found"),
        ("word\n" * 500, "The first 250 lines hold no numbers"),
        (",".join(["1"] * 1001), "1001 columns; a table has at most 1000"),
        ("1" * 200_000, "longer than 100000 characters"),
        ("a,b\n1,2\n" + "1" * 200_000 + ",2\n", "longer than 100000 characters"),
        ("a\n" + "1\n" * 20_000, "more than 10000 rows"),
    ],
)
def test_what_is_wrong_is_named(text: str, complaint: str):
    with pytest.raises(InputError, match=complaint) as refused:
        read(text, (0, 1) if "," in text or ";" in text else (0,))
    assert refused.value.key == "table.csv"


def test_memory_is_bounded_by_what_is_asked_for():
    text = "a,b\n" + "1,2\n" * 1000
    assert read(text, (1,), most_bytes=8000).values.sum() == 2000
    with pytest.raises(InputError, match="of numbers"):
        read(text, (0, 1), most_bytes=8000)


def test_a_file_is_told_what_it_is():
    assert kind_of(b"\x89PNG\r\n\x1a\n") == "a PNG image"
    assert kind_of(b"PK\x03\x04....gyro.npy") == "an NPZ archive"
    assert kind_of(b"PK\x03\x04....imu.csv") == "a ZIP archive"
    assert kind_of(b'\xef\xbb\xbf {"gyro": 1}') == "JSON"
    assert kind_of(b"<!DOCTYPE HTML><html>") == "an HTML page"
    assert kind_of(bytes(range(256))) == "not text"
    assert kind_of(b"[m],[s]\n1,2\n") is None
    assert kind_of("t,a\n1,2\n".encode("utf-16")) is None
    assert math.isnan(read("a,b\nnull,1\n").values[0, 0])

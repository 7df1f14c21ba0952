"""Names of columns that are made to take long: each is parted wherever a unit may begin."""

import time
from collections.abc import Callable

import pytest

from nav_model.allan.log_file import read_log
from nav_model.base.errors import InputError
from nav_model.base.text.column_names import listed, parted
from nav_model.trajectory.files.reader import parse_file


@pytest.mark.parametrize("read", [lambda content: read_log(content, file_name="a"), lambda c: parse_file(c, "a")])
@pytest.mark.parametrize("part", ["a_", "acc.0.", "lat (m/", "(] "])
def test_long_headers_of_a_wide_table_are_refused_soon(read: Callable[[bytes], object], part: str) -> None:
    header = ",".join(part * (95 // len(part)) + f"{place}" for place in range(900))
    content = "\n".join([header] * 20 + [",".join(["1.5"] * 900)] * 20)
    began = time.process_time()
    with pytest.raises(InputError) as refused:
        read(content.encode())
    assert time.process_time() - began < 5.0
    assert len(str(refused.value)) < 350


@pytest.mark.parametrize("read", [lambda content: read_log(content, file_name="a"), lambda c: parse_file(c, "a")])
def test_headers_of_another_width_are_passed_over_soon(read: Callable[[bytes], object]) -> None:
    content = "\n".join([",".join(["l" + " (" * 99] * 400)] * 195 + [",".join(["1.5"] * 900)] * 20)
    began = time.process_time()
    with pytest.raises(InputError):
        read(content.encode())
    assert time.process_time() - began < 3.0


def test_a_unit_of_many_words_is_parted_from_its_name() -> None:
    assert ("gyro_x_", "degrees_per_second_per_root_hertz", False) in parted(
        "gyro_x_degrees_per_second_per_root_hertz"
    )


def test_a_list_of_names_has_a_length() -> None:
    assert listed(["accelerometer_x [m/s^2]"] * 9).endswith("accelerometer_x [m/s^2] and 1 more")
    assert len(listed(["n" * 500] * 500)) < 240

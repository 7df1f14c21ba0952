"""Names of columns that are made to take long: each is parted wherever a unit may begin."""

import pytest

from nav_model.allan.log_file import read_log
from nav_model.base.errors import InputError
from nav_model.base.text.column_names import listed, parted
from nav_model.base.text.number_table import open_table

_ROWS = "\n".join([",".join(["1.5"] * 900)] * 20)


@pytest.mark.parametrize("part", ["a_", "acc.0.", "lat (m/", "(] "])
def test_a_name_is_parted_at_few_places_however_long_it_is(part: str) -> None:
    assert len(list(parted(part * 2000))) <= 9


def test_long_headers_of_a_wide_table_are_told_in_short() -> None:
    header = ",".join(f"{'acc.0.' * 15}{place}" for place in range(900))
    with pytest.raises(InputError) as refused:
        read_log(f"{header}\n{_ROWS}".encode(), file_name="a")
    assert len(str(refused.value)) < 350


def test_long_lines_far_above_the_rows_name_no_columns() -> None:
    header = ",".join(["l" + " (" * 49] * 900)
    table = open_table("\n".join([*[header] * 195, _ROWS]).encode(), "a")
    assert len(table.headers) == 2  # of 90 kB each, within 250 kB


def test_a_unit_of_many_words_is_parted_from_its_name() -> None:
    assert ("gyro_x_", "degrees_per_second_per_root_hertz", False) in parted(
        "gyro_x_degrees_per_second_per_root_hertz"
    )


def test_a_list_of_names_has_a_length() -> None:
    assert listed(["accelerometer_x [m/s^2]"] * 9).endswith("accelerometer_x [m/s^2] and 1 more")
    assert len(listed(["n" * 500] * 500)) < 240

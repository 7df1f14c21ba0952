"""The one input error: its fields, its message, its journey from a worker process."""

import pickle

import pytest

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.catalogue import find
from nav_model.design.file import parse_design
from nav_model.design.link import from_query


class Elsewhere(InputError):
    """A kind of its own, which must not turn into the plain one on the way."""


@pytest.mark.parametrize("kind", [InputError, Elsewhere])
@pytest.mark.parametrize("value", [None, 3.5, "text: with = marks", (5.0, 2.0)])
def test_the_message_is_made_of_the_fields_and_all_survive_pickling(kind, value):
    error = kind("imu.rate", "is not allowed: 1 = 2; try 100 Hz", value)
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is kind
    for e in (error, again):
        assert (e.key, e.reason, e.value) == ("imu.rate", "is not allowed: 1 = 2; try 100 Hz", value)
        assert str(e) == "imu.rate: is not allowed: 1 = 2; try 100 Hz"
    renamed = again.under("--rate")
    assert (type(renamed), renamed.key, renamed.reason, renamed.value) == (kind, "--rate", error.reason, value)


def test_a_message_has_a_length_whatever_a_file_says():
    error = InputError("k" * 10_000, "begins " + "x" * 10**6 + " ends.")
    assert len(str(error)) < 1000
    assert error.reason.startswith("begins xxx")
    assert error.reason.endswith("xxx ends.")
    again = pickle.loads(pickle.dumps(error))
    assert (again.key, again.reason) == (error.key, error.reason)


@pytest.mark.parametrize(
    ("make", "key", "value"),
    [
        (lambda: Design({"imu.rate": -1.0}), "imu.rate", -1.0),
        (lambda: Design({"imu.rate": "fast"}), "imu.rate", "fast"),
        (lambda: Design({"radar.window": "hann"}), "radar.window", "hann"),
        (lambda: Design({"imu.bogus": 7}), "imu.bogus", 7),
        (lambda: parse_design('[imu]\nrate = " -1 Hz"'), "imu.rate", " -1 Hz"),
        (lambda: parse_design('[imu]\nrate = "1 m"'), "imu.rate", "1 m"),
        (lambda: parse_design("[imu]\nrate = 3"), "imu.rate", 3),
        (lambda: parse_design("name = 3"), "name", 3),
        (lambda: from_query("fs=-1Hz"), "imu.rate", "-1Hz"),
        (lambda: parse_design('[gnss]\nrate = "0 Hz"'), "gnss.rate", "0 Hz"),
        (lambda: find("imu", "no such unit"), "imu.preset", "no such unit"),
        (lambda: analyse(Design(), [-1.0]), "times", [-1.0]),
    ],
)
def test_the_value_is_what_was_given_as_it_was_given(make, key, value):
    with pytest.raises(InputError) as caught:
        make()
    assert (caught.value.key, caught.value.value) == (key, value)
    assert type(caught.value.value) is type(value)

"""Models that come back whole are no news."""

import warnings

import pytest
from bokeh.core.serialization import Deserializer
from bokeh.models import Range1d

from app.upstream.sent_back import expect_known_models

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


def test_a_model_that_comes_back_whole_is_taken_in_silence() -> None:
    known = Range1d()
    whole = {"type": "object", "name": "Range1d", "id": known.id, "attributes": {"start": 1.0}}
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always")
        assert Deserializer([known]).deserialize(whole) is known
        assert len(raised) == 1  # as shipped
        expect_known_models()
        assert Deserializer([known]).deserialize(whole) is known
        assert len(raised) == 1

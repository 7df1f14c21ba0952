"""Fields for text have their bound on the server too."""

import re
from pathlib import Path

import pytest

import app
from app.ui.fields import TextArea, TextInput


@pytest.mark.parametrize("kind", [TextInput, TextArea])
@pytest.mark.parametrize("what", ["value", "value_input"])
def test_a_text_that_a_browser_did_not_cut_is_cut(kind: type[TextInput], what: str) -> None:
    field = kind(max_length=100)
    field._process_events({what: "word " * 100_000})
    assert len(getattr(field, what)) == 100


def test_no_other_fields_for_text_are_made() -> None:
    folder = Path(app.__file__).parent
    made = {
        path.name for path in folder.rglob("*.py") if re.search(r"pmui\.Text(Area)?Input", path.read_text("utf-8"))
    }
    assert made == {"fields.py"}

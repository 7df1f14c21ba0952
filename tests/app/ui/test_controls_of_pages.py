"""Controls that the subjects share: what they take from a page, and what they tell."""

import logging
from typing import Any

import panel as pn
import pytest

from app.ui import faults
from app.ui.named_views import NamedViews
from app.ui.row_editor import Field, RowEditor, Rows
from app.ui.verdict_switch import VerdictSwitch
from nav_model.base.errors import InputError


def editor(answer: Any = None) -> tuple[RowEditor, list[Rows]]:
    calls: list[Rows] = []

    def put(rows: Rows) -> Any:
        calls.append(rows)
        return answer

    fields = (Field("name", "Name"), Field("sigma", "Sigma [m]"), Field("source", "Source", read=True))
    return RowEditor(fields, put), calls


def test_rows_come_without_empty_texts_and_without_what_nobody_edits() -> None:
    table, calls = editor()
    table._handle_msg({"rows": [{"name": "mast", "sigma": " ", "source": "forged", "other": "x"}, {"sigma": 3}]})
    assert calls == [[{"name": "mast"}, {"sigma": "3"}]]
    assert table.refused == ""


@pytest.mark.parametrize("message", ["rows", None, {}, {"rows": "x"}, {"rows": [1]}, {"rows": {"name": "x"}}])
def test_a_message_that_is_no_table_is_passed_over(message: Any) -> None:
    table, calls = editor()
    table._handle_msg(message)
    assert calls == []


def test_a_refusal_names_row_and_column_and_goes_with_other_rows() -> None:
    table, _ = editor(InputError("contributors[mast].sigma", "Give a length.", "x"))
    table._handle_msg({"rows": [{"name": "mast", "sigma": "x"}]})
    assert table.refused.startswith("mast, Sigma [m]")
    assert "Give a length." in table.refused
    table.rows = [{"name": "mast", "sigma": "1 mm"}]
    assert table.refused == ""


def test_a_switch_takes_its_options_alone() -> None:
    chosen: list[str] = []
    switch = VerdictSwitch(chosen.append, options={"Real time": "real time", "Smoothed": "post-processed"})
    for message in ("post-processed", "Real time", "<script>", None, 1):
        switch._handle_msg(message)
    assert chosen == ["post-processed"]


def test_a_view_is_made_when_it_is_first_chosen_and_once() -> None:
    made: list[str] = []

    def view(name: str) -> Any:
        made.append(name)
        return pn.pane.Str(name)

    views = NamedViews(
        "See",
        {name: lambda name=name: view(name) for name in ("map", "table", "curve")},
        {"Plots": ("map", "curve"), "Numbers": ("table",)},
    )
    assert made == ["map"]
    views.chosen = "table"
    assert (views._switch.value, views._within.visible) == ("Numbers", False)
    views._switch.value = "Plots"  # its first view
    assert views.chosen == "map"
    views._within.value = "curve"
    assert views.chosen == "curve"
    views.chosen = "map"
    assert made == ["map", "table", "curve"]
    assert [place.visible for place in views._places.values()] == [True, False, False]


def test_bad_input_is_told_in_words_and_a_fault_by_a_number_that_the_log_has(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    messages: list[str] = []
    monkeypatch.setattr(faults, "_teller", lambda: messages.append)
    faults.handle(InputError("imu.bias", "Give a rate.", "x"))
    assert "Give a rate." in messages[-1]
    assert not caplog.records
    with caplog.at_level(logging.ERROR, logger="navbudget"):
        faults.handle(ZeroDivisionError("of a secret design"))
    (record,) = caplog.records
    assert "ZeroDivisionError" in messages[-1]
    assert "secret" not in messages[-1]
    assert messages[-1].endswith(f"fault {record.fields['fault']}.")  # type: ignore[attr-defined]
    faults.clear_message()
    assert messages[-1] == ""

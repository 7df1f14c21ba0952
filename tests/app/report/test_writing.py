"""A report is written whole or not at all, under a name that says its kind."""

import re
from datetime import datetime, timedelta, timezone
from pathlib import Path

import pytest
from known_designs import TACTICAL

from app import cli
from app.report.content import report_of

pytestmark = pytest.mark.long


def test_the_date_is_told_in_utc(mems):
    summer = timezone(timedelta(hours=3))
    report = report_of([mems], datetime(2026, 7, 1, 1, 0, tzinfo=summer))
    assert ("Written", "30 June 2026, 22:00 UTC") in report.chapters[0].facts


def refused(target: Path, capsys, *options: str, code: int = 2) -> str:
    """The command's message about a file it does not write."""
    assert cli.main(["report", TACTICAL, "-o", str(target), *options]) == code
    return capsys.readouterr().err


def test_a_way_to_show_figures_that_there_is_not_is_refused(tmp_path, capsys):
    message = refused(tmp_path / "r.html", capsys, "--show", "3s")
    assert "show: '3s' is not a display choice. Try 1s, 2s, 95 or cep" in message
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["r.txt", "r", "r.html.gz", ".pdf"])
def test_another_suffix_is_refused(name, tmp_path, capsys):
    assert re.search(r"-o: .*does not end in \.html, \.pdf or \.xlsx", refused(tmp_path / name, capsys))
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_and_a_folder_in_place_of_a_file_are_refused(tmp_path, capsys):
    assert re.search(r"-o: .*is not a folder", refused(tmp_path / "none" / "r.html", capsys))
    (tmp_path / "r.pdf").mkdir()
    assert re.search(r"-o: .*is a folder", refused(tmp_path / "r.pdf", capsys))


def test_a_failure_leaves_the_old_file_and_no_litter(tmp_path, monkeypatch, capsys):
    target = tmp_path / "r.html"
    target.write_text("old")

    def full(*_args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    assert "No space left" in refused(target, capsys, code=3)
    assert [path.name for path in tmp_path.iterdir()] == ["r.html"]
    assert target.read_text() == "old"


def test_the_command_writes_both_kinds(tmp_path, capsys):
    for name in ("r.html", "R.PDF"):
        target = tmp_path / name
        assert cli.main(["report", TACTICAL, "-o", str(target)]) == 0
        assert target.stat().st_size > 100_000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["R.PDF", "r.html"]
    assert len(capsys.readouterr().err.strip().splitlines()) == 2

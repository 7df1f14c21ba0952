"""A report is written whole or not at all, under a name that says its kind."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest

from app import cli
from app.report import write_report
from app.report.content import report_of
from nav_model.errors import InputError

NOW = datetime(2026, 11, 21, 9, 30, tzinfo=UTC)
EXAMPLES = Path(__file__).parents[3] / "examples"


def test_the_date_is_told_in_utc(mems):
    summer = timezone(timedelta(hours=3))
    report = report_of([mems], datetime(2026, 7, 1, 1, 0, tzinfo=summer))
    assert ("Written", "30 June 2026, 22:00 UTC") in report.chapters[0].facts


@pytest.mark.parametrize("name", ["r.txt", "r", "r.html.gz", ".pdf"])
def test_another_suffix_is_refused(name, mems, tmp_path):
    with pytest.raises(InputError, match=r"^-o: .*does not end in \.html or \.pdf"):
        write_report([mems], tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_and_a_folder_in_place_of_a_file_are_refused(mems, tmp_path):
    with pytest.raises(InputError, match=r"^-o: .*is not a folder"):
        write_report([mems], tmp_path / "none" / "r.html")
    (tmp_path / "r.pdf").mkdir()
    with pytest.raises(InputError, match=r"^-o: .*is a folder"):
        write_report([mems], tmp_path / "r.pdf")


def test_a_folder_that_refuses_gives_one_message(mems, tmp_path, monkeypatch):
    def refuse(*_args, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)  # root may write anywhere, so the refusal is acted
    with pytest.raises(InputError, match=r"^-o: .*cannot be written: Permission denied$"):
        write_report([mems], tmp_path / "r.html")


def test_a_failure_leaves_the_old_file_and_no_litter(mems, tmp_path, monkeypatch):
    target = tmp_path / "r.html"
    target.write_text("old")

    def full(*_args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(InputError, match="No space left"):
        write_report([mems], target)
    assert [path.name for path in tmp_path.iterdir()] == ["r.html"]
    assert target.read_text() == "old"


def test_the_command_writes_both_kinds(tmp_path, capsys):
    design = str(EXAMPLES / "tactical_x_band.toml")
    for name in ("r.html", "R.PDF"):
        target = tmp_path / name
        assert cli.main(["report", design, "-o", str(target)]) == 0
        assert target.stat().st_size > 100_000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["R.PDF", "r.html"]
    assert cli.main(["report", design, "-o", str(tmp_path / "r.doc")]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 3

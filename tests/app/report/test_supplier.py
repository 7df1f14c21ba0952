"""The supplier's sheet as a file, and a log judged by it."""

from pathlib import Path

import numpy as np
import pypdf
import pytest
from commanded import reply
from known_designs import TACTICAL

from app.cli import main
from app.examples import example
from nav_model.explore.supplier import required

pytestmark = pytest.mark.long


@pytest.mark.parametrize(
    ("unit", "value", "source"),
    [("imu", "Angle random walk", "NIST Special Publication 1065"), ("gnss", "Position noise", "ISO 17123-8")],
)
def test_a_sheet_is_one_page_with_values_test_and_sources(tmp_path: Path, unit: str, value: str, source: str) -> None:
    target = tmp_path / "sheet.pdf"
    assert main(["report", TACTICAL, "--supplier", unit, "-o", str(target)]) == 0
    (page,) = pypdf.PdfReader(target).pages
    text = page.extract_text()
    assert value in text
    assert "chi-square" in text
    assert source in text


def test_a_sheet_without_charts_is_a_small_html_page(tmp_path: Path) -> None:
    target = tmp_path / "sheet.html"
    assert main(["report", TACTICAL, "--supplier", "imu", "-o", str(target)]) == 0
    text = target.read_text("utf-8")
    assert "Accepted reading" in text
    assert len(text) < 100_000


def test_a_sheet_says_which_limits_are_not_in_its_values(tmp_path: Path) -> None:
    tables = '[allocation]\n[[limits]]\nname = "width"\non = "response_width"\nlimit = "0.3 m"\n'
    (tmp_path / "design.toml").write_text(Path(TACTICAL).read_text("utf-8") + tables, "utf-8")
    target = tmp_path / "sheet.html"
    assert main(["report", str(tmp_path / "design.toml"), "--supplier", "imu", "-o", str(target)]) == 0
    text = target.read_text("utf-8")
    assert "Not allocated, so not in these values: limits on the impulse response (width)." in text


@pytest.mark.parametrize("more", [["--show", "2s"], ["--with", "sar"], [TACTICAL]])
def test_a_sheet_and_a_spreadsheet_are_of_one_design_alone(
    tmp_path: Path, more: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    for target, options in (("sheet.pdf", ["--supplier", "imu"]), ("budget.xlsx", [])):
        assert main(["report", TACTICAL, *more, *options, "-o", str(tmp_path / target)]) == 2
        assert "of one design, without --with and --show" in capsys.readouterr().err
        assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("factor", "code"), [(0.8, 0), (1.2, 1)])
def test_a_log_is_judged_by_the_command(
    tmp_path: Path, factor: float, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    walks = [factor * 10 * line.value for line in required(example("tactical_x_band"), "imu")]
    noise = np.random.default_rng(2).standard_normal((2, 30_000, 3))
    np.savez(tmp_path / "log.npz", gyro=walks[0] * noise[0], accelerometer=walks[1] * noise[1])
    units = ["--rate", "100", "--gyro-unit", "rad/s", "--accelerometer-unit", "m/s2"]
    result = reply(capsys, "allan", str(tmp_path / "log.npz"), *units, "--against", TACTICAL, code=code)["acceptance"]
    assert result["passes"] is (code == 0)
    assert [axis["passes"] for axis in result["axes"]] == [code == 0] * 6

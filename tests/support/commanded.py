"""A command in this process."""

import json
from typing import Any

import pytest

from app.cli import main


def reply(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> Any:
    """The JSON that a command writes to standard output; fails if it ends with another code."""
    assert main(list(arguments)) == code
    return json.loads(capsys.readouterr().out)

"""What a visitor sees of a server as shipped."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="session")
def shipped() -> dict[str, Any]:
    """What `shipped_server` tells."""
    program = Path(__file__).with_name("shipped_server.py")
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found

"""A software bill of materials from a lock file, as CycloneDX 1.5 JSON: every package with version and digests."""

import json
import re
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any


def bill(lock: str) -> dict[str, Any]:
    """The bill of a lock file's text."""
    components = []
    for block in re.split(r"(?m)^(?=[A-Za-z0-9])", lock):
        if match := re.match(r"([A-Za-z0-9._-]+)(?:\\[[^]]*])?==([^ ;\\\n]+)", block):
            name, number = match.groups()
            digests = re.findall(r"--hash=sha256:([0-9a-f]{64})", block)
            components.append(
                {
                    "type": "library",
                    "name": name,
                    "version": number,
                    "purl": f"pkg:pypi/{name}@{number}",
                    # One digest a file that may be installed, as the lock file has them.
                    "hashes": [{"alg": "SHA-256", "content": digest} for digest in digests],
                }
            )
    program = {"type": "application", "name": "navbudget", "version": version("navbudget")}
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": program},
        "components": components,
    }


if __name__ == "__main__":
    json.dump(bill(Path(sys.argv[1]).read_text(encoding="utf-8")), sys.stdout, indent=1)

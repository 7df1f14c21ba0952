"""What `make run`, `make test` and the container install is what pyproject.toml asks for."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.markers import Marker
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
ENTRY = re.compile(r"^(?P<name>[A-Za-z0-9._-]+)==(?P<version>[^ \\;]+)(?: ; (?P<marker>[^\\]+?))? \\\n", re.MULTILINE)
FILES = {"run": (), "image": ("oauth", "postgresql"), "test": ("test",)}


def locked(name: str) -> dict[str, tuple[str, str | None]]:
    """Name -> version and marker of each package of a lock file."""
    text = (ROOT / "requirements" / f"{name}.lock").read_text(encoding="utf-8")
    return {canonicalize_name(m["name"]): (m["version"], m["marker"]) for m in ENTRY.finditer(text)}


def asked(name: str) -> list[Requirement]:
    """What pyproject.toml asks for where a lock file is installed, extras within extras followed."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    if name == "installer":
        return [Requirement(text) for text in project["dependency-groups"]["installer"]]
    extras = project["project"]["optional-dependencies"]
    result = [
        Requirement(text) for text in (*project["project"]["dependencies"], *project["build-system"]["requires"])
    ]
    waiting = list(FILES[name])
    while waiting:
        for requirement in map(Requirement, extras[waiting.pop()]):
            if requirement.name == project["project"]["name"]:
                waiting += requirement.extras
            else:
                result.append(requirement)
    return result


@pytest.mark.parametrize("name", [*FILES, "installer"])
def test_a_lock_file_holds_all_that_is_asked_for(name: str) -> None:
    versions = locked(name)
    for requirement in asked(name):
        version, marker = versions[canonicalize_name(requirement.name)]
        assert version in requirement.specifier, f"{requirement}, but {version} is locked: run `make lock`"
        assert marker is None or Marker(marker).evaluate(), requirement


@pytest.mark.parametrize("name", [*FILES, "installer"])
def test_every_package_is_named_by_its_digest_and_none_by_an_address(name: str) -> None:
    text = (ROOT / "requirements" / f"{name}.lock").read_text(encoding="utf-8")
    assert not re.search(r"://|^--(?!hash)|^ *-(?:i|f) ", text, re.MULTILINE)
    entries = re.split(r"^(?=\S)", re.sub(r"^ *#.*\n", "", text, flags=re.MULTILINE), flags=re.MULTILINE)[1:]
    assert len(entries) == len(locked(name)) > 0
    assert all(re.search(r"--hash=sha256:[0-9a-f]{64}", entry) for entry in entries)


def test_what_runs_is_what_is_tested_and_brings_no_test_packages() -> None:
    tested = locked("test")
    for name in ("run", "image"):
        assert locked(name).items() <= tested.items()
    assert locked("run").keys() <= locked("image").keys()
    assert not locked("image").keys() & {"allantools", "pytest", "sphinx", "numpydoc", "hypothesis", "mypy", "ruff"}


def test_the_build_is_locked_as_it_is_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert project["dependency-groups"]["build"] == project["build-system"]["requires"]


def test_all_installers_check_digests() -> None:
    for name in ("Makefile", "Dockerfile"):
        text = re.sub(r"\\\n", " ", (ROOT / name).read_text(encoding="utf-8"))
        # Parted at what joins commands; the last two install this product itself, whose packages are there already.
        for command in re.split(r"&&|\|\||;|\n", text):
            if re.search(r"\bpip\)? install|\bPIP\) install", command) and "uv>=" not in command:
                assert "--require-hashes" in command or "--no-deps" in command, command

"""The password file: a line ``name:hash`` per person, hashed with scrypt.

Each hash states its cost and salt, so the cost can be raised later without new passwords.
"""

import base64
import binascii
import hashlib
import hmac
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from nav_model.base.errors import InputError

_COST, _BLOCK, _LANES = 2**14, 8, 1  # 16 MiB and some 50 ms a try
_MOST_COST, _MOST_BLOCK, _MOST_LANES = 2**18, 16, 4  # a file must not stop the server
_MEMORY = 512 * 1024 * 1024
_SALT_BYTES, _KEY_BYTES = 16, 32
MAX_PASSWORD = 1024
MAX_NAME = 64
SHORTEST = 8


def password_line(name: str, password: str) -> str:
    """The line of the file for a person.

    Raises
    ------
    InputError
        If the name or the password cannot be used.
    """
    if not name or len(name) > MAX_NAME or not name.isprintable() or ":" in name or name != name.strip():
        raise InputError("NAME", f"{name!r} is not a name: 1 to {MAX_NAME} printable characters without a colon")
    if name.startswith("#"):
        raise InputError("NAME", f"{name!r} would be a comment in the file; # must not come first")
    if not SHORTEST <= len(password) <= MAX_PASSWORD:
        raise InputError("password", f"must have {SHORTEST} to {MAX_PASSWORD} characters")
    salt = secrets.token_bytes(_SALT_BYTES)
    key = _key(password, salt, _COST, _BLOCK, _LANES)
    return f"{name}:scrypt${_COST}${_BLOCK}${_LANES}${_text(salt)}${_text(key)}"


def _key(password: str, salt: bytes, cost: int, block: int, lanes: int) -> bytes:
    return hashlib.scrypt(
        password.encode("utf-8", "surrogatepass"),
        salt=salt, n=cost, r=block, p=lanes, maxmem=_MEMORY, dklen=_KEY_BYTES,
    )  # fmt: skip


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


@dataclass(frozen=True)
class _Hash:
    cost: int
    block: int
    lanes: int
    salt: bytes
    key: bytes

    def fits(self, password: str) -> bool:
        key = _key(password, self.salt, self.cost, self.block, self.lanes)
        return hmac.compare_digest(key, self.key)


_NOBODY = _Hash(_COST, _BLOCK, _LANES, secrets.token_bytes(_SALT_BYTES), secrets.token_bytes(_KEY_BYTES))


def _parsed(text: str) -> _Hash | None:
    """A hash as written by `password_line`; None if it is not one."""
    try:
        kind, cost, block, lanes, salt, key = text.split("$")
        parsed = _Hash(int(cost), int(block), int(lanes),
                      base64.b64decode(salt, validate=True), base64.b64decode(key, validate=True))  # fmt: skip
    except (ValueError, binascii.Error):
        return None
    usable = (
        kind == "scrypt"
        and 2 <= parsed.cost <= _MOST_COST
        and parsed.cost & (parsed.cost - 1) == 0
        and 1 <= parsed.block <= _MOST_BLOCK
        and 1 <= parsed.lanes <= _MOST_LANES
        and len(parsed.salt) >= _SALT_BYTES
        and len(parsed.key) == _KEY_BYTES
    )
    return parsed if usable else None


def read_passwords(path: Path) -> Mapping[str, _Hash]:
    """Name -> hash. Empty lines and lines that begin with # are left out.

    Raises
    ------
    InputError
        If the file cannot be read, a line is not ``name:hash``, a name comes twice, or nobody is in it.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        raise InputError("--password-file", f"{path}: {reason}") from error
    people: dict[str, _Hash] = {}
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.startswith("#"):
            continue
        name, colon, text = line.strip().rpartition(":")
        parsed = _parsed(text)
        if not colon or not name or parsed is None:
            # The line itself stays out of the message: somebody may have written a password in clear.
            raise InputError(
                "--password-file", f"{path} line {number} is not name:hash; `navbudget password NAME` prints one"
            )
        if name in people:
            raise InputError("--password-file", f"{path} line {number} names {name!r} a second time")
        people[name] = parsed
    if not people:
        raise InputError("--password-file", f"{path} names nobody; `navbudget password NAME` prints a line for it")
    return people


@dataclass
class Passwords:
    """The people of a password file; the file may change while the server runs.

    While the file is unreadable or wrong, nobody can log in.
    """

    path: Path
    _stamp: tuple[int, int] | None = None
    _people: Mapping[str, _Hash] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._people = read_passwords(self.path)
        self._stamp = self._now()

    def _now(self) -> tuple[int, int] | None:
        try:
            status = self.path.stat()
        except OSError:
            return None
        return status.st_mtime_ns, status.st_size

    def _current(self) -> Mapping[str, _Hash]:
        stamp = self._now()
        if stamp != self._stamp:
            try:
                self._people = read_passwords(self.path)
            except InputError:
                self._people = {}
            self._stamp = stamp
        return self._people

    def mark(self, name: str) -> str | None:
        """A mark that changes with this user's password; None for a name not in the file."""
        person = self._current().get(name)
        return None if person is None else _text(person.salt + person.key)

    def fits(self, name: str, password: str) -> bool:
        """True if name and password match; takes as long for an unknown name."""
        if len(password) > MAX_PASSWORD:
            return False
        person = self._current().get(name)
        right = (person or _NOBODY).fits(password)
        return right and person is not None

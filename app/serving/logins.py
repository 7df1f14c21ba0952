"""Logins, shared by all processes of a server: current ones and failed tries.

A cookie alone would stay valid until it expires, also in a copy. So each login has a row here: logging out removes
it, and it ends when the password changes. Tries are counted for the address they come from and for the account they
are for, over all processes.
"""

import hashlib
import secrets
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from sqlalchemy import Connection, text
from sqlalchemy.exc import DBAPIError

from app.library.engine import engine_at
from nav_model.base.errors import InputError

_TRIES = 10
_WINDOW = 60.0  # seconds
_TABLES = (
    """CREATE TABLE IF NOT EXISTS logins (
        id TEXT PRIMARY KEY, name TEXT NOT NULL, password TEXT NOT NULL, until DOUBLE PRECISION NOT NULL)""",
    "CREATE TABLE IF NOT EXISTS login_tries (who TEXT NOT NULL, at DOUBLE PRECISION NOT NULL)",
    "CREATE INDEX IF NOT EXISTS login_tries_who ON login_tries (who, at)",
)
_LOCK = 0x6C6F67


class Logins:
    """The store at a file's path or a database URL; `clock` gives seconds, the same in all processes.

    Raises
    ------
    InputError
        If the database cannot be used.
    """

    def __init__(self, address: str, clock: Callable[[], float] = time.time) -> None:
        self._clock = clock
        try:
            self._engine = engine_at(address)
            with self._writing() as connection:
                if connection.dialect.name == "postgresql":  # servers that start together do not make them together
                    connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _LOCK})
                for statement in _TABLES:
                    connection.execute(text(statement))
        except InputError as error:
            raise error.under("--login-store") from error
        except DBAPIError as error:
            raise InputError("--login-store", f"cannot be used: {error.orig}") from error

    def close(self) -> None:
        """Close the database."""
        self._engine.dispose()

    @contextmanager
    def _writing(self) -> Iterator[Connection]:
        with self._engine.connect().execution_options(writes=True) as connection, connection.begin():
            yield connection

    def begin(self, name: str, password: str, hours: float) -> str:
        """Start a login for a user with this password (its hash as in the file); returns the secret for the
        cookie."""
        secret, now = secrets.token_urlsafe(32), self._clock()
        with self._writing() as connection:
            connection.execute(text("DELETE FROM logins WHERE until < :now"), {"now": now})
            connection.execute(
                text("INSERT INTO logins VALUES (:id, :name, :password, :until)"),
                {"id": _hashed(secret), "name": name, "password": _hashed(password), "until": now + 3600 * hours},
            )
        return secret

    def holds(self, secret: str, name: str, password: str) -> bool:
        """True while this login is valid: started, not ended, and the password is unchanged."""
        query = text("SELECT 1 FROM logins WHERE id = :id AND name = :name AND password = :password AND until > :now")
        wanted = {"id": _hashed(secret), "name": name, "password": _hashed(password), "now": self._clock()}
        with self._engine.connect() as connection:
            return connection.execute(query, wanted).first() is not None

    def end(self, secret: str) -> None:
        """End the login of this secret, for every copy of its cookie."""
        with self._writing() as connection:
            connection.execute(text("DELETE FROM logins WHERE id = :id"), {"id": _hashed(secret)})

    def too_many(self, who: str) -> bool:
        """True if an address or account has failed too often in the last minute."""
        # Until now: a clock that was set back would block for as long as that.
        query = text("SELECT COUNT(*) FROM login_tries WHERE who = :who AND at BETWEEN :since AND :now")
        now = self._clock()
        window = {"who": _hashed(who), "since": now - _WINDOW, "now": now}
        with self._engine.connect() as connection:
            count = connection.execute(query, window).scalar_one()
        return int(count) >= _TRIES

    def failed(self, *who: str) -> None:
        """Count a failure."""
        now = self._clock()
        with self._writing() as connection:
            outside = text("DELETE FROM login_tries WHERE at NOT BETWEEN :since AND :now")
            connection.execute(outside, {"since": now - _WINDOW, "now": now})
            for name in who:
                connection.execute(
                    text("INSERT INTO login_tries VALUES (:who, :at)"), {"who": _hashed(name), "at": now}
                )


def _hashed(secret: str) -> str:
    """The hash for the store, from which neither secret nor address can be recovered."""
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()

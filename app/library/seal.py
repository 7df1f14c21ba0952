"""The signature of a review: Ed25519, with a key outside the database.

A plain hash shows a change, but whoever can write the database can compute it anew. A signature can be made only
with the key. It promises that a review is as it was signed by a NavBudget that had this key; it does not prove who
the user was, and does not protect against somebody who can read the key's file.
"""

from __future__ import annotations

import base64
import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from nav_model.base.errors import InputError

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

CHANGED = "changed outside the program"
"""Words for a review that is not what was sealed."""

_KIND = "ed25519"
_path: Path | None = None


def use_key(path: Path | None) -> None:
    """Sign and verify with the key in a file (PEM) from now on; None is the user's own, made when first needed."""
    global _path
    _path = path


def check_key(path: Path) -> None:
    """Refuse a file that holds no key, before anybody signs.

    Raises
    ------
    InputError
        If the key cannot be read.
    """
    use_key(path)
    _key(make=False)


def signature_of(seal: str) -> str:
    """The signature of a seal: kind, public key and signature.

    Raises
    ------
    InputError
        If the key cannot be read, or made.
    """
    key = _key(make=True)
    assert key is not None
    return f"{_KIND}:{_public(key)}:{_text(key.sign(seal.encode()))}"


def doubt_about(seal: str, signature: str | None) -> str:
    """Why a signature of a seal is not valid; empty if it is."""
    from cryptography.exceptions import InvalidSignature

    if not signature:
        return "sealed without a signature, by an earlier program or by somebody else"
    kind, _, rest = signature.partition(":")
    public, _, signed = rest.partition(":")
    try:
        key = _key(make=False)
    except InputError:
        key = None
    if kind != _KIND or key is None or public != _public(key):
        return f"signed with a key that this installation does not have ({public[:12]})"
    try:
        key.public_key().verify(base64.b64decode(signed, validate=True), seal.encode())
    except (InvalidSignature, ValueError):
        return CHANGED
    return ""


def _key(*, make: bool) -> Ed25519PrivateKey | None:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    path = _path or _key_path()
    try:
        if make and _path is None and not path.exists():
            _make(path)
        if not path.exists() and _path is None:
            return None
        key = load_pem_private_key(path.read_bytes(), None)
    except OSError as error:
        raise InputError("--review-key", f"{path}: {error.strerror}; name a file with an Ed25519 key") from error
    except (ValueError, TypeError) as error:
        raise InputError("--review-key", f"{path} holds no Ed25519 key in PEM without a password") from error
    if not isinstance(key, Ed25519PrivateKey):
        raise InputError("--review-key", f"{path} holds a key of another kind; Ed25519 is needed")
    return key


def _make(path: Path) -> None:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

    path.parent.mkdir(parents=True, exist_ok=True)
    text = Ed25519PrivateKey.generate().private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    with os.fdopen(os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    with suppress(FileExistsError):  # another process was first
        os.link(draft, path)
    draft.unlink()


def _key_path() -> Path:
    from platformdirs import user_data_path

    return user_data_path("navbudget", appauthor=False) / "review.key"


def _public(key: Ed25519PrivateKey) -> str:
    return _text(key.public_key().public_bytes_raw())


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")

"""The signature of a review, against an attacker who can write the database but does not have the key."""

import base64
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from behind_its_back import decided
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from sqlalchemy import text

from app.library import reviews, seal
from app.library.reviews import Review, load_review, open_review, sign
from app.library.store import Library
from app.subjects.review.overview import state_of
from app.subjects.review.report import audit_table
from nav_model.base.errors import InputError
from nav_model.budget import Budget


def _pem(key: Ed25519PrivateKey) -> bytes:
    return key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())


@pytest.fixture
def key(tmp_path: Path) -> Iterator[Path]:
    path = tmp_path / "review.key"
    path.write_bytes(_pem(Ed25519PrivateKey.generate()))
    seal.use_key(path)
    yield path
    seal.use_key(None)


@pytest.fixture
def signed(library: Library, tactical: Budget, key: Path) -> Review:
    review = open_review(library, "Gate 2", "Ann", [library.save(tactical, "Ann").key])
    review = decided(library, review)
    return sign(library, review.id, "Chief", review.version)


def test_the_signature_is_ed25519_of_the_seal(signed: Review) -> None:
    """As the cryptography library verifies it, with nothing of ours."""
    assert signed.intact
    kind, public, signature = signed.signature.split(":")
    assert kind == "ed25519"
    Ed25519PublicKey.from_public_bytes(base64.b64decode(public)).verify(
        base64.b64decode(signature), signed.seal.encode()
    )


def _resealed(library: Library, review: str, signature: Callable[[str], str | None]) -> Review:
    """The forgery of somebody who can write the database and knows this program."""
    with library.engine.begin() as connection:
        connection.execute(text("UPDATE reviews SET signed_by = 'Mallory' WHERE id = :id"), {"id": review})
    with library.read() as connection:
        anew = reviews._seal(reviews._load(connection, review))
    with library.engine.begin() as connection:
        values = {"seal": anew, "signature": signature(anew), "id": review}
        connection.execute(text("UPDATE reviews SET seal = :seal, signature = :signature WHERE id = :id"), values)
    return load_review(library, review)


def _of_mallory(sealed: str) -> str:
    key = Ed25519PrivateKey.generate()
    texts = (
        base64.b64encode(data).decode() for data in (key.public_key().public_bytes_raw(), key.sign(sealed.encode()))
    )
    return ":".join(("ed25519", *texts))


@pytest.mark.parametrize(
    ("forge", "message"),
    [
        (lambda old: lambda _: old, "changed outside the program"),
        (lambda _: lambda _: None, "sealed without a signature"),
        (lambda _: _of_mallory, "a key that this installation does not have"),
        (lambda old: lambda _: old[:-8] + "AAAAAAA=", "changed outside the program"),
        (lambda _: lambda _: "ed25519:x:y", "a key that this installation does not have"),
        (lambda _: lambda _: "nonsense", "a key that this installation does not have"),
    ],
)
def test_a_review_sealed_anew_is_found_out_on_opening_and_in_the_report(
    library: Library, signed: Review, forge: Any, message: str
) -> None:
    forged = _resealed(library, signed.id, forge(signed.signature))
    assert not forged.intact
    assert message in forged.doubt
    assert any(message in cell.text for row in audit_table(forged).rows for cell in row)
    assert state_of(forged).tone == "bad"


@pytest.mark.parametrize("column", ["name", "author", "note", "saved", "origin", "text", "content_hash"])
def test_what_the_record_says_of_a_design_is_under_the_signature(
    library: Library, signed: Review, column: str
) -> None:
    with library.engine.begin() as connection:
        connection.execute(text(f"UPDATE revisions SET {column} = '2001-01-01T00:00:00.000+00:00'"))
    assert load_review(library, signed.id).doubt == "changed outside the program"


def test_without_the_key_nothing_is_said_to_hold(library: Library, signed: Review, key: Path) -> None:
    key.write_bytes(_pem(Ed25519PrivateKey.generate()))
    assert "does not have" in load_review(library, signed.id).doubt
    key.unlink()
    assert "does not have" in load_review(library, signed.id).doubt


def test_a_key_that_cannot_be_used_is_told_and_nothing_is_signed(
    library: Library, tactical: Budget, key: Path
) -> None:
    review = open_review(library, "Gate 3", "Ann", [library.save(tactical, "Ann").key])
    review = decided(library, review)
    for content in (b"", b"not a key"):
        key.write_bytes(content)
        with pytest.raises(InputError, match=r"--review-key: .* holds no Ed25519 key"):
            sign(library, review.id, "Chief", review.version)
    assert load_review(library, review.id).signed is None


def test_a_persons_own_key_is_made_once_for_their_eyes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    first = seal.signature_of("a" * 64)
    assert seal.signature_of("a" * 64) == first  # Ed25519 draws nothing
    assert seal.doubt_about("a" * 64, first) == ""
    path = tmp_path / "navbudget" / "review.key"
    assert path.stat().st_mode & 0o777 == 0o600
    assert [file.name for file in path.parent.iterdir()] == ["review.key"]

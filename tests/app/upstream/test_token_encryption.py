"""A key that is given encrypts what a login leaves in cookies."""

from __future__ import annotations

from typing import Any

import pytest
from cryptography.fernet import Fernet
from panel.config import config
from panel.io.state import state

from app.upstream.login import encrypt_tokens


def test_as_shipped_a_key_encrypts_nothing(shipped: dict[str, Any]) -> None:
    assert not shipped["encrypts"]


def test_a_key_encrypts(monkeypatch: pytest.MonkeyPatch) -> None:
    key = Fernet.generate_key()
    before = config.oauth_encryption_key
    try:
        encrypt_tokens(key)
        assert Fernet(key).decrypt(state.encryption.encrypt(b"token")) == b"token"
    finally:
        config.oauth_encryption_key, state.encryption = before, None

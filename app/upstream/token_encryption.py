"""Tokens of an OAuth login are encrypted with the key that was given.

`panel serve` makes the cipher of its key; `panel.serve` takes the key and leaves tokens as they are.

Written for: Panel 1.9.4
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_token_encryption.py::test_as_shipped_a_key_encrypts_nothing fails
"""

from __future__ import annotations

from panel.config import config
from panel.io.state import state


def encrypt_tokens(key: bytes) -> None:
    """Use a Fernet key for all sessions of this process."""
    from cryptography.fernet import Fernet

    config.oauth_encryption_key = key
    state.encryption = Fernet(key)

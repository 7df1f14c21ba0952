"""Sign-in through an OAuth provider."""

from __future__ import annotations


def test_oauth_sends_to_the_provider(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PANEL_OAUTH_SECRET", "secret-of-the-client")
    with serving("--oauth-provider", "github", "--oauth-key", "the-id", "--oauth-allow", "ada") as served:
        assert served.ask("/")[2]["Location"].startswith("./login")
        _, _, headers = served.ask("/login")
        assert headers["Location"].startswith("https://github.com/login/oauth/authorize?")
        assert "client_id=the-id" in headers["Location"]
        assert "secret-of-the-client" not in str(headers)
        assert served.refused(generate_jwt_token(generate_session_id())) == 403

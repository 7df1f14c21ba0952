"""The operator's rules: options, the password file, who may enter."""

import subprocess
import sys
from pathlib import Path

import pytest
from waiting import PATIENCE

from app.cli import main
from app.serving.passwords import Passwords, password_line, read_passwords
from app.serving.rules import Rules, cookie_secret, is_loopback, oauth_from
from nav_model.base.errors import InputError

pytestmark = pytest.mark.long

PASSWORD = "correct horse battery"


def refusal(capsys: pytest.CaptureFixture[str], *options: str) -> str:
    assert main(["serve", *options]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    return message


@pytest.mark.parametrize("address", ["0.0.0.0", "::", "192.0.2.1", "example.org"])
def test_off_loopback_needs_a_decision(capsys: pytest.CaptureFixture[str], address: str) -> None:
    message = refusal(capsys, "--address", address)
    assert address in message
    assert "--password-file" in message
    assert "--open" in message


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--max-sessions", "0"], "--max-sessions: 0 is outside 1 to 10000"),
        (["--port", "70000"], "--port"),
        (["--session-lifetime", "nan"], "--session-lifetime"),
        (["--max-message", "inf"], "--max-message"),
        (["--workers", "0"], "--workers"),
        (["--allow-origin", "*"], "--allow-origin"),
        (["--allow-origin", "https://example.org"], "--allow-origin"),
        (["--password-file", "/nowhere"], "/nowhere: No such file"),
        (["--oauth-provider", "github"], "--oauth-key"),
        (["--oauth-key", "id"], "needs --oauth-provider"),
        (["--cookie-secret-file", "/dev/null"], "holds 0 characters"),
    ],
)
def test_wrong_options(capsys: pytest.CaptureFixture[str], options: list[str], message: str) -> None:
    assert message in refusal(capsys, *options)


def test_open_contradicts_a_password_file(people: Path) -> None:
    with pytest.raises(InputError, match="contradicts"):
        Rules(open=True, password_file=people).check()


@pytest.mark.parametrize(
    "text",
    ["", "# nobody", "ada", "ada:secret", "ada:scrypt$16384$8$1$AAAA$AAAA", "ada:scrypt$16383$8$1$$",
     "ada:scrypt$99999999999$8$1$AAAAAAAAAAAAAAAAAAAAAA==$" + "A" * 43 + "=", "\x00\xff"],
)  # fmt: skip
def test_a_wrong_password_file_is_refused_without_quoting_it(tmp_path: Path, text: str) -> None:
    path = tmp_path / "people"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(InputError) as caught:
        read_passwords(path)
    assert "secret" not in str(caught.value).replace(str(tmp_path), "")


def test_a_name_twice_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "people"
    path.write_text(f"{password_line('ada', PASSWORD)}\n{password_line('ada', PASSWORD)}")
    with pytest.raises(InputError, match="second time"):
        read_passwords(path)


def test_password_command(tmp_path: Path) -> None:
    path = tmp_path / "people"
    with path.open("w") as out:
        subprocess.run(
            [sys.executable, "-m", "app", "password", "ada"],
            input=PASSWORD + "\n",
            stdout=out,
            text=True,
            check=True,
        )
    assert Passwords(path).fits("ada", PASSWORD)
    assert PASSWORD not in path.read_text()
    for name, password in (("a:b", PASSWORD), ("#a", PASSWORD), ("ada", "short"), ("a\nb", PASSWORD)):
        with pytest.raises(InputError):
            password_line(name, password)


@pytest.mark.parametrize(
    ("option", "content", "message"),
    [
        ("--library", None, "--library: cannot be opened: unable to open"),
        ("--library", b"x" * 5000, "--library: cannot be opened: file is not a database"),
        ("--review-key", None, "Is a directory; name a file with an Ed25519 key"),
        ("--review-key", b"x", "holds no Ed25519 key"),
    ],
)
def test_a_file_that_cannot_be_used_is_told_at_the_start(
    tmp_path: Path, option: str, content: bytes | None, message: str
) -> None:
    path = tmp_path / "file"
    path.mkdir() if content is None else path.write_bytes(content)
    command = [sys.executable, "-m", "app", "serve", "--port", "0", option, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert message in done.stderr


def test_hash_is_scrypt_of_the_standard() -> None:
    """RFC 7914, section 12, third vector: what the file holds is scrypt, not something like it."""
    from app.serving.passwords import _key

    key = _key("pleaseletmein", b"SodiumChloride", 16384, 8, 1)
    assert key.hex() == "7023bdcb3afd7348461c06cd81fd38ebfda8fbba904f8e3ea9b543f6545da1f2"


def test_who_is_taken_out_of_the_file_is_out(tmp_path: Path) -> None:
    people = tmp_path / "people"
    people.write_text(password_line("ada", PASSWORD) + "\n" + password_line("bob", PASSWORD))
    passwords = Passwords(people)
    assert passwords.mark("ada") is not None
    assert passwords.fits("ada", PASSWORD)
    people.write_text(password_line("bob", PASSWORD + "!"))
    assert passwords.mark("ada") is None
    assert not passwords.fits("ada", PASSWORD)
    assert not passwords.fits("bob", PASSWORD)
    assert passwords.fits("bob", PASSWORD + "!")
    people.write_text("broken")
    assert passwords.mark("bob") is None
    people.unlink()
    assert not passwords.fits("bob", PASSWORD + "!")


def test_loopback() -> None:
    assert all(is_loopback(x) for x in ("127.0.0.1", "127.8.8.8", "::1", "localhost", "::ffff:127.0.0.1"))
    assert not any(is_loopback(x) for x in ("0.0.0.0", "::", "10.0.0.1", "localhost.example.org", "::ffff:10.0.0.1"))


def test_oauth_needs_its_parts_and_says_who_may_enter() -> None:
    environment = {"PANEL_OAUTH_SECRET": "s"}
    with pytest.raises(InputError, match="PANEL_OAUTH_SECRET"):
        oauth_from("github", "id", None, ("ada",), {})
    with pytest.raises(InputError, match="--oauth-allow"):
        oauth_from("github", "id", None, (), environment)
    oauth = oauth_from("github", "id", None, ("ada", "@example.org"), environment)
    assert all(oauth.admits(x) for x in ("ada", "Ada", "bob@example.org"))
    assert not any(
        oauth.admits(x) for x in ("bob", "ada@evil.org", "x@example.org.evil", "@example.org@evil", "None")
    )
    anybody = oauth_from("github", "id", None, ("*",), environment)
    assert anybody.admits("eve@evil.org")


def test_cookie_secret_outlives_a_restart(tmp_path: Path) -> None:
    assert cookie_secret(None) != cookie_secret(None)
    path = tmp_path / "secret"
    path.write_text("s" * 40 + "\n")
    assert cookie_secret(path) == "s" * 40

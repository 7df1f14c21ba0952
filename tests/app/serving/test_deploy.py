"""What deploy/ and the Dockerfile say is what the program takes; nginx's file is what nginx takes."""

import http.client
import json
import os
import re
import shutil
import socket
import ssl
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from known_designs import ROOT
from tornado.web import create_signed_value
from waiting import PATIENCE

from app.cli import main

pytestmark = [pytest.mark.long, pytest.mark.watches("deploy", "Dockerfile", "app/serving", "app/cli.py")]

_NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")


def test_the_bill_of_materials_has_every_package_of_the_lock_file() -> None:
    lock = ROOT / "requirements" / "image.lock"
    done = subprocess.run(
        [sys.executable, ROOT / "deploy" / "sbom.py", lock], capture_output=True, text=True, check=True
    )
    bill = json.loads(done.stdout)
    stated = [line.partition("==")[0] for line in lock.read_text().splitlines() if re.match(r"[a-z0-9].*==", line)]
    assert [part["name"] for part in bill["components"]] == [name.partition("[")[0] for name in stated]
    assert sum(len(part["hashes"]) for part in bill["components"]) == lock.read_text().count("--hash=sha256:")


def _refusal(capsys: pytest.CaptureFixture[str], command: list[str]) -> str:
    """The program's answer to a command whose files are not there: the options themselves it must take."""
    assert main(command) == 2
    return capsys.readouterr().err


def test_the_compose_file_gives_options_the_program_takes(capsys: pytest.CaptureFixture[str]) -> None:
    compose = yaml.safe_load((ROOT / "deploy" / "compose.yaml").read_text())
    services = compose["services"]
    assert all(service["mem_limit"] for service in services.values())
    command = services["navbudget"]["command"]
    options = dict(part.split("=", 1) for part in command if "=" in part)
    for option in ("--password-file", "--cookie-secret-file"):
        assert Path(options[option]).name in services["navbudget"]["secrets"]
        assert Path(options[option]).name in compose["secrets"]
    message = _refusal(capsys, command)
    assert "/run/secrets/" in message
    assert "No such file" in message
    host = re.search(r"//(\w+)@(\w+)/(\w+)$", options["--library"])
    database = services[host[2]]
    assert (database["environment"]["POSTGRES_USER"], database["environment"]["POSTGRES_DB"]) == (host[1], host[3])
    password = services["navbudget"]["environment"]["PGPASSWORD"]
    assert password == database["environment"]["POSTGRES_PASSWORD"]
    assert password.startswith("${DATABASE_PASSWORD:?")
    assert "ports" not in services["navbudget"]
    assert compose["networks"]["back"]["internal"]
    # The limit holds what these options may take, as the table of deploy/README.md says.
    readme = (ROOT / "deploy" / "README.md").read_text()
    parts = re.findall(r"^  \| [^|]+ \| (\d+) \| (\d+)(?: \(`(--[a-z-]+)`)?", readme, re.MULTILINE)
    assert [option for *_, option in parts] == ["", "--processes", "--max-sessions", "--workers", ""]
    assert all(options[option] == count for _, count, option in parts if option)
    # Long runs have as many processes more, two at least in each process that serves pages.
    assert int(parts[4][1]) == max(int(parts[3][1]), 2 * int(parts[1][1]))
    assert int(parts[3][1]) >= int(parts[1][1])
    limit = int(services["navbudget"]["mem_limit"].removesuffix("g")) * 1000
    assert 0.8 * limit < sum(int(size) * int(count) for size, count, _ in parts) < limit
    assert f"server_name {options['--allow-origin']};" in (ROOT / "deploy" / "nginx.conf").read_text()


def test_the_image_starts_with_options_the_program_takes(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "Dockerfile").read_text()
    (command,) = re.findall(r"^CMD (\[.*\])", text, re.M)
    assert "/run/secrets/people" in _refusal(capsys, json.loads(command))
    assert "http://127.0.0.1:5006/liveness" in text


@contextmanager
def _proxy(
    folder: Path, upstream: int, listening: tuple[socket.socket, socket.socket], *addresses: str
) -> Iterator[tuple[int, int]]:
    """nginx with the file of deploy/, its names and ports made those of this machine: https and http port.

    It is handed the sockets that listen already, as an nginx that replaces a running one: no port is chosen now and
    taken later, and whoever connects before it is there waits.
    The name ``navbudget`` has several addresses, as where compose runs several containers of one service. Names are
    looked up in a hosts file of our own, which only nginx sees.
    """
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost",
         "-keyout", folder / "privkey.pem", "-out", folder / "fullchain.pem"],
        check=True, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    text = (ROOT / "deploy" / "nginx.conf").read_text()
    port, plain = (listener.getsockname()[1] for listener in listening)
    for ours, theirs in (
        ("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"),
        ("listen 80", f"listen 127.0.0.1:{plain}"),
        ("server navbudget:5006;", f"server navbudget:{upstream};"),
        ("/etc/nginx/tls", str(folder)),
        ("navbudget.example.org", "localhost"),
    ):
        assert ours in text
        text = text.replace(ours, theirs)
    (folder / "site.conf").write_text(text)
    paths = "".join(
        f"{kind}_temp_path {folder}/{kind};" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    (folder / "nginx.conf").write_text(
        f"daemon off; pid {folder}/pid; error_log stderr; events {{}} http {{ {paths} include {folder}/site.conf; }}"
    )
    (folder / "hosts").write_text("".join(f"{address} navbudget\n" for address in addresses))
    apart = ["unshare", "--mount", *([] if os.geteuid() == 0 else ["--map-root-user"]), "sh", "-c",
             'mount --bind "$0" /etc/hosts && exec "$@"', folder / "hosts"]  # fmt: skip
    command = [*apart, str(_NGINX), "-c", str(folder / "nginx.conf"), "-p", str(folder)]
    subprocess.run([*command, "-t"], check=True, capture_output=True)
    handed = [listener.fileno() for listener in listening]
    environment = {**os.environ, "NGINX": "".join(f"{number};" for number in handed)}
    with subprocess.Popen(command, stderr=subprocess.DEVNULL, pass_fds=handed, env=environment) as process:
        try:
            yield port, plain
        finally:
            process.terminate()


def test_a_session_through_nginx(serving: Any, people: Path, tmp_path: Path) -> None:
    assert _NGINX, "no nginx: `make test` installs it (`make nginx`)"
    trusting = ssl.create_default_context()
    trusting.check_hostname, trusting.verify_mode = False, ssl.CERT_NONE
    (tmp_path / "cookie").write_text("c" * 48)
    options = ["--password-file", str(people), "--cookie-secret-file", str(tmp_path / "cookie"),
               "--behind-proxy", "--allow-origin", "localhost", "--log", "json", "--processes", "1",
               "--login-store", str(tmp_path / "logins.db")]  # fmt: skip
    with (
        serving(*options, log=tmp_path / "one") as served,
        serving(*options, "--address", "127.0.0.2", "--port", str(served.port), log=tmp_path / "two"),
        socket.create_server(("127.0.0.1", 0)) as first,
        socket.create_server(("127.0.0.1", 0)) as second,
        _proxy(tmp_path, served.port, (first, second), "127.0.0.1", "127.0.0.2") as (port, plain),
    ):
        visitor = replace(served, port=port, cookies={}, trusting=trusting, name="localhost")
        redirect = http.client.HTTPConnection("127.0.0.1", plain, timeout=PATIENCE)
        redirect.request("GET", "/?f=9GHz", headers={"Host": "localhost"})
        assert redirect.getresponse().headers["Location"] == "https://localhost/?f=9GHz"
        redirect.close()
        assert visitor.ask("/metrics")[0] == 403
        status, _, headers = visitor.log_in("ada", "correct horse battery")
        assert status == 302
        (user,) = (line for line in headers.get_all("Set-Cookie") if line.startswith("user="))
        assert "Secure" in user
        assert visitor.ask("/login", {"x": "x" * 70_000})[0] == 413
        status, _, headers = visitor.ask("/")
        assert status == 200
        assert "max-age" in headers["Strict-Transport-Security"]
        assert visitor.refused(visitor.token(), "https://example.org") == 403
        # A session stays with the server that opened it, whichever of the two that is.
        logins = [
            create_signed_value("c" * 48, "user", "ada", clock=lambda age=age: time.time() - age).decode()
            for age in range(24)
        ]
        for number, visitor.cookies["user"] in enumerate(logins):
            assert visitor.ask(f"/try-{number}")[0] == 404
        for log in ("one", "two"):
            tried = re.search(r"/try-(\d+)", (tmp_path / log).read_text())
            assert tried, "the proxy never chose this server"
            visitor.cookies["user"] = logins[int(tried[1])]
            for _ in range(2):
                assert "ACK" in str(visitor.hello(visitor.token()))

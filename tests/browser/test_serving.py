"""A team's server in the real browser: the way in and out, who is written under what, strangers, and the end."""

import http.server
import json
import math
import re
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from on_page import IDLE
from playwright.sync_api import Browser, Page, expect
from served import serving
from waiting import PATIENCE, until

from app.library.store import Library
from app.serving.passwords import password_line

_PASSWORD = "correct horse battery"


def _log_in(page: Page, name: str, password: str) -> None:
    page.get_by_label("Name").fill(name)
    page.get_by_label("Password").fill(password)
    page.get_by_role("button", name="Log in").click()


def test_the_way_in_and_out_with_a_password(page: Page, tmp_path: Path) -> None:
    people, library = tmp_path / "people", tmp_path / "library.db"
    people.write_text(password_line("ada", _PASSWORD) + "\n")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    with serving("--library", str(library), "--password-file", str(people)) as (server, _):
        page.goto(server + "/#review")
        expect(page.get_by_role("heading", name="Log in")).to_be_visible()
        _log_in(page, "ada", "wrong horse battery")
        expect(page.get_by_role("alert")).to_have_text("Name or password is wrong.")
        expect(page.get_by_label("Name")).to_have_value("ada")
        _log_in(page, "<b>eve</b>", _PASSWORD)
        expect(page.get_by_role("alert")).to_be_visible()
        assert page.locator("b").count() == 0
        _log_in(page, "ada", _PASSWORD)
        page.wait_for_function(IDLE)
        page.get_by_role("tab", name="Review", exact=True).click()
        who = page.get_by_role("textbox", name="Your name", exact=True)
        expect(who).to_have_value("ada")
        expect(who).to_be_disabled()
        page.get_by_role("button", name="Save as new design").click()
        expect(page.get_by_role("status").filter(has_text="Saved: revision 1")).to_be_visible()
        saved = Library(library)
        assert [design.author for design in saved.designs()] == ["ada"]
        saved.close()
        page.goto(server + "/logout")
        page.get_by_role("button", name="Log out").click()
        expect(page.get_by_text("You are logged out.")).to_be_visible()
        page.get_by_role("link", name="Log in again").click()
        expect(page.get_by_role("heading", name="Log in")).to_be_visible()
    assert all(url.startswith((server, "data:", "blob:")) for url in asked), asked


@pytest.fixture
def elsewhere(server: str) -> Iterator[str]:
    """Another site, whose page tries to open this server's connection and to show its page in a frame."""
    socket = server.replace("http", "ws") + "/ws"
    body = f"""<!doctype html><title>trying</title><iframe src="{server}/"></iframe><script>
      const s = new WebSocket("{socket}", ["bokeh", "no.token"]);
      s.onopen = () => document.title = "opened"; s.onerror = () => document.title = "refused";
    </script>""".encode()

    class Site(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: Any) -> None:
            pass

    site = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Site)
    thread = threading.Thread(target=site.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{site.server_port}/"
    site.shutdown()
    site.server_close()
    thread.join()


def test_another_site_gets_neither_the_connection_nor_a_frame(page: Page, elsewhere: str) -> None:
    page.goto(elsewhere)
    page.wait_for_function("() => document.title !== 'trying'")
    assert page.title() == "refused"
    assert page.frames[1].url.startswith("chrome-error:")


@pytest.mark.slow
def test_oversized_and_wrong_files_are_refused_where_they_are_given(visit: Callable[..., Page]) -> None:
    page = visit()
    files = page.get_by_label("Design file", exact=True)
    files.set_input_files({"name": "../../etc/passwd.toml", "mimeType": "text/plain", "buffer": b"imu = 3"})
    notice = page.get_by_role("alert").first
    expect(notice).to_contain_text("Not opened.")
    files.set_input_files(
        {"name": "<img src=x onerror=document.title='owned'>.toml", "mimeType": "text/plain", "buffer": b"\xff\x00"}
    )
    expect(notice).to_contain_text("<img src=x")
    files.set_input_files({"name": "big.toml", "mimeType": "text/plain", "buffer": b"#" * 3_000_000})
    expect(notice).to_contain_text("larger than 0.25 MB")
    assert page.title() == "NavBudget"
    assert page.locator("img[src=x]").count() == 0
    page.get_by_role("slider", name="Angle random walk").focus()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("button", name="Undo")).to_be_enabled()


@pytest.mark.slow
def test_a_report_under_way_arrives_although_the_server_is_told_to_stop(page: Page, tmp_path: Path) -> None:
    with serving("--library", str(tmp_path / "library.db"), "--grace", "300") as (server, process):
        page.goto(server)
        page.wait_for_function(IDLE)
        page.get_by_role("status").first.wait_for()
        page.get_by_role("button", name="Report", exact=True).click()
        with page.expect_download() as download:
            page.get_by_role("button", name="HTML report").click()
            until(
                lambda: "navbudget_heavy_tasks 0.0" not in page.request.get(server + "/metrics").text(),
                "the beginning of the report",
            )
            process.terminate()
        path = download.value.path()
        assert "</html>" in Path(path).read_text()
        assert process.wait(PATIENCE) == 0


def test_a_page_that_lost_its_server_says_so_and_goes_on_with_its_design(page: Page, tmp_path: Path) -> None:
    library = tmp_path / "library.db"
    slider = page.get_by_role("slider", name="Angle random walk")
    box = page.get_by_role("textbox", name="Angle random walk", exact=True)
    with serving("--library", str(library)) as (server, _):
        page.goto(server)
        page.wait_for_function(IDLE)
        slider.press("ArrowRight")
        expect(box).to_have_value("0.157 °/√h")
    lost = page.get_by_role("alert").filter(has_text="Connection to the server lost")
    expect(lost).to_contain_text("nothing is computed now")
    for part in (".sidebar", ".tools"):  # nothing seems to answer that does not
        expect(page.locator(part)).to_have_js_property("inert", True)
    with serving("--library", str(library), "--port", server.rpartition(":")[2]):
        expect(lost).to_contain_text("The server answers again")
        lost.get_by_role("button", name="Reload").click()
        expect(page.get_by_role("alert").filter(has_text="is back")).to_be_visible()
        expect(box).to_have_value("0.157 °/√h")
        slider.press("ArrowRight")
        expect(box).to_have_value("0.164 °/√h")


def test_a_slider_moves_without_its_server_and_tells_the_newest_place_when_that_answers(
    page: Page, tmp_path: Path
) -> None:
    frames: list[str] = []
    page.on("websocket", lambda socket: socket.on("framesent", lambda frame: frames.append(str(frame))))
    slider = page.get_by_role("slider", name="Angle random walk")
    box = page.get_by_role("textbox", name="Angle random walk", exact=True)
    with serving("--library", str(tmp_path / "library.db"), "--processes", "1") as (server, process):
        page.goto(server)
        page.wait_for_function(IDLE)
        slider.focus()
        process.send_signal(signal.SIGSTOP)
        try:
            for _ in range(30):
                page.keyboard.press("ArrowRight")
            expect(box).to_have_value("0.597 °/√h")
        finally:
            process.send_signal(signal.SIGCONT)
        for key, text in ((None, "0.597"), ("ArrowLeft", "0.57")):
            if key:
                page.keyboard.press(key)
            expect(box).to_have_value(f"{text} °/√h")
            # What a page sends is heard of while it is asked something.
            until(lambda text=text: page.title() and _noises(frames)[-1:] == [text], "word of the newest place")
            if not key:  # a press that comes much later begins a comparison of its own
                expect(page.get_by_text("Compared with: Angle random walk 0.15")).to_be_visible()
        assert len(_noises(frames)) < 15, "places between are not told one by one"
        expect(box).to_have_value("0.57 °/√h")


def _noises(frames: list[str]) -> list[str]:
    """Angle random walks [°/√h] of the places that frames to the server tell."""
    places = [float(place) for frame in frames for place in re.findall(r'"place",\s*(-?[\d.]+)', frame)]
    return [f"{60 * math.degrees(10**place):.3g}" for place in places]


_FAULTY = """
import sys
import app.dashboard.toolbar, app.subjects.theory.page
from app.cli import main

class Broken:
    def __init__(self, session):
        raise RuntimeError("a secret of the design")

async def broken(*_):
    raise MemoryError("a secret of the design")

app.subjects.theory.page.TheoryPage, app.dashboard.toolbar.run_in_pool = Broken, broken
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
def test_a_fault_of_ours_is_told_with_its_number_in_the_log_and_the_page_goes_on(page: Page, tmp_path: Path) -> None:
    log = tmp_path / "log"
    options = "--log", "json", "--library", str(tmp_path / "library.db")
    with serving(*options, log=log, program=("-c", _FAULTY)) as (server, _):
        page.goto(server)
        page.wait_for_function(IDLE)
        notice = page.get_by_role("alert").first
        for kind, act in (
            ("RuntimeError", page.get_by_role("tab", name="More", exact=True)),
            ("MemoryError", page.get_by_role("button", name="HTML report")),
        ):
            if kind == "MemoryError":
                page.get_by_role("button", name="Report", exact=True).click()
            act.click()
            expect(notice).to_contain_text(f"NavBudget failed ({kind})")
            expect(notice).not_to_contain_text("secret")
            number = notice.inner_text().rpartition("fault ")[2].strip(" .\n")
            records = [json.loads(line) for line in log.read_text().splitlines()]
            (record,) = [line for line in records if line.get("fault") == number]
            assert (record["event"], record["exception"]) == ("fault", kind)
        assert "secret" not in log.read_text()
        page.get_by_role("tab", name="Budget", exact=True).click()
        slider = page.get_by_role("slider", name="Angle random walk")
        slider.press("ArrowRight")
        expect(page.get_by_role("button", name="Undo")).to_be_enabled()


@pytest.mark.slow
def test_what_one_visitor_opens_first_another_can_open_too(browser: Browser, tmp_path: Path) -> None:
    """Both pages were open before either part was looked at, on a server that has just begun."""
    with serving("--library", str(tmp_path / "library.db")) as (server, _):
        failed: list[str] = []
        pages = [browser.new_page() for _ in range(2)]
        for page in pages:
            page.on("pageerror", lambda error: failed.append(str(error)))
            page.goto(server)
            page.wait_for_function(IDLE)
        for page in pages:
            page.get_by_role("tab", name="Sensors", exact=True).click()
            expect(page.get_by_role("button", name="Choose a log")).to_be_visible()
            page.get_by_role("tab", name="More", exact=True).click()
            expect(page.locator("section.equation math").first).to_be_attached()
        for page in pages:
            page.close()
        assert not failed

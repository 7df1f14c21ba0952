"""What the libraries do in the browser without `app.upstream`: each override can go when its test here fails.

That the product does otherwise is shown by test_layout, test_accessibility, test_first_minutes and their neighbours.
"""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from on_page import IDLE
from playwright.sync_api import Browser, Page
from waiting import PATIENCE

pytestmark = pytest.mark.watches("app/upstream", "app/ui")

_TWO_FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
_PASSES = """() => {
  const [root] = Bokeh.index.roots, measure = root.measure_layout.bind(root)
  let passes = 0
  root.measure_layout = () => { passes++; measure() }
  for (let i = 0; i < 5; i++) root.compute_layout()
  delete root.measure_layout
  const hidden = (view) => (view.layoutable_views ?? []).some((child) => !child.model.visible || hidden(child))
  return [passes, Bokeh.index.roots.some(hidden)]
}"""
_SWALLOWED = """() => {
  const figures = (view) => [...(view.model.type === "Figure" ? [view] : []),
    ...[...(view.child_views ?? [])].flatMap(figures)]
  const [figure] = Bokeh.index.roots.flatMap(figures), holder = figure.parent, wide = figure.bbox.width
  holder.update_bbox()
  figure.el.style.setProperty("width", `${wide - 50}px`, "important")
  const said = holder.update_bbox()
  figure.el.style.removeProperty("width")
  return [said, figure.bbox.width - wide]
}"""

# What is reached below two parts that have a layout of their own, in the way Bokeh hands sizes down.
_REACHED = """() => {
  const { _propagate_layout } = Bokeh.require("models/layouts/layout_dom").LayoutDOMView.prototype
  const reached = [], part = (name, layout, ...layoutable_views) =>
    ({ layout, layoutable_views, _propagate_layout, _compute_layout: () => reached.push(name) })
  part("outer", {}, part("near", null), part("inner", {}, part("deep", null)))._propagate_layout()
  return reached
}"""


@pytest.fixture(scope="module")
def shipped(browser: Browser) -> Iterator[Page]:
    """The page of `as_shipped_page`, opened."""
    program = Path(__file__).with_name("as_shipped_page.py")
    with subprocess.Popen([sys.executable, str(program)], stdout=subprocess.PIPE, text=True) as process:
        page = browser.new_page()
        page.set_default_timeout(1e3 * PATIENCE)
        page.goto(f"http://127.0.0.1:{int(process.stdout.readline())}/")
        page.wait_for_function(IDLE)
        page.get_by_role("combobox", name="choice").wait_for()
        page.locator(".bk-Figure").wait_for()
        yield page
        page.close()
        process.terminate()


def test_a_followed_link_is_written_into_the_history_twice(shipped: Page) -> None:
    before = shipped.evaluate("() => history.length")
    shipped.evaluate("""() => {
      const push = history.pushState.bind(history)
      window.pushed = 0
      history.pushState = (...what) => { window.pushed++; push(...what) }
    }""")
    shipped.get_by_role("link", name="there").click()
    shipped.wait_for_function("() => window.pushed > 0")
    assert shipped.evaluate("() => history.length") == before + 2
    assert shipped.evaluate("() => location.hash") == "#there"


def test_every_wish_is_a_pass_over_hidden_parts_too_and_a_size_that_changes_within_is_swallowed(
    shipped: Page,
) -> None:
    passes, hidden = shipped.evaluate(_PASSES)
    assert passes == 5
    assert hidden
    assert shipped.evaluate(_SWALLOWED) == [False, -50]


def test_what_stands_deeper_is_given_no_size_and_ours_is(shipped: Page, plain: Page) -> None:
    assert shipped.evaluate(_REACHED) == ["near"]
    assert plain.evaluate(_REACHED) == ["near", "deep"]


def test_a_choice_does_not_open_by_keyboard(shipped: Page) -> None:
    choice = shipped.get_by_role("combobox", name="choice")
    choice.focus()
    for key in ("Enter", " ", "ArrowDown"):
        shipped.keyboard.press(key)
        shipped.evaluate(_TWO_FRAMES)
        assert choice.get_attribute("aria-expanded") == "false"


def test_models_that_the_server_adds_come_back_whole(shipped: Page) -> None:
    """They are among those that the page sends whole with its next event, though they came from the server."""
    added = shipped.evaluate("""() => {
      const [document] = Bokeh.documents, [root] = document.roots()
      const model = { type: "object", name: "Range1d", id: "from the server", attributes: {} }
      const change = { kind: "ModelChanged", model: { id: root.id }, attr: "tags", new: [model] }
      document.apply_json_patch({ events: [change] })
      return [...document._new_models].some(({ id }) => id === "from the server")
    }""")
    assert added

"""Nothing is drawn over anything else; layout runs once a frame, and no paint does more than it needs to."""

from collections.abc import Callable

import pytest
from on_page import Visit, turn
from playwright.sync_api import Page, expect
from waiting import until

from app.subjects import TABS

# Counts how often the figures that can be seen now are measured from here on.
_COUNT_FIGURES = """() => {
  window.measured = 0
  const count = (view) => {
    if (view.model.type === "Figure" && view.el.offsetParent) {
      const measure = view.update_bbox.bind(view)
      view.update_bbox = () => { window.measured++; return measure() }
    }
    for (const child of view.child_views ?? []) count(child)
  }
  for (const root of Bokeh.index.roots) count(root)
}"""
_COUNT_PASSES = """() => new Promise((done) => {
  const [root] = Bokeh.index.roots, measure = root.measure_layout.bind(root)
  let passes = 0
  root.measure_layout = () => { passes++; measure() }
  for (let i = 0; i < 50; i++) root.compute_layout()
  requestAnimationFrame(() => requestAnimationFrame(() => { delete root.measure_layout; done(passes) }))
})"""

# Parts of one column, row or grid that cover each other by more than a line's breadth; what hangs out of its own box
# counts as part of it.
_OVERLAPS = """() => {
  const found = []
  const walk = (view) => {
    const shown = (view.child_views ?? []).filter((child) => {
      const style = getComputedStyle(child.el)
      return child.el.offsetParent && child.el.offsetHeight > 4 && !["absolute", "fixed"].includes(style.position)
    })
    if (/Column|Row|FlexBox/.test(view.model.type)) {
      const boxes = shown.map(({ el }) => {
        const { left, right, top, bottom } = el.getBoundingClientRect()
        const hangs = getComputedStyle(el).overflowY === "visible" ? el.scrollHeight - el.clientHeight : 0
        return { left, right, top, bottom: bottom + (hangs > 8 ? hangs : 0) }
      })
      boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b, j) => {
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left)
        const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top)
        const name = (child) => `${child.model.type} ${child.el.innerText.slice(0, 40)}`
        if (wide > 4 && high > 4) found.push(`${name(shown[i])} | ${name(shown[i + j + 1])}: ${high}`)
      }))
    }
    shown.forEach(walk)
  }
  for (const root of Bokeh.index.roots) walk(root)
  return found
}"""


# Every source of phase error: the table of them is at its longest.
_SOURCES = "/?ba=0.1mg&bg=0.4deg/h&vl=9Hz:1g&dly=2ms&ul=30Hz:0.01mm&vre=980ug/g^2&lf=10Hz:-60dBc/Hz%3B1kHz:-99dBc/Hz"
_ALL = ("Image", "Close it", "Simulate", "Suborbital", "Budget")


@pytest.mark.parametrize(
    ("path", "width", "height", "names"),
    [
        (_SOURCES, 1440, 900, ("Close it", "Budget")),
        *(
            pytest.param("/", *size, _ALL, marks=pytest.mark.slow)
            for size in ((1280, 720), (1440, 900), (1000, 700), (390, 844))
        ),
    ],
)
def test_no_part_of_a_page_is_drawn_over_another(
    visit: Visit, settled: Callable[[Page], None], path: str, width: int, height: int, names: tuple[str, ...]
) -> None:
    page = visit(path, width=width, height=height)
    page.keyboard.press("Escape")  # where the window is narrow the design is a drawer
    for name in names:
        turn(page, name)
        if name == "Image":
            expect(page.get_by_text("The runs match the design.")).to_be_visible()
        if name == "Simulate":
            page.get_by_role("button", name="Start", exact=True).click()
            expect(page.get_by_role("status").filter(has_text="NEES")).to_be_visible()
        if name == "Suborbital":
            expect(page.get_by_role("heading", name="The star tracker")).to_be_visible()
        if name == "Budget":
            page.get_by_role("button", name="Open" if width > 1240 else "Tools", exact=True).click()
            if width <= 1240:
                page.get_by_role("button", name="Open", exact=True).click()
            expect(page.get_by_role("button", name="L band from a jet")).to_be_in_viewport(ratio=1)
            page.keyboard.press("Escape")
        page.wait_for_function(
            "(name) => location.hash === '#' + name", arg=next(tab.address for tab in TABS if tab.title == name)
        )
        if name == "Close it":
            expect(page.get_by_role("table", name="What reduces")).to_be_visible()
        else:
            expect(page.locator(".bk-Figure:visible").last).to_be_visible()
        settled(page)
        until(lambda: not page.evaluate(_OVERLAPS), f"{name} with nothing drawn over anything else")


def test_only_fonts_of_characters_on_the_page_are_loaded(plain: Page, settled: Callable[[Page], None]) -> None:
    settled(plain)
    loaded = plain.evaluate("""() => [...document.fonts].filter(({ family, status }) => /Roboto/.test(family)
      && status === "loaded").map(({ unicodeRange }) => unicodeRange)""")
    assert loaded
    assert not [ranges for ranges in loaded if "U+400" in ranges or "U+0-10FFFF" in ranges]  # no Cyrillic


def test_fifty_wishes_in_one_frame_are_one_pass(plain: Page, settled: Callable[[Page], None]) -> None:
    settled(plain)
    assert 1 <= plain.evaluate(_COUNT_PASSES) <= 2


@pytest.mark.slow
def test_a_hidden_page_is_not_measured_and_stands_right_when_shown_again(
    visit: Visit, settled: Callable[[Page], None]
) -> None:
    page = visit()
    page.get_by_role("button", name="What limits horizontal position").click()
    regime = page.locator(".bk-Figure").last
    expect(regime).to_be_visible()
    page.evaluate(_COUNT_FIGURES)
    for name in ("Sensors", "Review"):
        page.get_by_role("tab", name=name, exact=True).click()
        expect(regime).to_be_hidden()
        if name == "Sensors":
            expect(page.get_by_text("Analyse a log")).to_be_visible()
            page.evaluate("() => { window.measured = 0 }")
    expect(page.get_by_role("button", name="Save as new design")).to_be_visible()
    page.set_viewport_size({"width": 1100, "height": 800})  # hidden while the window becomes narrower
    settled(page)
    assert page.evaluate("() => window.measured") == 0
    page.get_by_role("tab", name="Budget", exact=True).click()
    expect(regime).to_be_visible()
    page.wait_for_function("() => window.measured > 0")
    settled(page)
    wide = page.evaluate(
        """() => Bokeh.index.roots.map(root => {
          const figures = (view) => [...(view.model.type === "Figure" && view.el.offsetParent ? [view] : []),
            ...(view.child_views ?? []).flatMap(figures)]
          return figures(root).map(v => [v.el.clientWidth, v.bbox.width, v.canvas_view.el.clientWidth])
        }).flat()"""
    )
    assert len(wide) == 5
    for element, measured, canvas in wide:
        assert 200 < element < 1100 - 300
        assert abs(measured - element) <= 1
        assert abs(canvas - element) <= 1

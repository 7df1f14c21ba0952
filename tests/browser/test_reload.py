"""A page loaded again: the design, the study and the revision they came from are still there."""

from collections.abc import Callable

import pytest
from on_page import Visit, turn
from playwright.sync_api import Page, expect

_BACK = "The design you had on this page is back"


def test_the_design_the_study_and_their_revision_outlive_a_reload(visit: Visit) -> None:
    page = visit("/?arw=0.2deg/sqrt(h)#review")
    box = page.get_by_role("textbox", name="Angle random walk", exact=True)
    page.get_by_role("textbox", name="Design", exact=True).fill("Reloaded <b>")
    page.keyboard.press("Enter")
    page.get_by_role("textbox", name="Your name").fill("Ann")
    page.get_by_role("button", name="Save as new design").click()
    following = page.get_by_role("button", name="Save as revision 2 of Reloaded <b>")
    expect(following).to_be_visible()
    box.fill("0.1")
    box.press("Enter")
    expect(box).to_have_value("0.1 °/√h")
    turn(page, "Suborbital")
    page.get_by_role("button", name="Inputs", exact=True).click()
    bias = page.get_by_role("textbox", name="Gyro bias, constant", exact=True)
    bias.fill("7, 8, 9")
    bias.press("Enter")
    expect(bias).to_have_value("7, 8, 9 °/h")

    page.reload()
    expect(page.get_by_role("alert").filter(has_text=_BACK)).to_be_visible()
    expect(box).to_be_hidden()  # the design is folded where it does nothing
    expect(page.get_by_role("textbox", name="Design", exact=True)).to_have_value("Reloaded <b>")
    page.get_by_role("button", name="Inputs", exact=True).click()
    expect(bias).to_have_value("7, 8, 9 °/h")
    page.get_by_role("tab", name="Review", exact=True).click()
    expect(following).to_be_visible()
    expect(box).to_have_value("0.1 °/√h")
    page.get_by_role("button", name="Undo").click()
    expect(box).to_have_value("0.2 °/√h")
    expect(following).to_be_hidden()


def test_a_question_outlives_a_reload_without_a_word_of_the_design(visit: Visit) -> None:
    page = visit("/#close")
    asked = page.get_by_role("button", name="Probability", exact=True)
    asked.click()
    expect(page.get_by_text("Probability of closing")).to_be_visible()
    page.reload()
    expect(asked).to_have_attribute("aria-pressed", "true")
    expect(page.get_by_text(_BACK)).to_have_count(0)


@pytest.mark.slow
def test_a_page_opened_anew_takes_nothing_back_and_nothing_wrong_is_taken(visit: Visit) -> None:
    page = visit()
    box = page.get_by_role("textbox", name="Angle random walk", exact=True)
    page.get_by_role("slider", name="Angle random walk").press("ArrowRight")
    expect(box).to_have_value("0.157 °/√h")
    page = visit()
    page.wait_for_timeout(500)
    expect(box).to_have_value("0.15 °/√h")
    expect(page.get_by_text(_BACK)).to_have_count(0)
    page.evaluate("""() => sessionStorage.setItem("navbudget-design",
        JSON.stringify({at: "/", who: "", link: "arw=<img src=x onerror=alert(1)>", base: "../../x.1"}))""")
    page.reload()
    alert = page.get_by_role("alert").filter(has_text="could not be restored")
    expect(alert).to_contain_text("<img src=x onerror=alert(1)>")
    expect(box).to_have_value("0.15 °/√h")
    page.evaluate("""() => sessionStorage.setItem("navbudget-design",
        JSON.stringify({at: "/", who: "somebody else", link: "arw=0.2deg/sqrt(h)", base: ""}))""")
    page.reload()
    page.wait_for_function("() => JSON.parse(sessionStorage.getItem('navbudget-design')).who === ''")
    page.wait_for_timeout(1500)
    expect(box).to_have_value("0.15 °/√h")
    expect(page.get_by_text(_BACK)).to_have_count(0)


_GROUND = "() => getComputedStyle(document.body).backgroundColor"
_CANVAS = """() => {
  const figures = [...Bokeh.documents[0]._all_models.values()].filter(m => m.type === "Figure")
  return figures.length && figures.map(figure => figure.border_fill_color)  // they come after the first screen
}"""


def _canvas(page: Page) -> list[str]:
    """Colours behind the figures, once there are some."""
    names: list[str] = page.wait_for_function(_CANVAS).json_value()
    return names


@pytest.mark.slow
def test_a_page_in_dark_stays_dark(visit: Visit, settled: Callable[[Page], None]) -> None:
    page = visit()
    light, on_light = page.evaluate(_GROUND), _canvas(page)
    page.get_by_role("button", name="Toggle theme").click()
    page.wait_for_function(f"(before) => ({_GROUND})() !== before", arg=light)
    page.wait_for_function("() => document.cookie.includes('navbudget-theme=dark')")
    page.wait_for_function(f"(light) => ({_CANVAS})().every(colour => !light.includes(colour))", arg=on_light)
    settled(page)
    dark, on_dark = page.evaluate(_GROUND), _canvas(page)
    page = visit()
    settled(page)
    assert page.evaluate(_GROUND) == dark
    assert set(_canvas(page)) == set(on_dark)
    page.get_by_role("button", name="Toggle theme").click()
    page.wait_for_function("() => document.cookie.includes('navbudget-theme=light')")
    page = visit()
    settled(page)
    assert page.evaluate(_GROUND) == light
    assert set(_canvas(page)) == set(on_light)

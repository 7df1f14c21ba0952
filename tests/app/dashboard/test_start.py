"""The first question: each press leads to a task once."""

from app.dashboard.start import StartChoice


def test_each_press_leads_to_its_task_once() -> None:
    """A second time would select the box again, under the first letters typed."""
    choice, led = StartChoice(lambda rows: ""), []
    choice.param.watch(lambda event: led.append(event.new), "chosen", onlychanged=False)
    for pressed in ("My radar", "My radar", "My flight"):
        choice._handle_msg(pressed)
    assert led == ["My radar", "My radar", "My flight"]

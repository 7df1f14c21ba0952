"""The bar of tools: the words of a design, and the file that is saved."""

from app.dashboard.toolbar import Toolbar
from app.examples import EXAMPLES, example
from app.session import Session
from nav_model.design.file import parse_design


def saved(bar: Toolbar) -> bytes:
    files: list[bytes] = []
    bar.bar.give = lambda _, content: files.append(content)  # type: ignore[method-assign]
    bar._do({"do": "save"})
    return files[0]


def test_the_words_of_an_example_are_not_those_of_what_is_made_of_it() -> None:
    """As a report has them: what the example says of itself is wrong of another design."""
    session = Session(example(EXAMPLES[0]))
    bar = Toolbar(session, lambda *_: None)
    assert bar.bar.description == session.design.description
    assert parse_design(saved(bar)) == session.design
    session.change({"gnss.interval": 0.5})
    bar.show(session.budget)
    assert bar.bar.description == ""
    assert parse_design(saved(bar)).description == ""
    session.undo()
    bar.show(session.budget)
    assert bar.bar.description == session.design.description
    session.change({"gnss.interval": 0.5})
    bar.show(session.budget)
    bar.bar.description = "Ours."
    assert session.design.description == "Ours."
    assert parse_design(saved(bar)) == session.design

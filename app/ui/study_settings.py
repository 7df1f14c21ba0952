"""The settings of a study's page, as a part of the link, so that they survive a reload."""

from collections.abc import Callable
from typing import Any
from urllib.parse import parse_qsl, urlencode

import param

from app.session import Session


class StudySettings:
    """Settings of one kind of study, in the session's link.

    Parameters
    ----------
    session : Session
    kind : str
        What the study is called in links.
    of : param.Parameterized
        Has the settings as parameters.
    names : sequence of str
        Of its parameters. One that differs from its default is in the link.
    changed : callable
        Called without arguments when a link has changed the settings.

    Examples
    --------
    >>> settings = StudySettings(session, "sar", page, ("engine", "runs", "seed"), page.recall)
    >>> session.settings["sar"]
    'sar.runs=200'
    """

    def __init__(
        self, session: Session, kind: str, of: param.Parameterized, names: tuple[str, ...], changed: Callable[[], Any]
    ) -> None:
        self._session, self._kind, self._of, self._names = session, kind, of, names
        self._follow()
        of.param.watch(self._tell, list(names))
        session.param.watch(lambda _: self._follow() and changed(), "settings")

    @property
    def text(self) -> str:
        """The settings that are not the usual ones, as a part of a query."""
        usual = type(self._of).param
        pairs = [(name, getattr(self._of, name)) for name in self._names]
        return urlencode([(f"{self._kind}.{name}", value) for name, value in pairs if value != usual[name].default])

    def _tell(self, *_: Any) -> None:
        if self._session.settings.get(self._kind, "") != self.text:
            self._session.settings = {**self._session.settings, self._kind: self.text}

    def _follow(self) -> bool:
        """Apply the link's settings, ignoring unknown ones; return True if any changed."""
        before, query = self.text, self._session.settings.get(self._kind, "")
        if query == before:
            return False
        texts = dict(parse_qsl(query))
        taken: dict[str, Any] = {}
        for name in self._names:
            declared = self._of.param[name]
            value = taken[name] = texts.get(f"{self._kind}.{name}", declared.default)
            if isinstance(declared, param.Selector):
                taken[name] = next((o for o in declared.objects if str(o) == str(value)), declared.default)
        self._of.param.update(**taken)
        return self.text != before

    @property
    def asked(self) -> tuple[str, str, str]:
        """The key of a result with these settings, for `app.work.result_cache`."""
        return self._kind, self._session.design.content_hash, self.text

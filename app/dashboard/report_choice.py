"""The choice of finished studies for the report, and a note on missing ones."""

from typing import Any

from app.report.studies import belonging
from app.session import Session
from app.subjects import STUDIES


class ReportChoice:
    """The studies for a report; every study of the current design is ticked until the user unticks it."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._unticked: set[str] = set()

    def chosen(self) -> dict[str, Any]:
        """The findings to report, by kind; also those of another design, so that the report says that it omits
        them."""
        return {kind: finding for kind, finding in self._session.findings.items() if kind not in self._unticked}

    def tick(self, kind: str, ticked: bool) -> None:
        """Take a study into the report, or leave it out."""
        (self._unticked.discard if ticked else self._unticked.add)(kind)

    def offered(self) -> list[dict[str, Any]]:
        """Studies that can be ticked, as `Bar` shows them."""
        return [
            {"kind": kind, "label": f"{STUDIES[kind].study} in the report", "ticked": kind not in self._unticked}
            for kind, fits in self._fits().items()
            if fits
        ]

    def lacking(self) -> str:
        """Studies that a report written now would omit, in words."""
        waits = self._session.flight_words  # for a flight: the last one is of the design before
        kinds = [kind for kind, fits in self._fits().items() if not fits and not (waits and kind == "trajectory")]
        studies = [STUDIES[kind].study for kind in kinds]
        text = f"Not in the report, because they belong to another design: {', '.join(studies)}."
        lines = [*([text] if studies else []), *([waits] if waits else [])]
        if self._session.running:
            lines.append("A study is still running. A report written now will not include it.")
        return " ".join(lines)

    def _fits(self) -> dict[str, bool]:
        return belonging(self._session.findings, self._session.design) if self._session.findings else {}

"""Ticks of a logarithmic axis on screen: powers of ten as 10ⁿ, and 2 and 5 between them where there is room."""

from __future__ import annotations

from pathlib import Path

from bokeh.models import CustomJSTicker, CustomJSTickFormatter, LogAxis

_LABELS, _MAJOR, _MINOR = (
    Path(__file__).with_name(f"{name}.js").read_text("utf-8") for name in ("power_labels", "log_major", "log_minor")
)


def mark_in_powers(axis: LogAxis) -> None:
    """Tick and label a logarithmic axis."""
    axis.ticker = CustomJSTicker(major_code=_MAJOR, minor_code=_MINOR)
    axis.formatter = CustomJSTickFormatter(code=_LABELS)

"""How the product looks: one accent, quiet surfaces, light and dark."""

from __future__ import annotations

from typing import Any

ACCENT = "#0b5c8a"

_SHARED: dict[str, Any] = {
    # The frame's own progress bar has no name; screen readers need one.
    "MuiLinearProgress": {"defaultProps": {"aria-label": "long work under way"}},
    "MuiTab": {"styleOverrides": {"root": {"textTransform": "none", "minWidth": 0}}},
}

LIGHT: dict[str, Any] = {
    "chart_style": "standard",
    "components": _SHARED,
    "palette": {"primary": {"main": ACCENT}, "background": {"default": "#f6f7f8", "paper": "#ffffff"}},
    "shape": {"borderRadius": 6},
}
DARK: dict[str, Any] = {
    "chart_style": "standard",
    "palette": {
        "primary": {"main": "#6db6e3"},
        "background": {"default": "#10151a", "paper": "#161d24"},
    },
    "shape": {"borderRadius": 6},
    "components": {
        **_SHARED,
        "MuiAppBar": {"styleOverrides": {"root": {"backgroundColor": "#0d2230", "color": "#e8eef2"}}},
    },
}

FRAME = {
    "border": "1px solid color-mix(in srgb, currentColor 22%, transparent)",
    "border-radius": "6px",
}
"""Around a chart; follows the page's text colour, so it holds in the dark."""

NO_STEPPERS: dict[str, Any] = {"& .MuiIconButton-root": {"display": "none"}}
"""Of a field for a number: its stepping buttons have no names, and the arrow keys step as well."""

PRINT_NOTHING = "@media print { :host { display: none !important; } }"
"""Sheet of what has no place on paper: tools, tabs, fields."""

PRINT_PAGE = """
@media print {
  :host { height: auto !important; }
  header, nav, [role=tooltip] { display: none !important; }
  .page, .page > div, .page > div > div, .main, .main > div, .main-content { display: block !important;
    position: static !important; width: auto !important; height: auto !important; max-height: none !important;
    min-height: 0 !important; overflow: visible !important; margin: 0 !important; padding: 0 !important; }
  .main > div > .MuiToolbar-root { display: none !important; }
  .page.mui-dark { print-color-adjust: exact; background: #000 !important; filter: invert(1) hue-rotate(180deg); }
  .page.mui-dark > div, .page.mui-dark > div > div, .mui-dark .main { background: #000 !important; }
}
"""
"""Sheet of the frame: on paper the page alone; a dark one is turned over, and its hues turned back."""

PRINT_WHOLE = "@media print { :host { break-inside: avoid; } }"
"""Sheet of what must not be torn by a page's end."""

# Panes of our own HTML live in shadow roots: each carries this sheet. Colours follow the page's theme through
# currentColor, so there is one sheet for light and dark.
SHEET = """
:host { font-family: Roboto, "Segoe UI", system-ui, sans-serif; font-size: 14px; line-height: 1.4; }
.num { font-variant-numeric: tabular-nums; white-space: nowrap; }
.nw { white-space: nowrap; }
.quiet { opacity: .78; }
.tone.good, .tone.bad { font-weight: 600; }
.hidden { position: absolute; width: 1px; height: 1px; margin: 0; overflow: hidden; clip-path: inset(50%); }
a { color: inherit; text-underline-offset: 2px; }
a.eq { white-space: nowrap; text-decoration: underline dotted; }
.strip { display: flex; flex-wrap: wrap; gap: 6px 28px; align-items: center; padding: 10px 16px;
  border: 1px solid; border-color: color-mix(in srgb, currentColor 25%, transparent);
  border-left: 8px solid; border-radius: 6px; }
.strip.good { border-left-color: #1a7f4b; }
.strip.bad { border-left-color: #c62f2f; }
.strip.open, .strip.warn { border-left-color: #7b8794; }
.strip h2 { font-size: 22px; margin: 0; font-weight: 600; }
.strip p { margin: 0; }
.strip b { font-weight: 600; }
.cards, .scroll, ul.cautions { margin-top: 8px; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(220px, 45%), 1fr));
  gap: 8px; margin-bottom: 0; }
.card { border: 1px solid; border-color: color-mix(in srgb, currentColor 22%, transparent);
  border-radius: 6px; padding: 8px 12px; }
.card dt { font-size: 12.5px; }
.card dd { margin: 0; }
.card .big { font-size: 20px; font-weight: 600; }
.card .fine { font-size: 12px; }
table.checks { border-collapse: collapse; width: 100%; font-size: 13px; }
table.checks th, table.checks td { text-align: left; padding: 4px 10px 4px 0; vertical-align: top;
  border-bottom: 1px solid; border-color: color-mix(in srgb, currentColor 15%, transparent); }
table.checks th.wrap { white-space: normal; }
table.checks th.name { white-space: nowrap; }
table.checks th { font-weight: 500; }
table.checks td.num, table.checks th.num { text-align: right; padding-right: 18px; }
table.checks caption { text-align: left; font-weight: 600; padding: 10px 0 4px; }
table.checks td, table.checks th { overflow-wrap: break-word; }
table.checks td { min-width: 8ch; }
table.checks label { display: flex; align-items: center; gap: 6px; }
table.checks label input { margin: 0; flex: none; }
table.checks th[scope="row"] { min-width: 14ch; max-width: 60ch; }
.scroll { overflow-x: auto; }
.scroll.tall { max-height: 420px; overflow-y: auto; }
.line { display: flex; flex-wrap: wrap; gap: 0 16px; font-size: 13px; overflow-wrap: anywhere; }
.line > .mark { min-width: 17ch; }
.line > .who { min-width: 10ch; }
.tag { border: 1px solid; border-radius: 9px; padding: 0 7px; font-size: 12px; }
.slide { font-size: clamp(18px, 1.8vw, 44px); padding: 1.1em 1.3em; border: 1px solid; border-radius: 6px;
  border-color: color-mix(in srgb, currentColor 25%, transparent); }
.slide h2 { font-size: clamp(30px, 3.8vw, 96px); line-height: 1.15; margin: .2em 0; font-weight: 600; }
.slide p { margin: .35em 0; overflow-wrap: anywhere; }
.slide .figure { font-size: clamp(26px, 3.2vw, 80px); white-space: normal; }
.gauge { position: relative; height: 1.1em; margin: .6em 0; border-radius: 4px;
  background: color-mix(in srgb, currentColor 12%, transparent); }
.gauge div { height: 100%; border-radius: 4px; background: color-mix(in srgb, currentColor 55%, transparent); }
.gauge i { position: absolute; top: -.25em; bottom: -.25em; width: 0; border-left: 5px solid #c62f2f; }
ul.legend { display: flex; flex-wrap: wrap; gap: 2px 16px; list-style: none; margin: 0 0 4px; padding: 0;
  font-size: 12.5px; }
ul.legend svg { vertical-align: -1px; }
.pics { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(200px, 45%), 1fr)); gap: 10px; }
.pair .pics { grid-template-columns: repeat(auto-fill, minmax(min(320px, 100%), 460px)); }
.pic { margin: 0; font-size: 12.5px; }
.pic img { width: 100%; display: block; image-rendering: pixelated; border-radius: 3px; }
.scale { display: flex; gap: 8px; align-items: center; font-size: 12.5px; margin: 2px 0 8px; flex-wrap: wrap; }
.scale img { width: 160px; height: 12px; border-radius: 3px; }
.stale { border: 1px solid #b26a00; border-radius: 4px; padding: 0 6px; font-weight: 600; }
progress { width: 220px; vertical-align: middle; }
.know, .note { font-size: 12.5px; margin: 0; }
.mark { font-weight: 700; }
td.fine, .mark.fine { font-size: 12px; }
td.fine { min-width: 130px; }
table.checks th.source, table.checks td.wide { min-width: 260px; }
table.checks th[scope="colgroup"] { text-align: center; }
.digest { overflow-wrap: anywhere; font-size: 12px; }
progress { width: min(420px, 100%); height: 8px; accent-color: #2b83c4; }
p.name { font-weight: 600; margin: 10px 0 0; }
ul.cautions { padding-left: 18px; font-size: 13px; }
h3 { font-size: 15px; font-weight: 600; margin: 0; }
"""

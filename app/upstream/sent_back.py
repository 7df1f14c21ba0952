"""Models that the server has added to an open page come back whole with the page's next event.

Reports to send upstream, versions and ends: docs/upstream/sent_back.md
"""

import warnings

from bokeh.util.warnings import BokehUserWarning


def expect_known_models() -> None:
    """Take models that come back whole as known, in silence; the server calls it once, before it serves."""
    warnings.filterwarnings("ignore", "reference already known", BokehUserWarning)

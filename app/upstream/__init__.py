"""Overrides of Panel, Bokeh, Tornado and panel-material-ui, one subject a file.

Each file has its reports in `docs/upstream`: what the library does, the version it was written for, the upstream
issue or pull request, and which test shows the library as shipped still doing so: when that test fails, the override
can go. What Numba does otherwise is in `nav_model.base.compiled` and `nav_model.base.numba_typing`, which know no
app; its reports are there as well.
"""

"""Ways of navigating through a synthetic aperture, compared on the same noise, and what they make of the image. [C]

- `strategies`, `strategy_forms`: the ten strategies (sar.md, "Navigation strategies"), and the formulas of some;
- `axis_model`, `axis_filter`, `smoother`, `fast_engine`: the error model of one axis, its filter, its runs;
- `flown_engine`, `flown_smoother`: the same strategies on full runs of the simulator;
- `design_case`, `design_study`, `study`, `decomposition`: a design as a case, and its study;
- `design_map`, `winners`: the best strategy over aperture time and GNSS noise;
- `line_of_sight`, `image`, `back_projection`, `pictures`: from errors to phase and to images.

Geometry, phase budget and impulse response of one aperture are in `nav_model.aperture`.
"""

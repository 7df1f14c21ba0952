"""Figures of a design, or of arrays of designs at once, contributors included.

Everything that explores (solving backwards, ranking, maps, search, uncertainty, sweeps) takes its figures here.
"""

from collections.abc import Collection

import numpy as np

from nav_model.base.arrays import Array
from nav_model.budget.inputs import Inputs
from nav_model.budget.smoothed import model_of
from nav_model.design.figures import REQUIRED


def figures(x: Inputs, names: Collection[str] = REQUIRED) -> dict[str, Array]:
    """One sigma of some figures in the design's processing, in SI: those that `analyse` compares with requirements.

    Parameters
    ----------
    x : Inputs
    names : collection of str
        Figures (`nav_model.design.figures.FIGURES`) and the user's own limits.

    Returns
    -------
    dict
        Name -> array of the inputs' broadcast shape, or of a smaller shape that broadcasts to it; NaN where a design
        would be refused, as it has no line of sight or too long an aperture.
    """
    model = model_of(x)
    limits = {limit.name: (limit.on, limit.at) for limit in x.limits}
    sigmas = {name: model.sigma(*limits.get(name, (name, None))) for name in names}
    imaged = x.imaged
    return sigmas if imaged.all() else {name: np.where(imaged, sigma, np.nan) for name, sigma in sigmas.items()}

"""The figures of a flight in one processing, composed of variances by source and the user's own contributors."""

import numpy as np
from numpy.typing import NDArray

from nav_model.trajectory import aperture
from nav_model.trajectory.aperture import Apertures, shifts_of
from nav_model.trajectory.errors import ErrorModel
from nav_model.trajectory.place import PLACES, beside, places_of
from nav_model.trajectory.result import STATE_AXES, Processed
from nav_model.trajectory.specification import CovarianceSpec

FloatArray = NDArray[np.float64]


def all_sources(spec: CovarianceSpec, model: ErrorModel) -> tuple[str, ...]:
    """The model's sources, those beside the flight, then the user's own contributors."""
    entered = (part.name for parts in spec.contributors.in_figures.values() for part in parts)
    return *model.states.sources, *dict.fromkeys((*beside(spec.inputs), *entered))


def processed(
    spec: CovarianceSpec,
    model: ErrorModel,
    apertures: Apertures,
    variances: FloatArray,
    judged: FloatArray,
    image: FloatArray,
    rest: FloatArray,
    processing: str,
) -> Processed:
    """The figures of one processing.

    Parameters
    ----------
    spec : CovarianceSpec
        The study.
    model : ErrorModel
        Nodes and sources.
    apertures : Apertures
        Those that lie within the flight.
    variances, judged : array (sources, outputs, 9)
        At the outputs, and at the moment that is judged.
    image : array (sources, apertures, COLUMNS)
        Sums of the apertures.
    rest : array
        As `aperture.figures` takes it.
    processing : str
        Real time or post-processed.
    """
    judged, sources, count = np.maximum(judged, 0.0), model.states.sources, len(model.outputs)
    groups = {name: judged[:, :, axes].sum(axis=2) for name, axes in STATE_AXES.items()}
    sigmas = {name: np.sqrt(judged[:, :, axes].sum(axis=0).max(axis=1)) for name, axes in STATE_AXES.items()}
    for name, values in aperture.figures(image, spec.inputs, rest).items():
        groups[name] = np.full((len(sources), count), np.nan)
        groups[name][:, apertures.output] = np.maximum(values, 0.0)
        sigmas[name] = np.sqrt(groups[name].sum(axis=0))
    moved, by_source = (shifts_of(sums) for sums in (image.sum(axis=0), image))
    for name, (sigma, values) in places_of(moved, by_source, spec.inputs).items():
        groups[name], sigmas[name] = np.full((len(values), count), np.nan), np.full(count, np.nan)
        groups[name][:, apertures.output] = np.maximum(values, 0.0)
        sigmas[name][apertures.output] = sigma
    shares = {}
    for name, values in groups.items():
        total = values.sum(axis=0)
        nonzero = np.where(total == 0.0, 1.0, total)  # all of it may be beside the flight
        with np.errstate(invalid="ignore"):
            of_model = dict(zip((*sources, *beside(spec.inputs)), values / nonzero, strict=name in PLACES))
        whole = spec.contributors.composed(name, processing, sigmas[name], of_model)
        sigmas[name], mixed = whole.sigma, dict(whole.shares)
        shares[name] = np.stack([mixed.get(source, 0.0 * total) for source in all_sources(spec, model)])
    states = np.sqrt(np.maximum(variances, 0.0).sum(axis=0))
    return Processed(states[:, 0:3], states[:, 3:6], states[:, 6:9], sigmas, shares)

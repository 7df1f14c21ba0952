"""The error statistics of an image as the element of that name in SICD's XML, version 1.4.0."""

import math
from xml.etree import ElementTree

from nav_model.budget.sicd import ErrorStatistics

NAMESPACE = "urn:SICD:1.4.0"
_NAMES = ("P1", "P2", "P3", "V1", "V2", "V3")


def sicd_xml(statistics: ErrorStatistics) -> bytes:
    """The element ErrorStatistics: composite at the scene's centre, and components in the frame RIC_ECF.

    Over a flat Earth that frame's axes (radial, in track, cross track) are up, along the track and across it. The
    radar's own errors are not known to a navigation budget; its range bias is given as zero.
    """
    ElementTree.register_namespace("", NAMESPACE)
    root = ElementTree.Element(_tag("ErrorStatistics"))
    composite = _add(root, "CompositeSCP")
    for name, value in (("Rg", statistics.range), ("Az", statistics.azimuth), ("RgAz", statistics.correlation)):
        _add(composite, name, value)
    components = _add(root, "Components")
    error = _add(components, "PosVelErr")
    _add(error, "Frame").text = "RIC_ECF"
    sigmas = [math.sqrt(statistics.trajectory[i, i]) for i in range(6)]
    for name, sigma in zip(_NAMES, sigmas, strict=True):
        _add(error, name, sigma)
    correlations = _add(error, "CorrCoefs")
    for i, axis in enumerate(_NAMES):
        for j in range(i + 1, 6):
            _add(correlations, axis + _NAMES[j], statistics.trajectory[i, j] / (sigmas[i] * sigmas[j]))
    _add(_add(components, "RadarSensor"), "RangeBias", 0.0)
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _tag(name: str) -> str:
    return f"{{{NAMESPACE}}}{name}"


def _add(parent: ElementTree.Element, name: str, value: float | None = None) -> ElementTree.Element:
    element = ElementTree.SubElement(parent, _tag(name))
    if value is not None:
        element.text = repr(float(value))  # what is read back is what was written
    return element

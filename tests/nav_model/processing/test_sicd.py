"""Image location errors against sarkit, which propagates errors by SICD volume 3."""

import math
from subprocess import run
from sys import executable

import numpy as np
import pytest
from lxml import etree
from sarkit import wgs84
from sarkit.sicd import projection

from app.document.sicd import NAMESPACE, sicd_xml
from nav_model.budget import analyse
from nav_model.budget.sicd import error_statistics
from nav_model.processing.geolocation import AxisError, ground_covariance, shifts


def metadata(place, heading, right, grazing, distance, speed, squint=0.0):
    """A spotlight image of a plane scene, in sarkit's words, and the axes along the track, across it, up."""
    up = np.array(
        [math.cos(place[0]) * math.cos(place[1]), math.cos(place[0]) * math.sin(place[1]), math.sin(place[0])]
    )
    east = np.array([-math.sin(place[1]), math.cos(place[1]), 0.0])
    along = math.cos(heading) * np.cross(up, east) + math.sin(heading) * east
    across = np.cross(along, up) * (1 if right else -1)  # toward the scene
    target = wgs84.geodetic_to_cartesian([math.degrees(place[0]), math.degrees(place[1]), 0.0])
    flat = math.cos(grazing) ** 2 - math.sin(squint) ** 2
    sight = math.sin(squint) * along + math.sqrt(flat) * across - math.sin(grazing) * up
    antenna = target - distance * sight
    column = speed * along
    normal = np.cross(sight, column) * (1 if right else -1)
    if normal @ up < 0:
        normal = -normal
    row = sight
    col = np.cross(normal / np.linalg.norm(normal), row)
    return (
        projection.MetadataParams(
            Collect_Type="MONOSTATIC", SCP=target, SCP_Lat=math.degrees(place[0]), SCP_Lon=math.degrees(place[1]),
            SCP_HAE=0.0, SCP_Row=500, SCP_Col=500, t_SCP_COA=0.0, ARP_SCP_COA=antenna, VARP_SCP_COA=column,
            SideOfTrack="R" if right else "L", GRAZ_SCP_COA=math.degrees(grazing), NumRows=1000, NumCols=1000,
            FirstRow=0, FirstCol=0, Grid_Type="PLANE", uRow=row, uCol=col, Row_SS=0.3, Col_SS=0.3,
            cT_COA=np.zeros((1, 1)), ARP_Poly=np.stack([antenna, column]), IFA="RMA",
        ),
        (along, across, up),
    )  # fmt: skip


def component(trajectory, axes):
    """The trajectory's covariance (up, along, across), turned to Earth-fixed axes, as sarkit takes it."""
    along, across, up = axes
    turn = np.kron(np.eye(2), np.stack([up, along, across], axis=1))
    return projection.ErrorStatParams(
        component_mono=projection.ComponentErrorStatMono(
            C_AIF_APV=turn @ trajectory @ turn.T, AIF="ECF", VAR_RB=0.0, VAR_CLK_SF=0.0, VAR_TROP=0.0, VAR_IONO=0.0
        ),
        C_UI=np.zeros((2, 2)),
    )


def random_lines(rng):
    mean, slope = np.exp(rng.uniform(math.log(1e-4), math.log(9), 2)), np.exp(rng.uniform(-14, -4, 2))
    both = rng.uniform(-0.9, 0.9, 2) * np.sqrt(mean * slope)
    return AxisError(mean[0], slope[0], both[0]), AxisError(mean[1], slope[1], both[1])


def covariance(level, upright):
    whole = np.zeros((6, 6))
    for axis, line in enumerate((upright, level, level)):
        whole[axis, axis], whole[axis + 3, axis + 3] = line.mean, line.slope
        whole[axis, axis + 3] = whole[axis + 3, axis] = line.covariance
    return whole


@pytest.mark.long
def test_ground_covariance_of_five_hundred_geometries(compared):
    """Half of them broadside, half with a squint of up to 30 degrees forward or backward."""
    rng = np.random.default_rng(2)
    off = []
    for number in range(500):
        right = bool(rng.integers(2))
        place = rng.uniform(-1.4, 1.4), rng.uniform(-3, 3)
        heading, grazing = rng.uniform(0, 2 * math.pi), rng.uniform(0.1, 1.4)
        distance, speed = np.exp(rng.uniform(math.log(500), math.log(1e5))), rng.uniform(20, 250)
        height = np.exp(rng.uniform(math.log(0.01), math.log(30)))
        level, upright = random_lines(rng)
        most = min(math.radians(30), 0.9 * (math.pi / 2 - grazing))
        squint = (number % 2) * rng.uniform(-most, most)
        given, axes = metadata(place, heading, right, grazing, distance, speed, squint)
        sensitive = projection.compute_sensitivity_matrices(given)
        located, *_ = projection.scene_to_image(given, given.SCP)
        sets = projection.compute_projection_sets(given, located)
        stat = component(covariance(level, upright), axes)
        slant = projection.compute_composite_error_no_apo_mono(sets, sensitive, stat)
        point = projection.compute_i2s_error(slant, np.zeros((2, 2)), height**2, sensitive)
        ground = np.stack(axes[:2]) @ point @ np.stack(axes[:2]).T
        moved = shifts(level, upright, grazing, distance, speed, squint)
        ours = ground_covariance(moved, grazing, height, squint)
        sign = 1 if right else -1
        scale = math.sqrt(ground[0, 0] * ground[1, 1])
        off += [float(ours[0]) / ground[0, 0] - 1, float(ours[1]) / ground[1, 1] - 1]
        off.append((float(ours[2]) - ground[0, 1]) / scale)
        off += [float(moved.range) / slant[0, 0] - 1, float(moved.azimuth) / slant[1, 1] - 1]
        off.append((sign * float(moved.covariance) - slant[0, 1]) / math.sqrt(slant[0, 0] * slant[1, 1]))
    oracle = "sarkit 1.8, error propagation of SICD volume 3, 500 geometries"
    compared("Where the image lies on the ground", "P-7", "another program", oracle, off, 1e-6)


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_exported_xml_is_read_back_unchanged(open_design, mode):
    design = open_design.replace({"processing.mode": mode})
    result = error_statistics(design)
    element = etree.fromstring(sicd_xml(result))
    assert element.tag == f"{{{NAMESPACE}}}ErrorStatistics"
    whole = etree.Element(f"{{{NAMESPACE}}}SICD")
    whole.append(element)
    read = projection.ErrorStatParams.from_xml(etree.ElementTree(whole))
    composite = np.array([[result.range**2, 0], [0, result.azimuth**2]])
    composite[0, 1] = composite[1, 0] = result.correlation * result.range * result.azimuth
    np.testing.assert_allclose(read.C_SCP_RGAZ, composite, rtol=1e-15)
    assert read.component_mono.AIF == "RIC_ECF"
    np.testing.assert_allclose(read.component_mono.C_AIF_APV, result.trajectory, rtol=1e-14)
    budget = analyse(design)
    placed = [budget[name, mode].sigma for name in ("range_shift", "azimuth_shift")]
    assert (result.range, result.azimuth) == pytest.approx(tuple(placed), rel=1e-9)
    schema(whole)


def schema(whole):
    """The element against SICD's own schema."""
    from importlib.resources import files

    text = (files("sarkit.sicd") / "schemas" / "SICD_schema_V1.4.0_2024_05_01.xsd").read_bytes()
    here = b'<xs:element name="SICD">'
    text = text.replace(here, b'<xs:element name="ErrorStatistics" type="ErrorStatisticsType"/>' + here, 1)
    etree.XMLSchema(etree.fromstring(text)).assertValid(whole[0])


def test_command_writes_the_same_file(open_design, tmp_path):
    from nav_model.design.file import format_design

    path = tmp_path / "design.toml"
    path.write_text(format_design(open_design))
    done = run([executable, "-m", "app", "evaluate", str(path), "--sicd"], capture_output=True, check=True)
    assert done.stdout == sicd_xml(error_statistics(open_design))

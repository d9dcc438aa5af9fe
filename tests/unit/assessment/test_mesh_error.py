"""The estimate of what the mesh does to pressures: where it is zero, where it is, how near."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

import faying as fy
from faying.assessment.mesh_error import mesh_errors, smoothings
from faying.exceptions import ModelError
from faying.interface.smoothing import smoothing

LOAD = fy.Load({"tip.Fz": -500.0})


def tightened(**options):
    joint = fy.lap_joint(hole_radius=None, penalty=8.4e5, **options)
    return fy.preload(joint, {"bolt": 10e3})


@pytest.fixture(scope="module")
def coarse():
    return tightened(element_size=5.0)


@pytest.mark.parametrize("shape", ["hex8", "hex20", "tet4", "tet10", "wedge6"])
@pytest.mark.parametrize("quadrature", ["gauss", "nodal"])
def test_a_uniform_pressure_has_no_error(shape, quadrature):
    model = fy.lap_joint(element_size=10.0, shape=shape, quadrature=quadrature)
    pressure = np.full(model.contact.n_points, 7.0)
    found = mesh_errors(smoothings(model), model, pressure)["joint"]
    # Averages and shape functions add up to one.
    assert max(found.field, found.largest) < 1e-12


def test_a_uniform_pressure_has_no_error_where_meshes_do_not_match():
    model = fy.lap_joint(element_size=10.0, upper_element_size=7.0)
    pressure = np.full(model.contact.n_points, 7.0)
    found = mesh_errors(smoothings(model), model, pressure)["joint"]
    assert found.largest < 1e-12


@pytest.mark.parametrize("quadrature", ["gauss", "nodal"])
def test_a_linear_pressure_has_an_error_at_the_rim_alone(quadrature):
    model = fy.lap_joint(element_size=2.5, quadrature=quadrature, hole_radius=None)
    interface = model.interfaces["joint"]
    x = interface.points[:, 0]
    smooth = smoothings(model)["joint"]
    pressure = 10.0 + x / 4
    error = np.abs(smooth @ pressure - pressure)
    inner = np.abs(x) < 20.0 - 2.5  # one row of bricks off the ends of the overlap
    assert error[inner].max() < 1e-12 * pressure.max()
    assert error[~inner].max() > 0.01  # averages there lie on one side


@pytest.mark.parametrize(
    ("size", "options"), [(5.0, {}), (10.0, {"shape": "tet10"}), (5.0, {"penalty": "hard"})]
)
def test_it_comes_near_to_what_a_finer_mesh_shows(size, options):
    options = {"penalty": 8.4e5} | options
    joints = [
        fy.preload(fy.lap_joint(element_size=h, hole_radius=None, **options), {"bolt": 10e3})
        for h in (size, size / 2)
    ]
    ours, finer = (fy.solve_static(joint, LOAD) for joint in joints)
    places = [joint.interfaces["joint"].points[:, :2] for joint in joints]
    truth = LinearNDInterpolator(places[1], finer.pressure)(places[0])
    outside = np.isnan(truth)
    truth[outside] = NearestNDInterpolator(places[1], finer.pressure)(places[0][outside])
    weights = joints[0].interfaces["joint"].weights
    error = (ours.pressure - truth) / ours.max_pressure
    field = np.sqrt(weights @ error**2 / weights[ours.pressure > 0].sum())
    estimate = fy.mesh_error(joints[0], ours)["joint"]
    # Measured 1.3, 1.2 and 0.7: what docs/how-to/choose_the_mesh.md says of joints with edges.
    assert 0.3 < estimate.field / field < 2.0
    assert 0.2 < estimate.largest / np.abs(error).max() < 2.0


def test_of_several_cases_the_one_with_the_largest_pressure_counts(coarse):
    loads = [LOAD, fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}), fy.Load({})]
    several = fy.solve_static_cases(coarse, loads)
    largest = fy.solve_static(coarse, loads[int(several.max_pressure.argmax())])
    both = [fy.mesh_error(coarse, one)["joint"] for one in (several, largest)]
    # The cases are solved one after the other from different starts.
    assert both[0].field == pytest.approx(both[1].field, rel=1e-9)


def test_an_interface_without_pressure_is_left_out(coarse):
    loose = fy.lap_joint(element_size=5.0, hole_radius=None, penalty=8.4e5)
    assert fy.mesh_error(loose, fy.solve_static(loose, fy.Load({"tip.Fz": 1.0}))).keys() <= {
        "joint"
    }
    assert mesh_errors(smoothings(coarse), coarse, np.zeros(coarse.contact.n_points)) == {}


def test_a_model_with_other_points_is_refused(coarse):
    other = fy.lap_joint(element_size=10.0)
    with pytest.raises(ModelError, match="contact points, the model"):
        fy.mesh_error(other, fy.solve_static(coarse, LOAD))


def test_under_nodal_quadrature_the_field_is_read_between_the_nodes():
    joint = tightened(element_size=5.0, quadrature="nodal")
    interface = joint.interfaces["joint"]
    pressure = fy.solve_static(joint, LOAD).pressure
    assert interface.quadrature == "nodal"
    # Averages of points at the nodes are the points themselves, which would hide every error.
    np.testing.assert_array_equal(interface.nodal_average(pressure), pressure)
    nodes = joint.assembly.mesh.nodes
    assert np.abs(smoothing(interface, nodes) @ pressure - pressure).max() > 1.0
    named = replace(interface, quadrature="gauss-2")
    assert np.abs(smoothing(named, nodes) @ pressure - pressure).max() < 1e-9

"""Initial gap fields: exact equivalences, Hertz, interpolation, and files with faults."""

import numpy as np
import pytest
import scipy.linalg as la
from hertz import LineContact

import faying as fy
from faying.exceptions import FormatError, ModelError
from faying.interface.gap_field import (
    gap_from_nodes,
    gap_from_points,
    read_gap_field,
    with_gap_offset,
)


def offset(model, name, value):
    return model.with_interfaces({name: with_gap_offset(model.interfaces[name], value)})


@pytest.fixture(scope="module")
def interface(joint):
    return joint.interfaces["joint"]


def test_a_shim_under_a_loose_bolt_is_a_shorter_bolt(joint):
    """The upper plate hangs on the bolt alone, so a shim δ only stretches it: N₀ grows by k δ."""
    tall = 0.02
    stiffness, locked = joint.bolts["bolt"].stiffness, joint.bolts["bolt"].initial_force
    load = {"tip.Fz": -300.0, "tip.Mx": 8e3}
    shimmed = fy.solve_static(offset(joint, "joint", -tall), fy.Load(load))
    tighter = {"bolt": locked + stiffness * tall}
    tightened = fy.solve_static(joint, fy.Load(load, bolt_forces=tighter))
    # Two ways through the same flexibility: round-off times its condition.
    assert fy.compare(shimmed, tightened).max_relative_error < 1e-9
    assert shimmed.bolt_force("bolt") == pytest.approx(tightened.bolt_force("bolt"), rel=1e-9)
    lift = shimmed.displacement("tip")[2] - tightened.displacement("tip")[2]
    assert lift == pytest.approx(tall, rel=1e-6)  # the whole upper plate is that much higher


def test_a_gap_that_no_bolt_closes_leaves_no_pressure(joint):
    wide = offset(joint, "joint", 10.0)
    assert fy.solve_static(wide).max_pressure == 0.0


def test_a_parabola_on_a_half_plane_gives_hertz():
    """Condensed problem with the closed-form compliance of an elastic half-plane."""
    n, half, modulus, load, radius = 400, 1.0, 1e5, 100.0, 500.0
    cell = 2 * half / n
    x = (np.arange(n) + 0.5) * cell - half
    # Displacement under uniform pressure strips relative to far away (Johnson 1985, Eq. 2.30d):
    # −2/(π E*) ∫ ln|x − ξ| dξ, plus a constant that only shifts the rigid approach.
    left, right = x[:, None] - x + cell / 2, x[:, None] - x - cell / 2

    def primitive(t):
        return t * np.log(np.abs(t))

    H = -2 / (np.pi * modulus) * (primitive(left) - primitive(right)) / cell
    H = (H + H.T) / 2 + 1e-3  # the constant makes H definite: a soft spring that carries the body
    line = LineContact(load=load, radius=radius, modulus=modulus)
    gap = line.initial_gap(x)

    def force(approach):
        return fy.contact_problem(H, gap - approach).solve().forces

    approach = 0.0
    for _ in range(20):  # secant on the approach; the force is smooth and convex in it
        step = 1e-6
        miss = load - force(approach).sum()
        slope = (force(approach + step).sum() - force(approach).sum()) / step
        if abs(miss) < 1e-9 * load:
            break
        approach += miss / slope if slope > 0 else 0.1
    pressure = force(approach) / cell
    # Half a cell at the edge, where √ is steep; a is 42 cells wide.
    assert np.abs(pressure - line.pressure(x)).max() < 0.05 * line.peak_pressure
    assert pressure.max() == pytest.approx(line.peak_pressure, rel=2e-3)
    assert la.norm(pressure - pressure[::-1]) < 1e-6 * la.norm(pressure)


def crown(points):
    return points[:, 0] ** 2 / (2 * 5e3) + 1e-3 * points[:, 1]


def test_offset_of_each_point(joint, interface):
    field = crown(interface.points)
    model = offset(joint, "joint", field)
    np.testing.assert_allclose(model.contact.initial_gap, interface.initial_gap + field)
    with pytest.raises(ModelError, match="finite number for each"):
        with_gap_offset(interface, np.zeros(3))


def test_a_crowned_plate_presses_in_its_middle(joint, interface):
    """A bulge away from the edges takes pressure from where the gap is."""
    flat = fy.solve_static(joint)
    field = 2e-5 * (interface.points[:, 0] ** 2 + interface.points[:, 1] ** 2)
    crowned = offset(joint, "joint", field)
    crowned = crowned.with_bolt_forces(fy.tighten(crowned, {"bolt": 10e3}).initial_forces)
    bulged = fy.solve_static(crowned)
    assert bulged.contact_force() == pytest.approx(flat.contact_force(), rel=1e-9)
    assert bulged.open_fraction() > flat.open_fraction()
    assert bulged.max_pressure > flat.max_pressure


def linear(points):
    return 0.01 + 2e-3 * points[:, 0] - 1e-3 * points[:, 1]


def test_samples_of_a_linear_field_reproduce_it_in_any_position(interface):
    corners = interface.points.min(axis=0) - 1, interface.points.max(axis=0) + 1
    samples = np.random.default_rng(0).uniform(*corners, (60, 3))
    box = [[x, y, 0.0] for x in (-30, 30) for y in (-15, 15)]
    samples = np.vstack([samples, box])
    # Linear on triangles reproduces a linear field to round-off.
    np.testing.assert_allclose(
        gap_from_points(interface, samples, linear(samples)), linear(interface.points), atol=1e-12
    )


def test_outside_the_samples_the_nearest_counts(interface):
    samples = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    field = gap_from_points(interface, samples, np.array([1.0, 1.0, 1.0]))
    np.testing.assert_allclose(field, 1.0, rtol=1e-12)


def test_samples_on_a_line_are_refused(interface):
    with pytest.raises(ModelError, match="one line"):
        gap_from_points(interface, np.outer(np.arange(5.0), [1, 0, 0]), np.zeros(5))
    with pytest.raises(ModelError, match="do not match"):
        gap_from_points(interface, np.zeros((4, 3)), np.zeros(5))


def test_nodes_of_both_sides_add_up(joint, interface):
    mesh = joint.assembly.mesh
    minus, plus = mesh.node_ids[interface.pairs].T
    field = linear(mesh.nodes[interface.pairs[:, 0]])
    one = gap_from_nodes(interface, mesh.node_ids, minus.tolist(), field)
    # Shape functions reproduce a linear field to round-off.
    np.testing.assert_allclose(one, linear(interface.points), atol=1e-12)
    nodes = np.concatenate([minus, plus]).tolist()
    both = gap_from_nodes(interface, mesh.node_ids, nodes, np.concatenate([field, 0.5 * field]))
    np.testing.assert_allclose(both, 1.5 * one, atol=1e-12)


def test_missing_and_repeated_nodes_are_named(joint, interface):
    ids = joint.assembly.mesh.node_ids
    minus = ids[interface.pairs[:, 0]]
    with pytest.raises(ModelError, match=f"1 of {len(minus)} node pairs.* {minus[0]} and"):
        gap_from_nodes(interface, ids, minus[1:].tolist(), np.zeros(len(minus) - 1))
    with pytest.raises(ModelError, match=f"names node {minus[3]} twice"):
        gap_from_nodes(interface, ids, [*minus.tolist(), int(minus[3])], np.zeros(len(minus) + 1))
    with pytest.raises(ModelError, match="no value"):
        gap_from_nodes(interface, ids, [], np.zeros(0))


def test_files(tmp_path, joint, interface):
    mesh = joint.assembly.mesh
    rows = [*interface.points.tolist(), [-40.0, -20, 0], [40, -20, 0], [-40, 20, 0], [40, 20, 0]]
    points = tmp_path / "points.csv"
    gaps = linear(np.array(rows)).tolist()
    lines = [",".join(map(repr, [gap, *row])) for gap, row in zip(gaps, rows, strict=True)]
    points.write_text("# measured\ngap, X, Y, Z\n" + "\n".join(lines))
    expected = linear(interface.points)
    np.testing.assert_allclose(
        read_gap_field(points, interface, mesh.node_ids), expected, atol=1e-12
    )
    nodes = tmp_path / "nodes.csv"
    pairs = interface.pairs[:, 1]
    lines = [f"{mesh.node_ids[i]},{float(linear(mesh.nodes[[i]])[0])!r}" for i in pairs]
    nodes.write_text("node,gap\n" + "\n".join(lines))
    np.testing.assert_allclose(
        read_gap_field(nodes, interface, mesh.node_ids), expected, atol=1e-12
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("a,b\n1,2\n", "columns are 'a,b'"),
        ("node,gap\n1,0.1\n2,x\n", r"(?s)field\.csv: .*line 3: found 'x' in column 'gap'"),
        ("node,gap\n1,nan\n", "line 2: found 'nan'"),
        ("x,y,z,gap\n1,2,3\n", "found 3 cells, expected 4"),
        ("node,gap\n", "no lines below"),
        ("node,gap\n1.5,0\n", "whole numbers"),
    ],
)
def test_faults_are_named(tmp_path, joint, interface, text, message):
    path = tmp_path / "field.csv"
    path.write_text(text)
    with pytest.raises(FormatError, match=message):
        read_gap_field(path, interface, joint.assembly.mesh.node_ids)


def test_missing_file_is_named(tmp_path, joint, interface):
    with pytest.raises(FormatError, match="nowhere"):
        read_gap_field(tmp_path / "nowhere.csv", interface, joint.assembly.mesh.node_ids)

"""Meshes that do not match, against exact answers and against meshes that do."""

import logging
from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.contact.laws import normal_law
from faying.exceptions import ModelError
from faying.interface.curved_surface import standing_off
from faying.interface.gap_field import gap_from_nodes
from faying.interface.mortar import find_couplings
from faying.interface.pairing import pair_facets
from faying.interface.zero_thickness import build_interface
from faying.joint.build import build_model
from faying.joint.lap_joint import lap_joint_assembly
from faying.joint.sticking import sticking_stiffness, stuck_pairs
from faying.model.specs import InterfaceSpec
from faying.simulation.newton import solve_static_newton
from mortar_blocks import (
    SIZE,
    SPEC,
    all_closed,
    bent,
    blocks,
    mortar,
    nodal_forces,
    pressure_loads,
    squeezed,
    turned,
    unconstrained,
)

KINDS = [
    ("hex8", "hex8"),  # quad4 on quad4
    ("tet4", "hex8"),  # tri3 on quad4
    ("hex8", "tet4"),
    ("tet4", "tet4"),
    ("hex20", "hex20"),  # quad8 on quad8
    ("tet10", "tet10"),  # tri6 on tri6
    ("hex20", "tet10"),
    ("tet10", "hex8"),
    ("wedge6", "hex20"),
]
RULES = ("gauss", "nodal")
COUNTS = (4, 4), (6, 5)
INSIDE = turned(0.35, 0.62, (0.3, -0.2))
"""Puts the upper block wholly on the lower one, askew."""

every_kind = pytest.mark.parametrize(("below", "above"), KINDS)
both_rules = pytest.mark.parametrize("quadrature", RULES)


def arch(curvature):
    return lambda nodes: nodes - 0.5 * curvature * np.outer(nodes[:, 0] ** 2, [0.0, 0.0, 1.0])


def tube(radius):
    """Bend the blocks around the y axis; the surface between them has this radius."""

    def shape(nodes):
        distance, angle = radius + nodes[:, 2], nodes[:, 0] / radius
        x, z = distance * np.sin(angle), distance * np.cos(angle) - radius
        return np.column_stack([x, nodes[:, 1], z])

    return shape


def lifted(height):
    return lambda nodes: np.add(nodes, [0.0, 0.0, height])


def pair(below, above, counts=COUNTS, **options):
    return blocks((counts[0], below), (counts[1], above), **options)


class TestContactPatch:
    @every_kind
    @pytest.mark.parametrize(
        ("penalty", "quadrature", "near"),
        # Everything is a polynomial and integrated exactly; rounding of some 1000 unknowns. Saddle-
        # point equations mix stiffnesses of 1e6 with gaps of 1: six digits less.
        [(1e5, "gauss", 1e-12), (1e5, "nodal", 1e-12), ("hard", None, 1e-8)],
    )
    def test_uniform_pressure_on_flat_faces(self, below, above, penalty, quadrature, near):
        counts = (4, 4), (6, 6)  # even, so that there are nodes to be held at x = 0 and y = 0
        model, loads = squeezed(pair(below, above, counts), penalty, quadrature=quadrature)
        assert model.interfaces["joint"].quadrature.startswith(quadrature or "nodal")
        np.testing.assert_allclose(all_closed(model, loads), 100.0, rtol=near)

    @every_kind
    def test_distorted_facets(self, below, above):
        """Shape functions of irregular quadrilaterals are no polynomials of position."""
        counts = (4, 4), (6, 6)
        model, loads = squeezed(pair(below, above, counts, distort=0.2), 1e5)
        # Degree 12 on segments leaves 1e-11; supports at x = 0 no longer hold whole planes, so
        # loads, not supports, must keep the stress uniform: still exact.
        np.testing.assert_allclose(all_closed(model, loads), 100.0, rtol=1e-9)

    @pytest.mark.parametrize("penalty", [1e5, "hard"])
    @pytest.mark.parametrize(
        ("curve", "bound"),
        [
            # Measured 1.1e-4 for penalty, 1.5e-4 for hard contact; and 9e-4 around a tube whose
            # facets of 1.25 mm turn by 1.4° each.
            (arch(4e-3), 3e-4),
            (tube(50.0), 1.5e-3),
        ],
    )
    def test_uniform_pressure_on_curved_faces(self, curve, bound, penalty):
        model, loads = squeezed(pair("hex8", "hex8", ((8, 8), (12, 12))), penalty, curve=curve)
        pressure = all_closed(model, loads)
        # Facets of the two sides are chords of different lengths: areas and normals differ by
        # (h/R)², and of their distance (1e-3 of the size; pressures of 100 are gaps of 1e-3 mm)
        # the smooth surfaces leave a thousandth.
        np.testing.assert_allclose(pressure, 100.0, rtol=bound)

    @pytest.mark.long
    def test_deviation_on_curved_faces_is_of_second_order(self):
        off = []
        for n in (4, 8, 16):
            flat = pair("hex8", "hex8", ((n, n), (3 * n // 2, 3 * n // 2)))
            pressure = all_closed(*squeezed(flat, 1e5, curve=arch(4e-3)))
            off.append(np.sqrt(np.mean((pressure / 100 - 1) ** 2)))
        # Measured 1.6e-4, 3.6e-5, 9.2e-6: factors 4.4 and 3.9.
        assert off[0] > 3.5 * off[1] > 3.5 * 3.5 * off[2]

    @pytest.mark.parametrize("kinds", [("hex20", "hex20"), ("tet10", "tet10")])
    def test_quadratic_facets_follow_curved_faces_better(self, kinds):
        counts = (4, 4), (6, 6)
        quadratic = all_closed(*squeezed(pair(*kinds, counts=counts), 1e5, curve=arch(4e-3)))
        np.testing.assert_allclose(quadratic, 100.0, rtol=2e-4)  # measured 8e-5


def consistent_error(assembly, quadrature):
    """Return how far nodal forces of the plus side are from its consistent loads, of the largest.

    It is pressed evenly, and lies wholly on the minus side.
    """
    joint = mortar(assembly, quadrature=quadrature)
    forces = nodal_forces(joint, np.full(joint.n_points, 7.0))
    outside = assembly.mesh.exterior
    upper = (np.abs(assembly.mesh.nodes[outside.nodes[:, :3], 2]) < 1e-9).all(axis=1)
    upper &= outside.properties == 2
    expected = pressure_loads(assembly, outside.taken(upper), 7.0)
    own = assembly.mesh.bodies == 1
    return np.abs(forces[own] - expected[own]).max() / np.abs(expected).max()


class TestBalance:
    @every_kind
    @both_rules
    def test_plus_side_gets_its_consistent_loads(self, below, above, quadrature):
        """The plus side lies wholly on the minus side, whose facets are partly covered."""
        assembly = pair(below, above, ((5, 4), (4, 5)), move=INSIDE)
        # Rounding of sums over a hundred segments.
        assert consistent_error(assembly, quadrature) < 1e-12

    @both_rules
    @pytest.mark.parametrize("kinds", [("hex8", "hex8"), ("hex20", "hex20")])
    def test_so_does_it_where_facets_are_distorted(self, kinds, quadrature):
        assembly = pair(*kinds, counts=((5, 4), (4, 5)), move=INSIDE, distort=0.2)
        # Quadrature of rational functions: measured 9e-9 on quad4, 3e-7 on quad8; 8e-5 and 2e-4
        # without corrected weights.
        assert consistent_error(assembly, quadrature) < 1e-6

    @both_rules
    @pytest.mark.parametrize(("curvature", "arm"), [(1e-3, 2e-9), (1e-2, 2e-7)])
    def test_moment_on_curved_faces(self, curvature, arm, quadrature):
        flat = pair("hex8", "hex8", ((8, 8), (12, 10)))
        assembly = bent(flat, arch(curvature))
        joint = mortar(assembly, quadrature=quadrature)
        pressure = np.random.default_rng(1).uniform(0, 100, joint.n_points)
        forces = nodal_forces(joint, pressure)
        size = joint.weights @ pressure
        np.testing.assert_allclose(forces.sum(axis=0) / size, 0, atol=1e-13)
        moment = np.cross(assembly.mesh.nodes, forces).sum(axis=0)
        # The two polygons are up to κ h²/8 apart (2e-3 mm at κ = 0.01), nearly along the forces:
        # the line of a force misses its partner's by 8e-8 mm, measured, and 8e-10 at κ = 0.001.
        np.testing.assert_allclose(moment / size, 0, atol=arm)


def ring(nodes):
    """Bend the blocks about z within the surface: radii from 4 to 12, 96 degrees."""
    radius, angle = 8 + nodes[:, 1], -nodes[:, 0] / 6
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), nodes[:, 2]])


class TestGeometry:
    @pytest.mark.parametrize(
        ("kinds", "off"),
        # Facets of 12° below and 8° above. Quadratic ones follow the circles with half the
        # chords; measured 1.1e-3, 6.6e-4, and 8.1e-3 where the coarse polygon is the overlap.
        [(("hex20", "hex20"), 1.5e-3), (("tet10", "tet10"), 1.5e-3), (("hex8", "hex8"), 0.01)],
    )
    @both_rules
    def test_sides_curved_within_the_surface(self, kinds, off, quadrature):
        joint = mortar(bent(pair(*kinds, counts=((8, 4), (12, 6))), ring), quadrature=quadrature)
        area = (12**2 - 4**2) / 2 * SIZE[0] / 6
        assert joint.area == pytest.approx(area, rel=off)
        assert joint.weights.min() > 0
        forces = nodal_forces(joint, np.ones(joint.n_points))
        np.testing.assert_allclose(forces.sum(axis=0), 0, atol=1e-10 * area)

    @both_rules
    def test_area_of_a_curved_overlap(self, quadrature):
        """Quadratic facets stand off the planes they are clipped in: by 3.6° at their corners."""
        curvature, flat = 5e-2, pair("hex20", "hex20", move=INSIDE)
        joint = mortar(bent(flat, arch(curvature)), quadrature=quadrature)
        points, weights = np.polynomial.legendre.leggauss(20)
        x, y = 0.62 * np.array(np.meshgrid(points, points)).reshape(2, -1) * SIZE[:2, None] / 2
        across = np.cos(0.35) * x - np.sin(0.35) * y + 0.3
        dense = np.sqrt(1 + (curvature * across) ** 2) * np.outer(weights, weights).ravel()
        area = dense.sum() * np.prod(0.62 * SIZE[:2] / 2)
        assert area > 1.003 * np.prod(0.62 * SIZE[:2])
        # Measured 5e-5: chords of the upper block's rim stand 0.03 mm off the lower facets, and
        # are projected along normals that lean by up to 10°.
        assert joint.area == pytest.approx(area, rel=1e-4)

    def test_facets_covered_by_next_to_nothing_are_left_out(self):
        """The upper block reaches 1e-7 of a facet into the next column of facets."""
        shift = 5.0 - 2.5e-7
        (coupling,) = find_couplings(
            pair("hex8", "hex8", ((4, 4), (4, 4)), move=turned(0.0, 1.0, (shift, 0.0))), SPEC
        ).values()
        assert len(coupling.segments.minus) == 8
        assert coupling.weights.sum() == pytest.approx(SIZE[1] * 5.0, rel=1e-12)
        assert coupling.coverage.min() > 0.99

    def test_nodes_that_hardly_touch_share_a_contact_point(self):
        """Hard contact could not tell the forces of points apart that see the same corner."""
        shift = 4.99
        assembly = pair("hex8", "hex8", ((4, 4), (4, 4)), move=turned(0.0, 1.0, (shift, 0.0)))
        joint = mortar(assembly, np.inf)
        # Three rows of four facets, the third covered by 0.4 %: its five outer nodes have joined.
        assert len(joint.pairs) == 20
        assert joint.n_points == 15
        values = np.linalg.svd(joint.point_shape.toarray(), compute_uv=False)
        assert values[-1] > 0.3 * values[0]
        assert joint.area == pytest.approx(SIZE[1] * (SIZE[0] - shift), rel=1e-12)

    def test_points_lie_on_the_overlap(self):
        joint = mortar(pair("hex8", "tet4", move=INSIDE))
        back = (joint.points[:, :2] - [0.3, -0.2]) / 0.62
        c, s = np.cos(0.35), np.sin(0.35)
        inside = np.abs(back @ [[c, -s], [s, c]]) <= SIZE[:2] / 2 + 1e-9
        assert inside.all()

    @both_rules
    def test_nodal_points_stay_in_the_overlap_too(self, quadrature):
        """Nodes may lie far outside; what is averaged for them does not."""
        joint = mortar(pair("hex8", "hex8", ((5, 4), (9, 7)), move=INSIDE), quadrature=quadrature)
        reach = np.linalg.norm(SIZE[:2] / 2) * 0.62 + np.linalg.norm([0.3, -0.2])
        slack = 1.0 if quadrature == "nodal" else 0.0  # half a facet: blended with the nodes
        assert np.linalg.norm(joint.points[:, :2], axis=1).max() < reach + slack

    @every_kind
    def test_a_uniform_gap_is_found(self, below, above):
        apart = pair(below, above, move=lambda nodes: lifted(0.01)(INSIDE(nodes)))
        joint = mortar(apart, tolerance=0.02)
        np.testing.assert_allclose(joint.initial_gap, 0.01, rtol=1e-9)
        with pytest.raises(ModelError, match=r"0\.01 apart \(tolerance 0\.005\)"):
            mortar(pair(below, above, move=lifted(0.01)), tolerance=0.005)

    @both_rules
    def test_a_wedge_is_linear(self, quadrature):
        wedge = pair("hex8", "hex8", move=lambda n: n + 1e-3 * np.outer(n[:, 0] + 5, [0, 0, 1]))
        joint = mortar(wedge, tolerance=0.05, quadrature=quadrature)
        expected = 1e-3 * (joint.points[:, 0] + 5)
        np.testing.assert_allclose(joint.initial_gap, expected, atol=1e-12)

    @pytest.mark.parametrize("clearance", [0.0, 1e-3, 1e-2])
    def test_the_gap_of_tubes_is_that_of_circles_not_of_polygons(self, clearance):
        radius = 50.0
        flat = pair("hex8", "hex8", ((8, 8), (12, 10)), move=lifted(clearance))
        joint = mortar(bent(flat, tube(radius)), tolerance=0.05)
        # The polygons are (1.25 mm)²/8R = 4e-3 apart; smooth surfaces leave (h/R)⁴ R/400.
        np.testing.assert_allclose(joint.initial_gap, clearance, atol=1e-6)

    def test_a_cylinder_on_a_plane(self):
        """Only the plus side is curved; its gap is that of the parabola at every contact point."""
        flat = pair("hex8", "hex8", ((10, 4), (14, 6)))
        nodes = flat.mesh.nodes.copy()
        upper = flat.mesh.bodies == 1
        nodes[upper, 2] += 0.5 * nodes[upper, 0] ** 2 / 400.0
        joint = mortar(bent(flat, lambda _: nodes), tolerance=0.1)
        expected = joint.points[:, 0] ** 2 / 800.0
        # Relative displacements are linear on a facet: h²/8R = 3e-4.
        np.testing.assert_allclose(joint.initial_gap, expected, atol=3.2e-4)
        assert abs(joint.weights @ (joint.initial_gap - expected)) / joint.area < 1e-4

    def test_sides_that_are_covered_twice_are_refused(self):
        flat = pair("hex8", "hex8")
        every = replace(SPEC, minus="lower", plus="auto", tolerance=3.5)
        # Both faces of the upper block lie within the tolerance, but only one faces the other way;
        # a copy of the upper block does it.
        assert len(find_couplings(flat, every)) == 1
        (coupling,) = find_couplings(flat, SPEC).values()
        corners = coupling.segments.plus.nodes[:, :4]
        faces = np.vstack([corners, corners])
        double = replace(flat, face_sets={"both": faces})
        with pytest.raises(ModelError, match="covered more than once"):
            mortar(double, plus="both")


class TestMatchingMeshes:
    @both_rules
    @pytest.mark.parametrize("shape", ["hex8", "tet4", "wedge6"])
    @pytest.mark.parametrize("curvature", [0.0, 2e-3])
    def test_give_the_same_interface_either_way(self, shape, curvature, quadrature):
        joint = lap_joint_assembly(element_size=5.0, shape=shape, curvature=curvature)
        spec = InterfaceSpec(name="joint", minus="lower", plus="upper", quadrature=quadrature)
        dofs = unconstrained(joint.assembly)
        zero = build_interface(
            joint.assembly, dofs, spec, pair_facets(joint.assembly, spec), normal_law(1e5)
        )
        projected = mortar(joint.assembly, quadrature=quadrature)
        order = [np.lexsort(np.round(j.points, 6).T) for j in (zero, projected)]
        for name in ("points", "weights", "normals", "initial_gap"):
            one, other = (
                getattr(j, name)[o] for j, o in zip((zero, projected), order, strict=True)
            )
            # Averages of curved corners differ in the third order.
            slack = 1e-5 if quadrature == "nodal" and curvature else 1e-11
            np.testing.assert_allclose(other, one, rtol=slack, atol=slack)
        difference = zero.gap_operator[order[0]] - projected.gap_operator[order[1]]
        assert abs(difference).max() < (1e-4 if quadrature == "nodal" and curvature else 1e-11)


LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")


@pytest.fixture(scope="module")
def joint():
    """The cantilever with a finer upper plate, minus side below, facets partly covered."""
    model = fy.lap_joint(
        element_size=5.0, upper_element_size=3.0, damping=fy.Rayleigh(alpha=160.0, beta=5e-7)
    )
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


@pytest.fixture(scope="module")
def askew():
    """The same with the fine upper plate as minus side; its hole is smaller than the other."""
    described = lap_joint_assembly(element_size=5.0, upper_element_size=3.0)
    (spec,) = described.interfaces
    model = build_model(
        described.assembly,
        interfaces=[replace(spec, minus="upper", plus="lower")],
        bolts=described.bolts,
        boundaries=described.boundaries,
    )
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


class TestBoltedJoint:
    @pytest.mark.parametrize("curvature", [0.0, 2e-3])
    @pytest.mark.parametrize("upper", [4.0, 2.5])
    def test_forces_and_displacements_are_those_of_matching_meshes(self, upper, curvature):
        found = []
        for size in (None, upper):
            model = fy.lap_joint(
                element_size=5.0, upper_element_size=size, penalty=1e5, hole_radius=None,
                curvature=curvature,
            )  # fmt: skip
            tight = fy.preload(model, {"bolt": 10e3})
            solution = fy.solve_static(tight, LC2)
            found.append(
                [
                    solution.contact_force(),
                    float(solution.bolt_force("bolt")),
                    solution.displacement("tip")[2],
                    model.interfaces["joint"].nodal_average(solution.pressure).max(),
                ]
            )
        # Measured 1e-3, 1e-3, 2e-3 and 0.8 %: the upper plate is another mesh.
        np.testing.assert_allclose(found[1][:3], found[0][:3], rtol=4e-3)
        np.testing.assert_allclose(found[1][3], found[0][3], rtol=0.02)

    @pytest.mark.parametrize("which", ["joint", "askew"])
    def test_full_newton_agrees(self, which, request):
        model = request.getfixturevalue(which)
        condensed, full = fy.solve_static(model, LC2), solve_static_newton(model, LC2)
        assert np.abs(condensed.pressure - full.pressure).max() < 1e-9 * full.max_pressure * 10
        np.testing.assert_allclose(condensed.states, full.states, atol=1e-9)

    @pytest.mark.parametrize("which", ["joint", "askew"])
    def test_reduced_model_with_compliance_is_exact(self, which, request):
        model = request.getfixturevalue(which)
        rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=5), compliance=True)
        full, reduced = (fy.solve_static(system, LC2) for system in (model, rom))
        assert fy.compare(reduced, full).max_relative_error < 1e-9

    def test_recovery_and_certificate(self, askew):
        full = fy.solve_static(askew, LC2)
        rom = fy.reduce(askew, fy.craig_bampton(askew, normal_modes=5))
        poor = fy.solve_static(rom, LC2)
        assert fy.compare(poor, full).max_relative_error > 0.1
        bound = fy.certify(askew, LC2, poor.pressure)
        # ½ ‖λ̂ - λ*‖²_H from the matrices themselves.
        contact = askew.contact
        H = contact.at_points(askew.static_contact.total) + np.diag(contact.flexibility)
        off = poor.contact_forces - full.contact_forces
        true = np.sqrt(off @ H @ off)
        assert float(bound.energy) >= 0.5 * true**2
        recovered = fy.recover_pressure(askew, poor)
        # Static: exact however poor the basis is.
        error = np.abs(recovered.pressure - full.pressure).max() / full.max_pressure
        assert error < 1e-8

    def test_method_a_takes_its_subareas_from_the_covered_facets(self, askew):
        basis = fy.jim_a(askew, joint_modes=5, normal_modes=5)
        assert basis.vectors.shape[1] >= 10

    def test_hard_contact_is_unique_and_stable(self):
        described = lap_joint_assembly(element_size=5.0, upper_element_size=3.0)
        joint = mortar(described.assembly, np.inf, minus="upper", plus="lower")
        assert joint.quadrature == "nodal"
        G = joint.gap_operator.toarray()
        values = np.linalg.svd(G, compute_uv=False)
        # One force for each independent gap, none of them nearly dependent on others.
        assert len(values) == joint.n_points
        assert values[-1] > 0.05 * values[0]

    def test_hard_pressures_do_not_alternate(self):
        """Fine plates against coarse ones, either side carrying the points."""
        peaks = []
        for sizes in ((5.0, None), (5.0, 3.0), (3.0, 5.0), (5.0, 2.5)):
            model = fy.lap_joint(
                element_size=sizes[0], upper_element_size=sizes[1], penalty="hard", hole_radius=None
            )
            tight = fy.preload(model, {"bolt": 10e3})
            solution = fy.solve_static(tight)
            peaks.append(solution.max_pressure)
        # Smooth under the washer: all meshes see the same pressure within their resolution.
        np.testing.assert_allclose(peaks, peaks[0], rtol=0.12)


class TestDownstream:
    def test_pairs_lie_at_their_minus_nodes(self, joint):
        interface = joint.interfaces["joint"]
        nodes, label = joint.assembly.mesh.nodes, joint.assembly.mesh.bodies
        assert (label[interface.pairs] == [0, 1]).all()
        np.testing.assert_array_equal(interface.pair_points(nodes), nodes[interface.pairs[:, 0]])
        away = np.linalg.norm(np.diff(nodes[interface.pairs], axis=1), axis=2)
        assert away.max() < 3.0

    def test_sticking_holds_the_projected_motion(self, askew):
        interface, dofs = askew.interfaces["joint"], askew.dofs
        chosen = np.zeros(len(interface.pairs), dtype=bool)
        chosen[[3, 17, 40]] = True
        chosen |= interface.coupling.coverage < 0.999
        assert chosen.sum() > 10
        K = sticking_stiffness(interface, chosen, 1e4)
        nodal = np.random.default_rng(2).normal(size=K.shape[0])
        field = dofs.nodal(nodal)[:, :3]
        relative = (interface.coupling.motion @ field)[chosen]
        normal = interface.pair_normals[chosen]
        along = relative - (relative * normal).sum(axis=1, keepdims=True) * normal
        share = interface.coupling.coverage[chosen]
        energy = nodal @ K @ nodal
        assert energy == pytest.approx(1e4 * (share[:, None] * along**2).sum(), rel=1e-11)

    def test_a_stuck_joint_feels_no_rigid_motion_of_both_sides(self):
        assembly = pair("hex8", "hex8", ((5, 4), (9, 7)), move=INSIDE)
        joint = mortar(assembly)
        every = np.ones(len(joint.pairs), dtype=bool)
        K = sticking_stiffness(joint, every, 1e4)
        nodes = assembly.mesh.nodes
        rigid = np.array([1.0, 2.0, 3.0]) + np.cross([0.1, -0.2, 0.3], nodes)
        moved = np.hstack([rigid, np.zeros_like(rigid)]).ravel()
        # 1e4 N/mm times motions that agree to 1e-11.
        assert np.abs(K @ moved).max() < 1e-6
        sliding = moved.reshape(-1, 6) * (assembly.mesh.bodies == 1)[:, None]
        assert sliding.ravel() @ K @ sliding.ravel() > 1e4
        assert (K @ sliding.ravel()).reshape(-1, 6).sum(axis=0) == pytest.approx(0, abs=1e-6)

    def test_pressure_decides_what_sticks(self, askew):
        interface = askew.interfaces["joint"]
        pressure = np.where(interface.points[:, 0] > 5, 10.0, 0.0)
        stuck = stuck_pairs(interface, pressure, 0.5)
        x = interface.pair_points(askew.assembly.mesh.nodes)[:, 0]
        assert x[stuck].min() > 5 - 3.4
        assert stuck[x > 9].all()

    def test_gap_fields_by_nodes_of_either_side(self, askew):
        interface, mesh = askew.interfaces["joint"], askew.assembly.mesh
        coupling, ids = interface.coupling, mesh.node_ids

        def linear(x):
            return 0.01 + 1e-3 * x[:, 0] - 2e-3 * x[:, 1]

        for side in (coupling.minus, coupling.plus):
            used = np.unique(side.tocoo().col)
            field = gap_from_nodes(interface, ids, ids[used], linear(mesh.nodes[used]))
            # Linear fields pass through the projection unchanged.
            np.testing.assert_allclose(field, linear(interface.points), atol=1e-12)
        used = np.unique(coupling.plus.tocoo().col)[1:]
        with pytest.raises(ModelError, match="no value at"):
            gap_from_nodes(interface, ids, ids[used], linear(mesh.nodes[used]))

    def test_every_face_is_made_of_pairs(self, askew):
        interface = askew.interfaces["joint"]
        known = set(map(tuple, interface.pairs.tolist()))
        for faces in interface.faces:
            found = zip(faces.minus.ravel().tolist(), faces.plus.ravel().tolist(), strict=True)
            assert known.issuperset(found)
        total = sum(len(faces.minus) for faces in interface.faces)
        assert interface.face_of_point.max() == total - 1


class TestSides:
    def test_three_plates_and_automatic_sides(self):
        described = lap_joint_assembly(element_size=5.0, upper_element_size=4.0, plates=3)
        assert [spec.meshes for spec in described.interfaces] == ["non-matching"] * 2
        auto = InterfaceSpec(name="joint", meshes="non-matching")
        found = find_couplings(described.assembly, auto)
        assert list(found) == ["joint-1", "joint-2"]
        named = [find_couplings(described.assembly, spec) for spec in described.interfaces]
        for one, (coupling,) in zip(found.values(), (n.values() for n in named), strict=True):
            assert one.weights.sum() == pytest.approx(coupling.weights.sum(), rel=1e-12)

    def test_the_message_for_meshes_that_do_not_match_names_the_remedy(self):
        with pytest.raises(ModelError, match='meshes = "non-matching"'):
            fy.lap_joint(element_size=5.0, upper_element_size=4.0, meshes="matching")

    def test_sides_that_nowhere_touch(self):
        apart = pair("hex8", "hex8", move=lifted(1.0))
        with pytest.raises(ModelError, match="interface 'joint' is empty"):
            mortar(apart)

    def test_order_needs_gauss_points(self):
        with pytest.raises(ModelError, match="order 3 is given but nodal"):
            mortar(pair("hex8", "hex8"), quadrature="nodal", order=3)
        assert mortar(pair("hex8", "hex8"), order=4).n_points == 16 * 16

    def test_quadrilaterals_with_a_collapsed_corner(self):
        """Bricks degenerated to wedges have quadrilaterals of three corners, and some of none."""
        assembly = pair("hex8", "hex8", move=INSIDE)
        lower, upper = assembly.mesh.blocks
        bricks = lower.nodes
        halves = [bricks[:, [0, 1, 2, 2, 4, 5, 6, 6]], bricks[:, [0, 2, 3, 3, 4, 6, 7, 7]]]
        wedges = replace(
            lower,
            nodes=np.vstack(halves),
            ids=np.arange(1001, 1001 + 2 * len(bricks)),
            properties=np.ones(2 * len(bricks)),
        )
        mesh = replace(assembly.mesh, blocks=(wedges, upper), element_sets={})
        joint = mortar(replace(assembly, mesh=mesh), minus=1, plus=2)
        # Shape functions have no limit at the collapsed corner: measured 1e-8.
        assert joint.area == pytest.approx(SIZE[0] * SIZE[1] * 0.62**2, rel=1e-7)
        forces = nodal_forces(joint, np.ones(joint.n_points))
        np.testing.assert_allclose(forces.sum(axis=0), 0, atol=1e-10)
        swapped = mortar(replace(assembly, mesh=mesh), minus=2, plus=1)
        assert swapped.area == pytest.approx(joint.area, rel=1e-7)

    def test_graded_meshes(self, caplog):
        """Facets of a hundredth of the others' size: none is missed."""
        with caplog.at_level(logging.WARNING):
            joint = mortar(pair("hex8", "hex8", ((2, 2), (60, 50)), move=INSIDE))
        assert joint.area == pytest.approx(SIZE[0] * SIZE[1] * 0.62**2, rel=1e-12)
        swapped = mortar(
            pair("hex8", "hex8", ((2, 2), (60, 50)), move=INSIDE), minus="upper", plus="lower"
        )
        assert swapped.area == pytest.approx(joint.area, rel=1e-12)
        assert swapped.normals[:, 2].max() < -0.99


@pytest.mark.parametrize("degrees", [2.0, 8.0, 15.0])
def test_the_height_over_chords_of_a_circle(degrees):
    """½ R sin²θ in the middle, θ half the angle; short by θ²/4 of the true height."""
    half, radius = np.radians(degrees) / 2, 30.0
    angles = np.array([-half, half, half, -half])
    corners = np.stack([radius * np.sin(angles), [0, 0, 1, 1], radius * np.cos(angles)], axis=1)
    normals = np.stack([np.sin(angles), np.zeros(4), np.cos(angles)], axis=1)
    height = standing_off(np.full((1, 1, 4), 0.25), corners[None], normals[None])[0, 0]
    assert height == pytest.approx(radius * np.sin(half) ** 2 / 2, rel=1e-12)
    true = radius * (1 - np.cos(half))
    assert 1 - height / true == pytest.approx(half**2 / 4, rel=0.01)  # terms of sixth order

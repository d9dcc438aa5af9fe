"""Shell elements against plate theory: patches, rigid motions, plates and cantilevers."""

from dataclasses import replace

import numpy as np
import pytest

from faying.exceptions import ModelError
from faying.model.assembly import Assembly
from faying.model.matrices import assemble_matrices, mass_properties, rigid_body_motions
from faying.model.mesh import Mesh
from faying.model.shells import ShellBlock, ShellSection, plane_stress

E, NU, RHO = 210000.0, 0.3, 7.8e-9
KINDS = ("tri3", "quad4", "tri6", "quad8")
# Rounding in a well-conditioned system of a few shells.
EXACT = 1e-9


def plate_section(youngs_modulus, poissons_ratio, density, thickness):
    """A homogeneous isotropic plate, its shear correction being 5/6."""
    plane = plane_stress(youngs_modulus, poissons_ratio)
    shear = youngs_modulus / (2 * (1 + poissons_ratio)) * np.eye(2)
    return ShellSection(
        stiffness=np.kron(np.diag([thickness, thickness**3 / 12]), plane),
        shear=5 / 6 * thickness * shear,
        mass=density * thickness,
        inertia=density * thickness**3 / 12,
    )


def plate(kind, n_x, n_y, size=(10.0, 10.0), thickness=0.5, *, skew=0.0, turn=None, offset=0.0):
    """A plate in n_x by n_y cells from the origin along x and y, inner nodes moved by ``skew``."""
    x, y = (np.linspace(0, 1, n + 1) for n in (n_x, n_y))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2)
    moved = np.random.default_rng(1).uniform(-1, 1, grid[1:-1, 1:-1].shape)
    grid[1:-1, 1:-1] += skew * moved / np.array([n_x, n_y])
    nodes = np.zeros(((n_x + 1) * (n_y + 1), 3))
    nodes[:, :2] = grid.reshape(-1, 2) * size
    number = np.arange(len(nodes)).reshape(n_x + 1, n_y + 1)
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    cells = np.stack([corner.ravel() for corner in corners], axis=1)
    if kind.startswith("tri"):
        cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    if kind in ("tri6", "quad8"):
        nodes, cells = with_mid_sides(nodes, cells)
    nodes = nodes if turn is None else nodes @ turn.T
    block = ShellBlock(
        kind=kind,
        nodes=cells,
        ids=np.arange(1, len(cells) + 1),
        properties=np.ones(len(cells)),
        offsets=np.full(len(cells), offset),
        directions=np.zeros((len(cells), 3)),
    )
    return Assembly(
        mesh=Mesh(nodes=nodes, node_ids=np.arange(len(nodes))),
        shells=(block,),
        shell_sections={1: plate_section(E, NU, RHO, thickness)},
    )


def with_mid_sides(nodes, cells):
    """Nodes in the middle of all sides, in the order of the corners they follow."""
    ends = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2), axis=2)
    sides, which = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    middle = nodes[sides].mean(axis=1)
    return np.vstack([nodes, middle]), np.hstack([cells, len(nodes) + which.reshape(cells.shape)])


def turned():
    rotation = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    return rotation * np.sign(np.linalg.det(rotation))


def displacement_field(points, strain, curvature):
    """Displacements (n, 6) of constant strains and curvatures of a plane plate, no shear."""
    x, y = points[:, 0], points[:, 1]
    u = np.zeros((len(points), 6))
    exx, eyy, gxy = strain
    kxx, kyy, kxy = curvature
    u[:, 0], u[:, 1] = exx * x + gxy / 2 * y, eyy * y + gxy / 2 * x
    u[:, 2] = -(kxx * x**2 + kyy * y**2 + kxy * x * y) / 2
    u[:, 3], u[:, 4] = -(kyy * y + kxy * x / 2), kxx * x + kxy * y / 2
    return u


@pytest.mark.parametrize(
    ("kind", "skew", "curvature"),
    [
        *((kind, 0.3, (2e-3, 1e-3, -1.5e-3)) for kind in ("tri3", "quad4", "tri6")),
        # Eight nodes hold no quadratic deflection on sides that are not parallel.
        ("quad8", 0.0, (2e-3, 1e-3, -1.5e-3)),
        ("quad8", 0.3, (0.0, 0.0, 0.0)),
    ],
)
def test_patches_of_constant_strain_and_curvature(kind, skew, curvature):
    """The edge is prescribed: the inside follows exactly."""
    model = plate(kind, 3, 3, skew=skew)
    points = model.mesh.nodes
    edge = (np.isclose(points[:, :2], 0) | np.isclose(points[:, :2], 10)).any(axis=1)
    strain = (1e-3, -4e-4, 7e-4)
    exact = displacement_field(points, strain, curvature).ravel()
    held = np.repeat(edge, 6)
    K = assemble_matrices(model).K.toarray()
    found = exact.copy()
    found[~held] = np.linalg.solve(K[~held][:, ~held], -K[~held][:, held] @ exact[held])
    assert np.abs(found - exact).max() < EXACT * np.abs(exact).max()
    # The energy is that of plate theory.
    section = model.shell_sections[1].stiffness
    density = strain @ section[:3, :3] @ strain + curvature @ section[3:, 3:] @ curvature
    assert exact @ K @ exact == pytest.approx(100 * density, rel=EXACT)


@pytest.mark.parametrize("offset", [0.0, 0.4])
@pytest.mark.parametrize("kind", KINDS)
def test_rigid_motions_need_no_force_and_nothing_else_is_free(kind, offset):
    model = plate(kind, 2, 2, skew=0.3, turn=turned(), offset=offset)
    # A warped surface, too.
    nodes = model.mesh.nodes + np.outer(np.eye(len(model.mesh.nodes))[0] * 0.3, turned()[:, 2])
    model = replace(model, mesh=replace(model.mesh, nodes=nodes))
    K = assemble_matrices(model).K
    motion = rigid_body_motions(nodes, np.zeros(3))
    assert np.abs(K @ motion).max() < 1e-12 * 10 * abs(K).max()  # rounding of motions of that size
    stiffness = np.linalg.eigvalsh(K.toarray())
    assert np.abs(stiffness[:6]).max() < 1e-12 * stiffness[-1]
    # Drilling is the softest, 1e-4 of the shear modulus.
    assert stiffness[6] > 1e-8 * stiffness[-1]


@pytest.mark.parametrize("kind", KINDS)
def test_mass_centre_and_inertia_of_a_plate(kind):
    found = mass_properties(plate(kind, 2, 3, offset=1.5))
    mass = RHO * 0.5 * 100
    assert found.mass == pytest.approx(mass, rel=EXACT)
    np.testing.assert_allclose(found.centre, [5, 5, 1.5], atol=EXACT * 10)
    swing = mass * (100 + 0.5**2) / 12
    np.testing.assert_allclose(np.diag(found.inertia), [swing, swing, mass * 200 / 12], rtol=1e-9)


def solved(model, held, loads):
    K = assemble_matrices(model).K.toarray()
    free = ~held.ravel()
    u = np.zeros(len(K))
    u[free] = np.linalg.solve(K[free][:, free], loads.ravel()[free])
    return u.reshape(-1, 6)


def quarter_plate(kind, n, thickness):
    """Deflection under a central force over that of thin clamped plates, w = 0.00560 F a²/D.

    Timoshenko, Woinowsky-Krieger, Theory of Plates and Shells, table 37: one quarter, symmetric.
    """
    model = plate(kind, n, n, (10.0, 10.0), thickness)
    x, y, _ = model.mesh.nodes.T
    held = np.zeros((len(x), 6), dtype=bool)
    held[np.isclose(x, 0) | np.isclose(y, 0)] = True
    held[np.isclose(x, 10)] |= np.array([1, 0, 0, 0, 1, 1], dtype=bool)
    held[np.isclose(y, 10)] |= np.array([0, 1, 0, 1, 0, 1], dtype=bool)
    loads = np.zeros_like(held, dtype=float)
    corner = int(np.argmax(x + y))
    loads[corner, 2] = 0.25
    D = E * thickness**3 / 12 / (1 - NU**2)
    return solved(model, held, loads)[corner, 2] / (0.00560 * 400 / D)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("thickness", [0.001, 0.2])
def test_clamped_square_plate_under_a_central_force(kind, thickness):
    coarse, fine = (quarter_plate(kind, n, thickness) for n in (4, 8))
    # Whatever the thickness: the error halves at least with the element size, down to the three
    # digits of the table. Shear strains of one parameter a side (tri6: linear) approach from above.
    assert fine == pytest.approx(1.0, abs=0.045 if kind == "tri6" else 0.025)
    assert abs(fine - 1) < max(abs(coarse - 1) / 2, 0.007)


@pytest.mark.parametrize("kind", KINDS)
def test_thick_plates_are_softer_by_their_shear(kind):
    """A strip bent across its span: the shear deflection F L / (5/6 G A) adds to the beam's."""
    thickness = 4.0
    model = plate(kind, 8, 4, (10.0, 10.0), thickness)
    model = replace(model, shell_sections={1: plate_section(E, 0.0, RHO, thickness)})
    held = np.zeros((len(model.mesh.nodes), 6), dtype=bool)
    held[np.isclose(model.mesh.nodes[:, 0], 0)] = True
    tip = np.isclose(model.mesh.nodes[:, 0], 10)
    loads = np.zeros(held.shape)
    edge = np.flatnonzero(tip)[np.argsort(model.mesh.nodes[tip, 1])]
    linear, quadratic = [1, 2, 2, 2, 1], [1, 4, 2, 4, 2, 4, 2, 4, 1]
    loads[edge, 2] = np.array(linear) / 8 if len(edge) == 5 else np.array(quadratic) / 24
    found = solved(model, held, loads)[tip, 2].mean()
    bent, sheared = 10**3 / (3 * E * 10 * thickness**3 / 12), 10 / (5 / 6 * E / 2 * 10 * thickness)
    assert sheared > 0.05 * bent
    # Cubic deflections between nodes: the strip of quadrilaterals is exact, others nearly so.
    assert found == pytest.approx(bent + sheared, rel=EXACT if kind == "quad4" else 0.03)


def test_quadrilaterals_bend_in_their_plane_like_beams():
    model = plate("quad4", 10, 1, (100.0, 10.0), 2.0)
    x = model.mesh.nodes[:, 0]
    held = np.zeros((len(x), 6), dtype=bool)
    held[np.isclose(x, 0)] = True
    loads = np.zeros(held.shape)
    loads[np.isclose(x, 100), 1] = 0.5
    found = solved(model, held, loads)[np.isclose(x, 100), 1].mean()
    inertia, shear = 2.0 * 10**3 / 12, 5 / 6 * 20 * E / (2 * (1 + NU))
    # One element through the depth; the clamped end restrains Poisson's contraction.
    assert found == pytest.approx(100**3 / (3 * E * inertia) + 100 / shear, rel=0.02)


@pytest.mark.parametrize("kind", KINDS)
def test_a_roof_that_carries_its_weight(kind):
    """Scordelis, Lo, J. Am. Concr. Inst. 61 (1964): 0.3024 down in the middle of the free edge.

    The benchmark of curved shells: radius 25, length 50, 40° to each side, on stiff end walls.
    """
    n = 10
    flat = plate(kind, n, n, (1.0, 1.0), 0.25)
    angle, along = np.radians(40) * flat.mesh.nodes[:, 0], 25 * flat.mesh.nodes[:, 1]
    nodes = np.stack([25 * np.sin(angle), along, 25 * np.cos(angle)], axis=1)
    if kind in ("tri6", "quad8"):  # mid-sides on the surface, where the corners' mean is not
        nodes[:, [0, 2]] *= 25 / np.linalg.norm(nodes[:, [0, 2]], axis=1)[:, None]
    model = replace(
        flat,
        mesh=replace(flat.mesh, nodes=nodes),
        shell_sections={1: plate_section(4.32e8, 0.0, 360.0, 0.25)},
    )
    held = np.zeros((len(nodes), 6), dtype=bool)
    held[np.isclose(angle, 0)] |= np.array([1, 0, 0, 0, 1, 1], dtype=bool)
    held[np.isclose(along, 25)] |= np.array([0, 1, 0, 1, 0, 1], dtype=bool)
    held[np.isclose(along, 0)] |= np.array([1, 0, 1, 0, 1, 0], dtype=bool)
    down = np.tile([0.0, 0.0, -1.0, 0.0, 0.0, 0.0], len(nodes))
    loads = (assemble_matrices(model).M @ down).reshape(-1, 6)  # 360 × 0.25 = 90 a unit area
    edge = np.flatnonzero(np.isclose(along, 25) & np.isclose(angle, np.radians(40)))
    found = solved(model, held, loads)[edge[0], 2]
    # Deep shell theory gives 0.3006; linear triangles are the least accurate.
    assert found == pytest.approx(-0.3015, rel=0.1 if kind == "tri3" else 0.02)


def test_a_shear_panel_shears_and_does_nothing_else():
    model = plate("quad4", 1, 1, (10.0, 4.0))
    block = replace(model.shells[0], kind="panel4")
    for slant in (0.0, 3.0):
        nodes = model.mesh.nodes + np.outer(model.mesh.nodes[:, 1] / 4 * slant, [1.0, 0, 0])
        K = assemble_matrices(
            replace(model, shells=(block,), mesh=replace(model.mesh, nodes=nodes))
        ).K.toarray()
        values = np.linalg.eigvalsh(K)
        assert np.abs(values[:-1]).max() < 1e-12 * values[-1]
        # The upper side slides by 1.
        slid = np.zeros((4, 6))
        slid[nodes[:, 1] > 1, 0] = 1.0
        force = (K @ slid.ravel()).reshape(4, 6)[nodes[:, 1] > 1, 0].sum()
        # Uniform stress of unit flow: τ = 1 and σ along x of 2 cot of the side's angle.
        flexibility = 40 / 0.5 * ((2 * slant / 4) ** 2 / E + 2 * (1 + NU) / E)
        assert force == pytest.approx(10**2 / flexibility, rel=EXACT)
    crooked = model.mesh.nodes + np.outer(np.eye(4)[0], [1.0, 0, 0])
    with pytest.raises(ModelError, match="no plane parallelogram"):
        assemble_matrices(replace(model, shells=(block,), mesh=replace(model.mesh, nodes=crooked)))


@pytest.mark.parametrize("kind", KINDS)
def test_shells_that_are_collapsed_or_folded_are_refused(kind):
    model = plate(kind, 1, 1)
    nodes = model.mesh.nodes.copy()
    nodes[3] = nodes[0] if kind.startswith("tri") else [2.0, 2.0, 0.0]
    with pytest.raises(ModelError, match="collapsed or folded"):
        assemble_matrices(replace(model, mesh=replace(model.mesh, nodes=nodes)))

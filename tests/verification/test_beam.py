"""Beam elements against the closed forms of beam theory."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from faying.model.assembly import Assembly, Beam, BeamSection, Material
from faying.model.elements.beam import beam_frames
from faying.model.matrices import assemble_matrices, mass_properties, rigid_body_motions
from faying.model.mesh import Mesh

STEEL = Material(youngs_modulus=210000.0, poissons_ratio=0.3, density=7.82e-9)
SLENDER = BeamSection(area=12.0, inertia_y=9.0, inertia_z=16.0, torsion=20.0)
DEEP = replace(SLENDER, shear_factor_y=0.8, shear_factor_z=0.6)
LENGTH = 50.0
# Rounding in a well-conditioned system of a few beams.
EXACT = 1e-10


def straight_beam(section, n_element=1, direction=(1, 0, 0), orientation=(0, 1, 0), length=LENGTH):
    axis = np.asarray(direction) / np.linalg.norm(direction)
    nodes = np.linspace(0, length, n_element + 1)[:, None] * axis
    beams = tuple(
        Beam(id=i, nodes=(i, i + 1), section=section, material=STEEL, orientation=orientation)
        for i in range(n_element)
    )
    return Assembly(mesh=Mesh(nodes=nodes, node_ids=np.arange(len(nodes))), beams=beams)


def tip_motion(assembly, load):
    """Six displacements of the last node of a cantilever under six forces there."""
    K = assemble_matrices(assembly).K.toarray()[6:, 6:]
    force = np.zeros(len(K))
    force[-6:] = load
    return np.linalg.solve(K, force)[-6:]


@pytest.mark.parametrize("n_element", [1, 3])
@pytest.mark.parametrize("section", [SLENDER, DEEP])
def test_cantilever_under_six_end_loads(section, n_element):
    E, G, length = STEEL.youngs_modulus, STEEL.shear_modulus, LENGTH
    load = np.array([100.0, 20.0, 30.0, 400.0, 500.0, 600.0])
    shear_y = length / (section.shear_factor_y * section.area * G)
    shear_z = length / (section.shear_factor_z * section.area * G)
    in_xz, in_xy = E * section.inertia_y, E * section.inertia_z
    expected = [
        load[0] * length / (E * section.area),
        load[1] * (length**3 / (3 * in_xy) + shear_y) + load[5] * length**2 / (2 * in_xy),
        load[2] * (length**3 / (3 * in_xz) + shear_z) - load[4] * length**2 / (2 * in_xz),
        load[3] * length / (G * section.torsion),
        load[4] * length / in_xz - load[2] * length**2 / (2 * in_xz),
        load[5] * length / in_xy + load[1] * length**2 / (2 * in_xy),
    ]
    found = tip_motion(straight_beam(section, n_element), load)
    np.testing.assert_allclose(found, expected, rtol=EXACT)


def test_orientation_vector_lies_in_the_local_xy_plane():
    frames, length = beam_frames(
        straight_beam(SLENDER, orientation=(5.0, 0.0, 2.0)).beams, np.array([[3.0, 0.0, 0.0]])
    )
    np.testing.assert_allclose(frames[0], [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-15)
    assert length[0] == 3.0
    # Bending in the plane of the orientation vector, here basic x-z, uses inertia_z.
    tip = tip_motion(straight_beam(SLENDER, orientation=(0, 0, 1)), [0, 0, 1, 0, 0, 0])
    expected = LENGTH**3 / (3 * STEEL.youngs_modulus * SLENDER.inertia_z)
    assert tip[2] == pytest.approx(expected, rel=EXACT)


def test_rotated_beam_has_rotated_matrices():
    rotation = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    turn = scipy.linalg.block_diag(*[rotation] * 4)
    plain = assemble_matrices(straight_beam(DEEP))
    turned = assemble_matrices(
        straight_beam(DEEP, direction=rotation @ [1, 0, 0], orientation=tuple(rotation[:, 1]))
    )
    for before, after in ((plain.M, turned.M), (plain.K, turned.K)):
        scale = abs(before).max()
        expected = turn @ before.toarray() @ turn.T
        np.testing.assert_allclose(after.toarray(), expected, atol=1e-14 * scale)  # rounding


@pytest.mark.parametrize("section", [SLENDER, DEEP])
def test_rigid_motions_need_no_force_and_nothing_else_is_free(section):
    assembly = straight_beam(section, 2, direction=(1, 2, 3), orientation=(0, 0, 1))
    K = assemble_matrices(assembly).K
    motion = rigid_body_motions(assembly.mesh.nodes, np.zeros(3))
    assert np.abs(K @ motion).max() < 1e-13 * LENGTH * abs(K).max()  # rounding of motions of size L
    stiffness = np.linalg.eigvalsh(K.toarray())
    assert np.abs(stiffness[:6]).max() < 1e-12 * stiffness[-1]
    assert stiffness[6] > 1e-8 * stiffness[-1]


@pytest.mark.parametrize("section", [SLENDER, DEEP])
def test_mass_and_inertia_of_a_bar_are_exact(section):
    found = mass_properties(straight_beam(section, 3))
    line = STEEL.density * section.area
    polar = STEEL.density * (section.inertia_y + section.inertia_z) * LENGTH
    swing = line * LENGTH**3 / 12
    assert found.mass == pytest.approx(line * LENGTH, rel=EXACT)
    np.testing.assert_allclose(found.centre, [LENGTH / 2, 0, 0], atol=EXACT * LENGTH)
    expected = np.diag(
        [
            polar,
            swing + STEEL.density * section.inertia_y * LENGTH,
            swing + STEEL.density * section.inertia_z * LENGTH,
        ]
    )
    np.testing.assert_allclose(found.inertia, expected, rtol=EXACT, atol=EXACT * swing)


def test_mass_is_that_of_the_static_shapes():
    """Consistency by an independent route: M = Σ over slices of the shapes by statics."""
    whole = assemble_matrices(straight_beam(DEEP)).M.toarray()
    fine = assemble_matrices(straight_beam(DEEP, 40))
    K, M = fine.K.toarray(), fine.M.toarray()
    ends = np.r_[0:6, len(K) - 6 : len(K)]
    inner = np.setdiff1d(np.arange(len(K)), ends)
    shapes = np.zeros((len(K), 12))
    shapes[ends] = np.eye(12)
    # The element is exact for end loads, so statics gives its own shape functions at the nodes.
    shapes[inner] = -np.linalg.solve(K[np.ix_(inner, inner)], K[np.ix_(inner, ends)])
    # Between the nodes the slices' shapes coincide with those of the whole: rounding only.
    scale = np.sqrt(np.outer(np.diag(whole), np.diag(whole)))
    assert np.abs((shapes.T @ M @ shapes - whole) / scale).max() < 1e-8


def first_bending_frequencies(section, n_element, length, count=4):
    matrices = assemble_matrices(straight_beam(section, n_element, length=length))
    K, M = matrices.K.toarray()[6:, 6:], matrices.M.toarray()[6:, 6:]
    in_plane = (np.arange(len(K)) % 6 == 1) | (np.arange(len(K)) % 6 == 5)
    K, M = K[np.ix_(in_plane, in_plane)], M[np.ix_(in_plane, in_plane)]
    return np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True, subset_by_index=[0, count - 1]))


def test_first_bending_frequency_of_a_slender_cantilever():
    length = 1000.0
    stiffness = STEEL.youngs_modulus * SLENDER.inertia_z
    line = STEEL.density * SLENDER.area
    root = 1.8751040687119611  # of cos x cosh x = -1
    expected = root**2 * np.sqrt(stiffness / (line * length**4))
    found = first_bending_frequencies(SLENDER, 20, length)[0]
    # Rotary inertia lowers it by about I root² / (A L²) = 5e-6; 20 cubics are better than 1e-6.
    assert found == pytest.approx(expected, rel=1e-5)
    assert found < expected


def pinned_eigenvalues(n_element, length):
    matrices = assemble_matrices(straight_beam(DEEP, n_element, length=length))
    dof = np.arange(6 * (n_element + 1))
    within = (dof > 5) & (dof < 6 * n_element)
    keep = ((dof % 6 == 1) & within) | (dof % 6 == 5)
    K, M = (m.toarray()[np.ix_(keep, keep)] for m in (matrices.K, matrices.M))
    return scipy.linalg.eigh(K, M, eigvals_only=True, subset_by_index=[0, 2])


def test_frequencies_of_a_deep_pinned_beam():
    """Timoshenko's frequency equation has a closed form for pinned ends (sine shapes)."""
    length, order = 20.0, np.arange(1, 4)
    bending, mass = STEEL.youngs_modulus * DEEP.inertia_z, STEEL.density * DEEP.area
    rotary = STEEL.density * DEEP.inertia_z
    shear = DEEP.shear_factor_y * DEEP.area * STEEL.shear_modulus
    wave = (order * np.pi / length) ** 2
    # det [[S k² - ρA ω², -S k], [-S k, EI k² + S - ρI ω²]] = 0, a quadratic in ω².
    a = mass * rotary
    b = -(mass * (bending * wave + shear) + rotary * shear * wave)
    c = shear * wave * bending * wave
    expected = (-b - np.sqrt(b**2 - 4 * a * c)) / (2 * a)
    coarse, fine = pinned_eigenvalues(40, length), pinned_eigenvalues(80, length)
    # Shear strain is constant in an element, hence ω² converges with h² ...
    np.testing.assert_allclose((coarse - expected) / (fine - expected), 4.0, rtol=0.02)
    # ... and what is left after extrapolation is of order h⁴.
    np.testing.assert_allclose((4 * fine - coarse) / 3, expected, rtol=5e-6)

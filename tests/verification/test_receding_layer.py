"""Two elastic layers that strip loads press together: contact recedes to a known length.

The semi-analytic answers (plane elasticity of a layer, a dense integral equation) and the nodal
pressures of another program on the same mesh are in tests/data; see the README there.
"""

import json

import numpy as np
import pytest
from pressed_layers import pair_places, pressed_layers

FORCE = 1000.0  # N per mm of width


@pytest.fixture(scope="module")
def case(data):
    folder = data / "receding_layer"
    described = json.loads((folder / "case.json").read_text())
    return described, np.load(folder / "mesh.npz"), np.load(folder / "result.npz")


def layers_on_the_mesh(mesh, **options):
    nodes = mesh["nodes"]
    depth = np.unique(np.abs(nodes[:, 2]))
    return pressed_layers(np.unique(nodes[:, 0]), depth, 2.5, **options)


def profile(layers, solution):
    """Gap g₀ + n·(u⁺ − u⁻) at the node pairs along x."""
    x, row = pair_places(layers.joint, layers.model.assembly.mesh.nodes)
    relative = layers.joint.relative_operator @ solution.states
    return x, relative[row]


def closed_length(x, gap):
    """Where the gap opens, linear between nodes."""
    first = np.flatnonzero(gap > 0)[0]
    return np.interp(0.0, gap[first - 1 : first + 1], x[first - 1 : first + 1])


@pytest.mark.parametrize(
    ("element", "name"), [("standard", "C3D8_gauss2"), ("incompatible", "C3D8I_gauss2")]
)
def test_with_the_penalty_of_the_reference(element, name, case):
    described, mesh, result = case
    layers = layers_on_the_mesh(mesh, element=element, penalty=1e6, quadrature="gauss")
    solution = layers.pressed(FORCE)
    x, gap = profile(layers, solution)
    pressure = 1e6 * np.maximum(-gap, 0.0)
    # Another program on the same mesh; the holding spring takes 1e-5 of the load.
    np.testing.assert_allclose(pressure, result[f"p_{name}"], rtol=0, atol=1e-4 * pressure.max())
    length = closed_length(x, gap)
    assert length == pytest.approx(described[f"numpy_{name}"]["a_interp"], rel=1e-3)
    # Against the semi-analytic values: the mesh misses 0.2 % of the peak and a quarter of an
    # element (0.625) of the length.
    assert pressure.max() == pytest.approx(described["p0_semi"], rel=3e-3)
    assert length == pytest.approx(described["a_semi"], abs=0.25 * 0.625)


def test_pressure_profile(case):
    _, mesh, result = case
    layers = layers_on_the_mesh(mesh, penalty=1e6, quadrature="gauss")
    solution = layers.pressed(FORCE)
    place = layers.joint.points[:, 0]
    exact = np.interp(place, result["x_semi"], result["p_semi"])
    error = np.abs(solution.pressure - exact) / exact.max()
    # Up to 4.2 % in the element where contact ends (case.json), below 1 % before it.
    assert error.max() < 0.05
    assert error[place < 7.5].max() < 0.01


def test_hard_contact(case):
    described, mesh, _ = case
    layers = layers_on_the_mesh(mesh, penalty="hard")
    solution = layers.pressed(FORCE)
    x, gap = profile(layers, solution)
    # Closed gaps are zero to round-off, 4e-12 at most; the first open one is 5e-5.
    last = x[np.flatnonzero(gap < 1e-9)[-1]]
    # Nodal pressures: half a percent of the peak on this mesh; contact ends within one element.
    assert solution.max_pressure == pytest.approx(described["p0_rigid"], rel=5e-3)
    assert abs(last - described["a_rigid"]) < 0.625


def test_half_the_load_keeps_the_length(case):
    """Receding contact: the length does not depend on the load, the pressure is linear in it."""
    _, mesh, _ = case
    layers = layers_on_the_mesh(mesh, penalty="hard")
    whole, half = layers.pressed(FORCE), layers.pressed(FORCE / 2)
    np.testing.assert_array_equal(whole.contact_forces > 0, half.contact_forces > 0)
    # The same linear system with half the right-hand side.
    small = 1e-8 * whole.max_pressure
    np.testing.assert_allclose(2 * half.pressure, whole.pressure, rtol=0, atol=small)


def test_contact_carries_the_load(case):
    _, mesh, _ = case
    layers = layers_on_the_mesh(mesh, penalty=1e6, quadrature="gauss")
    # Less what the holding spring takes.
    assert layers.pressed(FORCE).contact_force() == pytest.approx(FORCE / 2, rel=2e-5)


def other_lines(x, ratio):
    """Grid lines of about ``ratio`` times as many elements, with one where the load ends."""
    parts = []
    for a, b in ((0.0, 2.5), (2.5, x[-1])):
        own = x[(x >= a) & (x <= b)]
        count = round((len(own) - 1) * ratio)
        parts.append(np.interp(np.linspace(0, len(own) - 1, count + 1), np.arange(len(own)), own))
    return np.unique(np.concatenate(parts).round(12))


@pytest.mark.parametrize("minus", ["body 0", "body 1"])
@pytest.mark.parametrize("ratio", [0.75, 1.3, 2.2])
class TestMeshesThatDoNotMatch:
    """The mortar coupling is held to the semi-analytic answers as matching meshes are."""

    def layers(self, case, ratio, minus, **options):
        x = np.unique(case[1]["nodes"][:, 0])
        depth = np.unique(np.abs(case[1]["nodes"][:, 2]))
        plus = "body 1" if minus == "body 0" else "body 0"
        upper = other_lines(x, ratio)
        return pressed_layers(x, depth, 2.5, upper_x=upper, minus=minus, plus=plus, **options)

    def test_pressure_profile(self, case, ratio, minus):
        layers = self.layers(case, ratio, minus, penalty=1e6, quadrature="gauss")
        solution = layers.pressed(FORCE)
        place, result = layers.joint.points[:, 0], case[2]
        exact = np.interp(place, result["x_semi"], result["p_semi"])
        error = np.abs(solution.pressure - exact) / exact.max()
        # The bounds of matching meshes; measured up to 4.6 % and 0.5 %.
        assert error.max() < 0.05
        assert error[place < 7.5].max() < 0.01
        assert solution.contact_force() == pytest.approx(FORCE / 2, rel=2e-5)

    def test_hard_contact(self, case, ratio, minus):
        described = case[0]
        layers = self.layers(case, ratio, minus, penalty="hard")
        solution = layers.pressed(FORCE)
        # Measured within 0.7 % on the coarsest mesh.
        assert solution.max_pressure == pytest.approx(described["p0_rigid"], rel=0.01)
        pressed = layers.joint.points[solution.contact_forces > 0, 0].max()
        assert abs(pressed - described["a_rigid"]) < 0.625 / min(ratio, 1)

"""A stiff flange under six bolts, lifted and tilted, against the equilibrium of a rigid plate.

The flange is a rigid square plate on an elastic bed, the penalty, of stiffness c per area; bolts
are springs on a circle. With the opening w = w₀ + φ y the bolts carry Fᵢ = F₀ + k (w(yᵢ) − w_F),
w_F = −n F₀/(c A), and the bed c ⟨−w⟩. What follows from the sums of forces and moments is exact:

* closed: w₀ = w_F + N/(c A + n k), φ = M/(c I + k Σ yᵢ²); it opens where w is 0 at the edge;
* open from a line y = e on: φ from N, then M, for whatever e is chosen;
* apart: Fᵢ = N/n + M_x yᵢ/Σ yᵢ² − M_y xᵢ/Σ xᵢ², whatever is stiff.
"""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.joint.build import build_model
from faying.model.assembly import Assembly, RigidCoupling, Spring, Support
from faying.model.generate import brick_grid
from solid_blocks import stacked

SIDE, BED, BOLT, PRELOAD, COUNT = 60.0, 2e3, 2e5, 20e3, 6
AREA, INERTIA = SIDE**2, SIDE**4 / 12
ANGLES = np.radians(10.0 + 60.0 * np.arange(COUNT))
X, Y = 22.0 * np.cos(ANGLES), 22.0 * np.sin(ANGLES)
REST = -COUNT * PRELOAD / (BED * AREA)
NAMES = [f"bolt {i + 1}" for i in range(COUNT)]
PULL = 15e3
EDGE = 7.0
"""Where contact ends in the partly open flange, on no line of the meshes."""


def flange(divisions, quadrature="gauss"):
    """Two square plates, all of whose nodes move as one, the lower one held."""
    lines = np.linspace(-SIDE / 2, SIDE / 2, divisions + 1)
    upper = brick_grid(lines, lines, np.array([0.0, 10.0]))
    n = len(upper.nodes)
    heads = np.stack([X, Y, np.full(COUNT, 10.0)], axis=1)
    middle = np.array([[0.0, 0.0, 10.0]])
    size = n + COUNT + 1
    plate = replace(upper, nodes=np.vstack([upper.nodes, heads, middle]))
    flipped = replace(
        plate, nodes=plate.nodes * [1, 1, -1], cells=plate.cells[:, [4, 5, 6, 7, 0, 1, 2, 3]]
    )
    steel = fy.Material(youngs_modulus=210e3, poissons_ratio=0.3, density=7.8e-9)
    references = (size - 1, 2 * size - 1)
    assembly = Assembly(
        mesh=stacked(flipped, plate),
        materials={1: steel, 2: steel},
        supports=(
            Support(id=1, nodes=np.array(references[:1]), components=(0, 1, 2, 3, 4, 5)),
            Support(id=2, nodes=np.array(references[1:]), components=(0, 1, 5)),
        ),
        rigid_couplings=tuple(
            RigidCoupling(
                id=one + 1,
                reference=reference,
                nodes=np.arange(reference - size + 1, reference),
                components=(0, 1, 2),
            )
            for one, reference in enumerate(references)
        ),
        springs=tuple(
            Spring(id=101 + i, ends=((n + i, 2), (size + n + i, 2)), stiffness=BOLT)
            for i in range(COUNT)
        ),
    )
    model = build_model(
        assembly,
        interfaces=[fy.InterfaceSpec(name="face", penalty=BED, quadrature=quadrature)],
        bolts=[fy.BoltSpec(name=name, elements=(101 + i,)) for i, name in enumerate(NAMES)],
        boundaries=[fy.BoundarySpec(name="head", node=2 * size)],
    )
    return fy.preload(model, dict.fromkeys(NAMES, PRELOAD))


def bolt_forces(solution):
    return np.array([float(solution.bolt_force(name)) for name in NAMES])


def opening_moment():
    """Moment beside PULL at which the edge opens."""
    lift = REST + PULL / (BED * AREA + COUNT * BOLT)
    return -lift / (SIDE / 2) * (BED * INERTIA + BOLT * (Y**2).sum())


def closed_forces(moment):
    """Forces of the bolts of the closed flange."""
    lift = PULL / (BED * AREA + COUNT * BOLT)
    return PRELOAD + BOLT * (lift + moment * Y / (BED * INERTIA + BOLT * (Y**2).sum()))


def half_open():
    """Moment beside PULL that opens the flange from EDGE on, and the forces of the bolts."""
    length = EDGE + SIDE / 2
    bed = BED * SIDE * length**2 / 2  # of the force per tilt; it acts 2/3 of the length inside
    tilt = (PULL - COUNT * (PRELOAD - BOLT * REST)) / (BOLT * (Y - EDGE).sum() - bed)
    forces = PRELOAD + BOLT * (tilt * (Y - EDGE) - REST)
    return (forces * Y).sum() - tilt * bed * (EDGE - 2 * length / 3), forces


def apart(pull, x_moment, y_moment):
    """Forces of the bolts of a flange that touches nowhere."""
    return pull / COUNT + x_moment * Y / (Y**2).sum() - y_moment * X / (X**2).sum()


TWISTED = (300e3, 4e5, -3e5)
"""Pull and moments that lift the flange off everywhere."""


def solved(model, pull, x_moment, y_moment=0.0):
    return fy.solve_static(
        model, fy.Load({"head.Fz": pull, "head.Mx": x_moment, "head.My": y_moment})
    )


def opened(divisions):
    """Factor of the load at which the first node opens, and the bolts of the half open flange."""
    model, (moment, _) = flange(divisions, "nodal"), half_open()
    load = fy.Load({"head.Fz": PULL, "head.Mx": opening_moment()}, name="tilt")
    all_closed = fy.Requirements(open_below=1.0)
    factor = fy.assess(model, [load], all_closed).interfaces["face"].opening["tilt"]
    return factor, bolt_forces(solved(model, PULL, moment))


def errors(factor, forces):
    """Relative errors of what ``opened`` returns."""
    return abs(factor - 1), np.abs(forces / half_open()[1] - 1).max()


@pytest.fixture(scope="module")
def gauss():
    return flange(12)


def test_closed_flange_shares_the_load_between_bolts_and_bed(gauss):
    """Gauss points integrate the square of y exactly; the preload is found to 1e-10 of itself."""
    moment = 0.5 * opening_moment()
    found = bolt_forces(solved(gauss, PULL, moment))
    assert found == pytest.approx(closed_forces(moment), rel=1e-9)


def test_bolts_of_a_flange_that_touches_nowhere_are_in_equilibrium(gauss):
    solution = solved(gauss, *TWISTED)
    assert solution.contact_force() == 0
    assert bolt_forces(solution) == pytest.approx(apart(*TWISTED), rel=1e-9)


def test_half_open_flange_tilts_about_the_edge_of_contact(gauss):
    """Contact ends within a facet, whose points are open or closed: off by 3e-4 of 20 kN."""
    moment, forces = half_open()
    solution = solved(gauss, PULL, moment)
    assert bolt_forces(solution) == pytest.approx(forces, rel=1e-3)
    y = gauss.interfaces["face"].points[:, 1]
    # Two points per facet of 5 mm: the edge lies between the last that is closed and the next.
    assert y[solution.pressure > 0].max() == pytest.approx(EDGE, abs=3.0)
    assert bolt_forces(solution).sum() - solution.contact_force() == pytest.approx(PULL, rel=1e-9)


def test_opening_moment_and_forces_after_it_converge_with_the_square_of_the_facets():
    """Weights at nodes are those of the trapezoidal rule, of second order for the bed's tilt."""
    coarse, fine = errors(*opened(8)), errors(*opened(16))
    assert max(fine) < 1e-2
    assert np.log2(np.divide(coarse, fine)) == pytest.approx([2.0, 2.0], abs=0.3)

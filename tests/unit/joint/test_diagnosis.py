"""What the message about an unconstrained structure says, by every route."""

import re
from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.joint.diagnosis import check_held
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import Spring, Support

JOINT = lap_joint_assembly(element_size=5.0)
MESH = JOINT.assembly.mesh
CLAMP = MESH.node_sets["clamp"]
LOWER_EDGE = CLAMP[MESH.nodes[CLAMP, 2] == MESH.nodes[CLAMP, 2].min()]
TIP = int(MESH.node_index(np.array([JOINT.boundaries[0].node]))[0])


def model(*, joint=JOINT, bolts=None, **changes) -> fy.Model:
    return fy.build_model(
        replace(joint.assembly, **changes),
        interfaces=joint.interfaces,
        bolts=joint.bolts if bolts is None else bolts,
        boundaries=joint.boundaries,
    )


def massless() -> dict:
    """Nothing balances loads in motions of a joint as a whole if it has no mass."""
    assembly = JOINT.assembly
    materials = {number: replace(one, density=0.0) for number, one in assembly.materials.items()}
    beams = tuple(
        replace(beam, material=replace(beam.material, density=0.0)) for beam in assembly.beams
    )
    return {"materials": materials, "beams": beams}


def supported(nodes, components) -> dict:
    return {"supports": (Support(id=1, nodes=nodes, components=components),)}


def axial_bolt() -> dict:
    """A spring along the bolt in place of its beam: the upper plate can slide, turn and tilt."""
    first, second = JOINT.assembly.beams[0].nodes
    spring = Spring(id=900, ends=((first, 2), (second, 2)), stiffness=1e5)
    return {"beams": (), "springs": (spring,), "bolts": [fy.BoltSpec(name="bolt", elements=[900])]}


ROUTES = {
    "check": check_held,
    "condensed": fy.solve_static,
    "Newton": fy.solve_static_newton,
    "compliance": fy.interface_compliance,
    "tightening": lambda model: fy.preload(model, {"bolt": 1e3}),
}


@pytest.mark.parametrize("route", ROUTES)
def test_every_route_names_the_body(route):
    loose = model(supports=(), **massless())
    text = "unconstrained body: body 'upper' .* is held by nothing, and with it body 'lower'"
    with pytest.raises(ModelError, match=text):
        ROUTES[route](loose)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"beams": (), "bolts": ()}, r"body 'upper' \(nodes \d+ to \d+\) is held by nothing; supp"),
        (supported(CLAMP, (1, 2)), "can move freely along (1.00, 0.00, 0.00) (one of 3 free moti"),
        (
            supported(LOWER_EDGE, (0, 1, 2)),
            "can turn freely about the axis (0.00, 1.00, 0.00) through (-55, 0, -10)",
        ),
        (supported(LOWER_EDGE[:1], (0, 1, 2)), "can turn freely about the axis"),
        (axial_bolt(), "(one of 5 free motions)"),
    ],
    ids=["no bolt", "sliding", "hinged", "one node", "axial bolt"],
)
def test_the_motion_is_described(changes, text):
    pattern = text if "\\" in text else re.escape(text)
    loose = model(**{**massless(), **changes})
    for route in ("check", "condensed", "Newton"):
        with pytest.raises(ModelError, match=pattern):
            ROUTES[route](loose)


def test_a_plate_held_by_contact_alone_is_free():
    joint = lap_joint_assembly(element_size=5.0, plates=3, tip_suspension=(0.0, 0.0))
    with pytest.raises(ModelError, match=r"body 'middle' .*contact alone holds nothing"):
        check_held(model(joint=joint))


@pytest.mark.parametrize("options", [{}, {"plates": 3}, {"washer": "rbe3"}, {"shape": "tet10"}])
def test_held_models_pass(options):
    check_held(model(joint=lap_joint_assembly(element_size=5.0, **options)))


def test_soft_springs_hold():
    # A millionth of the stiffness of the elements: far above rounding.
    joint = lap_joint_assembly(element_size=5.0, plates=3, tip_suspension=(1e-2, 10.0))
    check_held(model(joint=joint))


def test_given_matrices_are_judged_by_their_connected_parts():
    """Two bars of two nodes each, the second one free along x."""
    bar = np.array([[1.0, -1.0], [-1.0, 1.0]])
    K = np.block([[bar + np.diag([1.0, 0.0]), np.zeros((2, 2))], [np.zeros((2, 2)), bar]])
    from faying.io.matrices import matrices_assembly
    from faying.joint.diagnosis import unconstrained
    from faying.model.constraints import constrain
    from faying.model.matrices import used_components

    nodes = np.array([[0.0, 0, 0], [1, 0, 0], [5, 0, 0], [6, 0, 0]])
    dofs = [[1, 1], [2, 1], [3, 1], [4, 1]]
    assembly = matrices_assembly(np.eye(4), K, nodes=nodes, dofs=dofs)
    message = unconstrained(
        assembly, constrain(assembly, used_components(assembly)), assembly.matrices.K, np.ones(4)
    )
    assert "body (nodes 3 to 4) can move freely along (1.00, 0.00, 0.00);" in message

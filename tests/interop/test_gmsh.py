"""Meshes that gmsh itself makes: fragmented parts, and parts meshed apart with matching faces."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.model.assembly import Spring

try:
    import gmsh
except (ImportError, OSError) as error:  # the wheel needs libraries of a desktop (libGLU)
    pytest.skip(f"gmsh cannot be loaded: {error}", allow_module_level=True)

STEEL = fy.Material(name="steel", youngs_modulus=210e3, poissons_ratio=0.29, density=7.82e-9)
BOLT = fy.BoltSpec(name="bolt", axis=((0, 0, -10), (0, 0, 10)), diameter=6.0, washer_radius=6.0)
TIP = fy.BoundarySpec(name="tip", set="tip", coupling="rbe2", at=(55.0, 0.0, 5.0))
JOINT = fy.InterfaceSpec(name="joint", minus="lower", plus="upper", penalty=1e5)
LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
SIZE = 6.0


@pytest.fixture
def model():
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", SIZE)
    gmsh.model.add("lap")
    yield gmsh.model
    gmsh.finalize()


def plates(model):
    """The seed's plates: two boxes with an overlap of 40 x 20."""
    lower = model.occ.addBox(-55, -10, -10, 75, 20, 10)
    upper = model.occ.addBox(-20, -10, 0, 75, 20, 10)
    return lower, upper


def named(model, volumes):
    for name, members in volumes.items():
        model.addPhysicalGroup(3, members, name=name)
    for _, face in model.getEntities(2):
        x = model.occ.getCenterOfMass(2, face)[0]
        for name, place in (("clamp", -55), ("tip", 55)):
            if abs(x - place) < 1e-6:
                model.addPhysicalGroup(2, [face], name=name)


def fragment(model):
    """Let the plates share the face where they touch."""
    lower, upper = plates(model)
    _, pieces = model.occ.fragment([(3, lower)], [(3, upper)])
    model.occ.synchronize()
    volumes = {
        name: [tag for _, tag in found]
        for name, found in zip(("lower", "upper"), pieces, strict=True)
    }
    named(model, volumes)


def meshed(model, path, *, order=2, version=4.1):
    gmsh.option.setNumber("Mesh.ElementOrder", order)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    model.mesh.generate(3)
    gmsh.write(str(path))
    return path


def joint_of(path, **options):
    return fy.read_mesh(
        path,
        materials={"default": STEEL},
        supports=options.pop("supports", {"clamp": (0, 1, 2)}),
        interfaces=[JOINT],
        bolts=[BOLT],
        boundaries=[TIP],
        **options,
    )


def answer(model):
    preloaded = fy.preload(model, {"bolt": 10e3})
    return fy.solve_static(preloaded, LOAD)


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("order", [1, 2])
def test_fragmented_parts_come_apart(model, tmp_path: Path, version, order):
    fragment(model)
    path = meshed(model, tmp_path / "lap.msh", order=order, version=version)
    with pytest.raises(ModelError):  # one body: nothing can touch
        joint_of(path)
    joint = joint_of(path, separate=["upper"])
    assert joint.interfaces["joint"].area == pytest.approx(800.0, rel=1e-12)
    assert joint.assembly.mesh.n_elements > 100
    solution = answer(joint)
    # equilibrium: the joint carries the bolt's force and the load
    assert solution.contact_force("joint") == pytest.approx(
        float(solution.bolt_force("bolt")) + 500.0, rel=1e-9
    )


def test_tetrahedra_agree_with_the_built_in_bricks(model, tmp_path: Path):
    fragment(model)
    ours = joint_of(meshed(model, tmp_path / "lap.msh"), separate=["upper"])
    bricks = fy.lap_joint(shape="hex20", hole_radius=None, penalty=1e5, element_size=5.0)
    tips = [answer(joint).displacement("tip")[2] for joint in (ours, bricks)]
    # two meshes of quadratic elements; washers seat on different nodes, worth a percent or two
    assert tips[0] == pytest.approx(tips[1], rel=0.03)


@pytest.mark.long
def test_a_free_joint_vibrates_as_on_soft_springs(model, tmp_path: Path):
    """Full and reduced, elastic modes counted from 1."""
    fragment(model)
    path = meshed(model, tmp_path / "lap.msh", order=1)
    free = joint_of(path, separate=["upper"], supports={}).with_bolt_forces({"bolt": 10e3})
    assert free.rigid_motions.shape[1] == 6
    mesh = free.assembly.mesh
    ends = mesh.nodes[:, 0].argmin(), mesh.nodes[:, 0].argmax(), mesh.nodes[:, 1].argmax()
    # On which it swings at 0.6 Hz and less: (0.6/658)² is 1e-6.
    springs = tuple(
        Spring(id=free.assembly.largest_id + 1 + 3 * i + c, ends=((int(node), c),), stiffness=1e-3)
        for i, node in enumerate(ends)
        for c in range(3)
    )
    bolt = fy.BoltSpec(name="bolt", elements=[beam.id for beam in free.assembly.beams])
    hung = replace(free.assembly, springs=springs)
    soft = fy.build_model(hung, interfaces=[JOINT], bolts=[bolt])
    soft = soft.with_bolt_forces({"bolt": 10e3})
    np.testing.assert_allclose(
        fy.preloaded_frequencies(free, 3), fy.preloaded_frequencies(soft, 9)[6:], rtol=1e-5
    )
    rubbing = free.with_friction(0.2)
    reduced = fy.reduce(rubbing, fy.craig_bampton(rubbing, normal_modes=40), compliance=True)
    full, fast = (fy.backbone(one, 1, [0.05], increments=8) for one in (rubbing, reduced))
    # With 20 normal modes it was 3e-4 off.
    assert fast.frequency[0] == pytest.approx(full.frequency[0], rel=2e-4)
    assert fast.friction_damping[0] == pytest.approx(full.friction_damping[0], rel=5e-3)
    assert full.friction_damping[0] > 1e-5


@pytest.mark.slow
def test_a_joint_is_shaken_full_and_reduced_as_its_backbone_says(model, tmp_path: Path):
    """Where no neighbour resonates; slip takes what the load feeds less damping."""
    fragment(model)
    path = meshed(model, tmp_path / "lap.msh", order=1)
    joint = joint_of(path, separate=["upper"], damping=fy.Rayleigh(alpha=50.0))
    joint = joint.with_bolt_forces({"bolt": 8e3}).with_friction(0.2)
    swing = fy.backbone(joint, 1, [1e-3, 1e-2, 3e-2, 0.1, 0.2, 0.4])
    first, load, level = swing.small_frequency, {"tip.Fz": 1.0}, 5.0
    span = (0.97 * first, 1.02 * first)
    estimate = fy.backbone_response(joint, swing, load, span, [level]).curves[0].peak("tip.uz")
    asked = estimate.frequency * np.array([0.995, 1.0, 1.005])
    basis = fy.craig_bampton(joint, normal_modes=30)
    moved = []
    for system in (joint, fy.reduce(joint, basis, compliance=True)):
        (curve,) = fy.frequency_response(system, load, asked, [level], harmonics=3).curves
        assert curve.missed == ()
        assert np.abs(curve.contact.imbalance).max() < 0.02
        assert (curve.contact.friction_energy > 0.2 * curve.contact.load_work).all()
        peak = curve.peak("tip.uz")
        # It was 2.4 %; the peak between frequencies lies 3 in 1000 beside the estimate.
        assert peak.amplitude == pytest.approx(estimate.amplitude, rel=0.03)
        assert peak.frequency == pytest.approx(estimate.frequency, rel=5e-3)
        rows = [int(np.abs(curve.frequency - frequency).argmin()) for frequency in asked]
        moved.append(curve.response("tip.uz")[rows])
    full, reduced = moved
    # 4e-4 was seen.
    np.testing.assert_allclose(reduced, full, atol=1e-3 * np.abs(full).max())


def test_parts_meshed_apart_match_by_periodic_faces(model, tmp_path: Path):
    """The how-to's recipe: imprint, keep two volumes, let one face copy the other's mesh."""
    lower, upper = plates(model)
    face = model.occ.addRectangle(-20, -10, 0, 40, 20)
    other = model.occ.addRectangle(-20, -10, 0, 40, 20)
    low, _ = model.occ.fragment([(3, lower)], [(2, face)], removeTool=True)
    top, _ = model.occ.fragment([(3, upper)], [(2, other)], removeTool=True)
    model.occ.synchronize()
    volumes = {
        "lower": [tag for dimension, tag in low if dimension == 3],
        "upper": [tag for dimension, tag in top if dimension == 3],
    }
    sides = []
    for members in volumes.values():
        faces = model.getBoundary([(3, tag) for tag in members], oriented=False)
        sides.append(
            next(
                tag
                for _, tag in faces
                if np.allclose(model.occ.getCenterOfMass(2, tag), (0, 0, 0), atol=1e-6)
            )
        )
    identity = np.eye(4).ravel().tolist()
    model.mesh.setPeriodic(2, [sides[1]], [sides[0]], identity)
    named(model, volumes)
    joint = joint_of(meshed(model, tmp_path / "lap.msh"))
    assert joint.interfaces["joint"].area == pytest.approx(800.0, rel=1e-12)
    assert float(answer(joint).max_pressure) > 0

"""A small joint as FMU, and what compares it with our integrators; for the tests of FMUs."""

import ctypes
from dataclasses import replace

import fmpy
import numpy as np
import pytest
from fmpy import fmi2, fmi3

import faying as fy
from faying.export import fmu as fmu_export
from faying.export.fmu import archive, library

NEEDS_COMPILER = pytest.mark.skipif(
    library.compiler() is None, reason="there is no C compiler (apt install gcc)"
)
SCHEMES = {
    "implicit-euler": (fy.ImplicitEuler(), {"integrator": 0}),
    "energy-decaying": (fy.EnergyDecaying(0.6), {"integrator": 2, "rho_infinity": 0.6}),
    "generalized-alpha": (fy.GeneralizedAlpha(0.6), {"integrator": 1, "rho_infinity": 0.6}),
}
STEP = 1e-5
N_STEP = 40
FORCES = {"tip.Fz": -500.0, "tip.Mx": 20e3}

EQUAL = 1e-9
"""Relative. Both solve every step to round-off; what is left is round-off times the condition of
the contact problem, measured 1e-11 at most."""

BOLT = ("bolt.initial_force", float)
SEEN = ("tip.uz", "tip.vz", "bolt.force", "joint.max_pressure")


def handed_over(**parameters):
    model = fy.lap_joint(
        **{"element_size": 5.0, **parameters}, damping=fy.Rayleigh(alpha=160.0, beta=5e-7)
    )
    joint = fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())
    basis = fy.craig_bampton(joint, normal_modes=8)
    return replace(fy.reduce(joint, basis, compliance=True), name="lap joint")


def rubbing_joint(*, tangential_penalty=8e5, **parameters):
    smooth = fy.lap_joint(
        **{"element_size": 5.0, "penalty": 1e6, **parameters},
        damping=fy.Rayleigh(alpha=160.0, beta=5e-7),
    )
    tight = smooth.with_bolt_forces({"bolt": 10e3})
    model = tight.with_friction(0.2, tangential_penalty=tangential_penalty)
    return fy.reduce(model, fy.craig_bampton(model, normal_modes=10), compliance=True)


_LIBRARIES = {}


def written(rom, path):
    """Write FMUs; their libraries, the same for all joints, are compiled once in a test run."""

    def compiled(source, target):
        if source.name not in _LIBRARIES and library.compile_library(source, target):
            _LIBRARIES[source.name] = target.read_bytes()
        target.write_bytes(_LIBRARIES[source.name])
        return True

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(archive, "compile_library", compiled)
        return fmu_export.write(rom, path)


def unpacked(rom, folder):
    """Write FMUs into a folder; return their files, and FMI version to where each is extracted."""
    files = written(rom, folder / "joint.fmu")
    return files, {
        version: fmpy.extract(str(file), unzipdir=str(folder / f"fmi{version}"))
        for version, file in zip((2, 3), files, strict=True)
    }


def outputs(system):
    """Output name to what a solution of ours has in its place."""
    found = {
        f"tip.{name}": lambda solution, i=i: solution.displacement("tip")[..., i]
        for i, name in enumerate(("ux", "uy", "uz", "rx", "ry", "rz"))
    }
    return found | {
        "tip.vz": lambda solution: solution.velocities[..., system.boundaries["tip"].dofs[2]],
        "bolt.force": lambda solution: solution.bolt_force("bolt"),
        "joint.contact_force": lambda solution: solution.contact_force("joint"),
        "joint.max_pressure": lambda solution: solution.max_pressure,
        "joint.open_fraction": lambda solution: solution.open_fraction("joint"),
        "modal.a[1]": lambda solution: solution.accelerations[..., 0],
    }


def held(time, forces, initial_force):
    """Input table of fmpy: all inputs, those not named are zero."""
    names = ["tip.Fx", "tip.Fy", "tip.Fz", "tip.Mx", "tip.My", "tip.Mz"]
    columns = [np.broadcast_to(forces.get(name, 0.0), np.shape(time)) for name in names]
    columns.append(np.full(np.shape(time), initial_force))
    table = np.zeros(len(time), dtype=[("time", float), *((n, float) for n in names), BOLT])
    table["time"] = time
    for name, column in zip([*names, BOLT[0]], columns, strict=True):
        table[name] = column
    return table


def assert_equal(result, solution, chosen, every=1):
    for name, value in chosen.items():
        ours = value(solution)[::every]
        scale = np.abs(ours).max()
        # Lateral motions vanish by symmetry but for round-off.
        scale = max(scale, 1e-3 * np.abs(solution.displacement("tip")).max())
        np.testing.assert_allclose(result[name], ours, rtol=0, atol=EQUAL * scale, err_msg=name)


def simulate(place, table, start, *, interval=STEP, count=N_STEP, **options):
    return fmpy.simulate_fmu(
        str(place),
        stop_time=STEP * count,
        output_interval=interval,
        input=table,
        start_values={"step_size": STEP, "start_loaded": False, **start},
        **options,
    )


class Instance:
    """One instance of an FMU under direct control; ``log`` takes messages of FMI 3.0."""

    def __init__(self, place, version, log=None):
        self.description = fmpy.read_model_description(str(place))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.version = version
        kind = fmi2.FMU2Slave if version == 2 else fmi3.FMU3Slave
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=str(place),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="joint",
        )
        self.fmu.instantiate(**({} if log is None else {"logMessage": log}))

    def start(self, time=0.0, **parameters):
        if self.version == 2:
            self.fmu.setupExperiment(startTime=time)
        for name, value in {"step_size": STEP, **parameters}.items():
            self.set(name, value)
        if self.version == 2:
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=time)
        self.fmu.exitInitializationMode()
        self.time = time

    def set(self, name, value):
        reference = [self.references[name]]
        if isinstance(value, bool):
            self.fmu.setBoolean(reference, [value])
        elif isinstance(value, int):
            (self.fmu.setInteger if self.version == 2 else self.fmu.setInt32)(reference, [value])
        else:
            (self.fmu.setReal if self.version == 2 else self.fmu.setFloat64)(reference, [value])

    def set_rate(self, name, value):
        reference = (ctypes.c_uint * 1)(self.references[name])
        order, rate = (ctypes.c_int * 1)(1), (ctypes.c_double * 1)(value)
        self.fmu.fmi2SetRealInputDerivatives(self.fmu.component, reference, 1, order, rate)

    def get(self, *names):
        getter = self.fmu.getReal if self.version == 2 else self.fmu.getFloat64
        return getter([self.references[name] for name in names])

    def run(self, count, force, length=STEP, along="tip.Fz", seen=SEEN):
        found = []
        for step in range(count):
            self.set(along, force * np.cos(step))
            self.fmu.doStep(self.time, length)
            self.time += length
            found.append(self.get(*seen))
        return np.array(found)

    def state(self, act, *given):
        """Call a function of FMI about a kept state, as "get", "set", "serialize" and "free"."""
        names = {"deserialize": "deSerialize"} if self.version == 2 else {}
        name = "FMUstate" if self.version == 2 else "FMUState"
        return getattr(self.fmu, names.get(act, act) + name)(*given)

    def close(self):
        self.fmu.freeInstance()

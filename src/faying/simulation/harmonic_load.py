"""Loads that go to and fro in time as harmonics, each with an amplitude and a phase."""

from collections.abc import Mapping

import numpy as np

from faying._typing import ComplexVector
from faying.exceptions import ModelError
from faying.joint.system import System
from faying.simulation.load import Load


def harmonic_inputs(system: System, load: Mapping[str, complex]) -> ComplexVector:
    """Return the complex amplitudes F of inputs (n_input,), f(t) = Re(F exp(iωt)).

    The load is ``"boundary.component"``, or the name of a load pattern, to its complex amplitude.
    """
    if not any(load.values()):
        message = "the harmonic load is zero; give an amplitude, as {'tip.Fz': 1.0}"
        raise ModelError(message)
    start = np.zeros(1)
    still = Load().inputs(system, start)[0]

    def part(values: Mapping[str, float]) -> ComplexVector:
        moved = Load(values, name="harmonic load").inputs(system, start)[0] - still
        return np.asarray(moved, dtype=complex)

    real = part({name: float(np.real(value)) for name, value in load.items()})
    return real + 1j * part({name: float(np.imag(value)) for name, value in load.items()})

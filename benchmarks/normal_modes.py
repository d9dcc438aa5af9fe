"""How many normal modes are chosen for a pressure tolerance, and what they are truly worth.

``python benchmarks/normal_modes.py [PART [JOINT…]]`` prints the table of
docs/theory/transient_accuracy.md: tolerance 3 %, over a part of the longest period (a quarter) at
100 steps per period; processor seconds of the choice, the normal modes that the joint's other loads
tried not counted twice, and of the full model. With friction beside the pressures' errors those of
the tractions. Needs gmsh for the pipe flange.
"""

import sys
import tempfile
import time
from functools import cache, partial
from itertools import chain
from pathlib import Path

from method_ranges import STEPS, Joint, joints, rising
from transient_friction import LOAD, joint

import faying as fy
from faying.reduction.normal_modes import fixed_interface_normal_modes
from faying.reduction.projection import projected

LOADS = {"jump": 0.0, "rise over T/10": 0.1, "rise over T/4": 0.25, "rise over T": 1.0}
SCHEMES = {"implicit Euler": fy.ImplicitEuler(), "generalized-α 0.8": fy.GeneralizedAlpha(0.8)}


def main(part: float, chosen: set[str]) -> None:
    """Print a row for each joint, load and scheme."""
    write = sys.stdout.write
    write("| joint | load, scheme | tried | chosen | met | estimated | true | seconds | full |\n")
    write(f"{'|---' * 9}|\n")
    with tempfile.TemporaryDirectory() as folder:
        for one in chain([rubbing()], joints(Path(folder))):
            if chosen and one.name not in chosen:
                continue
            model = one.model
            period = 1.0 / fy.preloaded_frequencies(model, 1)[0]
            modes = cache(partial(fixed_interface_normal_modes, model.structure))
            for label, within in LOADS.items():
                load = fy.Load(one.bending)
                if within:
                    load = rising(one.bending, period, within)
                for scheme, integrator in SCHEMES.items():
                    options = {
                        "step": period / STEPS,
                        "duration": part * period,
                        "integrator": integrator,
                    }
                    begin = time.process_time()
                    found = fy.choose_normal_modes(model, load, modes=modes, **options)
                    middle = time.process_time()
                    full = fy.solve_transient(model, load, **options)
                    end = time.process_time()
                    basis = fy.craig_bampton(model, normal_modes=found.count)
                    rom = projected(model, basis, compliance=True)
                    motion = fy.solve_transient(rom, load, **options)
                    off = fy.compare(motion, full)
                    true = shown(off.max_relative_error, off.max_traction_error)
                    said = shown(found.error, found.traction_error)
                    write(
                        f"| {one.name} | {label}, {scheme} | "
                        f"{', '.join(map(str, found.counts.tolist()))} | {found.count} | "
                        f"{'yes' if found.met else 'no'} | {said} | "
                        f"{true} | {middle - begin:.1f} | "
                        f"{end - middle:.1f} |\n"
                    )
                    sys.stdout.flush()


def rubbing() -> Joint:
    """Return the cantilever of transient_friction.py."""
    return Joint("cantilever, friction", joint(), dict(LOAD.forces), {})


def shown(pressures: float, tractions: float | None) -> str:
    """Return errors of pressures and, where there are any, of tractions."""
    return f"{pressures:.2%}" + ("" if tractions is None else f", tractions {tractions:.2%}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if sys.argv[1:] else 0.25, set(sys.argv[2:]))

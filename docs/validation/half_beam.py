"""The half Brake–Reuß beam: a joint whose frequency and damping over amplitude were measured.

``python docs/validation/half_beam.py FOLDER`` writes deck, study and measured curve into the folder
and compares the study as it stands: table and figure of docs/measured_joint.md. ``faying fit
FOLDER/half_beam.toml`` looks for the parameters again. With ForcedFrequencyResponses.mat of
github.com/mattiacenedese/BRBtesting behind the folder it predicts the force-controlled curves.
"""

import sys
from itertools import product
from pathlib import Path

import numpy as np
from matplotlib import pyplot
from scipy.io import loadmat

import faying as fy
from faying._typing import Vector
from faying.assessment.measured_curve import deviations
from faying.assessment.stuck_modes import stuck_modes
from faying.report.figures.backbone import draw_fit
from faying.study.keys.measurements import measured_curves
from faying.study.keys.schema import read_study
from faying.study.stages.varied import varied_joint

FRICTION, PRELOAD, CROWN = 0.265, 14.5e3, 0.153
"""Coefficient, force of each bolt [N], and gap at the ends of the lap [mm]: fitted to the curve
below and to nothing else."""

CURVE = (
    (0.0196, 80.367, 0.153),
    (0.0792, 80.187, 0.198),
    (0.1214, 80.183, 0.238),
    (0.1584, 80.122, 0.302),
    (0.1976, 80.267, 0.383),
    (0.2364, 80.363, 0.460),
    (0.2756, 80.447, 0.557),
    (0.3147, 80.507, 0.643),
)
"""Displacement at the driving point [mm], frequency [Hz] and damping [%]: complex fits of a mode
and a constant to the response-controlled curves of github.com/mattiacenedese/BRBtesting, test of
doi 10.1016/j.ymssp.2021.108401."""

PEAKS = (80.5, 297.7, 580.7, 845.7, 1175.0, 1527.0)
"""Of small vibrations [Hz], in the direction that the sensors measure."""

LENGTH, WIDTH, HEIGHT, LAP = 720.0, 25.4, 12.7, 120.0
ALONG, ACROSS = 32, 8
"""Bricks of the lap, which have two over the thickness of each half."""

BOLT = """
[[bolt]]
name = "{name}"
axis = [[{x}, 0.0, -6.35], [{x}, 0.0, 6.35]]
diameter = 7.94
washer_radius = 8.7
washer = "rbe3"
mass = false                     # the holes are filled
end_masses = [5.65e-6, 5.65e-6]  # head, washer and nut
preload = {preload}
"""

STUDY = """
title = "Half Brake-Reuss beam"
units = "mm-t-s"
friction_during_preload = false

[model]
source = "abaqus"
file = "half_beam.inp"

[[interface]]
name = "I"
minus = "UPPER"
plus = "LOWER"
friction = {friction}

[[interface.crown]]
origin = [360.0, 0.0, 0.0]
along = [1.0, 0.0, 0.0]
distance = 60.0
height = {crown}
{bolts}
[[boundary]]
name = "driving point"
set = "ACC3"

[[mass]]
name = "impedance head"
set = "ACC3"
mass = 19e-6

[[mass]]
name = "accelerometer"
set = "ACC1"
mass = 1e-6

[[mass]]
name = "accelerometer"
set = "ACC2"
mass = 1e-6

[damping]
alpha = 1.426    # 0.141 %, that of the smallest decay of the hammer test

[[measurement]]
name = "stepped sine"
load_case = "damping"
mode = 1
file = "stepped.csv"
frequency_scatter = 0.01    # modulus, mass and length are known to a percent
damping_scatter = 0.1       # by which stepped sine and hammer differ

[[parameter]]
name = "friction"
keys = ["interface.I.friction"]
range = [0.1, 0.8]

[[parameter]]
name = "preload"
keys = ["bolt.b1.preload", "bolt.b2.preload", "bolt.b3.preload"]
range = [4e3, 20e3]

[[parameter]]
name = "crown"
keys = ["interface.I.crown.1.height"]
range = [0.02, 0.4]

[validation]
reference = "none"

[[load_case]]
name = "damping"
kind = "backbone"
modes = [1]
amplitudes = [0.0185, 0.1, 0.2, 0.33]
increments = 6
at = "driving point.uz"
"""


SENSORS = {
    "ACC1": ("LOWER", 25.4, HEIGHT / 2),
    "ACC2": ("UPPER", LENGTH - 165.1, -HEIGHT / 2),
    "ACC3": ("UPPER", LENGTH - 76.2, -HEIGHT / 2),
}
"""Body, x and z of the sensors."""


def deck() -> str:
    """Return the beam as an Abaqus deck: two bodies of C3D8I, left low and right high."""
    y = np.linspace(-WIDTH / 2, WIDTH / 2, ACROSS + 1)
    low, high = np.linspace(-HEIGHT / 2, 0, 3), np.linspace(0, HEIGHT / 2, 3)
    whole = np.concatenate([low, high[1:]])
    start, end = (LENGTH - LAP) / 2, (LENGTH + LAP) / 2
    left, lap = np.linspace(0, start, 31), np.linspace(start, end, ALONG + 1)
    right = np.linspace(end, LENGTH, 31)
    ids: dict[tuple[str, float, float, float], int] = {}
    lines, number = ["*NODE"], 0
    elements = []
    for body, blocks in (
        ("LOWER", ((left, whole), (lap, low))),
        ("UPPER", ((lap, high), (right, whole))),
    ):
        elements.append(f"*ELEMENT, TYPE=C3D8I, ELSET={body}")
        for x, z in blocks:
            for point in product(x.round(6), y.round(6), z.round(6)):
                ids.setdefault((body, *map(float, point)), len(ids) + 1)
            for i, j, k in product(range(len(x) - 1), range(ACROSS), range(len(z) - 1)):
                corners = [
                    ids[body, *(float(t[n].round(6)) for t, n in ((x, a), (y, b), (z, c)))]
                    for c in (k, k + 1)
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
                ]
                number += 1
                elements.append(", ".join(map(str, [number, *corners])))
    lines += [f"{n}, {x:.8g}, {y:.8g}, {z:.8g}" for (_, x, y, z), n in ids.items()]
    lines += elements
    for sensor, (body, x, z) in SENSORS.items():
        distances = {
            n: abs(node[1] - x) + abs(node[2]) + abs(node[3] - z)
            for node, n in ids.items()
            if node[0] == body
        }
        lines += [f"*NSET, NSET={sensor}", str(min(distances, key=distances.__getitem__))]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "193000., 0.29", "*DENSITY", "8e-9"]
    lines += [f"*SOLID SECTION, ELSET={body}, MATERIAL=STEEL" for body in ("LOWER", "UPPER")]
    return "\n".join([*lines, "*STEP", "*STATIC", "*END STEP", ""])


def write(folder: Path) -> Path:
    """Write deck, measured curve and study; return the study."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "half_beam.inp").write_text(deck(), encoding="utf-8")
    rows = [f"{amplitude},{f},{zeta / 100}" for amplitude, f, zeta in CURVE]
    (folder / "stepped.csv").write_text(
        "\n".join(["amplitude,frequency,damping", *rows, ""]), encoding="utf-8"
    )
    bolts = "".join(
        BOLT.format(name=f"b{number}", x=x, preload=PRELOAD)
        for number, x in enumerate((330.0, 360.0, 390.0), 1)
    )
    study = folder / "half_beam.toml"
    study.write_text(STUDY.format(friction=FRICTION, crown=CROWN, bolts=bolts), encoding="utf-8")
    return study


def peaks(system: fy.ReducedModel, state: fy.Solution) -> Vector:
    """Return frequencies of small vibrations that move the driving point along the sensors."""
    modes = stuck_modes(system, state, 1600.0, 1)
    (row,) = (
        dof
        for dof, component in zip(
            system.boundaries["driving point"].dofs,
            system.boundaries["driving point"].components,
            strict=True,
        )
        if component == 2
    )
    moved = np.abs(modes.shapes[row])
    return np.asarray(modes.frequencies[moved > 0.05 * moved.max()])


def compare(path: Path) -> None:
    """Print the computed curve beside the measured one, and the peaks of small vibrations."""
    study = read_study(path)
    system, state = varied_joint(study).tightened({})
    levels = np.geomspace(0.019, 0.33, 9)
    curve = fy.backbone(system, 1, levels, at="driving point.uz", initial=state, increments=40)
    (test,) = measured_curves(study)
    differences = deviations(test, curve)
    rows = ["| amplitude [mm] | f [Hz] | computed | ζ [%] | computed |", "|---|---|---|---|---|"]
    for n, (amplitude, f, zeta) in enumerate(CURVE):
        rows.append(
            f"| {amplitude} | {f:.2f} | {differences.frequency[n]:.2f} "
            f"({100 * differences.frequency_error[n]:+.1f} %) | {zeta:.3f} "
            f"| {100 * differences.damping_ratio[n]:.3f} "
            f"({100 * differences.damping_error[n]:+.0f} %) |"
        )
    draw_fit(curve, test).savefig(path.with_suffix(".png"))
    small = peaks(system, state)
    rows.append(f"small vibrations {small.round(1).tolist()} Hz, measured {list(PEAKS)}")
    sys.stdout.write("\n".join([*rows, ""]))


def predict(path: Path, measured: Path) -> None:
    """Compare the force-controlled curves, which nothing was fitted to, under their own forces.

    Parameters
    ----------
    measured
        ``ForcedFrequencyResponses.mat`` of the repository of the test.
    """
    tests = loadmat(measured, squeeze_me=True, struct_as_record=False)["FRdata"].ForceControl
    system, state = varied_joint(read_study(path)).tightened({})
    levels = np.geomspace(0.01, 0.36, 8)
    curve = fy.backbone(system, 1, levels, at="driving point.uz", initial=state, increments=24)
    rows = [
        "| force [N] | f [Hz] | predicted | amplitude [mm] | predicted | curve | moved |",
        "|---|---|---|---|---|---|---|",
    ]
    axes = pyplot.figure(figsize=(7.0, 4.2), layout="constrained").add_subplot()
    for number, test in enumerate(tests):
        amplitude = 1e3 * test.amplitude / (2 * np.pi * test.frequency) ** 2
        top = int(np.argmax(amplitude))
        force, f, highest = test.force[top], test.frequency[top], amplitude[top]
        # The force falls towards the peak: each point has its own.
        swept = fy.backbone_response(
            system, curve, {"driving point.Fz": 1.0}, (77.0, 84.0), test.force, initial=state
        )
        ups = [
            (one.frequency[one.swept_up], np.abs(one.response("driving point.uz")[one.swept_up]))
            for one in swept.curves
        ]
        peak = swept.curves[top].peak("driving point.uz")
        ratios = (peak.frequency / f, peak.amplitude / highest)
        error_f, error = (100 * (ratio - 1) for ratio in ratios)
        deviations_of = []
        for ratio, style in ((1.0, "-"), (ratios[0], "--")):
            there = [np.interp(ratio * at, *up) for at, up in zip(test.frequency, ups, strict=True)]
            deviations_of.append(100 * np.sqrt(np.mean((there - amplitude) ** 2)) / highest)
            axes.plot(test.frequency, there, style, color=f"C{number}")
        axes.plot(
            test.frequency, amplitude, "^", mfc="none", color=f"C{number}", label=f"{force:.2f} N"
        )
        rows.append(
            f"| {force:.3f} | {f:.2f} | {peak.frequency:.2f} ({error_f:+.1f} %) "
            f"| {highest:.4f} | {peak.amplitude:.4f} ({error:+.0f} %) "
            f"| {deviations_of[0]:.0f} % | {deviations_of[1]:.0f} % |"
        )
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("amplitude at the driving point [mm]")
    axes.legend(title="measured, at the peak")
    axes.get_figure().savefig(path.with_name("half_beam_forced.png"), dpi=110)
    sys.stdout.write("\n".join([*rows, ""]))


if __name__ == "__main__":
    study = write(Path(sys.argv[1]))
    if len(sys.argv) > 2:
        predict(study, Path(sys.argv[2]))
    else:
        compare(study)

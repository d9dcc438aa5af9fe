"""The data of the view: bodies, contact faces, bolts, and fields while there is room."""

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.colors import to_hex
from scipy.spatial import cKDTree

from faying._typing import Indices
from faying.assessment.joint_verdict import JointVerdict
from faying.display.quantities import percent
from faying.display.style import BODY_COLOURS, BOLT_COLOUR, PRESSURE_MAP
from faying.interface.surface import pair_facets
from faying.model.mesh import Mesh
from faying.report.figures.surface_map import Unrolled, best_plane, looks_both_ways
from faying.report.style import ERROR_MAP, GAP_MAP, OPEN_COLOUR, SLIP_MAP
from faying.report.view.fields import Frames, averages, fields, frames, models
from faying.report.view.outer_surface import OuterSurface, explosion, outer_surface, triangles_of
from faying.report.view.packing import packed_integers, packed_numbers
from faying.study.judgement.comparison import increments
from faying.study.judgement.verdict import run_verdict
from faying.study.results.values import CaseResult, InterfaceRecord, Response, Results

ROOM = 4_000_000
"""Bytes of the view's data; with scripts, text and tables the page stays below 5 MB."""

MOST_NODES = 150_000
"""Nodes of an outer surface above which only its edges are drawn."""


@dataclass(frozen=True, kw_only=True)
class SceneText:
    """A scene as JSON.

    Attributes
    ----------
    text
        JSON text, safe within a script element.
    notes
        Sentences about left out data.
    """

    text: str
    notes: tuple[str, ...]


def scene(results: Results, room: int = ROOM) -> SceneText | None:
    """Return the data of the view, at most about ``room`` bytes; None without a surface.

    The view starts with the deciding load case and field. The outer surface of the solids is
    shown, and nodal averages on the contact faces. Fields are added by priority until one does
    not fit.
    """
    verdict, pairs = (
        run_verdict(results),
        [interface.pairs for interface in results.interfaces.values()],
    )
    surface = outer_surface(
        Mesh(nodes=results.nodes, node_ids=np.arange(len(results.nodes)), blocks=results.blocks),
        np.concatenate([*(interface.ravel() for interface in pairs), np.empty(0, dtype=np.int64)]),
    )
    faces = any(record.faces for record in results.interfaces.values())
    if not len(surface.triangles) and not faces:
        return None  # matrices, without any elements
    notes = []
    if len(surface.nodes) > MOST_NODES:
        notes.append("The surface of the bodies is too large for a page; their edges are drawn.")
        surface = surface.outline(np.concatenate(pairs).ravel())
    units = results.unit_set
    frames_of = {name: frames(case, units) for name, case in results.cases.items()}
    shown: dict[str, Any] = {
        "units": {
            "length": units.length,
            "pressure": units.pressure,
            "force": units.force,
        },
        "colours": {
            "pressure": _scale(PRESSURE_MAP),
            "gap": _scale(GAP_MAP),
            "slip": _scale(SLIP_MAP),
            "error": _scale(ERROR_MAP),
            "open": OPEN_COLOUR,
            "bolt": BOLT_COLOUR,
            "bodies": BODY_COLOURS,
        },
        "bodies": _bodies(results, surface),
        "contact": _contact(results, surface),
        "bolts": _bolts(results, surface, verdict),
        "cases": [_case(case, frames_of[name]) for name, case in results.cases.items()],
    }
    shown |= _start(verdict, shown["cases"])
    if results.interfaces:
        shown["cases"].append(_preload(results))
    room -= len(json.dumps(shown))
    notes += _thinned(results)
    left_out = 0
    for field in fields(results, frames_of, surface.nodes):
        if left_out:
            left_out += 1
            continue
        packed: dict[str, Any] = {"at": field.at, **packed_numbers(field.values())}
        if field.amplitudes is not None:
            rows = [_short(row) for row in field.amplitudes.tolist()]
            packed |= {"amplitudes": rows, "largest": field.largest}
        room -= len(json.dumps({field.name: packed}))
        if room < 0:
            left_out += 1
            continue
        shown["cases"][field.case]["models"][field.model]["fields"][field.name] = packed
    if left_out:
        notes.append(f"{left_out} more fields are only in results.h5, to keep the page below 5 MB.")
    # A name could otherwise end the script.
    text = json.dumps(shown, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    return SceneText(text=text, notes=tuple(notes))


def _thinned(results: Results) -> list[str]:
    """Return a note about the number of shown states and shapes."""
    all_motions = (case.reference.motion for case in results.cases.values())
    motions = [motion for motion in all_motions if motion is not None]
    if not motions:
        return []
    states, shapes = (max(motion.amplitudes.shape[axis] for motion in motions) for axis in (0, 1))
    missed = max(motion.missed for motion in motions)
    return [
        f"Load cases in time or increments have up to {states} states here, displaced as the "
        f"reference, by up to {shapes} shapes with an error of at most {percent(missed)} of the "
        "largest displacement."
    ]


def _scale(name: str) -> list[str]:
    return [to_hex(colour) for colour in mpl.colormaps[name](np.linspace(0.0, 1.0, 33))]


def _bodies(results: Results, surface: OuterSurface) -> dict[str, Any]:
    return {
        "points": packed_numbers(results.nodes[surface.nodes]),
        "owner": packed_integers(np.maximum(results.body[surface.nodes], 0)[:, None]),
        "triangles": packed_integers(surface.triangles),
        "edges": packed_integers(surface.edges),
        "moves": explosion(results.interfaces, results.body).round(6).tolist() or [[0, 0, 0]],
    }


def _contact(results: Results, surface: OuterSurface) -> list[dict[str, Any]]:
    position = np.zeros(len(results.nodes), dtype=np.int64)
    position[surface.nodes] = np.arange(len(surface.nodes))
    return [_sides(name, record, results, position) for name, record in results.interfaces.items()]


def _sides(
    name: str, record: InterfaceRecord, results: Results, position: Indices
) -> dict[str, Any]:
    parts = [triangles_of(kind, nodes) for kind, nodes in pair_facets(record)]
    plane = best_plane(record)
    # Non-matching meshes share one set of points, since plus nodes are only neighbours.
    points = (
        results.nodes[record.pairs.T]
        if record.face_coverage is None
        else np.stack([record.pair_points] * 2)
    )
    return {
        "name": name,
        "points": [packed_numbers(side) for side in points],
        "nodes": [packed_integers(position[side][:, None]) for side in record.pairs.T],
        "triangles": packed_integers(np.concatenate([*parts, np.empty((0, 3), dtype=np.int64)])),
        "flat": packed_numbers(plane.project(record.pair_points)),
        "labels": plane.labels,
        "period": plane.period if isinstance(plane, Unrolled) else 0.0,
        "over": looks_both_ways(record),
    }


def _start(verdict: JointVerdict, cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the deciding load case and quantity, or the case of the largest pressure."""
    peaks, names = [case["peak"] for case in cases], [case["name"] for case in cases]
    check = verdict.decides
    if check is None or check.case not in names:
        return {"start": peaks.index(max(peaks)) if peaks else 0, "quantity": "pressure"}
    opens = check.outcome == "not met" and check.quantity.startswith(("opening", "clamp"))
    slides = check.quantity.startswith(("slid", "slip"))
    quantity = "gap" if opens else "slip" if slides else "pressure"
    return {"start": names.index(check.case), "quantity": quantity}


QUIET, LOUD = "#4d5761", "#d01c1c"
"""Colours of bolts: normal, and with a check that is not met."""


def _bolts(results: Results, surface: OuterSurface, verdict: JointVerdict) -> list[dict[str, Any]]:
    failed = {
        part.part for part in verdict.parts if part.kind == "bolt" and part.outcome == "not met"
    }
    tree = cKDTree(results.nodes[surface.nodes])
    return [
        {
            "name": name,
            "colour": LOUD if name in failed else QUIET,
            "failed": name in failed,
            "ends": bolt.axis.tolist(),
            "nodes": tree.query(bolt.axis)[1].tolist(),
        }
        for name, bolt in results.bolts.items()
        if bolt.axis is not None
    ]


def _case(case: CaseResult, shown: Frames) -> dict[str, Any]:
    paths = increments(case.reference)
    pressures = paths[-1].pressure if paths else case.reference.pressure
    return {
        "name": case.name,
        "kind": case.kind,
        "frames": {"label": shown.label, "unit": shown.unit, "values": _short(shown.values)},
        "peak": float(np.max(pressures, initial=0.0)),
        "models": [
            {"name": name, "bolts": _forces(response, shown), "fields": {}}
            for name, response in models(case)
        ],
    }


def _forces(response: Response, shown: Frames) -> dict[str, list[float]]:
    paths = increments(response)
    forces = paths[-1].bolt_forces if paths else response.bolt_forces
    return {
        name: _short(np.atleast_1d(force)[shown.chosen].tolist()) for name, force in forces.items()
    }


def _preload(results: Results) -> dict[str, Any]:
    """Return the tightened joint in the form of a load case."""
    whole = np.concatenate([record.preload_pressure for record in results.interfaces.values()])
    pressure = packed_numbers(averages(results, whole[None]))
    return {
        "name": "preload",
        "kind": "bolts tightened, no load",
        "frames": {"label": "", "unit": "", "values": [0.0]},
        "peak": float(whole.max(initial=0.0)),
        "models": [
            {
                "name": "full model",
                "bolts": {name: [bolt.preload] for name, bolt in results.bolts.items()},
                "fields": {"pressure": {"at": [0], **pressure}},
            }
        ],
    }


def _short(values: Any) -> list[float]:
    """Return numbers rounded to six digits."""
    return [float(f"{value:.6g}") for value in values]


OWN = (
    "tables.js",
    "unpack.js",
    "colours.js",
    "map.js",
    "motion.js",
    "chart.js",
    "stage.js",
    "view.js",
)


@cache
def three() -> str:
    """Return the used part of three.js, preceded by its licence."""
    return f"/*! three.js\n{_text('three.LICENSE.txt')}*/\n{_text('three.min.js')}"


@cache
def own() -> str:
    """Return the scripts of the page in a common scope."""
    return '(() => {\n"use strict";\n' + "\n".join(map(_text, OWN)) + "})();"


def _text(name: str) -> str:
    return files("faying.report.view").joinpath(name).read_text(encoding="utf-8")

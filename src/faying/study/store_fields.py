"""What every entry of ``results.h5`` means: dimension, shape and one line, by value and field."""

from dataclasses import dataclass

from faying.contact.interface import FacePairs
from faying.model.mesh import CellBlock
from faying.simulation.accuracy import Accuracy
from faying.study.results import (
    BoltRecord,
    CaseResult,
    InterfaceRecord,
    MethodResult,
    Response,
    Results,
)


@dataclass(frozen=True)
class Meaning:
    """Meaning of one field.

    Attributes
    ----------
    description
    dimension
        In words, as ``"force/length²"``; ``"1"`` is a plain number; empty for text and groups.
    shape
        Names of the axes; empty for one value.
    """

    description: str
    dimension: str = ""
    shape: str = ""


MEANINGS: dict[type, dict[str, Meaning]] = {
    Results: {
        "title": Meaning("title of the study"),
        "units": Meaning("consistent unit set, length-mass-time"),
        "study_text": Meaning("the study file as run (TOML)"),
        "nodes": Meaning("coordinates in the basic frame", "length", "(n_node, 3)"),
        "node_ids": Meaning("node ids as the user knows them", "1", "(n_node,)"),
        "body": Meaning("body of each node; -1 where none", "1", "(n_node,)"),
        "blocks": Meaning("solid elements, one group per block of one kind"),
        "mass": Meaning("total mass", "mass"),
        "dofs": Meaning("free degrees of freedom of the full model", "1"),
        "interfaces": Meaning("contact interfaces by name"),
        "bolts": Meaning("bolts by name"),
        "tightening_stages": Meaning("what each entry of the bolt histories is", "", "(n_stage,)"),
        "cases": Meaning("load cases by name"),
        "timings": Meaning("wall time by stage", "s"),
        "provenance": Meaning("what computed this file"),
        "warnings": Meaning("what did not converge or deserves notice", "", "(n_warning,)"),
    },
    CellBlock: {
        "kind": Meaning("hex8, hex20, tet4, tet10 or wedge6"),
        "nodes": Meaning("indices into /nodes, Nastran order", "1", "(n_cell, n_node_per_cell)"),
        "ids": Meaning("element ids", "1", "(n_cell,)"),
        "properties": Meaning("property ids", "1", "(n_cell,)"),
    },
    InterfaceRecord: {
        "points": Meaning("contact points", "length", "(n_point, 3)"),
        "normals": Meaning("unit normals out of the minus side", "1", "(n_point, 3)"),
        "weights": Meaning("area each contact point stands for", "length²", "(n_point,)"),
        "initial_gap": Meaning("gap before any load", "length", "(n_point,)"),
        "slice": Meaning("first and last + 1 of its points in pressures and gaps", "1", "(2,)"),
        "pairs": Meaning("touching nodes (minus, plus), indices into /nodes", "1", "(n_pair, 2)"),
        "pair_points": Meaning("where the pairs are", "length", "(n_pair, 3)"),
        "averaging": Meaning("point values to nodal averages", "1", "(n_pair, n_point)"),
        "faces": Meaning("matched facets, one group per kind"),
        "penalty": Meaning("contact stiffness c_n; inf is hard contact", "force/length³"),
        "quadrature": Meaning("rule that places the contact points"),
        "stuck": Meaning("pairs that stick in tangential direction", "1", "(n_pair,)"),
        "preload_pressure": Meaning(
            "pressure after tightening, nothing stuck yet", "force/length²", "(n_point,)"
        ),
    },
    FacePairs: {
        "kind": Meaning("tri3, tri6, quad4 or quad8"),
        "minus": Meaning("indices into /nodes", "1", "(n_face, n_node_per_face)"),
        "plus": Meaning("the nodes that touch them", "1", "(n_face, n_node_per_face)"),
    },
    BoltRecord: {
        "preload": Meaning("nominal final axial force", "force"),
        "initial_force": Meaning("initial force the bolt is locked at", "force"),
        "history": Meaning("axial force while bolts were tightened", "force", "(n_stage,)"),
        "axis": Meaning("ends of the element that is tightened", "length", "(2, 3)"),
    },
    CaseResult: {
        "name": Meaning("name of the load case"),
        "kind": Meaning("static, step or history"),
        "times": Meaning("instants; absent for static cases", "time", "(n_time,)"),
        "components": Meaning("displacement components by boundary: ux uy uz rx ry rz"),
        "reference": Meaning("solution of the full model"),
        "methods": Meaning("method name, then number of joint modes"),
        "half_step": Meaning("the reference again with half the time step"),
        "half_step_times": Meaning("instants of half_step", "time", "(n_half_time,)"),
    },
    MethodResult: {
        "joint_modes": Meaning("joint modes of the basis", "1"),
        "n_modes": Meaning("length of the basis", "1"),
        "response": Meaning("solution of the reduced model"),
        "accuracy": Meaning("errors against the full model"),
        "recovered_error": Meaning("max |p - p_ref| / max p_ref of recovered pressures", "1"),
    },
    Accuracy: {
        "max_relative_error": Meaning("max |p - p_ref| / max p_ref, points and instants", "1"),
        "rms_relative_error": Meaning("root mean square of the same", "1"),
        "p999_relative_error": Meaning("99.9th percentile of the same", "1"),
        "max_pressure_ratio": Meaning("max p / max p_ref", "1"),
        "displacement_error": Meaning("boundary translations, over the largest of them", "1"),
    },
    Response: {
        "pressure": Meaning(
            "contact pressure, compression positive", "force/length²", "([n_time,] n_point)"
        ),
        "gap": Meaning("gap, open positive", "length", "([n_time,] n_point)"),
        "displacements": Meaning(
            "by boundary: translations [length] and rotations [rad]", "length", "([n_time,] n)"
        ),
        "bolt_forces": Meaning("axial force by bolt, tension positive", "force", "([n_time])"),
        "contact_forces": Meaning("total normal force by interface", "force", "([n_time])"),
        "open_fraction": Meaning("area without pressure by interface", "1", "([n_time])"),
        "iterations": Meaning("linear systems of the contact problem", "1", "([n_time])"),
        "seconds": Meaning("wall time, offline work excluded", "s"),
        "nodal_displacement": Meaning("of static cases", "length", "(n_node, 3)"),
        "recovered_pressure": Meaning(
            "pressure recovered from the motion", "force/length²", "(n_time, n_point)"
        ),
    },
}

"""What every entry of ``results.h5`` means: dimension, shape and one line, by value and field."""

from faying.assessment.accuracy import Accuracy
from faying.assessment.backbone import Backbone
from faying.assessment.best_possible import BestPossible
from faying.assessment.choose import JointModeChoice
from faying.assessment.joint_record import Assessment, BoltAssessment, InterfaceAssessment
from faying.assessment.mesh_error import MeshError
from faying.assessment.penalty_sweep import PenaltySweep
from faying.assessment.preload_scatter import Spread
from faying.assessment.requirements import Verdict
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.thread import ThreadStress
from faying.files.described import Meaning, Table
from faying.reduction.mode_count import ModeCount
from faying.reduction.model_fields import GEOMETRY, SURFACE
from faying.study.jumps import Jump
from faying.study.path_record import CycleRecord, PathRecord
from faying.study.recovered import RecoveredRecord
from faying.study.results import (
    BoltRecord,
    CaseResult,
    InterfaceRecord,
    LoadSpaceRecord,
    LoadSpaceResult,
    MethodResult,
    PenaltyRecord,
    Response,
    Results,
    ValidationRecord,
    WorstCaseRecord,
)

MEANINGS: dict[type, Table] = {
    **GEOMETRY,
    InterfaceRecord: {
        **SURFACE,
        "preload_pressure": Meaning(
            "pressure after tightening, nothing stuck yet", "force/length²", "(n_point,)"
        ),
    },
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
        "timings": Meaning("wall time by stage; together that of the run before its files", "s"),
        "provenance": Meaning("what computed this file"),
        "warnings": Meaning("what did not converge or deserves notice", "", "(n_warning,)"),
        "omissions": Meaning("validation and the like that failed, and why", "", "(n_omission,)"),
        "validation": Meaning("load space, worst loads and penalty"),
        "reduced": Meaning("reduced models: method name, then number of joint modes"),
        "normal_modes": Meaning("proof that no fixed-interface normal mode was missed"),
        "factor_bytes": Meaning("memory of the factors of the full model", "1"),
        "reference": Meaning("what load cases were compared with: full, worst or none"),
        "reference_reason": Meaning("why, where the study leaves it open"),
        "assessment": Meaning("the joint judged over the load cases"),
    },
    Assessment: {
        "bolts": Meaning("by name"),
        "interfaces": Meaning("by name"),
        "verdicts": Meaning("requirements, each where it is nearest to failing"),
        "scatter": Meaning("metrics of static load cases over scattered preloads"),
    },
    BoltAssessment: {
        "preload": Meaning("axial force at rest", "force"),
        "least": Meaning("smallest axial force", "force"),
        "least_case": Meaning("load case it belongs to"),
        "most": Meaning("largest axial force", "force"),
        "most_case": Meaning("load case it belongs to"),
        "axial_loads": Meaning("axial load of bolt and area around it by load case", "force"),
        "load_factors": Meaning("what the bolt gains over that load, by load case", "1"),
        "thread": Meaning("stress in the thread, where that is given"),
    },
    ThreadStress: {
        "axial": Meaning("axial stress of the largest force", "force/length²"),
        "torsion": Meaning("shear stress that tightening leaves", "force/length²"),
        "reduced": Meaning("both together, half of the shear counted", "force/length²"),
        "amplitude": Meaning("half the range of the axial stress", "force/length²"),
        "proof": Meaning("proof stress of the grade", "force/length²"),
        "safety": Meaning("proof stress over the two together", "1"),
    },
    InterfaceAssessment: {
        "preload": Meaning("clamp force at rest", "force"),
        "least_clamp": Meaning("smallest clamp force", "force"),
        "least_clamp_case": Meaning("load case it belongs to"),
        "certified": Meaning("the full model's clamp force there lies between", "force", "(2,)"),
        "max_pressure": Meaning("largest pressure of a contact point", "force/length²"),
        "max_pressure_case": Meaning("load case it belongs to"),
        "max_pressure_point": Meaning("where it is", "length", "(3,)"),
        "closed_area": Meaning("smallest area under pressure", "length²"),
        "closed_area_case": Meaning("load case it belongs to"),
        "first_opening": Meaning("factor at which a pressed point opens, by load case", "1"),
        "loss_of_clamp": Meaning("factor from which nothing is pressed, by load case", "1"),
    },
    Spread: {
        "case": Meaning("load case"),
        "metric": Meaning("what, as in tables of solved cases"),
        "dimension": Meaning("of the values"),
        "meant": Meaning("at the preloads that were meant"),
        "least": Meaning("smallest"),
        "p05": Meaning("what 5 % stay below"),
        "median": Meaning("what half stay below"),
        "p95": Meaning("what 95 % stay below"),
        "most": Meaning("largest"),
    },
    Verdict: {
        "requirement": Meaning("its key in the study"),
        "met": Meaning("whether it is met"),
        "place": Meaning("interface or bolt"),
        "case": Meaning("load case"),
        "value": Meaning("where it is nearest to failing, in the unit of the key"),
        "limit": Meaning("of the study"),
    },
    ModeCount: {
        "below": Meaning("frequency in a gap between modes", "1/time"),
        "found": Meaning("modes computed below it", "1"),
        "counted": Meaning("modes there are, by the inertia of K - w^2 M", "1"),
        "reason": Meaning("why they could not be counted"),
    },
    RecoveredRecord: {
        "title": Meaning("title of the study"),
        "units": Meaning("consistent unit set, length-mass-time"),
        "history": Meaning("file the pressures were recovered from"),
        "route": Meaning("modal or boundary loads"),
        "method": Meaning("reduced model whose coordinates these are, or that was simulated"),
        "joint_modes": Meaning("its joint modes", "1"),
        "derivatives": Meaning("where velocities and accelerations come from"),
        "loads": Meaning("loads of the history; all others are zero", "", "(n_load,)"),
        "times": Meaning("instants", "time", "(n_time,)"),
        "pressure": Meaning(
            "contact pressure, compression positive", "force/length²", "(n_time, n_point)"
        ),
        "gap": Meaning("gap, open positive", "length", "(n_time, n_point)"),
        "displacements": Meaning(
            "by boundary: translations [length] and rotations [rad]", "length", "(n_time, n)"
        ),
        "contact_force": Meaning("total normal force by interface", "force", "(n_time,)"),
        "bolt_force": Meaning("axial force by bolt, tension positive", "force", "(n_time,)"),
        "max_pressure": Meaning("largest over all contact points", "force/length²", "(n_time,)"),
        "iterations": Meaning("linear systems of the contact problem", "1", "(n_time,)"),
    },
    BoltRecord: {
        "preload": Meaning("nominal final axial force", "force"),
        "initial_force": Meaning("initial force the bolt is locked at", "force"),
        "history": Meaning("axial force while bolts were tightened", "force", "(n_stage,)"),
        "axis": Meaning("ends of the element that is tightened", "length", "(2, 3)"),
    },
    CaseResult: {
        "name": Meaning("name of the load case"),
        "kind": Meaning("static, step, history, path, cycle or backbone"),
        "times": Meaning("instants; absent for static cases", "time", "(n_time,)"),
        "components": Meaning("displacement components by boundary: ux uy uz rx ry rz"),
        "reference": Meaning("solution that the methods are compared with"),
        "methods": Meaning("method name, then number of joint modes"),
        "half_step": Meaning("the reference with half the time step"),
        "half_step_times": Meaning("instants of half_step", "time", "(n_half_time,)"),
        "reserve": Meaning("load factors at which the joint slips"),
        "reference_model": Meaning("model that the reference is of"),
        "mesh_errors": Meaning("by interface: estimated errors that the mesh makes"),
        "jumps": Meaning("the largest jump of each load that jumps"),
    },
    Jump: {
        "load": Meaning("boundary and component, or load of the deck"),
        "time": Meaning("when it begins", "time"),
        "change": Meaning("by how much the load changes: force, moment or factor", "force"),
        "share": Meaning("the same over the largest magnitude of the load", "1"),
        "window": Meaning("within which it does so; zero at an instant", "time"),
        "rise": Meaning("over which it is proposed to rise", "time"),
    },
    MeshError: {
        "field": Meaning("root mean square over the area under pressure, over the peak", "1"),
        "largest": Meaning("largest at a contact point, over the peak", "1"),
        "peak": Meaning("of the largest pressure", "1"),
    },
    SlipReserve: {
        "first_slip": Meaning("load factor at which the first point slips", "1"),
        "interface": Meaning("interface of that point"),
        "point": Meaning("its number among the points of the interface; -1 where none", "1"),
        "onset": Meaning("load factor at which 5 % of the area slips that preload left stuck", "1"),
        "share": Meaning("share of the area in contact that share_slip is about", "1"),
        "share_slip": Meaning("load factor at which that share slips", "1"),
        "gross_slip": Meaning("load factor at which all that is closed slips", "1"),
        "largest": Meaning("load factor up to which was looked", "1"),
        "stopped": Meaning("whether the next increment had no solution"),
    },
    MethodResult: {
        "joint_modes": Meaning("joint modes of the basis", "1"),
        "n_modes": Meaning("length of the basis", "1"),
        "response": Meaning("solution of the reduced model"),
        "accuracy": Meaning("errors against the reference"),
        "certified_energy_error": Meaning("bound of the error in the energy norm", "1"),
        "certified_force_error": Meaning("bound of the error of the contact force", "1"),
        "certified_bound": Meaning("bound of max_relative_error without full solution", "1"),
        "recovered_error": Meaning("max |p - p_ref| / max p_ref of recovered pressures", "1"),
        "traction_error": Meaning("max |t - t_ref| / max |t_ref|, points and increments", "1"),
        "dissipation_error": Meaning("difference of the energies that friction took", "1"),
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
        "seconds": Meaning("wall time (side by side: its share), offline work excluded", "s"),
        "nodal_displacement": Meaning("of static cases", "length", "(n_node, 3)"),
        "recovered_pressure": Meaning(
            "pressure recovered from the motion", "force/length²", "(n_time, n_point)"
        ),
        "energy_gain": Meaning(
            "share of the energy in motion that the time integration gained from nothing", "1"
        ),
        "estimate": Meaning("of transients of reduced models: errors without a full solution"),
        "path": Meaning("increments of a path, or of a static load with friction"),
        "cycles": Meaning("amplitude to cycles of that amplitude"),
        "backbones": Meaning("number of a mode to its backbone"),
    },
    PathRecord: {
        "loads": Meaning("what the columns of factors multiply", "", "(n_load,)"),
        "factors": Meaning("load factors", "1", "(n_increment, n_load)"),
        "pressure": Meaning(
            "contact pressure, compression positive", "force/length²", "(n_increment, n_point)"
        ),
        "traction": Meaning(
            "tangential traction on the plus side", "force/length²", "(n_increment, n_point, 3)"
        ),
        "slip": Meaning(
            "slip of the plus side since the joint was unstressed",
            "length",
            "(n_increment, n_point, 3)",
        ),
        "status": Meaning("0 open, 1 stick, 2 slip", "1", "(n_increment, n_point)"),
        "open_share": Meaning("open area over that with friction", "1", "(n_increment,)"),
        "stick_share": Meaning("sticking area over that with friction", "1", "(n_increment,)"),
        "slip_share": Meaning("slipping area over that with friction", "1", "(n_increment,)"),
        "macroslip": Meaning(
            "whether all that is closed slips on an interface", "1", "(n_increment,)"
        ),
        "dissipation": Meaning("energy that friction took", "force·length", "(n_increment,)"),
        "load_work": Meaning(
            "load at factor one times the displacement it does work on",
            "force·length",
            "(n_increment,)",
        ),
        "iterations": Meaning("Newton steps", "1", "(n_increment,)"),
        "displacements": Meaning(
            "by boundary: translations [length] and rotations [rad]", "length", "(n_increment, n)"
        ),
        "bolt_forces": Meaning("axial force by bolt", "force", "(n_increment,)"),
    },
    CycleRecord: {
        "amplitude": Meaning("load factor at the reversals", "1"),
        "energies": Meaning("energy that friction took per cycle", "force·length", "(n_cycle,)"),
        "stationary": Meaning("whether the last two cycles agree"),
        "loop_area": Meaning("area of the last loop", "force·length"),
        "slip_range": Meaning("largest distance between two places", "length", "(n_point,)"),
        "fretting": Meaning("slip range times largest traction", "force/length", "(n_point,)"),
        "slip_work": Meaning("energy per area and cycle", "force/length", "(n_point,)"),
        "start_work": Meaning("load_work where the last cycle begins", "force·length"),
        "increments": Meaning("the last cycle: down from the amplitude and up again"),
    },
    Backbone: {
        "mode": Meaning("number of the mode of small vibrations, from 1", "1"),
        "small_frequency": Meaning("frequency of small vibrations, nothing slips", "1/time"),
        "measured_at": Meaning("boundary, or component of one, whose displacement is amplitude"),
        "amplitude": Meaning("half of the way there and back", "length", "(n,)"),
        "load": Meaning("largest load on the mass-normalized mode", "", "(n,)"),
        "modal_amplitude": Meaning("half of the way of the modal coordinate", "", "(n,)"),
        "frequency": Meaning("frequency", "1/time", "(n,)"),
        "damping_ratio": Meaning("of friction and of the damping matrix", "1", "(n,)"),
        "friction_damping": Meaning("its share of friction", "1", "(n,)"),
        "linear_damping": Meaning("its share of the damping matrix", "1", "(n,)"),
        "energy_per_cycle": Meaning("energy that friction takes, by slip", "force·length", "(n,)"),
        "loop_area": Meaning("the same by load and displacement", "force·length", "(n,)"),
        "stick_share": Meaning("least share of the closed area that sticks", "1", "(n,)"),
        "macroslip": Meaning("whether an interface slips as a whole", "1", "(n,)"),
        "cycles": Meaning("cycles solved until they repeated", "1", "(n,)"),
        "stationary": Meaning("whether they do", "1", "(n,)"),
        "loop_load": Meaning("load along the last cycle", "", "(n, n_increment + 1)"),
        "loop_modal": Meaning("modal coordinate along it", "", "(n, n_increment + 1)"),
        "masing_frequency": Meaning("frequency by Masing's rule; absent", "1/time", "(n,)"),
        "masing_damping": Meaning("damping by Masing's rule; absent", "1", "(n,)"),
        "remarks": Meaning("what a reader should know", "", "(n_remark,)"),
        "units": Meaning("consistent unit set of the model, length-mass-time"),
    },
    ValidationRecord: {
        "load_space": Meaning("methods at random loads of the training box"),
        "worst_cases": Meaning("method name to the load it gets most wrong"),
        "penalty": Meaning("what the contact stiffness does"),
        "choices": Meaning("numbers of joint modes chosen automatically"),
    },
    LoadSpaceRecord: {
        "n_loads": Meaning("random loads", "1"),
        "methods": Meaning("method name, then number of joint modes"),
        "best_possible": Meaning("the floor under all linear bases of pressures"),
        "best_possible_gap": Meaning("the yardstick of displacement bases, by the gap"),
    },
    LoadSpaceResult: {
        "median_error": Meaning("median of the loads' largest relative errors", "1"),
        "worst_error": Meaning("largest of them", "1"),
    },
    BestPossible: {
        "counts": Meaning("vectors of the basis", "1", "(n_count,)"),
        "training_rms": Meaning("rms error of the cases it is made of", "1", "(n_count,)"),
        "training_max": Meaning("largest error of the cases it is made of", "1", "(n_count,)"),
        "unseen_rms": Meaning("rms error of other cases", "1", "(n_count,)"),
        "unseen_median": Meaning("median case's largest error", "1", "(n_count,)"),
        "unseen_max": Meaning("worst case's largest error", "1", "(n_count,)"),
    },
    WorstCaseRecord: {
        "joint_modes": Meaning("joint modes of the basis", "1"),
        "forces": Meaning(
            "boundary.component to force [force] or moment, deck load to factor", "force"
        ),
        "bolt_forces": Meaning("initial bolt forces", "force"),
        "bound": Meaning("certified energy error, which was maximized", "1"),
        "certified_bound": Meaning("certified bound of the relative pressure error", "1"),
        "max_relative_error": Meaning("true error by one full solution", "1"),
        "evaluations": Meaning("loads judged without full solution", "1"),
        "within_round_off": Meaning("whether the method is exact to round-off at all loads tried"),
    },
    PenaltyRecord: {
        "sweep": Meaning("static cases over the contact stiffness"),
        "recommended": Meaning("recommended contact stiffness", "force/length³"),
        "reached": Meaning("whether it is within the tolerance of hard contact"),
        "advice": Meaning("the reasons"),
    },
    PenaltySweep: {
        "loads": Meaning("names of the load cases", "", "(n_load,)"),
        "penalties": Meaning("contact stiffness", "force/length³", "(n_penalty,)"),
        "automatic": Meaning("10 E/h", "force/length³"),
        "max_pressure": Meaning("largest pressure", "force/length²", "(n_penalty, n_load)"),
        "max_average": Meaning("largest nodal average", "force/length²", "(n_penalty, n_load)"),
        "penetration": Meaning("largest penetration", "length", "(n_penalty, n_load)"),
        "deviation": Meaning("largest difference to hard contact", "1", "(n_penalty, n_load)"),
        "rms_deviation": Meaning("rms difference to hard contact", "1", "(n_penalty, n_load)"),
        "hard_max_average": Meaning(
            "largest pressure of hard contact", "force/length²", "(n_load,)"
        ),
        "element_size": Meaning("root of the mean facet area", "length"),
        "deflection": Meaning("largest boundary translation", "length", "(n_load,)"),
        "errors": Meaning("method name to max relative error", "1", "(n_penalty, n_load)"),
    },
    JointModeChoice: {
        "count": Meaning("chosen number of joint modes", "1"),
        "met": Meaning("whether the tolerance is certified"),
        "tolerance": Meaning("what was asked for", "1"),
        "measure": Meaning("certified quantity"),
        "counts": Meaning("numbers that were tried", "1", "(n,)"),
        "bounds": Meaning("certified error of each", "1", "(n,)"),
    },
}

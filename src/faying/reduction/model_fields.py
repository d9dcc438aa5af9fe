"""The meaning of every entry of a stored reduced model, in results.h5 and in a file of its own."""

from faying.files.meanings import Meaning, Table, meanings
from faying.interface.interface import FacePairs
from faying.interface.surface import ContactSurface
from faying.joint.tangential import TangentialRows
from faying.joint.weak_support import WeakSupport
from faying.model.boundary import Boundary
from faying.model.cells import CellBlock
from faying.reduction.stored_compliance import StoredCompliance

PORTS: Table = {
    "compliance": Meaning(
        "displacement per force between ports: relative displacements of the contact pairs, "
        "boundary degrees of freedom, bolt elongations, load patterns",
        "length/force",
        "(n_port, n_port)",
    ),
    "interpolation": Meaning("gaps at contact points from relative displacements (CSR)"),
    "boundaries": Meaning("boundaries by name, in the order of their ports"),
    "bolt_stiffness": Meaning("EA/L by bolt, in the order of their ports", "force/length"),
    "frame_recovery": Meaning(
        "port displacements per acceleration of a moving frame, Q K⁻¹ M A: of the origin in x, "
        "y, z [time²], then e_i X_j row by row [length·time²]",
        "time²",
        "(n_port, 12)",
    ),
    "load_patterns": Meaning("loads of the deck, in the order of their ports"),
    "pattern_bolt_forces": Meaning(
        "what they add to the forces of bolts that expand; absent if nothing",
        "force",
        "(n_pattern, n_bolt)",
    ),
    "shear": Meaning("tangential displacements from relative ones (CSR); absent without friction"),
    "tangents": Meaning("directions of those", "1", "(2, n_point, 3)"),
}
"""Entries of the full model at its ports."""

COORDINATES: Table = {
    "kinds": Meaning("kinds of the coordinates q in their order", "", "(n_mode,)"),
    "mass": Meaning("Φᵀ M Φ", "mass", "(n_mode, n_mode)"),
    "damping": Meaning("Φᵀ C Φ", "mass/time", "(n_mode, n_mode)"),
    "stiffness": Meaning("Φᵀ K Φ", "force/length", "(n_mode, n_mode)"),
    "relative": Meaning("relative displacements of the pairs", "1", "(n_relative, n_mode)"),
    "elongations": Meaning("elongations of the bolts", "1", "(n_bolt, n_mode)"),
    "boundary": Meaning("coordinate of each boundary dof", "1", "(n_boundary,)", "n_mode"),
    "inertia_recovery": Meaning(
        "port displacements per acceleration, Q K⁻¹ M Φ", "time²", "(n_port, n_mode)"
    ),
    "damping_recovery": Meaning(
        "port displacements per velocity, Q K⁻¹ C Φ", "time", "(n_port, n_mode)"
    ),
    "compliance": Meaning(
        "whether pairs also move by (S - relative stiffness⁻¹ relativeᵀ) times their forces, "
        "S of ports/compliance"
    ),
    "shapes": Meaning("which of /shapes each coordinate moves", "1", "(n_mode,)", "n_shape"),
    "invariants": Meaning(
        "mass integrals of products of the fields 1, x, y, z [length] and the components x, y, "
        "z of each trial vector, for floating frames",
        "mass",
        "(4 + 3 n_mode, 4 + 3 n_mode)",
    ),
    "pattern_forces": Meaning(
        "forces of the load patterns; absent without any", "force", "(n_pattern, n_mode)"
    ),
    "rigid_motions": Meaning(
        "motions as a whole that nothing resists, in coordinates, orthonormal in the mass; absent "
        "where the structure is held",
        "1/mass^(1/2)",
        "(n_mode, n_motion)",
    ),
}
"""Entries of a reduced model in its coordinates."""

BOUNDARY: Table = {
    "nodes": Meaning("node id of each degree of freedom", "1", "(n,)"),
    "components": Meaning("its component, 0..5 for ux..rz", "1", "(n,)"),
}
"""Entries of a boundary."""

TABLES: dict[type, Table] = {
    **{
        kind: meanings(kind)
        for kind in (
            CellBlock,
            FacePairs,
            ContactSurface,
            StoredCompliance,
            TangentialRows,
            WeakSupport,
        )
    },
    Boundary: BOUNDARY,
}
"""Entries of all values in a file of one model."""

OWN_ROOT: Table = {
    "name": Meaning("name of the full model"),
    "method": Meaning("name of the reduction"),
    "units": Meaning("consistent unit set, length-mass-time"),
    "nodes": Meaning("coordinates in the basic frame", "length", "(n_node, 3)"),
    "node_ids": Meaning("node ids as the user knows them", "1", "(n_node,)"),
    "blocks": Meaning("solid elements, one group per block of one kind"),
    "interfaces": Meaning("contact interfaces by name"),
    "laws": Meaning("contact law of each interface: its name, and its parameters in model units"),
    "period": Meaning(
        "longest period of small vibrations about the preloaded state; absent where unknown", "time"
    ),
    "bolts": Meaning("initial force each bolt is locked at", "force"),
    "bolt_ends": Meaning("where each bolt begins and ends, as far as known", "length", "(2, 3)"),
    "provenance": Meaning("what made this file"),
}
"""Entries of a file of one reduced model."""

OWN_PORTS: Table = {
    "relative_stiffness": Meaning(
        "force between the pairs per relative displacement, the inverse of what compliance has of "
        "them; absent where it was not formed",
        "force/length",
        "(n_relative, n_relative)",
    ),
    "relative_compliance": Meaning(
        "relative displacements per force between the pairs, not formed; in place of compliance "
        "where interfaces are too large for that"
    ),
    "contact_columns": Meaning(
        "other ports per force between the pairs, beside it",
        "length/force",
        "(n_input, n_relative)",
    ),
    "input_rows": Meaning(
        "displacements of the other ports per force at them", "length/force", "(n_input, n_input)"
    ),
    "tangential": Meaning(
        "what is carried along the interfaces per force at the ports, whole ones and around bolts"
    ),
    "dense_budget": Meaning("memory that dense matrices between contact points may take", "1"),
}
"""Entries of such a file in addition to :data:`PORTS`."""

OWN_COORDINATES: Table = {
    "residual_compliance": Meaning(
        "displacement of the pairs per force between them that the trial vectors lack, a group of "
        "its parts where it is not formed; absent where the model does without",
        "length/force",
        "(n_relative, n_relative)",
    ),
    "trial_vectors": Meaning(
        "displacements at the free degrees of freedom of the full model per coordinate",
        "1",
        "(n_dof, n_mode)",
    ),
    "translations": Meaning(
        "displacements x, y, z of all nodes per free degree of freedom (CSR)",
    ),
    "bending": Meaning(
        "bending moments of bolts that are beams, two components where they begin and two where "
        "they end",
        "force",
        "(4, n_mode)",
    ),
    "residual_bending": Meaning(
        "such moments per force between the pairs that the trial vectors lack",
        "length",
        "(4, n_relative)",
    ),
    "weak_supports": Meaning("springs beside contact alone, by the bodies that they hold together"),
    "nodal_shapes": Meaning(
        "displacements of all nodes per coordinate, where the trial vectors are not known",
        "1",
        "(n_mode, n_node, 3)",
    ),
}
"""Entries of such a file in addition to :data:`COORDINATES`."""

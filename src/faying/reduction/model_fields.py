"""What every entry of a stored reduced model means, in results.h5 and in a file of its own."""

from faying.contact.laws import Coulomb, Hard, Penalty
from faying.files.described import Meaning, Table
from faying.interface.interface import FacePairs
from faying.interface.surface import ContactSurface
from faying.model.boundary import Boundary
from faying.model.elements import SOLIDS
from faying.model.mesh import CellBlock

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
}
"""Of the full model at its ports."""

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
}
"""Of a reduced model in its coordinates."""

SURFACE: Table = {
    "points": Meaning("contact points", "length", "(n_point, 3)"),
    "normals": Meaning("unit normals out of the minus side", "1", "(n_point, 3)"),
    "weights": Meaning("area each contact point stands for", "length²", "(n_point,)"),
    "initial_gap": Meaning("gap before any load", "length", "(n_point,)"),
    "slice": Meaning("first and last + 1 of its points in pressures and gaps", "1", "(2,)"),
    "pairs": Meaning(
        "touching nodes (minus, plus), indices into /nodes", "1", "(n_pair, 2)", "n_node"
    ),
    "pair_points": Meaning("where the pairs are", "length", "(n_pair, 3)"),
    "averaging": Meaning("point values to nodal averages", "1", "(n_pair, n_point)"),
    "faces": Meaning("matched facets, one group per kind"),
    "penalty": Meaning("contact stiffness c_n; inf is hard contact", "force/length³"),
    "quadrature": Meaning("rule that places the contact points"),
    "stuck": Meaning("pairs that stick in tangential direction", "1", "(n_pair,)"),
    "face_coverage": Meaning(
        "share of each facet that the other side covers; absent where meshes match",
        "1",
        "(n_face,)",
    ),
    "overlap": Meaning(
        "triangles of the common part of facets covered in part; absent where meshes match",
        "length",
        "(n_triangle, 3, 3)",
    ),
    "declared_area": Meaning(
        "area of the smaller side that was named as faces; absent where none was", "length²"
    ),
    "friction": Meaning("coefficient of friction", "1"),
    "tangential_penalty": Meaning(
        "tangential stiffness c_t of points that stick; zero without friction", "force/length³"
    ),
}
"""Of a contact surface."""

BOUNDARY: Table = {
    "nodes": Meaning("node id of each degree of freedom", "1", "(n,)"),
    "components": Meaning("its component, 0..5 for ux..rz", "1", "(n,)"),
}
"""Of a boundary."""

GEOMETRY: dict[type, Table] = {
    CellBlock: {
        "kind": Meaning(f"one of {', '.join(SOLIDS)}"),
        "nodes": Meaning(
            "indices into /nodes, Nastran order", "1", "(n_cell, n_node_per_cell)", "n_node"
        ),
        "ids": Meaning("element ids", "1", "(n_cell,)"),
        "properties": Meaning("property ids", "1", "(n_cell,)"),
        "formulation": Meaning("of these elements, as reduced; empty for that of the model"),
    },
    FacePairs: {
        "kind": Meaning("tri3, tri6, quad4 or quad8"),
        "minus": Meaning("indices into /nodes", "1", "(n_face, n_node_per_face)", "n_node"),
        "plus": Meaning("the nodes that touch them", "1", "(n_face, n_node_per_face)", "n_node"),
    },
}
"""Of values that results and models have in common."""

TABLES: dict[type, Table] = {**GEOMETRY, ContactSurface: SURFACE, Boundary: BOUNDARY}
"""Of all values in a file of one model."""

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
"""Of a file of one reduced model."""

OWN_PORTS: Table = {
    "places": Meaning("where the relative displacements are", "length", "(n_relative, 3)"),
    "shear": Meaning("tangential displacements from relative ones (CSR); absent without friction"),
    "tangents": Meaning("directions of those", "1", "(2, n_point, 3)"),
    "dense_budget": Meaning("memory that dense matrices between contact points may take", "1"),
}
"""What such a file has beside :data:`PORTS`."""

OWN_COORDINATES: Table = {
    "residual_compliance": Meaning(
        "displacement of the pairs per force between them that the trial vectors lack; absent "
        "where the model does without",
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
    "nodal_shapes": Meaning(
        "displacements of all nodes per coordinate, where the trial vectors are not known",
        "1",
        "(n_mode, n_node, 3)",
    ),
}
"""What such a file has beside :data:`COORDINATES`."""

LAWS: dict[str, type[Hard | Penalty | Coulomb]] = {
    "hard": Hard,
    "penalty": Penalty,
    "coulomb": Coulomb,
}
"""Contact laws by the names that files give them."""

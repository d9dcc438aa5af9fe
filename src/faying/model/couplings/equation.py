"""MPC: linear equations between single degrees of freedom."""

import numpy as np

from faying.exceptions import refuse_model
from faying.model.assembly import Assembly
from faying.model.couplings.rows import Rows, dof_name, sparse_rows


def equation_rows(assembly: Assembly) -> Rows:
    """Return Σ a_k u_k = 0 solved for the first term of each equation."""
    equations = assembly.equations
    for equation in equations:
        if not equation.terms:
            refuse_model(f"{equation.label} has no terms; give it at least one")
    counts = np.array([len(equation.terms) for equation in equations], dtype=np.int64)
    terms = [term for equation in equations for term in equation.terms]
    node, component, coefficient = np.array(terms, dtype=float).reshape(-1, 3).T
    dofs = (6 * node + component).astype(np.int64)
    rows = np.repeat(np.arange(len(equations)), counts)
    dependent = dofs[np.cumsum(counts) - counts]
    first = dofs == dependent[rows]
    coefficients = np.bincount(rows[first], coefficient[first], minlength=len(equations))
    if np.any(coefficients == 0):
        row = int(np.flatnonzero(coefficients == 0)[0])
        refuse_model(
            f"{equations[row].label}: the coefficient of its first term, "
            f"{dof_name(assembly, int(dependent[row]))}, is zero; that term is the dependent one, "
            "so put one with a coefficient first"
        )
    others = ~first
    values = -coefficient[others] / coefficients[rows[others]]
    shape = (len(equations), 6 * len(assembly.mesh.nodes))
    return Rows(
        dependent=dependent,
        matrix=sparse_rows(shape, rows[others], dofs[others], values),
        owner=np.arange(len(equations)),
        labels=tuple(equation.label for equation in equations),
    )

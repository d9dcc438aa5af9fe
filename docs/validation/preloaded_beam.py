"""Modes of the bolted Brake-Reuss beam after preload, with and without its stress stiffness.

``python docs/validation/preloaded_beam.py FOLDER`` prints the frequencies of docs/accuracy.md. The
folder holds Job.inp (github.com/Nidish96/Abaqus4Joints, assets/demo). Abaqus' tutorial there tells
frequencies after a static step with NLGEOM, whose stiffness holds the stresses, and those of its
own condensed matrices, whose stiffness does not.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from full_beam import SOFT, deck

import faying as fy
from faying._typing import SparseMatrix, Vector
from faying.assessment.stuck_modes import stuck_stiffness
from faying.linalg.relief import factorize_relieved
from faying.model.elements import stiffness
from faying.model.elements.geometry import determinants
from faying.model.matrices import block_element, materials_of
from faying.reduction.normal_modes import lowest_modes

MODULUS, POISSON, BOLT = 2e11, 0.29, 12e3
STRESSED, UNSTRESSED = (141.10, 152.42, 570.33, 643.49), (143.74, 151.3, 575.08, 642.81)
"""What Abaqus found, and what its matrices on a soft penalty give there [Hz]."""

FUSED = 1e15
"""Penalty of closed pairs [N/m³]: ten times what a layer of bricks gives."""

MODES = 8


def stress_stiffness(model: fy.Model, motion: Vector) -> SparseMatrix:
    """Return ∫ ∇N_i · σ ∇N_j dV in each direction, with the stresses that a motion makes."""
    assembly, transformation = model.assembly, model.dofs.transformation
    nodes = assembly.mesh.nodes
    moved = (transformation @ motion).reshape(-1, 6)[:, :3]
    total = sp.csr_array((6 * len(nodes), 6 * len(nodes)))
    for block in assembly.mesh.blocks:
        element = block_element(block, assembly.element)
        materials, which = materials_of(assembly, block)
        young = np.array([entry.youngs_modulus for entry in materials])[which]
        poisson = np.array([entry.poissons_ratio for entry in materials])[which]
        places = nodes[block.nodes]
        rooted = stiffness._mean_gradients(
            element, places, stiffness._weighted_gradients(element, places)
        )[:, 0]
        mapping = stiffness._mapping(stiffness.stiffness_gradients(element), places)
        volumes = determinants(*mapping) @ element.stiffness_quadrature().weights
        gradient = np.einsum("ebn,ena->eab", rooted, moved[block.nodes])
        strain = (gradient + gradient.swapaxes(1, 2)) / (2 * np.sqrt(volumes)[:, None, None])
        shear = (young / (2 * (1 + poisson)))[:, None, None]
        lame = 2 * shear[:, 0, 0] * poisson / (1 - 2 * poisson) * np.trace(strain, axis1=1, axis2=2)
        stress = 2 * shear * strain + lame[:, None, None] * np.eye(3)
        values = np.einsum("eam,eab,ebn->emn", rooted, stress, rooted)
        rows, columns = np.broadcast_arrays(block.nodes[:, :, None], block.nodes[:, None, :])
        for a in range(3):
            at = (6 * rows.ravel() + a, 6 * columns.ravel() + a)
            total = total + sp.coo_array((values.ravel(), at), shape=total.shape).tocsr()
    return transformation.T @ total @ transformation


def main(folder: Path) -> None:
    """Print peak pressure and frequencies."""
    model = fy.read_abaqus(
        deck(folder, SOFT, f"{MODULUS}, {POISSON}", BOLT),
        interfaces=[
            fy.InterfaceSpec(
                name="lap", minus="BOTBEAM_INSURF", plus="TOPBEAM_INSURF", penalty="hard"
            )
        ],
        bolts=[],
        boundaries=[fy.BoundarySpec(name="sensor", set="OutNodes")],
    ).with_deck_loads("step 1")
    load = fy.Load({"step 1": 1.0})
    state = fy.solve_static(model, load)
    added = stress_stiffness(model, state.states)
    fused = model.with_penalty(FUSED)
    tangent = stuck_stiffness(fused, fy.solve_static(fused, load))
    factor = factorize_relieved(tangent, model.M, model.rigid_motions)
    squares, shapes = lowest_modes(tangent, model.M, factor, MODES)
    plain = np.sqrt(squares) / (2 * np.pi)
    # What the stresses change of the modes joins them: errors of second order of that change.
    shapes = np.column_stack([shapes, factor.solve(added @ shapes)])
    both = [shapes.T @ (matrix @ shapes) for matrix in (tangent + added, model.M)]
    stressed = np.sqrt(la.eigh(*both, eigvals_only=True)[:MODES]) / (2 * np.pi)
    sys.stdout.write(
        f"peak {state.pressure.max() / 1e6:.2f} MPa\n"
        f"without stresses {plain[:4].round(2).tolist()} Hz for {UNSTRESSED}\n"
        f"with stresses {stressed[:4].round(2).tolist()} Hz for {STRESSED}\n"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))

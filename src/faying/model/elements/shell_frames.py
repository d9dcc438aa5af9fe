"""Frames of shells, rigid arms from nodes to the reference surface, and laws in these frames."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.digits import DECK_DIGITS, SOLVED
from faying.exceptions import refuse_model
from faying.model.couplings.rows import lever_arms
from faying.model.shells import ShellBlock, ShellSection, strain_rotation


@dataclass(frozen=True, eq=False, kw_only=True)
class ElementLaws:
    """Sections of a batch of shells in the axes of each shell.

    Attributes
    ----------
    stiffness, shear : (n, 6, 6), (n, 2, 2)
        As in :class:`faying.model.shells.ShellSection`; shear is zero where it is rigid.
    rigid : (n,)
        Rigid in transverse shear.
    mass, inertia : (n,)
    """

    stiffness: Matrix
    shear: Matrix
    rigid: Mask
    mass: Vector
    inertia: Vector


def flat_frames(coordinates: Matrix, ids: Indices) -> tuple[Matrix, Matrix]:
    """Return frames (n, 3, 3), rows x, y, z, and corners in them (n, n_node, 3).

    x runs along the first side, z along the normal: for quadrilaterals across both diagonals.

    Raises
    ------
    ModelError
        If a shell is collapsed or folded at a corner.
    """
    n_node = coordinates.shape[1]
    first, second = (1, 2) if n_node == 3 else (2, 3)
    start = coordinates[:, 0] if n_node == 3 else coordinates[:, 1]
    normal = np.cross(coordinates[:, first] - coordinates[:, 0], coordinates[:, second] - start)
    extent = np.ptp(coordinates, axis=1).max(axis=1)
    size = np.linalg.norm(normal, axis=1)
    check_area(size > SOLVED * extent**2, ids)
    z = normal / size[:, None]
    side = coordinates[:, 1] - coordinates[:, 0]
    side = side - np.einsum("ei,ei->e", side, z)[:, None] * z
    length = np.linalg.norm(side, axis=1)
    check_area(length > SOLVED * extent, ids)
    x = side / length[:, None]
    frames = np.stack([x, np.cross(z, x), z], axis=1)
    centred = coordinates - coordinates.mean(axis=1, keepdims=True)
    local = np.einsum("eci,eni->enc", frames, centred)
    to_previous, to_next = np.roll(local, 1, axis=1) - local, np.roll(local, -1, axis=1) - local
    corner = to_next[..., 0] * to_previous[..., 1] - to_next[..., 1] * to_previous[..., 0]
    check_area(corner.min(axis=1) > SOLVED * extent**2, ids)
    return frames, local


def check_area(good: Mask, ids: Indices) -> None:
    """Refuse shells that are not ``good`` (n,)."""
    if not good.all():
        bad = ids[~good]
        others = f" (and {len(bad) - 1} more)" if len(bad) > 1 else ""
        refuse_model(
            f"shell {bad[0]}{others} is collapsed or folded: its corners do not run around a "
            "surface; correct the order of its nodes, or remesh"
        )


def carried(frames: Matrix, arms: Matrix) -> Matrix:
    """Return motions in the frames at the ends of rigid arms per nodal motion (n, n_node, 6, 6).

    Frames are (n, 3, 3) or (n, n_node, 3, 3), arms (n, n_node, 3) [length].
    """
    n, n_node = arms.shape[:2]
    axes = frames if frames.ndim == 4 else frames[:, None]
    lever = lever_arms(arms.reshape(-1, 3)).reshape(n, n_node, 3, 3)
    motion = np.zeros((n, n_node, 6, 6))
    motion[..., :3, :3] = motion[..., 3:, 3:] = axes
    motion[..., :3, 3:] = axes @ lever
    return motion


def on_nodes(matrix: Matrix, motion: Matrix) -> Matrix:
    """Return Tᵀ A T for matrices (n, 6 n_node, 6 n_node), by node pair (n, i, j, 6, 6)."""
    n, n_node = motion.shape[:2]
    pairs = matrix.reshape(n, n_node, 6, n_node, 6).transpose(0, 1, 3, 2, 4)
    return np.asarray(motion.swapaxes(-1, -2)[:, :, None] @ pairs @ motion[:, None])


def laws_in(
    block: ShellBlock, part: slice, frames: Matrix, sections: Mapping[int, ShellSection]
) -> ElementLaws:
    """Return the sections of some shells of a block in the axes of their frames.

    Frames are (n, 3, 3), at one point of each shell, or (n, n_q, 3, 3); the laws are then in one
    list (n · n_q).
    """
    repeat = 1 if frames.ndim == 3 else frames.shape[1]
    frames = frames.reshape(-1, 3, 3)
    numbers, which = np.unique(block.properties[part], return_inverse=True)
    for position, number in enumerate(numbers.tolist()):
        if number not in sections:
            shell = block.ids[part][int(np.argmax(which == position))]
            refuse_model(f"property {number} (of shell {shell}) has no section; define it")
    used = [sections[number] for number in numbers.tolist()]
    which = np.repeat(which, repeat)
    direction = np.repeat(block.directions[part], repeat, axis=0)
    directed = direction.any(axis=1)
    along = np.einsum("eci,ei->ec", frames[:, :2], direction)
    # The projection of a direction along the normal is round-off.
    upright = directed & ~(
        np.linalg.norm(along, axis=1) > DECK_DIGITS * np.linalg.norm(direction, axis=1)
    )
    if upright.any():
        shell = np.repeat(block.ids[part], repeat)[upright][0]
        refuse_model(
            f"shell {shell}: the direction of its material's x axis is "
            "normal to it; give one that lies in the surface"
        )
    # Strains in the material's axes, which are rotated from the element's by this angle.
    angle = np.where(directed, np.arctan2(along[:, 1], along[:, 0]), 0.0)
    T = strain_rotation(angle)
    both = np.zeros((len(angle), 6, 6))
    both[:, :3, :3] = both[:, 3:, 3:] = T
    c, s = np.cos(angle), np.sin(angle)
    plane = np.moveaxis(np.array([[c, s], [-s, c]]), 2, 0)
    stiffness = np.array([section.stiffness for section in used])[which]
    shear = np.array(
        [np.zeros((2, 2)) if member.shear is None else member.shear for member in used]
    )[which]
    return ElementLaws(
        stiffness=both.swapaxes(1, 2) @ stiffness @ both,
        shear=plane.swapaxes(1, 2) @ shear @ plane,
        rigid=np.array([section.shear is None for section in used])[which],
        mass=np.array([section.mass for section in used])[which],
        inertia=np.array([section.inertia for section in used])[which],
    )

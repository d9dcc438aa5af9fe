"""Three cantilevers over each other with gaps between them, as decks of two programs."""

from dataclasses import dataclass

import numpy as np

LENGTH, WIDTH, HEIGHT = 60.0, 10.0, 4.0


@dataclass(frozen=True, kw_only=True)
class Stack:
    """Three beams clamped at x = 0, the top one loaded at its tip.

    Attributes
    ----------
    counts
        Bricks along, across and through each beam, from below.
    gaps
        Between the beams.
    force
        Downwards, over the upper edge of the tip.
    penalty
        Contact stiffness.
    """

    counts: tuple[tuple[int, int, int], ...] = ((12, 2, 2),) * 3
    gaps: tuple[float, float] = (0.1, 0.1)
    force: float = 120.0
    penalty: float = 1e5

    def beam(self, number):
        """Coordinates (n, 3) and bricks (m, 8) of a beam, counted from zero, and its base."""
        nx, ny, nz = self.counts[number]
        base = number * HEIGHT + sum(self.gaps[:number])
        lines = np.linspace(0, LENGTH, nx + 1), np.linspace(0, WIDTH, ny + 1)
        z, y, x = np.meshgrid(np.linspace(base, base + HEIGHT, nz + 1), *lines[::-1], indexing="ij")
        nodes = np.stack([x, y, z], axis=-1).reshape(-1, 3)
        index = np.arange(len(nodes)).reshape(nz + 1, ny + 1, nx + 1)
        square = [(0, 0), (0, 1), (1, 1), (1, 0)]
        corners = [
            index[k : k + nz, j : j + ny, i : i + nx].ravel() for k in (0, 1) for j, i in square
        ]
        return nodes, np.stack(corners, axis=1)

    @property
    def parts(self):
        """Per beam: first node id, coordinates, first element id, bricks."""
        first_node = first_element = 1
        for number in range(3):
            nodes, bricks = self.beam(number)
            yield first_node, nodes, first_element, bricks
            first_node += len(nodes)
            first_element += len(bricks)

    def faces(self, number, upper):
        """Element ids of a beam with a face at its top or bottom."""
        *_, first, bricks = list(self.parts)[number]
        per_layer = self.counts[number][0] * self.counts[number][1]
        rows = np.arange(len(bricks) - per_layer, len(bricks)) if upper else np.arange(per_layer)
        return first + rows

    def node_ids(self, number, chosen):
        """Ids of the nodes of a beam that a function of coordinates chooses."""
        first, nodes, *_ = list(self.parts)[number]
        return first + np.flatnonzero(chosen(nodes))

    @property
    def clamped(self):
        """Ids of all nodes at x = 0."""
        return np.concatenate([self.node_ids(i, lambda x: x[:, 0] == 0) for i in range(3)])

    @property
    def loaded(self):
        """Ids of the nodes at the upper edge of the tip."""
        top = list(self.parts)[2][1][:, 2].max()
        return self.node_ids(2, lambda x: (x[:, 0] == LENGTH) & (x[:, 2] > top - 1e-9))

    def abaqus(self, *, pair="", more=""):
        """Deck for CalculiX; ``pair`` are parameters of *CONTACT PAIR."""
        lines = ["*NODE, NSET=NALL"]
        for first, nodes, _, _ in self.parts:
            lines += [
                f"{first + i}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(nodes.tolist())
            ]
        for number, (node, _, element, bricks) in enumerate(self.parts):
            lines.append(f"*ELEMENT, TYPE=C3D8, ELSET=BEAM{number}")
            lines += [
                f"{element + i}, {', '.join(map(str, row))}" for i, row in numbered(bricks + node)
            ]
        lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3"]
        lines += [f"*SOLID SECTION, ELSET=BEAM{i}, MATERIAL=STEEL" for i in range(3)]
        for i in range(2):
            lines.append(f"*SURFACE, NAME=UNDER{i}, TYPE=ELEMENT")
            lines += [f"{element}, S1" for element in self.faces(i + 1, upper=False).tolist()]
            lines.append(f"*SURFACE, NAME=OVER{i}, TYPE=ELEMENT")
            lines += [f"{element}, S2" for element in self.faces(i, upper=True).tolist()]
            lines += [f"*SURFACE INTERACTION, NAME=J{i}"]
            lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{self.penalty!r}"]
            lines += [f"*CONTACT PAIR, INTERACTION=J{i}, TYPE=SURFACE TO SURFACE{pair}"]
            lines += [f"UNDER{i}, OVER{i}"]
        lines += [more] if more else []
        lines += ["*BOUNDARY", *(f"{node}, 1, 3" for node in self.clamped.tolist())]
        lines += ["*STEP", "*STATIC", "*CLOAD"]
        share = -self.force / len(self.loaded)
        lines += [f"{node}, 3, {share!r}" for node in self.loaded.tolist()]
        lines += ["*NODE PRINT, NSET=NALL", "U"]
        for i in range(2):
            lines += [f"*CONTACT PRINT, SLAVE=UNDER{i}, MASTER=OVER{i}", "CF"]
        return "\n".join([*lines, "*END STEP", ""])

    def nastran(self, *, contact, more=""):
        """Deck for Nastran; regions 1, 3 are lower sides of gaps and 2, 4 upper ones."""
        lines = ["SOL 101", "CEND", "SPC = 1", "LOAD = 1", *contact, "BEGIN BULK"]
        for number, (node, nodes, element, bricks) in enumerate(self.parts):
            lines += [
                f"GRID,{node + i},,{x:.6f},{y:.6f},{z:.6f}" for i, (x, y, z) in numbered(nodes)
            ]
            for i, row in numbered(bricks + node):
                lines.append(f"CHEXA,{element + i},{number + 1},{','.join(map(str, row[:6]))}")
                lines.append(f",{row[6]},{row[7]}")
            lines.append(f"PSOLID,{number + 1},1,,TWO,,FULL")
        lines += ["MAT1,1,210000.,,.3"]
        lines += [f"SPC1,1,123,{node}" for node in self.clamped.tolist()]
        share = self.force / len(self.loaded)
        lines += [f"FORCE,1,{node},,{share!r},0.,0.,-1." for node in self.loaded.tolist()]
        for i in range(2):
            for region, beam, upper in ((2 * i + 1, i, True), (2 * i + 2, i + 1, False)):
                first, _, start, bricks = list(self.parts)[beam]
                rows = []
                for element in self.faces(beam, upper=upper).tolist():
                    corners = bricks[element - start] + first
                    face = corners[[4, 5, 6]] if upper else corners[[0, 3, 2]]
                    rows.append(f"{element},{','.join(map(str, face.tolist()))}")
                lines.append(f"BSURFS,{region},,,,{rows[0]}")
                pairs = [rows[k : k + 2] for k in range(1, len(rows), 2)]
                lines += [f",{','.join(pair)}" for pair in pairs]
        return "\n".join([*lines, more, "ENDDATA", ""])


def numbered(table):
    """Rows of a table with their numbers."""
    return enumerate(table.tolist())

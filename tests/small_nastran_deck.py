"""Two blocks on each other, for tests of Nastran decks: nodes 1 to 8 below, 11 to 18 above."""


def blocks(size=1):
    """Return cards of the grid points, the bricks 1 and 2, their property and material."""
    square = [(0, 0), (size, 0), (size, size), (0, size)]
    grids = "".join(
        f"GRID,{10 * part + 4 * top + i + 1},,{x}.,{y}.,{size * (part + top)}.\n"
        for part in (0, 1)
        for top in (0, 1)
        for i, (x, y) in enumerate(square)
    )
    return f"""{grids}CHEXA,1,1,1,2,3,4,5,6
,7,8
CHEXA,2,1,11,12,13,14,15,16
,17,18
PSOLID,1,1
MAT1,1,210000.,,.3,7.8-9
"""

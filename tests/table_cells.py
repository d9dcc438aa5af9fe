"""Cells of a report's table by row and column, as text."""


def cells(table):
    """Row head to column to text; columns called alike are told by what stands before them."""
    return {
        row[0].text: {name: cell.text for name, cell in zip(table.names, row, strict=True)}
        for row in table.rows
    }

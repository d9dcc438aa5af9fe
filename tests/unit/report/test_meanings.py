"""Docstrings of stored values are what files say of them."""

from dataclasses import dataclass

import pytest

from faying.files.meanings import Meaning, meanings


@dataclass(frozen=True)
class Surface:
    """A surface.

    Attributes
    ----------
    area : [length²]
        Area of the surface, see :mod:`faying.interface`; None where
        nobody knows.
    name
        What it is called.
    """

    area: float | None
    name: str


@dataclass(frozen=True)
class Meshed(Surface):
    """A surface with nodes.

    Attributes
    ----------
    pressure, gap : ([n_time,] n_point) [force/length²], optional
        At ``points``.
    nodes : (n_face, 3) [into n_node]
        Its nodes.

    Notes
    -----
    Ends the attributes.
    """

    nodes: tuple[int, ...]
    gap: float
    pressure: float


def test_entries_are_read_with_their_axes_dimension_and_what_they_point_into():
    found = meanings(Meshed)
    assert found["nodes"] == Meaning("Its nodes", "1", "(n_face, 3)", "n_node")
    assert found["gap"] == Meaning("At points", "force/length²", "([n_time,] n_point)")
    assert found["pressure"] == found["gap"]


def test_entries_of_bases_come_first_and_markup_is_left_out():
    found = meanings(Meshed)
    assert list(found) == ["area", "name", "nodes", "gap", "pressure"]
    description = "Area of the surface, see faying.interface; None where nobody knows"
    assert found["area"] == Meaning(description, "length²")
    assert found["name"] == Meaning("What it is called")


def test_a_field_nobody_describes_is_refused():
    @dataclass(frozen=True)
    class Silent(Surface):
        """A surface.

        Attributes
        ----------
        depth : [length]
        """

        depth: float
        hidden: float

    with pytest.raises(TypeError, match="Silent does not describe depth, hidden"):
        meanings(Silent)

"""What a contact point admits: the part of a contact problem that is local."""

from typing import Protocol

from faying._typing import Matrix, Vector


class Law(Protocol):
    """The relation between force and relative displacement at the points of an interface.

    A law is a frozen value of one file. It says which forces are admissible, and how far an
    admissible force closes or shears the interface itself. With the slack s = z + c(x), in which z
    is the relative displacement of the two surfaces and c(x) what the law adds to it, a force x is
    a solution where, for any r > 0,

        x = admissible(x − r s).

    Frictionless contact has the normal component alone. A law with friction has three components
    and a state, the slip, which is part of s and moves on with every increment.
    """

    @property
    def name(self) -> str:
        """Name in studies and files."""
        ...

    @property
    def components(self) -> int:
        """Components of force and slack at a point: 1 along the normal, 3 with both tangents."""
        ...

    @property
    def penalty(self) -> float:
        """Contact stiffness c_n [force/length³] of Eq. (15.12); ``inf`` is Eq. (15.7)."""
        ...

    @property
    def friction(self) -> float:
        """Coefficient of friction μ; zero without friction."""
        ...

    def compliance(self, weights: Vector) -> Matrix:
        """Return c′(x) (components, n_point) [length/force], the diagonal of D of (M2).

        Parameters
        ----------
        weights : (n_point,) [length²]
            Area each point stands for.
        """
        ...

    def admissible(self, forces: Matrix) -> Matrix:
        """Return the admissible forces (components, ..., n_point) nearest to given ones."""
        ...

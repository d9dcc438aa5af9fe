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

    Newton's method takes the derivatives of both from the law as well, so that a solver knows
    nothing of a law but this. Frictionless contact has the normal component alone. A law with
    friction has three components and a state, the slip, which is part of s and moves on with every
    increment.
    """

    @property
    def name(self) -> str:
        """Name in studies and files."""
        ...

    @property
    def normal(self) -> "Law":
        """Law of the normal component; itself where there is no other."""
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
    def stiffness(self) -> float:
        """Contact stiffness [force/length³] where one must stand for all: c_n, or a slope."""
        ...

    @property
    def friction(self) -> float:
        """Coefficient of friction μ; zero without friction."""
        ...

    @property
    def tangential_penalty(self) -> float:
        """Stiffness c_t [force/length³] by which sticking points hold on; zero: they do not."""
        ...

    def with_normal(self, normal: "Law") -> "Law":
        """Return the law with another normal component."""
        ...

    def with_coefficient(self, friction: float) -> "Law":
        """Return the law with another coefficient of friction; itself where nothing holds on."""
        ...

    @property
    def yields(self) -> bool:
        """Whether forces follow from displacements; hard contact has no :meth:`respond`."""
        ...

    @property
    def proportional(self) -> bool:
        """Whether c(x) is in proportion to x, as active sets need it; others take solve_path."""
        ...

    @property
    def remembers(self) -> bool:
        """Whether pressure depends on how far a point was closed before, as of gaskets."""
        ...

    def after(self, deepest: Vector) -> "Law":
        """Return the law of points whose largest closures so far are (n_point,) [length]."""
        ...

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return c(x) [length] and its derivative c′(x) [length/force], (components, n_point) each.

        Components do not mix. The derivative is the diagonal of D of (M2).

        Parameters
        ----------
        forces : (components, n_point) [force]
        weights : (n_point,) [length²]
            Area each point stands for.
        """
        ...

    def energy(self, forces: Matrix, weights: Vector) -> Vector:
        """Return what the law has stored under forces (components, n_point) [force·length]."""
        ...

    def springs(self, weights: Vector) -> Matrix:
        """Return about what closed and sticking points resist (components, n_point) [force/length].

        Newton's method is prepared for these; infinite where contact is hard.
        """
        ...

    def admissible(self, forces: Matrix) -> Matrix:
        """Return the admissible forces (components, n_point) nearest to given ones.

        Normal forces of the result bound its tangential ones.
        """
        ...

    def derivative(self, forces: Matrix) -> Matrix:
        """Return the derivative of :meth:`admissible` (n_point, components, components)."""
        ...

    def respond(self, moved: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return forces λ (components, n_point) [force] and −∂λ/∂moved at relative displacements.

        The stiffness (n_point, components, components) [force/length] is that of the branch the
        point is on. A point whose gap is zero counts as closed, and as sticking while it has not
        moved along: there Newton's method begins.

        Parameters
        ----------
        moved : (components, n_point) [length]
            Gap g, negative where the surfaces approach, and the tangential displacements less the
            slip so far.
        weights : (n_point,) [length²]

        Raises
        ------
        ModelError
            If the law does not yield.
        """
        ...

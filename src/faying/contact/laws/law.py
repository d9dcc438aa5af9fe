"""The interface of contact laws: the part of a contact problem that is local to a point."""

from typing import Protocol

from faying._typing import Matrix, Vector


class Law(Protocol):
    """The relation between force and relative displacement at the points of an interface.

    A law is a frozen value of one file. It says which forces are admissible, and how far an
    admissible force closes or shears the interface itself. With the slack s = z + c(x), where z is
    the relative displacement of the two surfaces and c(x) the closure of the law, a force x is a
    solution where, for any r > 0,

        x = admissible(x − r s).

    Newton's method also takes the derivatives of both from the law, so a solver depends on nothing
    else of a law. Frictionless contact has the normal component alone. A law with friction has
    three components and a state, the slip, which is part of s and is updated in every increment.
    """

    @property
    def name(self) -> str:
        """Name in studies and files."""

    @property
    def normal(self) -> "Law":
        """Law of the normal component; itself without friction."""

    @property
    def components(self) -> int:
        """Components of force and slack at a point: 1 along the normal, 3 with both tangents."""

    @property
    def penalty(self) -> float:
        """Contact stiffness c_n [force/length³] of Eq. (15.12); ``inf`` is Eq. (15.7)."""

    @property
    def stiffness(self) -> float:
        """Representative contact stiffness [force/length³]: c_n, or a slope of the curve."""

    @property
    def friction(self) -> float:
        """Coefficient of friction μ; zero without friction."""

    @property
    def tangential_penalty(self) -> float:
        """Tangential stiffness c_t [force/length³] of sticking points; zero without friction."""

    def with_normal(self, normal: "Law") -> "Law":
        """Return the law with another normal component."""

    def friction_or(self, given: float) -> float:
        """Return μ of the law, or a given one where the law has none."""

    def with_coefficient(self, friction: float) -> "Law":
        """Return the law with another coefficient of friction; itself without friction."""

    @property
    def yields(self) -> bool:
        """Whether forces follow from displacements; hard contact has no :meth:`respond`."""

    @property
    def proportional(self) -> bool:
        """Whether c(x) is proportional to x, as active sets need; other laws take solve_path."""

    @property
    def remembers(self) -> bool:
        """Whether pressure depends on the earlier closure of a point, as in gaskets."""

    def after(self, deepest: Vector) -> "Law":
        """Return the law of points with largest closures so far (n_point,) [length]."""

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return c(x) [length] and its derivative c′(x) [length/force], (components, n_point) each.

        Components are independent. The derivative is the diagonal of D of (M2).

        Parameters
        ----------
        forces : (components, n_point) [force]
        weights : (n_point,) [length²]
            Area of each point.
        """

    def energy(self, forces: Matrix, weights: Vector) -> Vector:
        """Return the energy stored under forces (components, n_point) [force·length]."""

    def springs(self, weights: Vector) -> Matrix:
        """Return stiffnesses of closed, sticking points (components, n_point) [force/length].

        Newton's method starts from these typical values; infinite where contact is hard.
        """

    def admissible(self, forces: Matrix) -> Matrix:
        """Return the admissible forces (components, n_point) nearest to given ones.

        The limit of tangential forces follows from the normal forces of the result.
        """

    def derivative(self, forces: Matrix) -> Matrix:
        """Return the derivative of :meth:`admissible` (n_point, components, components)."""

    def respond(self, moved: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return forces λ (components, n_point) [force] and −∂λ/∂moved at relative displacements.

        The stiffness (n_point, components, components) [force/length] is that of the current branch
        of the law. For the start of Newton's method, a point of zero gap counts as closed, and as
        sticking without tangential displacement.

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

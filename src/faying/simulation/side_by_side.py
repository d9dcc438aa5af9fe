"""How many responses may be stepped side by side: their histories are in memory together."""

from faying.joint.system import System

HISTORY_BYTES = 2 * 2**30
"""Memory that the histories of responses stepped side by side may take.

The same on every machine, for round-off depends on how many there are.
"""


def runs_at_once(system: System, n_time: int, n_states: int | None = None) -> int:
    """Return how many histories of ``n_time`` instants fit; one always does.

    Displacements and their derivatives are in memory at ``n_states`` instants together; at all by
    default.
    """
    contact, n_states = system.contact, n_time if n_states is None else n_states
    numbers = 3 * n_states * system.K.shape[0] + 2 * n_time * contact.components * contact.n_points
    return max(1, HISTORY_BYTES // (8 * int(numbers)))

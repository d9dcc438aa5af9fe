"""What decks are not written of."""

from faying.exceptions import FormatError
from faying.model.assembly import Assembly


def refuse_unwritten(assembly: Assembly) -> None:
    """Refuse an assembly with elements that no deck writer knows.

    Raises
    ------
    FormatError
        Naming them.
    """
    kinds = {
        "shells": assembly.shells,
        "bushes": assembly.bushes,
        "scalar masses": assembly.scalar_masses,
        "average couplings of different components": [
            one for one in assembly.average_couplings if one.entering is not None
        ],
        "materials whose directions differ": [
            one for one in assembly.materials.values() if one.law is not None
        ],
    }
    found = [name for name, family in kinds.items() if family]
    if found:
        message = (
            f"the assembly has {' and '.join(found)}, which faying reads but does not write; "
            "export the reduced model instead, or write solids, beams, springs and couplings alone"
        )
        raise FormatError(message)

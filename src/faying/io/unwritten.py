"""What decks are not written of."""

from faying.exceptions import refuse
from faying.model.assembly import Assembly


def refuse_unwritten(assembly: Assembly) -> None:
    """Refuse an assembly with elements that no deck writer knows."""
    kinds = {
        "shells": assembly.shells,
        "bushes": assembly.bushes,
        "scalar masses": assembly.scalar_masses,
        "average couplings of different components": [
            item for item in assembly.average_couplings if item.entering is not None
        ],
        "materials whose directions differ": [
            item for item in assembly.materials.values() if item.law is not None
        ],
    }
    unwritten = [name for name, family in kinds.items() if family]
    if unwritten:
        refuse(
            f"the assembly has {' and '.join(unwritten)}, which faying reads but does not write; "
            "export the reduced model instead, or write solids, beams, springs and couplings alone"
        )

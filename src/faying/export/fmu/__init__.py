"""FMU: the joint with its contact inside, as co-simulation slaves of FMI 2.0 and FMI 3.0 in C."""

from faying.export.fmu.archive import write

__all__ = ["write"]

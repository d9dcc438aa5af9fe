"""Shared libraries of an FMU, compiled by the C compiler of the system."""

import ctypes
import logging
import platform
import shutil
import subprocess
import sys
from pathlib import Path

COMPILERS = ("cc", "gcc", "clang")
OPTIONS = ("-std=c99", "-O3", "-shared", "-fvisibility=hidden", "-DFMI2_OVERRIDE_FUNCTION_PREFIX")
_log = logging.getLogger("faying")

SYSTEMS = {"linux": ("linux", ".so"), "win32": ("win", ".dll"), "darwin": ("darwin", ".dylib")}
FMI3_SYSTEMS = {"linux": "linux", "win32": "windows", "darwin": "darwin"}
MACHINES = {"amd64": "x86_64", "x86_64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}


def compiler() -> str | None:
    """Return the path of a C compiler; None without one."""
    return next((path for path in map(shutil.which, COMPILERS) if path), None)


def suffix() -> str:
    """Return the suffix of shared libraries on this system."""
    return SYSTEMS.get(sys.platform, SYSTEMS["linux"])[1]


def platform_folder(version: int) -> str:
    """Return the name of the folder for this system's binaries in FMI 2.0 or 3.0."""
    if version == 2:
        name = SYSTEMS.get(sys.platform, SYSTEMS["linux"])[0]
        return f"{name}{8 * ctypes.sizeof(ctypes.c_void_p)}"
    machine = platform.machine().lower()
    return f"{MACHINES.get(machine, machine)}-{FMI3_SYSTEMS.get(sys.platform, 'linux')}"


def compile_library(source: Path, library: Path) -> bool:
    """Compile a source file to a shared library; return whether that was possible.

    If there is no compiler, or it fails, a warning states that the FMU has only sources.
    """
    command = compiler()
    if command is None:
        _log.warning(
            "no C compiler found (%s), so the FMU has sources but no binary; compile it where "
            "it is used, see resources/README.txt in it",
            ", ".join(COMPILERS),
        )
        return False
    position = () if sys.platform == "win32" else ("-fPIC",)
    arguments = [command, *OPTIONS, *position, str(source), "-o", str(library), "-lm"]
    try:
        done = subprocess.run(arguments, capture_output=True, text=True, check=False, timeout=300)
    except (OSError, subprocess.TimeoutExpired) as error:
        _log.warning("%s failed (%s), so the FMU has sources but no binary", command, error)
        return False
    if done.returncode != 0:
        _log.warning(
            "%s failed, so the FMU has sources but no binary: %s", command, done.stderr.strip()
        )
        return False
    return True

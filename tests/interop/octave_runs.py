"""Scripts run in Octave, and what they leave compared."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import scipy.io
from programs import MissingProgramError

SAME = 1e-9
"""Round-off: both programs take the same steps in double precision, with condition numbers of 1e5
or so of the effective matrices."""


def octave() -> str:
    found = shutil.which("octave-cli") or shutil.which("octave")
    if found is None:
        message = "Octave is not installed: there is no 'octave-cli' on the path"
        raise MissingProgramError(message)
    return found


def run_octave(program: str, folder: Path, script: str) -> dict[str, np.ndarray]:
    """Run a script that fills variables and return them."""
    text = f"{script}\nclear joint state; save('-v7', 'out.mat');\n"
    (folder / "script.m").write_text(text)
    done = subprocess.run(
        [program, "--no-init-file", "--quiet", "script.m"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
        env={"OMP_NUM_THREADS": "1", "PATH": "/usr/bin:/bin", "HOME": str(folder)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stderr.lower(), done.stderr
    return {k: v for k, v in scipy.io.loadmat(folder / "out.mat").items() if k[0] != "_"}


def close(found: np.ndarray, wanted: np.ndarray, tolerance: float = SAME) -> None:
    scale = np.abs(wanted).max()
    assert scale > 0
    np.testing.assert_allclose(found, wanted, rtol=0, atol=tolerance * scale)

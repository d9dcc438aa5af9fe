"""FMUs of the joint that a module of tests has `given`, written and extracted once a module."""

import pytest


@pytest.fixture(scope="module")
def written_files(given, tmp_path_factory):
    from fmu_joints import unpacked  # Only where fmpy is there.

    # Masters read resources through a URI: blanks and letters beyond ASCII must survive.
    return unpacked(given, tmp_path_factory.mktemp("fmu für dich"))


@pytest.fixture(scope="module")
def files(written_files):
    return written_files[0]


@pytest.fixture(scope="module")
def unzipped(written_files):
    """FMI version to folder of the extracted FMU."""
    return written_files[1]

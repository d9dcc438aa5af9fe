"""Interface files hold facets and nodal averages, readable by any XML reader."""

import base64
import zlib
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from fake_results import NX, NY, fake_results
from faying.exceptions import FormatError
from faying.export.vtk import write_interface_vtu
from faying.interface.interface import FacePairs
from faying.interface.surface import pair_facets

RESULTS = fake_results()
TYPES = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}


def content_of(text):
    """Undo base64 and compression: sizes of the blocks, then the blocks."""
    count = int.from_bytes(base64.b64decode(text[:12])[:8], "little")
    header = 4 * -(-8 * (3 + count) // 3)
    whole, last, *packed = np.frombuffer(base64.b64decode(text[:header]), "<u8")[1:].tolist()
    rest, blocks = base64.b64decode(text[header:]), []
    for size in packed:
        blocks.append(zlib.decompress(rest[:size]))
        rest = rest[size:]
    assert rest == b""
    assert [len(block) for block in blocks] == [whole] * (count - 1) + [last]
    return b"".join(blocks)


def arrays_of(path):
    return {
        element.get("Name"): np.frombuffer(
            content_of(element.text.strip()), TYPES[element.get("type")]
        )
        for element in ET.parse(path).getroot().iter("DataArray")
    }


def test_facets_cover_the_interface(tmp_path):
    (path,) = write_interface_vtu(RESULTS, tmp_path)
    assert path == tmp_path / "interface_joint.vtu"
    arrays = arrays_of(path)
    points = arrays["Points"].reshape(-1, 3)
    quads = points[arrays["connectivity"].reshape(-1, 4)]
    diagonals = quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1]
    area = 0.5 * np.linalg.norm(np.cross(*diagonals), axis=1).sum()
    # Exact geometry; only sums of a few dozen numbers round.
    assert area == pytest.approx(NX * NY * 25.0, rel=1e-12)
    np.testing.assert_array_equal(arrays["types"], 9)
    np.testing.assert_array_equal(arrays["offsets"], 4 * np.arange(1, NX * NY + 1))


def test_point_data_are_the_averages(tmp_path):
    (path,) = write_interface_vtu(RESULTS, tmp_path)
    arrays = arrays_of(path)
    joint = RESULTS.interfaces["joint"]
    response = RESULTS.cases["LC1"].methods["jim-b"][20].response
    np.testing.assert_array_equal(
        arrays["LC1 jim-b 20 pressure [MPa]"], joint.averaging @ response.pressure
    )
    np.testing.assert_array_equal(arrays["LC1 compliance gap [mm]"].shape, (len(joint.pairs),))
    np.testing.assert_array_equal(arrays["sticking"], joint.stuck)
    assert not any(name.startswith("LC2-step") for name in arrays)


def test_points_of_a_second_interface_are_its_own(tmp_path):
    joint = RESULTS.interfaces["joint"]
    n = len(joint.weights)
    two = {"a/b": joint, "a b": replace(joint, slice=(n, 2 * n))}
    case = RESULTS.cases["LC1"]
    doubled = replace(
        case.reference,
        pressure=np.concatenate([case.reference.pressure, np.arange(n) * 1.0]),
        gap=np.zeros(2 * n),
    )
    results = replace(
        RESULTS, interfaces=two, cases={"LC1": replace(case, reference=doubled, methods={})}
    )
    first, second = write_interface_vtu(results, tmp_path)
    assert first.name == "interface_a-b.vtu"
    assert second.name == "interface_a-b-2.vtu"
    found = arrays_of(second)["LC1 reference pressure [MPa]"]
    np.testing.assert_array_equal(found, np.arange(n))


def test_pairs_sharing_a_node_stay_apart():
    # Node 0 touches node 10 in one facet and node 20 in the other, as where three parts meet.
    joint = replace(
        RESULTS.interfaces["joint"],
        pairs=np.array([[0, 20], [0, 10], [1, 11], [2, 12], [3, 23]]),
        faces=(
            FacePairs(
                kind="tri3",
                minus=np.array([[0, 1, 2], [0, 2, 3]]),
                plus=np.array([[10, 11, 12], [20, 12, 23]]),
            ),
        ),
    )
    ((kind, facets),) = pair_facets(joint)
    assert kind == "tri3"
    np.testing.assert_array_equal(facets, [[1, 2, 3], [0, 3, 4]])


def test_folder_that_is_not_there(tmp_path):
    with pytest.raises(FormatError, match=r"cannot write .*interface_joint\.vtu"):
        write_interface_vtu(RESULTS, tmp_path / "nowhere")

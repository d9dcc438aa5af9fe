"""Damage to files as a strategy: bytes changed, lost, doubled, cut off, numbers made extreme."""

import re

from hypothesis import strategies as st

EXTREMES = [b"1e308", b"-1", b"0", b"nan", b"1e12", b"2147483648", b"99999999999999999999", b"\0"]
WORDS = [0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**40, 2**62, 2**64 - 1]
NUMBER = re.compile(rb"[-+\d.eE]+")


@st.composite
def damaged(draw, whole, *, text=False):
    """Return bytes like those given, with one to four mistakes in them."""
    data = bytearray(whole)
    for _ in range(draw(st.integers(1, 4))):
        # Headings are short, and most is decided there.
        reach = draw(st.sampled_from([len(data), min(len(data), 300)]))
        at = draw(st.integers(0, max(reach - 1, 0)))
        kinds = ["change", "flip", "delete", "insert", "cut", "double", "word"]
        kind = draw(st.sampled_from([*kinds, *(["number"] * 4 if text else [])]))
        if kind == "change":
            data[at : at + 1] = draw(st.binary(min_size=1, max_size=1))
        elif kind == "flip" and data:
            data[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == "delete":
            del data[at : at + draw(st.integers(1, 60))]
        elif kind == "insert":
            data[at:at] = draw(st.binary(min_size=1, max_size=8))
        elif kind == "cut":
            del data[at:]
        elif kind == "double":
            data[at:at] = data[at : at + draw(st.integers(1, 200))]
        elif kind == "word":
            width = draw(st.sampled_from([4, 8]))
            word = draw(st.sampled_from(WORDS)).to_bytes(8, "little")
            data[at : at + width] = word[:width]
        elif kind == "number":
            found = NUMBER.search(bytes(data), at)
            if found:
                data[slice(*found.span())] = draw(st.sampled_from(EXTREMES))
    return bytes(data)

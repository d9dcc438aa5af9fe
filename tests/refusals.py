"""What readers and writers refuse."""

import pytest

from faying.exceptions import FormatError


def refuses(message, call, *args, **keywords):
    """Check that a call ends in a FormatError whose text has a pattern."""
    with pytest.raises(FormatError, match=message):
        call(*args, **keywords)

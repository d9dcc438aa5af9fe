"""Response curves that fold: which of their points slow sweeps pass."""

import numpy as np

from faying.assessment.response_curve import ResponseCurve


def test_sweeps_pass_the_outer_branches_of_a_fold():
    frequency = np.array([1.0, 2.0, 3.0, 2.5, 2.2, 2.8, 4.0])
    curve = ResponseCurve(
        level=1.0, components=("tip.uz",), frequency=frequency, harmonics=np.zeros((7, 2, 1))
    )
    assert frequency[curve.swept_up].tolist() == [1.0, 2.0, 3.0, 4.0]
    assert frequency[curve.swept_down].tolist() == [1.0, 2.0, 2.2, 2.8, 4.0]

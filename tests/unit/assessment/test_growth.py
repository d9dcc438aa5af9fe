"""What first happens as a load grows, of made-up states."""

import numpy as np

from faying.assessment.growth import first_events


def test_what_happens_at_once_takes_one_trial_and_trials_are_shared():
    asked = []

    def reach(factor, state):
        asked.append((factor, state))
        return (factor, len(asked))

    def happens(at):
        return lambda trial, _: -np.inf if trial[0] >= at else np.inf

    events = {"at once": happens(1e-9), "first": happens(0.31), "second": happens(0.33)}
    found = first_events(reach, (0.0, 0), events, increments=2, largest=1.0)
    assert len(set(asked)) == len(asked)
    assert [factor for factor, _ in asked[:2]] == [0.5, found.factors["at once"]]
    for name, at in (("first", 0.31), ("second", 0.33)):
        assert at <= found.factors[name] <= at * (1 + 1e-3)

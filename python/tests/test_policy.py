"""The policy for `fasten`."""

import numpy as np
import pytest

pytest.importorskip("gymnasium")

from ramp.policies import fasten  # noqa: E402


def test_the_weights_are_there_and_beat_a_straight_push():
    weights = fasten.load()
    assert weights.shape == (3, fasten.FEATURES) and np.isfinite(weights).all()
    env = fasten.environments("ideal", 8, (100_001, 8), 2e-3)
    seeds = list(range(8))
    _, policy, _ = fasten.episodes(env, seeds, lambda seen: fasten.linear(weights, seen))
    _, push, _ = fasten.episodes(env, seeds, fasten.push)
    assert policy.sum() > push.sum()


def test_training_takes_its_steps():
    weights = fasten.train(0.1, ("ideal",), 1, pairs=1)
    assert weights.shape == (3, fasten.FEATURES) and not np.array_equal(weights, fasten.straight())

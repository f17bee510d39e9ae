"""The policy for `fasten`."""

import numpy as np
import pytest

pytest.importorskip("gymnasium")

from ramp.policies import fasten, judge  # noqa: E402


def test_the_weights_are_there_and_beat_a_straight_push():
    weights = fasten.load()
    assert weights.shape == (3, fasten.FEATURES) and np.isfinite(weights).all()
    env = fasten.environments("ideal", 4, (100_001, 4), 2e-3)
    seeds = list(range(4))
    _, policy, _ = fasten.episodes(env, seeds, lambda seen: fasten.linear(weights, seen))
    _, push, _ = fasten.episodes(env, seeds, judge.push)
    assert policy.sum() > push.sum()


def test_a_spiral_begins_anew_with_the_next_episode():
    over, touching = np.zeros((2, fasten.FEATURES)), np.zeros((2, fasten.FEATURES))
    over[:, 2] = 1.0
    act = judge.LIGHT.policy()
    first = [act(it) for it in (over, touching, touching)]
    again = [act(it) for it in (over, touching, touching)]
    assert np.array_equal(first, again) and not np.array_equal(first[1], first[2])


def test_a_share_has_an_interval():
    low, high = judge.interval(36, 40)
    assert 76.0 < low < 77.5 and 95.0 < high < 96.5


def test_episodes_to_judge_come_in_whole_batches(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["judge", "--episodes", "30"])
    with pytest.raises(SystemExit):
        judge.main()
    assert "found 30, expected a multiple of 20" in capsys.readouterr().err


def test_training_takes_its_steps():
    weights = fasten.train(1, ("ideal",), 1, pairs=1)
    assert weights.shape == (3, fasten.FEATURES) and not np.array_equal(weights, fasten.straight())

"""The policy for `fasten` that is cloned from demonstrations."""

import json
import shutil

import numpy as np
import pytest

pytest.importorskip("gymnasium")

import ramp  # noqa: E402
from ramp.demos.__main__ import main  # noqa: E402
from ramp.policies import clone, convolution, fasten, judge, localise  # noqa: E402

ROWS = 3


def rows(random):
    """Observations of some environments, with the fields that the policy takes."""
    return {
        "error": random.normal(0.0, 2e-3, (ROWS, 6)) - [0, 0, 0.04, 0, 0, 0],
        "wrench": random.normal(0.0, 5.0, (ROWS, 6)),
        "lead": random.normal(0.0, 2e-3, (ROWS, 6)),
        "tip": np.tile([0.3, 0.0, 0.1, 0.0, 0.8, 0.6, 0.0], (ROWS, 1)),
        "wrist": random.integers(0, 256, (ROWS, localise.IMAGE, localise.IMAGE, 3), np.uint8),
    }


def shown(random, count=12):
    """Steps as those of demonstrations."""
    return clone.Demonstrations(
        images=random.integers(0, 256, (count, localise.IMAGE, localise.IMAGE, 3), np.uint8),
        error=random.normal(0.0, 2e-3, (count, 3)),
        felt=random.normal(0.0, 5.0, (count, 5)),
        lead=random.normal(0.0, 2e-3, (count, 3)),
        yaw=random.uniform(-3.0, 3.0, count),
        wanted=random.uniform(-1.0, 1.0, (count, clone.OUTPUTS)).astype(np.float32),
        episode=np.arange(count) // 4,
    )


def test_senses_are_those_of_the_hand_whichever_way_it_is_turned():
    random = np.random.default_rng(2)
    error, lead = random.normal(0.0, 2e-3, (2, 4, 3))
    felt = random.normal(0.0, 5.0, (4, 5))
    straight = clone.senses(error, felt, lead, np.zeros(4))
    assert straight.shape == (4, clone.SENSES)
    angle = np.full(4, 0.7)
    for vectors in (error[:, :2], felt[:, :2], felt[:, 3:5], lead[:, :2]):
        vectors[:] = localise.turned(vectors, angle)
    assert clone.senses(error, felt, lead, angle) == pytest.approx(straight, abs=1e-5)


def test_a_mirror_turns_what_points_aside_and_torques_about_what_does_not():
    error, lead = np.array([[1e-3, 2e-3, -0.03]]), np.array([[1e-3, 2e-3, 0.0]])
    felt = np.array([[1.0, 2.0, 3.0, 0.1, 0.2]])
    one = clone.senses(error, felt, lead, np.zeros(1))
    error[:, 1] *= -1.0
    felt[:, 1] *= -1.0
    felt[:, 3] *= -1.0
    lead[:, 1] *= -1.0
    assert np.array_equal(clone.senses(error, felt, lead, np.zeros(1)), one * clone.MIRRORED)


def test_an_action_is_the_mean_of_what_several_calls_say_of_it():
    weights = clone.initial(np.random.default_rng(1))
    weights[-2][:] = 0.0
    weights[-1][:] = np.linspace(0.0, 0.55, clone.OUTPUTS)
    seen, policy = rows(np.random.default_rng(0)), clone.Clone(weights)
    policy.aim(seen)
    first = policy.policy(np.zeros((ROWS, 1)))
    chunk = np.linspace(0.0, 0.55, clone.OUTPUTS).reshape(clone.CHUNK, 3)
    assert first[0, 2] == pytest.approx(chunk[0, 2])
    for _ in range(6):
        policy.aim(seen)
    assert policy.policy(np.zeros((ROWS, 1)))[0, 2] == pytest.approx(chunk[:, 2].mean())
    # Along the axes of the world: the hand's are turned.
    yaw = localise.yaw(seen["tip"])
    found = localise.turned(policy.policy(np.zeros((ROWS, 1)))[:, :2], -yaw)
    assert found == pytest.approx(np.tile(chunk[:, :2].mean(0), (ROWS, 1)), abs=1e-6)


def test_the_same_seed_gives_the_same_weights():
    examples = shown(np.random.default_rng(0))
    how = clone.Training(epochs=2, batch=4)
    first, again, other = (clone.train(examples, seed, how) for seed in (1, 1, 2))
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert not np.array_equal(first[0], other[0])


REFUSED = {
    "text": "no weights of a network",
    "missing": "no weights of a network",
    "layers": "no weights of a network",
    "shape": "expected float16 of shape",
    "number": "not finite",
    "large": "larger than",
}


@pytest.mark.parametrize("change", REFUSED)
def test_a_file_with_other_weights_is_refused(tmp_path, change):
    file, weights = tmp_path / "clone.npz", clone.initial(np.random.default_rng(0))
    if change == "text":
        file.write_text("no weights")
    elif change != "missing":
        if change == "layers":
            del weights[-1]
        elif change == "shape":
            weights[0] = weights[0][:, :-1]
        elif change == "number":
            weights[3][0] = np.nan
        else:
            weights[-1] = np.zeros(10_000_000, np.float32)
        convolution.save(file, weights)
    with pytest.raises(ramp.InputError, match=f"clone.npz.*{REFUSED[change]}"):
        clone.load(file)


def test_demonstrations_are_read_and_others_are_refused(tmp_path):
    pytest.importorskip("zarr")
    request = {
        "what": "fasten", "skill": True, "logs": [], "goals": ["easy-1"], "world": "ideal", "start": "moved",
        "track": "noisy", "belief_error": 0.0, "agent": None, "rate": 20, "seed": 5, "episodes": 1, "program": "ramp",
        "format": "zarr", "image_size": localise.IMAGE, "depth": False, "output": str(tmp_path / "set"),
    }  # fmt: skip
    assert main(["record", json.dumps(request)]) == 0
    meta = tmp_path / "set" / "meta/ramp.json"
    told = json.loads(meta.read_text(encoding="utf-8"))
    steps = clone.demonstrations(tmp_path / "set")
    count = len(steps.wanted)
    assert 20 < count < 70 and steps.images.shape == (count, localise.IMAGE, localise.IMAGE, 3)
    # The second action of a step is the first of the next one, and the last one is repeated.
    assert steps.wanted[:-1, 3:6] == pytest.approx(steps.wanted[1:, :3], abs=1e-3)
    assert np.array_equal(steps.wanted[-1], np.tile(steps.wanted[-1, :3], clone.CHUNK))
    for name, other in (("format", "hdf5"), ("environment", "RAMP/Push-v0"), ("image_size", 96), ("rate", 10)):
        meta.write_text(json.dumps({**told, name: other}), encoding="utf-8")
        with pytest.raises(ramp.InputError, match=f"its {name} is {other!r}"):
            clone.demonstrations(tmp_path / "set")
    meta.write_text(json.dumps(told), encoding="utf-8")
    shutil.rmtree(tmp_path / "set/demos.zarr/data/lead")
    with pytest.raises(ramp.InputError, match="zarr arrays"):
        clone.demonstrations(tmp_path / "set")


def test_the_weights_are_there_and_seat_pegs_whose_holes_are_believed_elsewhere():
    env = fasten.environments("real", 3, (100_001, 3), 0.0, goals=("easy-3",), image=localise.IMAGE)
    cloned = judge.rivals(fasten.load(), clone.load())[judge.CLONED]
    assert judge.judge(env, cloned, 2e-3, 3)[0] >= 2


def test_a_misled_hand_first_goes_over_the_believed_hole():
    features = np.zeros((2, fasten.FEATURES))
    features[:, 0], features[:, 2] = 0.5, 1.0
    act, _ = judge.misled(judge.rivals(fasten.load(), clone.load())["straight push"])(2)
    moves = [act(features) for _ in range(judge.FIRST_MOVE + 1)]
    assert all(np.array_equal(move, [[0.5, 0.0, 0.0]] * 2) for move in moves[:-1])
    assert np.array_equal(moves[-1][:, 2], [-1.0, -1.0])

"""The policy for `fasten` with eyes."""

import numpy as np
import pytest

pytest.importorskip("gymnasium")

from ramp.policies import convolution, fasten, localise, looking  # noqa: E402


def test_the_gradient_is_that_of_finite_differences():
    random = np.random.default_rng(3)
    # In double precision; an odd side, so that the edges count.
    weights = [each.astype(float) for each in convolution.initial(9, (3, 4), 6, 2, 1, random)]
    for offset in weights[1::2]:
        offset += 0.3 * random.standard_normal(offset.shape)
    images, further = random.standard_normal((3, 9, 9, 3)), random.standard_normal((3, 1))
    wanted = random.standard_normal((3, 2))
    _, gradients = convolution.error_and_gradient(weights, images, further, wanted)
    for weight, gradient in zip(weights, gradients, strict=True):
        assert gradient.shape == weight.shape
        for index in random.choice(weight.size, min(weight.size, 6), replace=False):
            place, error = np.unravel_index(index, weight.shape), []
            for step in (1e-5, -2e-5):
                weight[place] += step
                error.append(convolution.error_and_gradient(weights, images, further, wanted)[0])
            weight[place] += 1e-5
            assert gradient[place] == pytest.approx((error[0] - error[1]) / 2e-5, abs=2e-5)


def test_the_network_gives_what_it_gave():
    weights = localise.load()
    assert 60_000 < sum(each.size for each in weights) < 90_000
    rows, columns, colours = np.ogrid[: localise.SIDE, : localise.SIDE, :3]
    images = ((3 * rows + 5 * columns + 40 * colours) % 256).astype(np.uint8)[None]
    found = localise.locate(weights, images, np.array([0.04]), np.array([[0.3, 0.1, 0.1, 0.0, 0.3, 0.95, 0.0]]))
    assert found == pytest.approx(np.array([[-0.027891, -0.004634]]), abs=2e-5)


def test_both_kinds_of_images_show_the_network_the_same():
    whole = np.random.default_rng(0).integers(0, 256, (localise.IMAGE, localise.IMAGE, 3), np.uint8)
    seen = np.zeros((2 * localise.IMAGE, localise.LOOK, 3), np.uint8)
    beside = (localise.LOOK - 2 * localise.IMAGE) // 2
    seen[:, beside:-beside] = whole.repeat(2, 0).repeat(2, 1)
    assert np.array_equal(localise.shrink(seen), localise.cut(whole))


def test_no_goal_and_no_start_of_judging_is_one_of_training():
    import ramp

    assert not set(localise.TRAINING) & set(localise.UNSEEN)
    assert set(localise.TRAINING) | set(localise.UNSEEN) == set(ramp.goals)


def test_the_same_seed_gives_the_same_weights():
    random = np.random.default_rng(0)
    examples = localise.Examples(
        random.integers(0, 256, (8, localise.IMAGE, localise.IMAGE, 3), np.uint8),
        random.uniform(0.036, 0.046, 8),
        np.tile([0.3, 0.0, 0.1, 0.0, 1.0, 0.0, 0.0], (8, 1)),
        random.normal(0.0, 2e-3, (8, 2)),
    )
    how = localise.Training(epochs=2, batch=4)
    first, again, other = (localise.train(examples, seed, how) for seed in (1, 1, 2))
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert not np.array_equal(first[0], other[0])


def test_a_peg_that_finds_no_hole_where_it_was_seen_seeks_it_where_it_is_believed():
    sight = looking.Sight(2)
    sight.sum, sight.weight = np.full((2, 2), 3e-3), np.ones(2)
    errors = np.array([[0.0, 0.0, -0.034], [0.0, 0.0, -0.020]])
    for _ in range(int(looking.PATIENCE * fasten.RATE)):
        found = sight.corrected(errors)
    assert found[:, :2] == pytest.approx(np.full((2, 2), 3e-3))
    # The second peg is in its hole.
    assert sight.corrected(errors)[:, :2] == pytest.approx(np.array([[0.0, 0.0], [3e-3, 3e-3]]))


def test_images_show_where_the_hole_is_on_a_goal_that_was_never_seen():
    examples = localise.collect("real", ("easy-3",), (localise.FIRST_JUDGING_START, 2), 2, 5, SHORT)
    beside = np.median(np.hypot(*examples.offsets.T))
    assert beside > 2e-3
    assert np.median(localise.errors(localise.load(), examples)) < 0.3 * beside


def test_images_seat_pegs_that_the_blind_policy_does_not_and_the_truth_stays_hidden():
    env = fasten.environments("real", 6, (100_001, 3), 4e-3, goals=("easy-3",), image=localise.IMAGE)
    weights = fasten.load()
    seeds = list(range(6))

    def policy(features):
        return fasten.linear(weights, features)

    _, blind, _ = fasten.episodes(env, seeds, policy)
    _, looking_too, _ = fasten.episodes(env, seeds, policy, looking.aim(6))
    assert looking_too.all() and blind.sum() < 6
    _, start = env.reset(seed=seeds)
    told = env.step(np.zeros((6, 3), np.float32))[4]
    assert "truth" not in start and "truth" not in told


SHORT = localise.Collection(envs=2, steps=20)

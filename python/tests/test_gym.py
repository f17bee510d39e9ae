"""Environments for Gymnasium."""

import os
import pickle
import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402

import ramp  # noqa: E402
from ramp.gym import CHAIN, IDS, RampChainEnv, RampEnv, RampVectorEnv  # noqa: E402
from ramp.policies.fasten import SETTINGS, Features, linear, load  # noqa: E402

FASTEN = {"goals": ["easy-3"], "starts": (1, 2)}


@pytest.mark.parametrize("env_id", IDS)
def test_every_id_passes_the_check(env_id):
    env = gymnasium.make(env_id, starts=(1, 1))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Whole goals have no pictures here; their own test is below.
        check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("action", ["cartesian", "joint", "raw"])
@pytest.mark.parametrize("track", ["state", "noisy"])
def test_every_action_passes_the_check(action, track):
    env = gymnasium.make("RAMP/Push-v0", goals=["medium-1"], starts=(1, 1), action=action, track=track, rate=50)
    check_env(env.unwrapped, skip_render_check=True)


def test_images_pass_the_check_and_show_something():
    env = gymnasium.make(
        "RAMP/Fasten-v0", **FASTEN, cameras=["wrist", "birds-eye"], depth=True, image_size=48, render_mode="rgb_array"
    )
    # The check opens a window, too.
    check_env(env.unwrapped, skip_render_check="DISPLAY" not in os.environ)
    seen, _ = env.reset(seed=1)
    for camera in ("wrist", "birds-eye"):
        assert seen[camera].shape == (48, 48, 3) and seen[camera].std() > 10
        assert seen[f"{camera}-depth"].shape == (48, 48)
    assert 0.02 < seen["wrist-depth"].min() < 0.2


def rollout(env, seed, steps=15):
    """Observations and rewards of random actions."""
    random = np.random.default_rng(seed)
    seen, _ = env.reset(seed=seed)
    rows = [seen]
    rewards = []
    for _ in range(steps):
        seen, reward, terminated, truncated, _ = env.step(
            random.uniform(-1, 1, env.action_space.shape).astype(np.float32)
        )
        rows.append(seen)
        rewards.append(reward)
        if terminated or truncated:
            break
    return rows, rewards


def test_vectors_give_the_bits_of_single_environments_for_any_number_of_threads():
    single = RampEnv("fasten", **FASTEN, reward="shaped")
    alone = [rollout(single, seed) for seed in (4, 5, 6)]
    for threads in (1, 2):
        vector = RampVectorEnv(3, "fasten", **FASTEN, reward="shaped", threads=threads, autoreset_mode="DISABLED")
        randoms = [np.random.default_rng(seed) for seed in (4, 5, 6)]
        seen, _ = vector.reset(seed=4)
        for step in range(16):
            # An episode that has ended stays as it is.
            running = [index for index in range(3) if step < len(alone[index][0])]
            for index in running:
                for name, values in alone[index][0][step].items():
                    assert np.array_equal(values, seen[name][index]), name
            actions = np.stack([it.uniform(-1, 1, single.action_space.shape) for it in randoms]).astype(np.float32)
            seen, reward, _, _, _ = vector.step(actions)
            for index in range(3):
                if step < len(alone[index][1]):
                    assert reward[index] == alone[index][1][step]


def test_next_step_resets_on_the_step_after_the_end():
    env = gymnasium.make_vec("RAMP/Fasten-v0", num_envs=2, **FASTEN, limit=0.2)
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert isinstance(env.unwrapped, RampVectorEnv)
    env.reset(seed=1)
    idle = np.zeros(env.action_space.shape, np.float32)
    ends = [env.step(idle)[3].tolist() for _ in range(10)]
    assert ends == [[step % 5 == 3] * 2 for step in range(10)]
    seen, reward, _, _, info = env.step(idle)
    assert seen["error"].shape == (2, 6) and env.observation_space.contains(seen)
    assert reward.shape == (2,) and info["_success"].all()


def test_same_step_resets_at_the_end_and_keeps_the_last_observation():
    env = gymnasium.make_vec("RAMP/Fasten-v0", num_envs=2, **FASTEN, limit=0.2, autoreset_mode="SAME_STEP")
    _, begun = env.reset(seed=[1, 2])
    idle = np.zeros(env.action_space.shape, np.float32)
    for _ in range(3):
        _, _, _, truncated, info = env.step(idle)
        assert not truncated.any() and "final_obs" not in info
    seen, _, _, truncated, info = env.step(idle)
    assert truncated.all() and seen["time"][:, 0].tolist() == [1.0, 1.0]
    assert [float(last["time"][0]) for last in info["final_obs"]] == [0.0, 0.0]
    assert info["_final_obs"].all() and info["final_info"]["success"].tolist() == [False, False]
    assert set(info["goal"]) == {"easy-3"} == set(begun["goal"])


def test_a_vector_tells_at_reset_what_one_environment_tells():
    env = RampVectorEnv(3, "fasten", "easy-3", starts=(1, 2))
    _, infos = env.reset(seed=[4, 5, 6])
    for index, seed in enumerate([4, 5, 6]):
        alone = RampEnv("fasten", "easy-3", starts=(1, 2))
        _, info = alone.reset(seed=seed)
        for name, value in info.items():
            assert np.array_equal(infos[name][index], value), name
    _, infos = env.reset(options={"reset_mask": np.array([False, True, False])})
    assert infos["_scene_seed"].tolist() == [False, True, False]


def test_normalised_observations_are_the_same_in_other_units():
    plain, scaled = (RampEnv("fasten", ["easy-3"], starts=(1, 1), normalise=it) for it in (False, True))
    before, after = plain.reset(seed=1)[0], scaled.reset(seed=1)[0]
    assert scaled.observation_space.contains(after)
    for name, unit in (("error", 0.01), ("wrench", 10.0), ("tip", 1.0)):
        assert np.allclose(before[name] / unit, after[name]), name
        high = scaled.observation_space[name].high
        assert np.allclose(plain.observation_space[name].high / unit, high), name


def test_the_truth_is_told_on_request_only():
    idle = np.zeros(7, np.float32)
    for truth in (False, True):
        env = RampEnv("fasten", ["easy-3"], starts=(1, 1), truth=truth, belief_error=0.003, track="noisy")
        seen, info = env.reset(seed=1)
        assert "truth" not in info
        seen, _, _, _, info = env.step(idle)
        assert ("truth" in info) == truth
        if truth:
            # The believed error and the true one differ by the error of the belief.
            off = np.linalg.norm(seen["error"][:2] + info["truth"]["off"][:2])
            assert 1e-4 < off < 0.02
        vector = RampVectorEnv(2, "fasten", ["easy-3"], starts=(1, 1), truth=truth)
        vector.reset(seed=1)
        info = vector.step(np.zeros((2, 7), np.float32))[4]
        assert ("truth" in info) == truth
        if truth:
            assert info["truth"]["off"].shape == (2, 3)


def test_a_limit_is_told_in_actions():
    env = gymnasium.make("RAMP/Fasten-v0", goals="easy-3", starts=(1, 1), limit=0.5, rate=30)
    # Periods of 33 ms.
    assert env.spec is not None and env.spec.max_episode_steps == 16 == env.unwrapped.max_episode_steps
    env.reset(seed=1)
    idle = np.zeros(env.action_space.shape, np.float32)
    ends = [env.step(idle)[3] for _ in range(16)]
    assert ends == [False] * 15 + [True]
    assert RampVectorEnv(1, "fasten", "easy-3", limit=0.5).max_episode_steps == 10


def test_disabled_leaves_ended_environments_and_resets_those_of_a_mask():
    env = gymnasium.make_vec(
        "RAMP/Fasten-v0", num_envs=3, **FASTEN, limit=0.1, vector_kwargs=None, autoreset_mode="DISABLED"
    )
    env.reset(seed=1)
    idle = np.zeros(env.action_space.shape, np.float32)
    env.step(idle)
    assert env.step(idle)[3].all()
    seen, _ = env.reset(options={"reset_mask": np.array([True, False, False])})
    assert seen["time"][:, 0].tolist() == [1.0, 0.0, 0.0]
    assert not env.step(idle)[2][0]


def test_a_limit_of_steps_truncates():
    env = gymnasium.make_vec("RAMP/Fasten-v0", num_envs=2, **FASTEN, max_episode_steps=3)
    env.reset(seed=1)
    idle = np.zeros(env.action_space.shape, np.float32)
    assert [env.step(idle)[3].all() for _ in range(8)] == [False, False, True, False, False, False, True, False]


def test_arrays_are_new_or_on_request_shared():
    for copied in (True, False):
        env = RampVectorEnv(2, "fasten", **FASTEN, copy=copied)
        first, _ = env.reset(seed=1)
        before = first["time"].copy()
        env.step(np.zeros(env.action_space.shape, np.float32))
        assert np.array_equal(first["time"], before) == copied


def test_environments_of_other_processes_and_pickles_are_the_same():
    env = RampEnv("fasten", **FASTEN)
    again = pickle.loads(pickle.dumps(env))
    assert np.array_equal(rollout(env, 3)[0][-1]["tip"], rollout(again, 3)[0][-1]["tip"])
    vector = gymnasium.make_vec("RAMP/Fasten-v0", num_envs=2, vectorization_mode="async", **FASTEN)
    seen, _ = vector.reset(seed=3)
    assert np.array_equal(seen["tip"][0], env.reset(seed=3)[0]["tip"])
    vector.close()


def test_what_is_no_action_ends_the_episode_with_its_cause():
    env = gymnasium.make("RAMP/Fasten-v0", **FASTEN).unwrapped
    env.reset(seed=1)
    _, _, terminated, _, info = env.step(np.array([np.nan, 0, 0], np.float32))
    assert terminated and "not finite" in info["cause"]
    with pytest.raises(ramp.InputError, match="4 numbers, and 3 were expected"):
        env.step(np.zeros(4))
    strided = np.zeros((3, 2), np.float32)[:, 0]
    env.reset(seed=1)
    assert env.step(strided)[1] == 0.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"skill": "fastn"}, "there is no skill `fastn`"),
        ({"skill": "slide", "goals": ["easy-1"]}, "none of the goals easy-1 has a step"),
        ({"skill": "push", "action": "dance"}, "there is no action `dance`"),
        ({"skill": "push", "rate": 2.0}, "not within 5 and 100 "),
        ({"skill": "push", "cameras": ["nose"]}, "there is no camera `nose`"),
        ({"skill": "push", "image_size": 4000, "cameras": ["wrist"]}, "image_size: found 4000"),
        ({"skill": "push", "image_size": -1}, "image_size: found -1"),
        ({"skill": "push", "starts": (-1, 3)}, "starts: found -1"),
        ({"skill": "push", "starts": (1, 2**70)}, "starts: found"),
        ({"skill": "push", "render_mode": "ansi"}, "render_mode: found 'ansi'"),
        ({"skill": "push", "leash": (0.1, -1.0, 0.1)}, "leash must be more than 0"),
        ({"skill": "push", "world": "moon"}, "there is no world `moon`"),
        ({"skill": "push", "frame": "stiff"}, "there is no frame `stiff`; there are rigid, free"),
        ({"goals": "easy-1", "truth": True}, "`truth` is the place of the part of a skill"),
        ({"skill": "push", "rate": 101}, "the rate 101 is not within 5 and 100 Hz"),
        ({}, "a goal is needed"),
    ],
)
def test_bad_arguments_say_what_is_wrong(arguments, words):
    with pytest.raises(ramp.InputError) as error:
        RampEnv(**arguments)
    assert words in str(error.value)


def test_seeds_and_options_that_have_no_effect_are_refused():
    env = RampEnv("push", ["medium-1"], starts=(1, 1))
    vector = RampVectorEnv(2, "push", ["medium-1"], starts=(1, 1))
    for seed in (-1, 2**64, 2**70):
        for each in (env, vector, RampChainEnv()):
            with pytest.raises(ramp.InputError, match="seed: found .* expected an integer from 0 to"):
                each.reset(seed=seed)
    with pytest.raises(ramp.InputError, match="seed: found -2"):
        vector.reset(seed=[1, -2])
    assert vector.reset(seed=np.int64(3))[0]["tip"].shape == (2, 7)
    with pytest.raises(ramp.InputError, match="no option 'reset_mask'"):
        env.reset(options={"reset_mask": [True]})
    with pytest.raises(ramp.InputError, match="expected seeds below"):
        RampEnv("push", ["medium-1"], starts=(2**64 - 1, 2))


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("num_envs", {"num_envs": 0}),
        ("num_envs", {"num_envs": 2**70}),
        ("threads", {"threads": -1}),
        ("max_episode_steps", {"max_episode_steps": 0}),
    ],
)
def test_numbers_of_environments_out_of_range_are_refused(name, arguments):
    with pytest.raises(ramp.InputError, match=f"{name}: found"):
        RampVectorEnv(skill="fasten", **FASTEN, **arguments)


def shows_the_work(picture):
    """Whether a picture for a person has its size, and shows more than a table."""
    assert picture.shape == (480, 640, 3) and picture.dtype == np.uint8
    assert picture[120:360, 160:480].std() > 30


def test_pictures_for_a_person_change_with_the_work():
    env = gymnasium.make("RAMP/Fasten-v0", **FASTEN, render_mode="rgb_array")
    env.reset(seed=1)
    before = env.render()
    shows_the_work(before)
    for _ in range(10):
        env.step(np.array([0, 0, -1], np.float32))
    assert np.abs(env.render().astype(int) - before).max() > 50
    with pytest.raises(gymnasium.error.ResetNeeded):
        RampEnv("fasten", **FASTEN, render_mode="rgb_array").render()


def test_a_window_shows_the_work_where_there_is_a_display():
    if "DISPLAY" not in os.environ:
        with pytest.raises(ramp.InputError, match='"human" needs'):
            RampEnv("fasten", **FASTEN, render_mode="human").reset(seed=1)
        pytest.skip("no display")
    pytest.importorskip("tkinter", reason="this Python has no tkinter")
    env = gymnasium.make("RAMP/Fasten-v0", **FASTEN, render_mode="human")
    env.reset(seed=1)
    env.step(np.zeros(3, np.float32))
    assert env.render() is None
    env.close()


def test_a_start_can_be_that_of_a_trial():
    env = RampEnv("push", ["medium-1"], begin="home", whole_scene=True, starts=(4, 1))
    _, info = env.reset(seed=1)
    assert info["skill"] == "push" and info["goal"] == "medium-1" and info["scene_seed"] == 4


def test_a_chain_builds_a_whole_goal_with_a_policy_for_one_action():
    arguments = {"speed": SETTINGS["speed"], "leash": SETTINGS["leash"], "render_mode": "rgb_array"}
    env = gymnasium.make(CHAIN, goals="easy-1", **arguments)
    seen, _ = env.reset(seed=1)
    shows_the_work(env.render())
    first = {name: value.copy() for name, value in seen.items()}
    weights, features = load(), Features(1)
    parts, terminated = 0, False
    while not terminated:
        action = linear(weights, features({name: seen[name][None] for name in ("error", "wrench", "tip", "lead")}))[0]
        features.action = action[None]
        done = -seen["error"][2] < 3e-4
        seen, reward, terminated, _, info = env.step(np.array([*action, 1.0 if done else -1.0], np.float32))
        if done:
            parts, features = parts + 1, Features(1)
    assert (parts, reward, info["success"]) == (3, 1.0, True)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(env.action_space.sample())
    again, _ = env.reset(seed=1)
    assert all(np.array_equal(first[name], again[name]) for name in first)
    # In the middle of a build.
    env.reset(seed=2)
    env.close()


def test_a_chain_says_what_is_wrong():
    with pytest.raises(ramp.InputError, match="no action of the kind slide"):
        gymnasium.make(CHAIN, goals="easy-1", skill="slide").reset(seed=1)
    with pytest.raises(ramp.InputError, match="rate"):
        gymnasium.make(CHAIN, rate=1.0)
    with pytest.raises(ramp.InputError, match="goal"):
        gymnasium.make(CHAIN, goals="no-goal").reset(seed=1)


def test_fingers_feel_what_they_hold(tmp_path):
    env = RampEnv("fasten", **FASTEN, touch=True)
    assert env.observation_space["touch_force"].shape == (2, 3)
    seen, _ = env.reset(seed=1)
    # A held peg: both fingers press beyond the range of their sensors, against each other.
    assert list(seen["touch_force"][:, 1]) == [-20.0, 20.0]
    assert np.abs(seen["touch_centre"]).max() < 0.03
    assert "touch_force" not in RampEnv("fasten", **FASTEN).observation_space.spaces
    many = RampVectorEnv(2, "fasten", **FASTEN, touch=True)
    assert many.reset(seed=1)[0]["touch_force"].shape == (2, 2, 3)
    assert RampChainEnv("easy-1", touch=True).observation_space["touch_centre"].shape == (2, 2)
    own = tmp_path / "own.toml"
    own.write_text('name = "own"\nbased_on = "real"\n[touch]\nfitted = { value = 1.0, source = "ours" }\n')
    assert "touch_force" in RampEnv("fasten", **FASTEN, world=own).observation_space.spaces
    with pytest.raises(ramp.InputError, match=r"touch\.fitted"):
        RampEnv("fasten", **FASTEN, world=own, touch=True)

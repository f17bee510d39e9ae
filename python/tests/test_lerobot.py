"""The adapter of LeRobot's environments, and `lerobot-eval`'s own way to it where LeRobot is installed."""

import importlib
import importlib.util
import pathlib
import sys

import numpy as np
import pytest

pytest.importorskip("gymnasium")

PLUGIN = pathlib.Path(__file__).resolve().parents[1] / "lerobot-env-ramp"


@pytest.fixture
def plugin(monkeypatch):
    """The folder of the plugin on the path, without its parts that need LeRobot."""
    monkeypatch.syspath_prepend(str(PLUGIN / "lerobot_env_ramp"))
    yield importlib.import_module("adapter")
    sys.modules.pop("adapter", None)


def test_an_adapter_has_what_lerobot_expects(plugin):
    import gymnasium

    def one():
        return plugin.Adapter("fasten", goals=["easy-1"], world="ideal", starts=(1, 1), image_size=32)

    env = gymnasium.vector.SyncVectorEnv([one], autoreset_mode=gymnasium.vector.AutoresetMode.SAME_STEP)
    seen, info = env.reset(seed=[1])
    assert seen["agent_pos"].shape == (1, 55) and seen["pixels"]["birds_eye"].shape == (1, 32, 32, 3)
    assert env.call("task_description")[0].startswith("fasten C") and env.call("_max_episode_steps") == (120,)
    assert not info["is_success"][0]
    for _ in range(120):
        seen, _, terminated, truncated, info = env.step(np.array([[0.0, 0.0, 1.0]], np.float32))
    assert truncated[0] and not terminated[0] and not info["final_info"]["is_success"][0]
    assert env.call("render")[0].shape == (480, 640, 3)


def test_a_goal_takes_the_actions_of_its_demonstrations(plugin):
    from ramp.demos.logs import ACTIONS, FIELDS

    env = plugin.Adapter("easy-1", world="ideal", image_size=16, rate=20.0, limit=1.0)
    seen, _ = env.reset(seed=1)
    assert env.action_space.shape == (len(ACTIONS),) and seen["agent_pos"].shape == (sum(FIELDS.values()),)
    assert env.task_description == "build the frame easy-1"


def test_an_unknown_task_is_named(plugin):
    with pytest.raises(ValueError, match="no task 'fastn'"):
        plugin.Adapter("fastn")


def test_lerobot_finds_the_plugin_by_its_name():
    # The name as it is written counts: LeRobot does not take - for _.
    assert '\nname = "lerobot_env_ramp"\n' in (PLUGIN / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.skipif(importlib.util.find_spec("lerobot") is None, reason="LeRobot is not installed")
def test_lerobot_makes_the_environments(monkeypatch):
    monkeypatch.syspath_prepend(str(PLUGIN))
    from lerobot.envs.configs import EnvConfig

    importlib.import_module("lerobot_env_ramp")
    config = EnvConfig.get_choice_class("ramp")(task="fasten", goals="easy-1", starts=1, image_size=32)
    env = config.create_envs(2)["ramp"][0]
    seen, _ = env.reset(seed=[1, 2])
    assert seen["agent_pos"].shape == (2, *config.features["agent_pos"].shape)

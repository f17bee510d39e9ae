"""Demonstrations: what is recorded, each format, going on after a stop, and playing them again."""

import importlib.util
import io
import json
import shutil
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("gymnasium")

import ramp  # noqa: E402
from ramp.demos import collect, formats, logs, skills, statistics  # noqa: E402
from ramp.demos.__main__ import main  # noqa: E402
from ramp.demos.episode import Episode  # noqa: E402
from ramp.demos.skills import SkillRecorder  # noqa: E402

SKILL = {
    "what": "fasten", "skill": True, "logs": [], "goals": ["easy-1"], "world": "ideal", "start": "moved",
    "track": "noisy", "belief_error": 0.0, "agent": None, "rate": 20, "image_size": 32, "depth": False, "seed": 5,
    "episodes": 2,
}  # fmt: skip


MADE = {}


@pytest.fixture(autouse=True)
def made_once(monkeypatch):
    """Makes each environment once: tests share its starts, and an episode does not depend on those before."""
    make = skills.make

    def kept(environment, arguments):
        key = json.dumps([environment, arguments])
        if key not in MADE:
            MADE[key] = make(environment, arguments)
        return MADE[key]

    monkeypatch.setattr(skills, "make", kept)


def have(form):
    """Skips a test without the packages of a format."""
    for name in formats.NEEDED[form]:
        pytest.importorskip(name)


def record(folder, **asked):
    """Makes a data set, as `ramp demos` does; the exit status."""
    asked = {**SKILL, "program": "ramp", "output": str(folder), **asked}
    return main(["record", json.dumps(asked)])


def play(folder):
    """Plays a data set again, as `ramp replay --dataset` does; the exit status."""
    return main(["replay", json.dumps({"dataset": str(folder), "json": True})])


@pytest.mark.parametrize("form", formats.NEEDED)
def test_a_data_set_is_read_back_and_ends_the_same(form, tmp_path, capsys):
    have(form)
    assert record(tmp_path / "set", format=form) == 0
    assert not (tmp_path / "set" / collect.UNFINISHED).exists()
    told = collect.read_meta(tmp_path / "set")
    assert [it["seed"] for it in told["episodes"]] == [5, 6] and all(it["success"] for it in told["episodes"])
    assert told["cameras"]["wrist"]["frame"] == "tip" and told["cameras"]["birds_eye"]["frame"] == "world"
    capsys.readouterr()
    assert play(tmp_path / "set") == 0
    assert json.loads(capsys.readouterr().out)["equal"] == 2
    # With the same arguments nothing is done; with others nothing is written.
    before = (tmp_path / "set" / collect.META).stat().st_mtime_ns
    assert record(tmp_path / "set", format=form) == 0
    assert record(tmp_path / "set", format=form, seed=6) == 2
    assert (tmp_path / "set" / collect.META).stat().st_mtime_ns == before
    # Another end, and another outcome.
    told["episodes"][0]["state"] = "0" * 16
    told["episodes"][1]["success"] = False
    (tmp_path / "set" / collect.META).write_text(json.dumps(told))
    capsys.readouterr()
    assert play(tmp_path / "set") == 1
    first, second = json.loads(capsys.readouterr().out)["differences"]
    assert "the state" in first["why"] and "success is True" in second["why"]


class Stop(Exception):
    """Stands for the end of the process."""


def test_a_stopped_call_goes_on_with_what_is_finished(tmp_path, monkeypatch):
    have("hdf5")
    recorded, whole = [], SkillRecorder.record

    def stops(self, seed):
        if len(recorded) == 1:
            raise Stop
        recorded.append(seed)
        return whole(self, seed)

    monkeypatch.setattr(SkillRecorder, "record", stops)
    with pytest.raises(Stop):
        record(tmp_path, format="hdf5")
    assert not (tmp_path / "demos.hdf5").exists()
    # With other arguments it does not mix.
    assert record(tmp_path, format="hdf5", world="real") == 2
    monkeypatch.setattr(SkillRecorder, "record", lambda self, seed: recorded.append(seed) or whole(self, seed))
    assert record(tmp_path, format="hdf5") == 0
    assert recorded == [5, 6] and play(tmp_path) == 0


def test_a_folder_of_somebody_else_is_left_alone(tmp_path, capsys):
    have("hdf5")
    (tmp_path / "thesis.txt").write_text("mine")
    assert record(tmp_path, format="hdf5") == 2
    assert "is not empty" in capsys.readouterr().err
    assert [it.name for it in tmp_path.iterdir()] == ["thesis.txt"]


def test_a_missing_package_is_named_and_nothing_is_written(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(formats, "NEEDED", {**formats.NEEDED, "zarr": ("no_such_package",)})
    assert record(tmp_path / "set", format="zarr") == 2
    assert "pip install 'ramp-benchmark[data]'" in capsys.readouterr().err and not (tmp_path / "set").exists()


def test_a_skill_without_a_policy_is_refused(tmp_path, capsys):
    have("hdf5")
    assert record(tmp_path / "set", format="hdf5", what="push") == 2
    assert "no policy that demonstrates `push`" in capsys.readouterr().err and not (tmp_path / "set").exists()


@pytest.mark.parametrize("text", ["", "[]", '{"schema": "ramp-demos-1"}', '{"schema": "ramp-demos-9"}'])
def test_a_damaged_data_set_is_one_clear_error(text, tmp_path, capsys):
    assert play(tmp_path) == 2
    (tmp_path / "meta").mkdir()
    (tmp_path / "meta/ramp.json").write_text(text)
    assert play(tmp_path) == 2
    told = capsys.readouterr().err
    assert told.count("Error: ") == 2 and ("ramp-demos-9" not in text or "expected 'ramp-demos-1'" in told)


class Sway(ramp.Agent):
    """Turns the first joint for a second, and presses by an impedance for another one."""

    name = "sway"

    def run(self, robot, goal):
        self.report(0.0, "action_begun", action="sway")
        driver = ramp.Driver(robot, "joint", speed=0.2)
        for _ in range(20):
            driver.act(robot, [1.0, 0, 0, 0, 0, 0, 0], periods=50)
        driver = ramp.Driver(robot, speed=0.02)
        for _ in range(20):
            driver.act(robot, [0, 0, -1.0, 0, 0, 0], periods=50)


def test_episodes_of_a_goal_come_from_logs_that_repeat_them(tmp_path, capsys):
    have("zarr")
    result = ramp.run("easy-1", agent=Sway(), track="state", world="ideal+touch", record=tmp_path / "sway.mcap")
    asked = {"what": None, "skill": False, "logs": [str(tmp_path)], "goals": [], "format": "zarr"}
    assert record(tmp_path / "set", **asked, image_size=16, depth=True, rate=10) == 0
    (episode,) = collect.read_meta(tmp_path / "set")["episodes"]
    assert not episode["success"] and episode["task"] == "build the frame easy-1" and episode["state"] == result.state
    assert episode["actions"] == [{"frame": 0, "action": "sway"}] and episode["agent"] == "sway 1"
    (actions,) = formats.module("zarr").actions(tmp_path / "set")
    import zarr

    data = zarr.open_group(str(tmp_path / "set/demos.zarr"), mode="r")["data"]
    assert actions.shape == (20, 8) and data["wrist_image"].shape == (20, 16, 16, 3)
    # The camera from above is further from the table than that at the hand, and nothing touches the fingers.
    wrist, above = data["wrist_depth"][:], data["birds_eye_depth"][:]
    assert above.shape == (20, 16, 16, 1) and above.dtype == np.uint16
    assert 24_000 < np.median(above) < 26_000 and 2_000 < np.median(wrist) < np.median(above)
    assert data["touch_force"].shape == (20, 6) and data["touch_centre"].shape == (20, 4)
    assert np.abs(data["touch_force"][:]).max() < 1.0
    # A target is where the joints are a little later: of commanded positions, and of a pose in space.
    positions = data["positions"][:]
    assert positions[10, 0] - positions[0, 0] > 0.15
    assert np.abs(positions[1:] - actions[:-1, :7]).max() < 0.02
    capsys.readouterr()
    assert play(tmp_path / "set") == 0
    zarr.open_group(str(tmp_path / "set/demos.zarr"), mode="r+")["data"]["action"][3] = 0.0
    assert play(tmp_path / "set") == 1
    assert "its actions are not those of its log" in capsys.readouterr().out
    log = tmp_path / "set/meta/logs/episode-000000.mcap"
    log.write_bytes(log.read_bytes()[:-100])
    assert play(tmp_path / "set") == 2


def test_logs_with_and_without_tactile_sensors_do_not_mix(tmp_path, capsys):
    have("zarr")
    for world in ("ideal", "ideal+touch"):
        ramp.run("easy-1", agent=Sway(), track="state", world=world, record=tmp_path / f"{world}.mcap")
    asked = {"what": None, "skill": False, "logs": [str(tmp_path)], "goals": [], "format": "zarr"}
    assert record(tmp_path / "set", **asked, image_size=0) == 2
    assert "has tactile sensors" in capsys.readouterr().err and not (tmp_path / "set").exists()


def test_the_reward_of_a_goal_is_the_share_of_pegs_that_begin_to_count():
    times = np.array([0.01, 0.05, 0.1, 0.15])
    assert logs.rewards_of(times, [0.1, None, 0.12, 9.0]).tolist() == [0.0, 0.25, 0.5]
    assert logs.rewards_of(times, [0.0]).tolist() == [1.0, 0.0, 0.0]


def test_statistics_of_images_are_those_of_their_values():
    random = np.random.default_rng(1)
    images = random.integers(0, 256, (3, 8, 8, 3)).astype(np.uint8)
    colours = statistics.Counts.of_colours()
    colours.add(images)
    told = colours.told()
    values = images.reshape(-1, 3) / 255.0
    assert np.allclose(np.ravel(told["mean"]), values.mean(0)) and np.allclose(np.ravel(told["std"]), values.std(0))
    assert np.allclose(np.ravel(told["max"]), values.max(0)) and told["count"] == [3]
    assert np.allclose(np.ravel(told["q50"]), np.quantile(values, 0.5, axis=0), atol=2 / 255)


def test_an_episode_is_kept_as_it_is(tmp_path):
    episode = Episode(
        {"tip": np.ones((3, 7), np.float32)}, {"wrist": np.zeros((3, 4, 4, 3), np.uint8)},
        {"wrist": np.full((3, 4, 4, 1), 65535, np.uint16)},
        np.zeros((2, 3), np.float32), np.zeros(2, np.float32), {"seed": 2**64 - 1, "task": "é", "success": False},
    )  # fmt: skip
    episode.save(tmp_path / "it.npz")
    again = Episode.load(tmp_path / "it.npz")
    assert again.facts == episode.facts and np.array_equal(again.state(), episode.state())
    assert np.array_equal(again.depths["wrist"], episode.depths["wrist"])
    assert [it.name for it in tmp_path.iterdir()] == ["it.npz"]


def test_the_command_starts_this_python(tmp_path):
    have("hdf5")
    arguments = ["demos", "fasten", "--goal", "easy-1", "--world", "ideal", "--episodes", "1", "--image-size", "0"]
    command = [sys.executable, "-m", "ramp", *arguments, "--format", "hdf5", "-o", "set"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "1 episodes, 1 successful" in done.stdout, done.stderr
    again = [sys.executable, "-m", "ramp", "replay", "--dataset", "set"]
    done = subprocess.run(again, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "1 of 1 episodes end as recorded" in done.stdout, done.stderr
    shutil.rmtree(tmp_path / "set/meta")
    assert subprocess.run(again, cwd=tmp_path, capture_output=True, check=False).returncode == 2


@pytest.fixture(scope="module")
def lerobot_set(tmp_path_factory):
    """A data set of two episodes in LeRobot's format."""
    have("lerobot")
    folder = tmp_path_factory.mktemp("lerobot") / "set"
    assert record(folder, format="lerobot", depth=True) == 0
    return folder


def test_the_files_of_lerobot_say_what_they_hold(lerobot_set):
    import av
    import pyarrow.parquet as parquet

    info = json.loads((lerobot_set / "meta/info.json").read_text())
    table = parquet.read_table(lerobot_set / "data")
    assert info["codebase_version"] == "v3.0" and info["total_frames"] == len(table)
    assert table["next.success"].to_numpy().sum() == 2
    told = json.loads((lerobot_set / "meta/stats.json").read_text())
    assert np.shape(told["observation.images.wrist"]["mean"]) == (3, 1, 1)
    assert told["action"]["count"] == [len(table)]
    with av.open(str(lerobot_set / "videos/observation.images.wrist/chunk-000/file-000.mp4")) as video:
        assert sum(1 for _ in video.decode(video=0)) == len(table)
    assert "LeRobot" in (lerobot_set / "README.md").read_text()


def test_depth_in_lerobot_is_in_metres(lerobot_set):
    import PIL.Image
    import pyarrow.parquet as parquet

    key = "observation.images.birds_eye_depth"
    feature = json.loads((lerobot_set / "meta/info.json").read_text())["features"][key]
    assert feature["dtype"] == "image" and feature["info"] == {"is_depth_map": True, "depth_unit": "m"}
    (first, *_) = parquet.read_table(lerobot_set / "data")[key].to_pylist()
    distances = np.asarray(PIL.Image.open(io.BytesIO(first["bytes"])))
    # The camera from above is 2.5 m over the table.
    assert distances.shape == (32, 32) and distances.dtype == np.float32 and 2.4 < np.median(distances) < 2.6
    told = json.loads((lerobot_set / "meta/stats.json").read_text())[key]
    assert np.shape(told["mean"]) == (1, 1, 1) and 2.0 < told["mean"][0][0][0] < 3.0


@pytest.mark.skipif(importlib.util.find_spec("lerobot") is None, reason="LeRobot is not installed")
def test_the_published_loader_of_lerobot_reads_it(lerobot_set, monkeypatch):
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    data = LeRobotDataset("ramp/fasten", root=str(lerobot_set), video_backend="pyav")
    assert data.num_episodes == 2
    actions = np.concatenate(list(formats.module("lerobot").actions(lerobot_set)))
    assert np.array_equal(np.stack([data[it]["action"].numpy() for it in range(len(data))]), actions)
    assert data[0]["observation.images.wrist"].shape == (3, 32, 32)


@pytest.mark.skipif(importlib.util.find_spec("robomimic") is None, reason="robomimic is not installed")
def test_the_published_loader_of_robomimic_reads_it(tmp_path):
    have("hdf5")
    assert record(tmp_path, format="hdf5") == 0
    import robomimic.utils.obs_utils as obs_utils
    from robomimic.utils.dataset import SequenceDataset

    obs_utils.initialize_obs_utils_with_obs_specs({"obs": {"low_dim": ["tip"], "rgb": ["wrist_image"]}})
    data = SequenceDataset(
        hdf5_path=str(tmp_path / "demos.hdf5"), obs_keys=("tip", "wrist_image"), dataset_keys=("actions",),
        frame_stack=1, seq_length=1, hdf5_use_swmr=False,
    )  # fmt: skip
    assert data[0]["obs"]["tip"].shape == (1, 7)

"""Episodes and environments on a cluster of Ray: equal to those of one machine, whatever is lost."""

import contextlib
import importlib.util
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import ramp
from ramp import ray as cluster
from ramp.ray import engine, program

OPTIONS = {"track": "state", "world": "ideal", "show": False}
SEED = 918273645
"""Of the first episode of a bench whose agent looks for it."""

AGENT = f"""
import json, pathlib, sys
print(json.dumps({{"hello": {{"protocol": 1, "name": "idle", "version": "1"}}}}))
sys.stdin.readline()
lines = [it.read_bytes() for it in pathlib.Path("/proc").glob("[0-9]*/cmdline")]
print("looked at", len(lines), "processes", file=sys.stderr)
print("seen in", sum(b"{SEED}" in it for it in lines), file=sys.stderr)
print(json.dumps({{"done": {{}}}}))
"""


def timeless(result):
    """A result without what the clock of a machine says."""
    told = json.loads(result.json)
    for peg in filter(None, told["pegs"]):
        del peg["t_total"]
    robot = told["time"]["robot"]
    return {key: told[key] for key in ("goal", "seed", "repeat", "pegs", "physics", "events", "ended")}, robot


def of_folder(folder):
    """The results of a folder, in the order of their names."""
    return [timeless(ramp.Result.from_json(path.read_text())) for path in sorted(folder.glob("*.json"))]


@pytest.fixture(scope="module")
def nodes():
    """A cluster of two nodes."""
    pytest.importorskip("ray", reason="SKIPPED: ray is not installed")
    from ray.cluster_utils import Cluster

    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    made.add_node(num_cpus=1)
    yield made
    made.shutdown()


@pytest.fixture(scope="module")
def local():
    """Results of one machine, by seed."""
    return {it.seed: timeless(it) for it in ramp.bench("easy-1", repeats=5, jobs=2, **OPTIONS)}


def kill_workers(nodes):
    """Kills the workers of a cluster that run an episode; their number."""
    raylets = {node.all_processes["raylet"][0].process.pid for node in nodes.list_all_nodes()}
    killed = 0
    for place in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            parent = int((place / "stat").read_text().rpartition(")")[2].split()[1])
            if parent in raylets and (place / "cmdline").read_bytes().startswith(b"ray::work"):
                os.kill(int(place.name), signal.SIGKILL)
                killed += 1
    return killed


def environment():
    """In which the command finds this package."""
    return {**os.environ, "RAMP_PYTHON": sys.executable}


def bench(folder, *words, **options):
    """Starts `ramp bench` in a folder."""
    command = [engine.PROGRAM, "bench", *map(str, words)]
    return subprocess.Popen(command, cwd=folder, env=environment(), text=True, **options)


def example(word):
    """Runs the example of the page of clusters that has this word; its names."""
    page = pathlib.Path(__file__).resolve().parents[2] / "docs/src/howto/run-on-a-cluster.md"
    blocks = page.read_text(encoding="utf-8").split("```python\n")[1:]
    names = {}
    exec(compile(next(it for it in blocks if word in it).split("```")[0], page, "exec"), names)
    return names


def test_an_unknown_backend_is_refused():
    for backend in ("dask", "ray:", "rays"):
        with pytest.raises(ramp.InputError, match="there is no backend"):
            ramp.bench("easy-1", backend=backend, **OPTIONS)


def test_an_address_without_a_cluster_is_one_error_and_nothing_is_written(tmp_path):
    pytest.importorskip("ray", reason="SKIPPED: ray is not installed")
    for address in ("127.0.0.1:1", "nonsense"):
        with pytest.raises(ramp.InputError, match="there is no cluster of Ray at"):
            ramp.bench("easy-1", backend=f"ray:{address}", **OPTIONS)
    there = bench(tmp_path, "easy-1", "--backend", "ray:127.0.0.1:1", "-o", "far", stderr=subprocess.PIPE)
    assert "there is no cluster of Ray" in " ".join(there.communicate()[1].split()) and there.returncode == 2
    assert not (tmp_path / "far").exists()


def test_files_travel_and_a_node_of_another_build_is_refused(tmp_path, monkeypatch):
    world = tmp_path / "mine.toml"
    world.write_text("name")
    call = cluster.Call({"goal": "easy-1", "world": world, "start": "moved"}, None, None, None)
    # `moved` is a name, even where a folder is called so.
    monkeypatch.chdir(tmp_path)
    (tmp_path / "moved").mkdir()
    assert cluster.files(call) == {"world": {"mine.toml": b"name"}}
    assert cluster.work("another", call, {}, None)[0] == "refused"
    kind, why, _ = cluster.work(engine.build(), call, cluster.files(call), None)
    assert kind == "refused" and "mine.toml" in why
    assert "another build" in program.work("another", {}, [])


def test_a_job_that_takes_too_long_is_stopped_with_all_its_processes(tmp_path):
    agent = program.File("0/agent.py", False)
    sleeper = b"import os, time\nopen('%s/pid', 'w').write(str(os.getpid()))\ntime.sleep(600)\n" % bytes(tmp_path)
    words = ["run", "--track", "state", "--world", "ideal", "--agent", "0/agent.py", "-o", "out/result.json", "easy-1"]
    ended = program.work(engine.build(), {"words": words, "limit": 3}, [agent], sleeper)
    assert ended.status is None and ended.took < 3 + program.PATIENCE
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


def test_the_command_gives_the_results_of_one_machine_and_goes_on_after_a_kill(nodes, local, tmp_path):
    # A benchmark of one goal, so that five episodes are a class.
    subprocess.run([engine.PROGRAM, "data", "export", tmp_path / "data"], check=True)
    for goal in (tmp_path / "data/goals").glob("*.xml"):
        if goal.name != "easy-1.xml":
            goal.unlink()
    words = ["easy", "--data", "data", "--track", "state", "--world", "ideal"]
    words += ["--backend", f"ray:{nodes.address}", "-o", "far"]
    first = bench(tmp_path, *words, stderr=subprocess.PIPE)
    # A worker that is lost costs no episode; then the bench itself is killed.
    while not kill_workers(nodes):
        assert first.poll() is None
        time.sleep(0.2)
    assert "1/5" in first.stderr.readline()
    first.send_signal(signal.SIGKILL)
    first.wait()
    kept = {path: path.stat().st_mtime_ns for path in (tmp_path / "far").glob("*.json")}
    assert 0 < len(kept) < 5
    second = bench(tmp_path, *words, "--json", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    told, shown = second.communicate()
    assert second.returncode == 0, shown
    assert f"{len(kept)} of 5 episodes are finished already" in shown
    assert json.loads(told)["goals"][0]["sum"]["finished"] == 5
    assert of_folder(tmp_path / "far") == [local[seed] for seed in range(1, 6)]
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    for ending in ("mcap", "svg"):
        assert len(list((tmp_path / "far").glob(f"*.{ending}"))) == 5
    check = [engine.PROGRAM, "entry", "check", "far", "--data", "data", "--backend", f"ray:{nodes.address}"]
    checked = subprocess.run(check, cwd=tmp_path, env=environment(), capture_output=True, text=True, check=False)
    assert "would be admitted" in checked.stdout, checked.stdout + checked.stderr


def test_an_agent_travels_and_does_not_see_its_seed(nodes, tmp_path):
    (tmp_path / "agent.py").write_text(AGENT)
    world = subprocess.run([engine.PROGRAM, "world", "show", "ideal", "--file"], capture_output=True, check=True)
    (tmp_path / "mine.toml").write_bytes(world.stdout)
    words = ["easy-1", "--track", "state", "--world", "mine.toml", "--repeats", 1, "--first-seed", SEED]
    bench(tmp_path, *words, "--agent", "agent.py", "--backend", f"ray:{nodes.address}", "-o", "far").wait()
    told = (tmp_path / f"far/easy-1-state-{SEED}.log").read_text()
    assert "looked at" in told and "seen in 0" in told, told


def test_environments_in_actors_equal_those_of_this_process(nodes, monkeypatch):
    gymnasium = pytest.importorskip("gymnasium")
    import ray

    monkeypatch.setenv("RAY_ADDRESS", nodes.address)
    try:
        names = example("RayVectorEnv(")
        assert names["reward"].shape == (4,)
        RayVectorEnv = names["RayVectorEnv"]
        arguments = {"goals": ["easy-1"], "starts": (1, 2), "world": "ideal", "limit": 0.2}
        here = gymnasium.make_vec("RAMP/Fasten-v0", num_envs=4, **arguments)
        there = RayVectorEnv("RAMP/Fasten-v0", 4, actors=2, **arguments)
        assert there.observation_space == here.observation_space and there.action_space == here.action_space
        assert there.metadata["autoreset_mode"] is here.metadata["autoreset_mode"]
        np.testing.assert_equal(there.reset(seed=7), here.reset(seed=7))
        random = np.random.default_rng(1)
        for step in range(8):
            if step == 6:
                options = {"reset_mask": np.array([True, False, False, True])}
                np.testing.assert_equal(there.reset(options=options), here.reset(options=options))
            actions = random.uniform(-1, 1, here.action_space.shape).astype(np.float32)
            np.testing.assert_equal(there.step(actions), here.step(actions))
        for wrong in (lambda: RayVectorEnv("RAMP/Fasten-v0", 3, actors=2), lambda: there.step(actions[:3])):
            with pytest.raises(ramp.InputError):
                wrong()
        there.close()
    finally:
        ray.shutdown()


def test_the_example_with_rllib_runs(nodes):
    pytest.importorskip("gymnasium")
    pytest.importorskip("ray.rllib", reason="SKIPPED: RLlib is not installed", exc_type=ImportError)
    import ray
    from ray.tune.registry import ENV_CREATOR, _global_registry

    config = example("rllib")["config"]
    ray.init(address=nodes.address, log_to_driver=False)
    try:
        env = _global_registry.get(ENV_CREATOR, config.env)(config.env_config)
        seen, _ = env.reset(seed=1)
        assert env.observation_space.contains(seen) and seen.ndim == 1
        assert np.isfinite(env.step(env.action_space.sample())[1])
        if importlib.util.find_spec("torch") is None:
            pytest.skip(
                "SKIPPED: PyTorch is not installed. The configuration and its environment ran, training did not"
            )
        assert config.build_algo().train()["training_iteration"] == 1
    finally:
        ray.shutdown()


def test_demonstrations_equal_those_of_one_machine(nodes, tmp_path, monkeypatch):
    pytest.importorskip("gymnasium")
    pytest.importorskip("h5py")
    from ramp.demos.__main__ import main
    from ramp.demos.collect import read_meta

    world = subprocess.run([engine.PROGRAM, "world", "show", "ideal", "--file"], capture_output=True, check=True)
    (tmp_path / "mine.toml").write_bytes(world.stdout)
    monkeypatch.chdir(tmp_path)
    skill = {
        "what": "fasten", "skill": True, "logs": [], "goals": ["easy-1"], "world": "./mine.toml", "start": "moved",
        "track": "noisy", "belief_error": 0.0, "agent": None, "rate": 20, "image_size": 0, "depth": False, "seed": 5,
        "episodes": 2, "format": "hdf5", "program": str(engine.PROGRAM),
    }  # fmt: skip
    backend = {"address": nodes.address}

    def told(folder, **asked):
        assert main(["record", json.dumps({**skill, "output": folder, **asked})]) == 0
        meta = read_meta(pathlib.Path(folder))
        return meta["request"], meta["episodes"]

    assert told("far", backend=backend) == told("here")
    (tmp_path / "logs").mkdir()
    ramp.run("easy-1", track="state", world="ideal", seed=1, record="logs/easy-1.mcap")
    logs = {"what": None, "skill": False, "logs": ["logs"], "goals": [], "world": "ideal"}
    assert told("far-logs", backend=backend, **logs) == told("here-logs", **logs)
    log = "meta/logs/episode-000000.mcap"
    assert (tmp_path / "far-logs" / log).read_bytes() == (tmp_path / "here-logs" / log).read_bytes()
    monkeypatch.setenv("RAMP_DATA", ".")
    assert main(["record", json.dumps({**skill, "output": "data", "backend": backend})]) == 2


def test_a_lost_worker_and_a_lost_node_cost_no_episode(nodes, local, tmp_path):
    import ray

    second = nodes.list_all_nodes()[-1]
    ray.init(address=nodes.address, log_to_driver=False)
    try:
        # Workers in the middle of an episode.
        losses = {0: lambda: kill_workers(nodes), 1: lambda: nodes.remove_node(second) or True}
        calls = [
            cluster.Call(
                {"goal": "easy-1", "track": "state", "world": "ideal", "seed": seed, "repeat": seed},
                None, None, tmp_path / f"easy-1-state-{seed}.json",
            )
            for seed in range(1, 5)
        ]  # fmt: skip
        found = {}
        for count, (index, text) in enumerate(cluster.episodes(calls, None)):
            found[index] = timeless(ramp.Result.from_json(text))
            if count in losses:
                time.sleep(1.0)
                assert losses[count]()
        assert {index + 1: found[index] for index in found} == {seed: local[seed] for seed in range(1, 5)}
        assert len(list(tmp_path.glob("*.mcap"))) == 4
        # Episodes of the folder are not run again.
        again = ramp.bench("easy-1", repeats=4, backend="ray", output=tmp_path, **OPTIONS)
        assert {it.seed: timeless(it) for it in again} == {seed: local[seed] for seed in range(1, 5)}
    finally:
        ray.shutdown()

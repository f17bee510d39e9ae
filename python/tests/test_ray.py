"""Episodes on a cluster of Ray: equal to those of one machine, whatever is lost meanwhile."""

import json
import subprocess
import time

import pytest

import ramp
from ramp import ray as cluster

OPTIONS = {"track": "state", "world": "ideal", "show": False}


def timeless(result):
    """A result without what the clock of a machine says."""
    told = json.loads(result.json)
    for peg in filter(None, told["pegs"]):
        del peg["t_total"]
    robot = told["time"]["robot"]
    return {key: told[key] for key in ("goal", "seed", "repeat", "pegs", "physics", "events", "ended")}, robot


def test_an_unknown_backend_is_refused():
    for backend in ("dask", "ray:", "rays"):
        with pytest.raises(ramp.InputError, match="there is no backend"):
            ramp.bench("easy-1", backend=backend, **OPTIONS)


def test_files_travel_and_a_node_of_another_build_is_refused(tmp_path, monkeypatch):
    world = tmp_path / "mine.toml"
    world.write_text("name")
    call = cluster.Call({"goal": "easy-1", "world": world, "start": "moved"}, None, None, None)
    # `moved` is a name, even where a folder is called so.
    monkeypatch.chdir(tmp_path)
    (tmp_path / "moved").mkdir()
    assert cluster.files(call) == {"world": {"mine.toml": b"name"}}
    assert cluster.work("another", call, {}, None)[0] == "refused"
    kind, why, _ = cluster.work(cluster.build(), call, cluster.files(call), None)
    assert kind == "refused" and "mine.toml" in why


def test_a_lost_worker_and_a_lost_node_cost_no_episode(tmp_path):
    pytest.importorskip("ray", reason="SKIPPED: ray is not installed")
    import ray
    from ray.cluster_utils import Cluster

    local = [timeless(it) for it in ramp.bench("easy-1", repeats=4, **OPTIONS)]
    nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    second = nodes.add_node(num_cpus=1)
    ray.init(address=nodes.address, log_to_driver=False)
    try:
        # Workers in the middle of an episode: `pkill` fails if it meets none.
        losses = {0: lambda: subprocess.run(["pkill", "-9", "-f", "ray::work"], check=True)}
        losses[1] = lambda: nodes.remove_node(second)
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
                losses[count]()
        assert [found[index] for index in range(4)] == local
        assert len(list(tmp_path.glob("*.mcap"))) == 4
        # Episodes of the folder are not run again.
        begin = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*.json")}
        again = ramp.bench("easy-1", repeats=4, backend="ray", output=tmp_path, **OPTIONS)
        assert [timeless(it) for it in again] == local
        assert len(begin) == 4
    finally:
        ray.shutdown()
        nodes.shutdown()

"""Small images, drivers, planners, and the examples for policies and planners that need other packages."""

import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import ramp

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"


def test_a_small_image_shows_the_whole_field_of_view():
    with ramp.Twin("easy-1", track="tags") as full, ramp.Twin("easy-1", track="tags") as small:
        large, tiny = full.look("birds-eye"), small.look("birds-eye", size=160)
        assert large.depth is None
        assert large.pixels.shape == (800, 1280, 3) and tiny.pixels.shape == (100, 160, 3)
        assert tiny.time == large.time and full.time == small.time
        mean = large.pixels.reshape(100, 8, 160, 8, 3).mean(axis=(1, 3))
        assert np.abs(mean - tiny.pixels).mean() < 8.0
        for wrong in (8, 1281):
            with pytest.raises(ramp.InputError, match="size: found"):
                small.look("wrist", size=wrong)


def test_depth_comes_with_its_track():
    with ramp.Twin("easy-1", track="depth", world="ideal") as twin:
        above, hand = twin.look("birds-eye"), twin.look("wrist", size=320)
    assert above.depth is not None and above.depth.shape == (800, 1280) and above.depth.dtype == np.uint16
    # The table is 2.5 m below, and the left border is outside of the second lens's image.
    assert abs(float(above.depth[700, 1000]) - 25000) < 100 and above.depth[700, 5] == 0
    assert hand.depth is not None and hand.depth.shape == (200, 320)


def test_a_world_with_touch_reports_the_fingers():
    with ramp.Twin("easy-1", world="ideal+touch") as twin, ramp.Twin("easy-1", world="ideal") as bare:
        seen = twin.observe()
        assert bare.observe().touch_force is None and bare.observe().touch_centre is None
    assert seen.touch_force is not None and seen.touch_force.shape == (2, 3) and not seen.touch_force.any()
    assert seen.touch_centre is not None and np.isnan(seen.touch_centre).all()


def test_an_agent_looks_in_small_and_drives_by_actions():
    class Look(ramp.Agent):
        def run(self, robot, goal):
            self.shape = robot.look("wrist", size=64).pixels.shape
            driver = ramp.Driver(robot, "joint", speed=0.5)
            before = robot.observe().positions[0]
            seen = driver.act(robot, [0.2, 0, 0, 0, 0, 0, 0], periods=500)
            self.moved = seen.positions[0] - before
            assert not driver.lead(seen).any()

    agent = Look()
    result = ramp.run("easy-1", agent=agent, world="ideal")
    assert agent.shape == (40, 64, 3) and result.ended == "done"
    assert agent.moved == pytest.approx(0.05, abs=0.01)


def test_a_planner_in_python_plans_and_plans_again():
    asked = []

    def own(problem):
        asked.append(problem)
        assert "(:requirements :strips)" in problem.pddl()["strips_domain"]
        path = EXAMPLES / "planners" / "greedy.py"
        lines = [json.dumps({"goal": {"name": problem.goal.name}}), json.dumps({"pddl": problem.pddl()})]
        done = subprocess.run(
            [sys.executable, path], input="\n".join(lines), capture_output=True, text=True, check=True
        )
        return "\n".join(done.stdout.splitlines()[1:])

    result = ramp.run("easy-1", track="state", planner=own, fault="peg-missing@1")
    assert result.counted == 3 and result.agent.startswith("baseline+planner-own."), result.agent
    assert len(asked) > 1 and asked[0].state["in_assembly"] == [] and asked[-1].state["lost_pegs"]
    assert asked[-1].history[-1]["kind"]


def test_a_planner_that_fails_is_heard():
    def refused(problem):
        return "(assemble b4)"

    result = ramp.run("easy-1", track="state", world="ideal", planner=refused)
    assert result.counted == 0 and result.ended.startswith("no plan: the planner's plan: ")
    with pytest.raises(ZeroDivisionError):
        ramp.run("easy-1", track="state", world="ideal", planner=lambda problem: 1 / 0)
    with pytest.raises(ramp.InputError, match="returned a int"):
        ramp.run("easy-1", track="state", world="ideal", planner=lambda problem: 7)
    with pytest.raises(ramp.InputError, match="no other plan"):
        ramp.run("easy-1", plan=ramp.plan("easy-1"), planner=refused)


def test_fast_downward_plans():
    pytest.importorskip("up_fast_downward", reason="SKIPPED: up-fast-downward is not installed")
    problem = ramp.Problem(ramp.Goal.load("easy-1"), {}, [])
    lines = [json.dumps({"goal": {"name": "easy-1"}}), json.dumps({"pddl": problem.pddl()})]
    path = EXAMPLES / "planners" / "with_fast_downward.py"
    done = subprocess.run([sys.executable, path], input="\n".join(lines), capture_output=True, text=True, check=True)
    steps = done.stdout.splitlines()[1:]
    assert len(steps) > 10 and any("fasten" in step for step in steps)


@pytest.mark.parametrize("name", ["hold", "insert"])
def test_the_example_server_speaks_the_dialect(name):
    for package in ("msgpack", "websockets"):
        pytest.importorskip(package, reason=f"SKIPPED: {package} is not installed")
    from websockets.sync.client import connect

    sys.path.insert(0, str(EXAMPLES / "policies"))
    try:
        import msgpack
        from server import pack, unpack
    finally:
        sys.path.pop(0)
    seen = {
        "observation/wrist_image_left": np.zeros((224, 224, 3), np.uint8),
        "ramp/tip_pose": np.zeros(7), "ramp/part_pose": np.zeros(7), "ramp/goal_pose": np.full(7, -0.01),
        "ramp/wrench": np.zeros(6),
    }  # fmt: skip
    command = [sys.executable, "-u", EXAMPLES / "policies" / "server.py", name, "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            url = server.stdout.readline().split()[-1]
            with connect(url, compression=None) as socket:
                about = msgpack.unpackb(socket.recv())
                assert about["name"] == name
                socket.send(msgpack.packb({"endpoint": "reset"}))
                assert socket.recv() == "reset successful"
                socket.send(msgpack.packb({**seen, "endpoint": "infer"}, default=pack))
                actions = msgpack.unpackb(socket.recv(), object_hook=unpack)["actions"]
                numbers = 7 if about["action_space"] == "cartesian_velocity" else 8
                assert actions.shape[1] == numbers and np.isfinite(actions).all()
                # Words in place of bytes where something is missing.
                socket.send(msgpack.packb({"prompt": "nothing"}))
                assert "KeyError" in socket.recv()
        finally:
            server.terminate()


def test_opencv_s_detector_finds_parts_for_the_baseline(tmp_path):
    pytest.importorskip("cv2", reason="SKIPPED: opencv-python-headless is not installed")
    result = tmp_path / "result.json"
    finder = EXAMPLES / "finders/tags_with_opencv.py"
    words = ["run", "easy-1", "--world", "ideal", "--track", "tags", "--finder", str(finder), "--output", str(result)]
    environment = os.environ | {"PATH": f"{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}"}
    done = subprocess.run([sys.executable, "-m", "ramp", *words], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert ramp.Result.from_json(result.read_text()).agent.startswith("baseline+finder-tags_with_opencv.")


def test_a_finder_in_python_sees_images_and_what_it_raises_arrives():
    seen = []

    def find(sight):
        seen.append((sight.camera, sight.pixels.shape, sight.depth.dtype, len(sight.parts), sight.camera_pose[2] > 0.2))
        if len(seen) > 3:
            raise RuntimeError("enough")
        return [ramp.Absent("p1")]

    with pytest.raises(RuntimeError, match="enough"):
        ramp.run("easy-1", track="depth", world="ideal", finder=find)
    assert {camera for camera, *_ in seen} == {"wrist", "birds-eye"}
    assert all(rest == [(800, 1280, 3), np.uint16, 24, True] for _, *rest in seen), seen
    for wrong in (lambda _: [7], lambda _: [ramp.Found("b1", pose=[1.0])]):
        with pytest.raises(ramp.InputError, match="the finder g"):
            ramp.run("easy-1", track="colour", world="ideal", finder=wrong)
    with pytest.raises(ramp.InputError, match="gives none"):
        ramp.run("easy-1", track="state", finder=find)

"""Goals, plans, episodes and the twin, as a user has them."""

import copy
import json
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import ramp
from ramp.policies.fasten import FastenPolicy


def test_a_frame_is_taken_apart_and_one_in_a_state_is_completed(tmp_path):
    result = ramp.run("easy-1", task="take-apart", track="state", world="ideal", start="sheet")
    assert result.task == "take-apart" and result.counted == 6 and not result.pegs
    assert "6 of 6 parts back" in str(result) and set(result.back) == {"b1", "b4", "b5", "p1", "p4", "p7"}
    state = tmp_path / "state.json"
    state.write_text('{"in_assembly": ["b4"], "fastened": [["C1", "p1"]]}')
    kept = ramp.run("easy-1", state=state, track="state", world="ideal", start="sheet")
    assert kept.counted == 3 and kept.pegs[0].t_robot < 0.1
    with pytest.raises(ramp.InputError, match="there is no task `paint`; there are build, take-apart"):
        ramp.run("easy-1", task="paint")
    with pytest.raises(ramp.InputError, match="leave out the state"):
        ramp.run("easy-1", task="take-apart", state=state)


def test_goals_are_those_of_the_benchmark():
    assert len(ramp.goals) == 9 and ramp.goals[0] == "easy-1"
    assert ramp.goals.of_class("hard") == ["hard-1", "hard-2", "hard-3"]
    goal = ramp.Goal.load("easy-1")
    assert goal.base == "b7" and [it.name for it in goal.connections] == ["C1", "C2", "C3"]
    assert goal.svg().startswith("<svg") and "<goal" in goal.text or "easy" in goal.text
    assert ramp.Goal.load(ramp.data() / "goals" / "easy-1.xml").beams == goal.beams


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: ramp.Goal.load("esay-1"), "did you mean `easy-1`"),
        (lambda: ramp.Goal.load("nowhere.xml"), "nowhere.xml"),
        (lambda: ramp.run("easy-1", track="sight"), "there is no track `sight`"),
        (lambda: ramp.run("easy-1", world="idael"), "did you mean `ideal`"),
        (lambda: ramp.run("easy-1", arm="ur5e"), "the arms are panda, fr3"),
        (lambda: ramp.run("easy-1", fault="fire"), "unknown fault `fire`"),
        (lambda: ramp.Twin(seed=1).look("nose"), "there is no camera `nose`"),
        (lambda: ramp.Command.joint_positions([0.0] * 6), "6 numbers, and 7 were expected"),
        (lambda: ramp.Command.pose([0, 0, 0], [2, 0, 0, 0]), "the length 2.0000"),
    ],
)
def test_bad_input_is_a_value_error_that_says_what(call, words):
    with pytest.raises(ramp.InputError, match=None) as error:
        call()
    assert words in str(error.value)
    assert isinstance(error.value, ValueError)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: ramp.run("easy-1", seed=-1), "seed"),
        (lambda: ramp.run("easy-1", seed=2**64), "seed"),
        (lambda: ramp.run("easy-1", repeat=0), "repeat"),
        (lambda: ramp.run("easy-1", repeat=2**40), "repeat"),
        (lambda: ramp.bench("easy-1", repeats=0), "repeats"),
        (lambda: ramp.bench("easy-1", first_seed=2**64 - 4), "first_seed"),
        (lambda: ramp.bench("easy-1", jobs=-1), "jobs"),
        (lambda: ramp.Twin(seed=-1), "seed"),
        (lambda: ramp.Twin(seed=2**70), "seed"),
        (lambda: ramp.Twin().render(size=2**70), "size"),
        (lambda: ramp.Twin().step(ramp.Command.joint_positions([0.0] * 7), periods=-1), "periods"),
    ],
)
def test_an_integer_out_of_range_is_bad_input(call, name):
    with pytest.raises(ramp.InputError) as error:
        call()
    assert re.fullmatch(f"{name}: found -?[0-9]+, expected an integer from [0-9]+ to [0-9]+", str(error.value))


GYMNASIUM = """
__version__ = "{version}"
registry = {{}}


def register(env_id, entry_point, **_):
    registry[env_id] = entry_point
"""


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (
            GYMNASIUM.format(version="0.29.1"),
            "need Gymnasium 1.1 or newer: pip install 'gymnasium>=1.1' (found 0.29.1)",
        ),
        (GYMNASIUM.format(version="1.0.0"), "(found 1.0.0)"),
        ("raise RuntimeError('built for another numpy')", "built for another numpy"),
    ],
)
def test_a_gymnasium_that_does_not_fit_disturbs_only_the_environments(code, words, tmp_path):
    (tmp_path / "gymnasium.py").write_text(code)
    script = """
import ramp
print(ramp.Goal.load("easy-1").base)
try:
    import gymnasium
    gymnasium.registry["RAMP/Fasten-v0"](goals=["easy-3"])
except (ImportError, RuntimeError) as error:
    print(error)
try:
    import ramp.gym
except ImportError as error:
    print(error)
"""
    env = {**os.environ, "PYTHONPATH": str(tmp_path)}
    child = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=env)
    assert child.returncode == 0, child.stderr
    base, made, imported = child.stdout.splitlines()
    assert base == "b7" and words in made and words in imported
    command = subprocess.run([sys.executable, "-m", "ramp", "goals"], capture_output=True, text=True, env=env)
    assert command.returncode == 0 and "easy-1" in command.stdout, command.stderr


def test_a_plan_goes_out_and_comes_back(tmp_path):
    plan = ramp.plan("easy-1")
    assert len(plan) == 35 and plan.coarse[0]["action"] == "pick_up" and len(plan.fine) > 35
    plan.save(tmp_path / "plan.json")
    result = ramp.run("easy-1", track="state", plan=tmp_path / "plan.json")
    assert result.completion == 1.0 and result.agent.startswith("baseline+plan.")
    plan.steps.pop(3)
    with pytest.raises(ramp.PlanningError, match="refused at step"):
        ramp.run("easy-1", track="state", plan=plan)


def test_an_episode_has_a_result(tmp_path):
    seen = []
    result = ramp.run("easy-1", track="state", record=tmp_path / "log.mcap", progress=lambda *it: seen.append(it))
    assert (
        result.counted == 3 and result.ended == "done" and [it.connection for it in result.pegs] == ["C1", "C2", "C3"]
    )
    assert seen and seen[-1][2] == 3
    assert (tmp_path / "log.mcap").stat().st_size > 10_000
    assert result._repr_svg_().startswith("<svg") and "3 of 3 pegs" in str(result)
    assert ramp.Result.from_json(result.json) == result
    # As an agent that is a program of its own has it.
    value = json.loads(result.json)
    value["time"]["agent_cpu"] = 1.5
    assert ramp.Result.from_json(json.dumps(value)).time.agent_cpu == 1.5
    # The same seed, the same bits; the command's too.
    again = ramp.run("easy-1", track="state")
    assert again.state == result.state
    assert pickle.loads(pickle.dumps(result)) == result


def test_a_bench_goes_on_where_it_stopped(tmp_path, capsys):
    results = ramp.bench(["easy-1"], repeats=2, track="state", output=tmp_path)
    assert len(results) == 2 and results.completion == 1.0
    assert "2/2 episodes" in capsys.readouterr().err
    assert len(list(tmp_path.glob("*.mcap"))) == 2, "each result has its log beside it"
    begin = time.perf_counter()
    assert [it.state for it in ramp.bench("easy-1", repeats=2, track="state", output=tmp_path, show=False)] == [
        it.state for it in results
    ]
    assert time.perf_counter() - begin < 60
    assert results.rows()[0]["counted"] == 3 and "<table>" in results._repr_html_()


def test_a_bench_takes_no_result_of_another_arm_world_track_seed_or_agent(tmp_path):
    options = {"track": "state", "world": "ideal", "output": tmp_path, "show": False}
    (first,) = ramp.bench(["easy-1"], agent=Idle, repeats=1, **options)
    (file,) = tmp_path.glob("*.json")
    written = file.read_bytes()
    # The same episode is not run again.
    Idle.runs = 0
    (again,) = ramp.bench(["easy-1"], agent=Idle, repeats=1, **options)
    assert again == first and Idle.runs == 0
    # Another seed or track has a file of its own.
    ramp.bench(["easy-1"], agent=Idle, repeats=1, first_seed=2, **options)
    ramp.bench(["easy-1"], agent=Idle, repeats=1, **(options | {"track": "noisy"}))
    assert Idle.runs == 2 and len(list(tmp_path.glob("*.json"))) == 3
    with pytest.raises(ramp.InputError, match="of the world ideal"):
        ramp.bench(["easy-1"], agent=Idle, repeats=1, **(options | {"world": "real"}))
    with pytest.raises(ramp.InputError, match="of the arm panda"):
        ramp.bench(["easy-1"], agent=Idle, repeats=1, **(options | {"arm": "fr3"}))
    assert first.arm == "panda" and ramp.run("easy-1", agent=Idle(), arm="fr3", track="state").arm == "fr3"
    with pytest.raises(ramp.InputError, match="of the agent idle 0.1"):
        ramp.bench(["easy-1"], agent=Stays, repeats=1, **options)
    text = json.loads(written)
    text["software"]["version"] = "0.0.1"
    file.write_text(json.dumps(text))
    with pytest.raises(ramp.InputError, match="made by ramp 0.0.1"):
        ramp.bench(["easy-1"], agent=Idle, repeats=1, **options)
    # A file of this episode's name that holds another seed's result, or none, is replaced.
    text = json.loads(written)
    text["seed"] = 7
    for damaged in (json.dumps(text), "{"):
        file.write_text(damaged)
        (again,) = ramp.bench(["easy-1"], agent=Idle, repeats=1, **options)
        assert again.seed == 1 and json.loads(file.read_text())["seed"] == 1
    assert Idle.runs == 5


class Idle(ramp.Agent):
    name = "idle"
    version = "0.1"
    runs = 0

    def run(self, robot, goal):
        Idle.runs += 1


class Stays(ramp.Agent):
    name = "stays"
    version = "0.1"

    def run(self, robot, goal):
        self.robot = robot
        seen = robot.observe()
        hold = ramp.Command.joint_positions(seen.positions.astype(np.float32)[::1])
        for _ in range(10):
            seen = robot.step(hold, 100)
        self.report(0.5, "action_begun", action="wait", seconds=1)
        self.report(0.6, "fault", fault="jammed", part="b4", remaining=0.0031, force=25.0)
        self.report(0.7, "diagnosis", cause="jam", part="b4", evidence="25 N")
        self.note(seen.time, "stood still")
        self.parts = robot.read_parts()


def test_an_agent_in_python_works_is_named_and_filmed(tmp_path):
    agent = Stays()
    log = tmp_path / "log.mcap"
    result = ramp.run("easy-1", agent=agent, track="state", record=log)
    assert result.agent == "stays 0.1" and result.counted == 0 and result.ended == "done"
    assert result.time.robot == pytest.approx(1.0) and result.events[-1]["text"] == "stood still"
    kinds = [event["kind"] for event in result.events]
    assert kinds == ["action_begun", "fault", "diagnosis", "note"]
    assert [ramp.describe(event) for event in result.events] == [
        "wait seconds 1",
        "b4 jams 3.1 mm before its place at 25.0 N",
        "jam: 25 N",
        "stood still",
    ]
    for kind, fields, why in [
        ("dance", {}, "unknown variant `dance`, expected one of `action_begun`"),
        ("diagnosis", {"cause": "bad luck", "evidence": ""}, "unknown variant `bad luck`, expected one of `part-lost`"),
        ("note", {"text": "a", "what": "b"}, "unknown field `what`"),
        ("note", {"text": "a" * 300}, "325 characters, and 250 is the most"),
        ("note", {"text": "a\x1b[2J"}, "a control character"),
        ("stopped", {"why": "it says so"}, "only the episode reports"),
    ]:
        with pytest.raises(ramp.InputError, match=why.replace("`", ".")):
            agent.report(1.0, kind, **fields)
    assert agent.parts["b4"].shape == (7,)
    with pytest.raises(RuntimeError, match="the robot is gone"):
        agent.robot.observe()
    film = ramp.Film(log, seen_from="birds-eye")
    assert film.gif.startswith(b"GIF8") and film._repr_html_().startswith('<img alt="log.mcap" src="data:image/gif')
    with pytest.raises(ramp.InputError, match="nowhere.mcap"):
        _ = ramp.Film("nowhere.mcap").gif


def test_what_an_agent_raises_passes_through_and_what_stops_the_robot_ends_the_episode():
    class Fails(ramp.Agent):
        def run(self, robot, goal):
            raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        ramp.run("easy-1", agent=Fails(), track="state")

    class Jumps(ramp.Agent):
        def run(self, robot, goal):
            robot.step(ramp.Command.joint_positions(robot.observe().positions + 0.5))

    result = ramp.run("easy-1", agent=Jumps(), track="state")
    assert "joint 1" in result.ended

    class Peeks(ramp.Agent):
        def run(self, robot, goal):
            with pytest.raises(ramp.Refused, match="gives no poses of parts"):
                robot.read_parts()

    assert ramp.run("easy-1", agent=Peeks(), track="tags").ended == "done"


def test_a_skill_in_python_fastens_inside_the_baseline():
    class GivesUpOnce(FastenPolicy):
        gave_up = False

        def work(self, robot, task):
            assert task.kind == "fasten" and task.held_pose is not None
            if not self.gave_up:
                self.gave_up = True
                return "not today"
            return super().work(robot, task)

    result = ramp.run("easy-1", skills=[GivesUpOnce()], track="state")
    assert result.agent.startswith("baseline+fasten-by-linear-policy")
    # The baseline goes on as after any fault, and tries again.
    assert any("not today" in it.get("why", "") for it in result.events)
    assert result.counted == 3, result
    # It does not rehearse, and the result says so once.
    (skill,) = [it["skill"] for it in result.events if it["kind"] == "not_rehearsed"]
    assert skill.startswith("fasten-by-linear-policy.")


def test_a_skill_in_python_rehearses_its_motions():
    class Press(ramp.Skill):
        asked = 0

        def rehearse(self, task):
            assert task.kind == "fasten" and task.held_pose is not None
            self.asked += 1
            down = task.goal_pose.copy()
            down[2] += 5.0
            down[3:] = [0.0, 1.0, 0.0, 0.0]
            return [[ramp.Motion.straight(down, task.width, contact=True), ramp.Motion.retreat()]]

        def work(self, robot, task):
            return "it cannot"

    press = Press()
    result = ramp.run("easy-1", skills=[press], track="state")
    assert press.asked > 0 and not any(it["kind"] == "not_rehearsed" for it in result.events)
    # Five metres up is out of reach, so the planner learns that the connection cannot be fastened.
    notes = [it["text"] for it in result.events if it["kind"] == "note"]
    assert any("C1 cannot be fastened: the arm cannot follow" in text for text in notes), notes


def test_a_twin_goes_back_to_the_last_bit():
    with ramp.Twin("easy-1", world="ideal") as twin:
        seen = twin.observe()
        hold = ramp.Command.joint_positions(seen.positions)
        start = twin.snapshot()
        after = twin.step(hold, 500)
        state = twin.state_hash
        twin.restore(start)
        assert twin.time == start.time == 0.0
        again = twin.step(hold, 500)
        assert twin.state_hash == state
        for name in ("positions", "velocities", "wrench"):
            assert np.array_equal(getattr(after, name), getattr(again, name))
        assert twin.render(size=64).shape == (64, 64, 3) and twin.look("birds-eye").pixels.shape == (800, 1280, 3)
        twin.expose()
        exposed = twin.time
        twin.step(hold, 60)
        image = twin.look("wrist")
        assert abs(image.time - exposed - 0.004) < 1e-9 and abs(twin.time - exposed - 0.06) < 1e-9
        assert set(twin.pegs()) == {"C1", "C2", "C3"} and twin.true_poses()["p1"].shape == (7,)
        with pytest.raises(ramp.InputError, match="another twin"):
            ramp.Twin("easy-1").restore(start)
        with pytest.raises(ramp.RobotStopped, match="not a finite"):
            twin.step(ramp.Command.joint_positions([np.nan] * 7))


def test_twins_are_pickled_and_copied_at_their_start():
    twin = ramp.Twin("easy-2", seed=3)
    for other in (pickle.loads(pickle.dumps(twin)), copy.deepcopy(twin)):
        assert other.state_hash == twin.state_hash and other.goal == twin.goal


def test_two_threads_on_one_twin_get_an_error_and_not_a_mixture():
    twin = ramp.Twin("easy-1")
    hold = ramp.Command.joint_positions(twin.observe().positions)
    errors = []

    def work():
        try:
            twin.step(hold, 3000)
        except RuntimeError as error:
            errors.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(2)]
    for it in threads:
        it.start()
    for it in threads:
        it.join()
    assert all("at work on another thread" in it for it in errors)
    assert twin.time in (3.0, 6.0)


SCRIPT = """
import ramp, signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # Tests that run in the background hand on that it is ignored.
twin = ramp.Twin("easy-1")
hold = ramp.Command.joint_positions(twin.observe().positions)
print("ready", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.parametrize("work", ["twin.step(hold, 1_000_000)", "ramp.run('easy-3', track='state')"])
def test_ctrl_c_ends_what_takes_long(work):
    child = subprocess.Popen(
        [sys.executable, "-c", SCRIPT.format(work=work)], stdout=subprocess.PIPE, text=True, env=dict(os.environ)
    )
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    out, _ = child.communicate(timeout=60)
    assert out == "interrupted\n"


def test_the_package_works_beside_any_mujoco(tmp_path):
    """Another libmujoco whose names are all visible must not take the place of our own."""
    libraries = pathlib.Path(ramp.__file__).parent.parent.glob("ramp_benchmark.libs/libmujoco*")
    library = next(libraries, None)
    if library is None:
        pytest.skip("not an installed wheel")
    script = (
        f"import ctypes; ctypes.CDLL({str(library)!r}, mode=ctypes.RTLD_GLOBAL); import ramp; "
        "print(ramp.Twin('easy-1').state_hash)"
    )
    child = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path)
    assert child.stdout.strip() == ramp.Twin("easy-1").state_hash, child.stderr


def test_the_command_comes_with_the_package(tmp_path):
    program = pathlib.Path(ramp.__file__).parent / "bin" / "ramp"
    if not program.exists():
        pytest.skip("not an installed wheel")
    child = subprocess.run(
        [sys.executable, "-m", "ramp", "goals"], capture_output=True, text=True, cwd=tmp_path, check=True
    )
    assert "easy-1" in child.stdout

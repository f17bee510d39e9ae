"""Teleoperation: input from files and devices, the window, and what a session leaves."""

import json
import os
import pathlib
import types

import numpy as np
import pytest

from ramp import InputError, Refused
from ramp._core import play_log
from ramp.demos import formats
from ramp.demos.__main__ import main as demos
from ramp.teleop import devices
from ramp.teleop.__main__ import main
from ramp.teleop.controls import Controls, Event
from ramp.teleop.operator import Cameras
from ramp.teleop.script import Script, read
from ramp.teleop.session import DEMONSTRATION, INPUT, hold
from ramp.teleop.settings import AXES, Settings

EXAMPLE = pathlib.Path(__file__).parents[2] / "examples/teleop/fasten.txt"

ASKED = {
    "what": "fasten", "skill": True, "goal": "easy-1", "track": "state", "world": "real", "start": "moved",
    "seed": 1, "format": "lerobot",
}  # fmt: skip


def have(form):
    """Skips a test without the packages of a format."""
    for name in formats.NEEDED[form]:
        pytest.importorskip(name)


@pytest.mark.parametrize(
    ("text", "line", "why"),
    [
        ("0 down f\nnow up f\n0 down enter", 2, "found `now`"),
        ("0 press f\n0 down enter", 1, "expected SECONDS down|up KEY or SECONDS axis AXIS VALUE"),
        ("# a key\n0 down f5\n0 down enter", 2, "there is no key `f5`; there are w, s,"),
        ("0 axis height 1\n0 down enter", 1, "there is no axis `height`; there are x, y,"),
        ("0 axis z -2\n0 down enter", 1, "found -2, expected a number from -1 to 1"),
        ("0 axis z nan\n0 down enter", 1, "found `nan`, expected a finite number"),
        ("0 axis z\n0 down enter", 1, "found 3 words, expected 4"),
        ("-1 down f\n0 down enter", 1, "before the start of the turn"),
        ("2 down f\n1 up f\n3 down enter", 2, "before that of the line above, 2 s"),
        ("0 down enter\n1 down f", 2, "the turn has ended"),
        ("0 down f\nturn\n0 down enter", 2, "the turn has no end"),
        ("0 down enter\nturn\n", 2, "the turn has no end"),
        ("", 0, "the turn has no end"),
    ],
)
def test_a_bad_line_is_one_error_and_nothing_is_written(tmp_path, capsys, text, line, why):
    have("lerobot")
    file = tmp_path / "input.txt"
    file.write_text(text)
    asked = ASKED | {"input": str(file), "output": str(tmp_path / "out")}
    assert main([json.dumps(asked)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"Error: {file}, line {line}: ") and why in told and told.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("content", [b"\xff\xfe", b"0 down \x1b[31m\n", b"#" * (5 * 1024 * 1024)])
def test_a_hostile_file_is_one_error(tmp_path, content):
    file = tmp_path / "input.txt"
    file.write_bytes(content)
    with pytest.raises(InputError) as error:
        read(file)
    assert str(file) in str(error.value) and str(error.value).isprintable()


def test_a_script_gives_each_event_once_and_in_time(tmp_path):
    file = tmp_path / "input.txt"
    file.write_text("0.1 down f  # down\n\n0.3 up f\n0.3 down enter\nturn\n0 down backspace\n")
    script = Script(file)
    assert script.begin("one") is None
    assert [len(script.events(time)) for time in (0.0, 0.05, 0.1, 0.15, 0.3, 0.35)] == [0, 0, 1, 0, 2, 0]
    assert script.begin("two") is None
    assert script.events(0.0) == [Event("down", "backspace")]
    assert script.begin("three") == "the input ends after turn 2"


def test_keys_and_axes_make_an_action():
    controls = Controls(Settings(slow=0.25))
    for event in (Event("down", "w"), Event("down", "d"), Event("axis", "x", 0.5), Event("axis", "z", -0.5)):
        controls.take(event)
    assert dict(zip(AXES, controls.action(), strict=True)) == {
        "x": 1.0, "y": -1.0, "z": -0.5, "about-x": 0.0, "about-y": 0.0, "about-z": 0.0, "gripper": 0.0,
    }  # fmt: skip
    controls.take(Event("down", "shift"))
    controls.take(Event("up", "w"))
    assert controls.action()[:3] == [0.125, -0.25, -0.125] and controls.end is None
    controls.take(Event("down", "backspace"))
    controls.take(Event("down", "enter"))
    assert controls.end == "backspace"


def test_a_teleoperated_fasten_leaves_result_log_input_and_demonstration(tmp_path, capsys):
    have("lerobot")
    asked = ASKED | {"input": str(EXAMPLE), "output": str(tmp_path / "out")}
    result = hold(asked, Settings(demonstration_size=0))
    assert result.counted == 3 and result.agent.startswith("baseline+fasten-by-teleop.")
    # The log repeats to the last bit.
    again = json.loads(play_log(str(tmp_path / "out/easy-1-1.mcap"), None, periods=1000))
    kept = json.loads((tmp_path / "out/easy-1-1.json").read_text())
    assert again["equal"] and again["state"] == kept["physics"]["state"] and again["agent"] == result.agent
    # The events that the session took are those of the file.
    assert read(tmp_path / "out" / INPUT) == read(EXAMPLE)
    assert "# fasten C1" in (tmp_path / "out" / INPUT).read_text()
    # The demonstration has the episode, and repeats, too.
    told = json.loads((tmp_path / "out" / DEMONSTRATION / "meta/ramp.json").read_text())
    assert told["format"] == "lerobot" and told["episodes"][0]["success"]
    turns = [it for it in told["episodes"][0]["actions"] if "fasten" in json.dumps(it["action"])]
    assert len(turns) == 3
    capsys.readouterr()
    assert demos(["replay", json.dumps({"dataset": str(tmp_path / "out" / DEMONSTRATION), "json": True})]) == 0


def test_a_goal_by_hand_sees_images_and_ends_with_its_turn(tmp_path, monkeypatch, capsys):
    have("hdf5")
    views = []
    monkeypatch.setattr(Script, "show", lambda self, view: views.append(view))
    (tmp_path / "input.txt").write_text("0 down w\n0.3 down c\n0.5 down enter\n")
    asked = ASKED | {
        "what": "easy-1", "skill": False, "goal": None, "track": "tags", "format": "hdf5",
        "input": str(tmp_path / "input.txt"), "output": str(tmp_path / "out"),
    }  # fmt: skip
    assert main([json.dumps(asked)]) == 1
    told = json.loads((tmp_path / "out/easy-1-1.json").read_text())
    assert told["agent"]["name"] == "teleop" and told["completion"] == 0.0 and told["ended"]["kind"] == "done"
    # Away from the base, and the fingers close.
    assert views[-1].tip[0] > views[0].tip[0] + 0.02 and views[-1].width < 0.075
    assert {name: image.shape for name, image in views[-1].images.items()} == {
        "wrist": (200, 320, 3), "birds-eye": (200, 320, 3),
    }  # fmt: skip
    # Images are those of cameras with a delay, and the arm does not wait for them.
    assert 0.45 < told["time"]["robot"] < 0.75 and not views[0].images


def test_a_goal_without_the_action_is_one_error(tmp_path, capsys):
    have("lerobot")
    asked = ASKED | {"what": "slide", "input": str(EXAMPLE), "output": str(tmp_path / "out")}
    assert main([json.dumps(asked)]) == 2
    assert "the plan of easy-1 has no action `slide`" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


class Shutters:
    """Cameras of a robot: how many pairs are on their way, and which camera has stopped."""

    def __init__(self, stopped=()):
        self.exposed, self.delivered, self.stopped = 0, {"wrist": 0, "birds-eye": 0}, stopped

    def expose(self):
        self.exposed += 1

    def look(self, camera, size):
        self.delivered[camera] += 1
        if camera in self.stopped:
            raise Refused(f"the {camera} camera has stopped")
        return types.SimpleNamespace(pixels=np.zeros((size * 5 // 8, size, 3), np.uint8))


def test_no_image_of_the_operator_is_left_for_the_baseline():
    robot, cameras = Shutters(), Cameras(Settings(image_every=2, image_delay=1))
    for _ in range(7):
        cameras.step(robot)
    assert robot.exposed == 4 and robot.delivered == {"wrist": 3, "birds-eye": 3}
    cameras.finish(robot)
    assert robot.delivered == {"wrist": 4, "birds-eye": 4} and set(cameras.images) == {"wrist", "birds-eye"}


def test_a_camera_that_has_stopped_shows_nothing():
    robot, cameras = Shutters(stopped=("wrist",)), Cameras(Settings())
    cameras.step(robot)
    cameras.finish(robot)
    assert set(cameras.images) == {"birds-eye"}


def pad(**held):
    """A gamepad of pyglet."""
    names = "lefty leftx righty rightx dpady dpadx rightshoulder leftshoulder a b x"
    return types.SimpleNamespace(name="pad", **(dict.fromkeys(names.split(), 0.0) | held))


def test_a_gamepad_and_a_6_axis_mouse_are_axes_and_keys():
    settings = Settings(dead_zone=0.1)
    gamepad = devices.Gamepad(pad(lefty=0.504, leftx=1.0, rightx=0.09, leftshoulder=True, a=True))
    axes, keys = devices.together([gamepad], settings)
    assert axes | {"x": 0.5, "y": -1.0, "about-z": 0.0, "gripper": -1.0} == axes and keys == {"enter"}
    state = types.SimpleNamespace(t=1.0, x=0.75, y=0.0, z=-0.5, roll=0.0, pitch=0.05, yaw=0.2, buttons=[0, 1])
    mouse = devices.Mouse(types.SimpleNamespace(read=lambda: state))
    axes, keys = devices.together([gamepad, mouse], settings)
    assert axes | {"x": 1.0, "z": -0.5, "about-y": 0.0, "about-z": 0.2, "gripper": 0.0} == axes


def window():
    """A window, where pyglet and a display are there."""
    pytest.importorskip("pyglet")
    if not os.environ.get("DISPLAY"):
        pytest.skip("no display")
    from ramp.teleop.window import Window

    return Window(Settings(), "test")


def test_keys_of_the_window_are_events():
    opened = window()
    try:
        from pyglet.window import key

        def send(*event):
            opened._window.dispatch_event(*event)
            # pyglet keeps events until the window is drawn.
            opened._draw()

        assert opened.begin("fasten C1") is None
        for symbol in (key.F, key.F, key.LSHIFT, key.F9):
            send("on_key_press", symbol, 0)
        assert opened.events(0.0) == [Event("down", "f"), Event("down", "shift")]
        # Nothing stays pressed when another window gets the keyboard.
        send("on_deactivate")
        assert opened.events(0.05) == [Event("up", "f"), Event("up", "shift")]
        opened._devices = [devices.Gamepad(pad(righty=-0.5, a=True))]
        assert opened.events(0.1) == [Event("axis", "z", -0.5), Event("down", "enter")]
        assert opened.events(0.15) == []
        opened.tick(0.2, 0, 3)
        send("on_close")
        assert opened.events(0.2) == [Event("down", "backspace")] and opened.begin("fasten C2") is not None
    finally:
        opened.close()


def test_the_window_shows_what_the_track_gives():
    from ramp.teleop import window as module
    from ramp.teleop.operator import View

    view = View(12.34, np.array([0.0, 0, -15, 0, 0, 0]), np.array([0.3, 0, 0.05]), 0.04, np.array([0, 0, -0.043]), {})
    told = module.lines("fasten C1", True, view.time, view)
    assert told[0] == "your turn: fasten C1" and "z -15.0 N" in told[2] and "z -43.0 mm" in told[5]
    assert module.lines("fasten C1", False, 12.3, view) == ["the baseline works", "robot time 12.3 s"]
    strip = np.full((120, 8, 3), 24, np.uint8)
    column = module.advance(strip, view.wrench)[:, -1]
    assert (column[60:] == module.COLOURS["down"]).all() and (column[:60] == 24).all()

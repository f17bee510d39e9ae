"""An agent that tells the arm where to be, and not how it gets there."""
import os

from common import hear, tell

clip = os.environ["BAD_WAY"] == "clip"
tell({"hello": {"protocol": 1, "name": "jumper", "version": "1.0", "clip": clip}})
goal = hear()["goal"]
there = [goal["arm"]["home"][0] + 0.5] + goal["arm"]["home"][1:]
command = {"arm": {"joint_positions": there}, "gripper": {"width": 0.04, "force": 10.0}, "repeat": 3000}
tell({"step": {"commands": [command]}})
answer = hear()
if "observation" in answer:
    off = [abs(at - to) for at, to in zip(answer["observation"]["positions"], there)]
    assert max(off) < 0.005, off
    tell({"done": {}})

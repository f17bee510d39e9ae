"""An agent that looks once, moves one joint a little, and is done. It is one file, as an entry of a
leaderboard wants it."""
import json
import sys

NAME, SHIFT = "mover", 1


def tell(message):
    print(json.dumps(message), flush=True)
    line = sys.stdin.buffer.readline()
    return json.loads(line) if line else None


goal = tell({"hello": {"protocol": 1, "name": NAME, "version": "1.0"}})["goal"]
home = goal["arm"]["home"]
tell({"read_parts": {}})
steps = []
for step in range(20):
    turned = [home[0] + 1e-5 * SHIFT * step] + home[1:]
    steps.append({"arm": {"joint_positions": turned}, "gripper": {"width": 0.04, "force": 10.0}, "repeat": 5})
tell({"step": {"commands": steps}})
tell({"done": {}})

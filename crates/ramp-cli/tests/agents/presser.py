"""An agent that presses on the table until the arm stops by reflex, and goes on when it is ready again."""
from common import hear, hello, tell

goal = hello("presser")


def move(seen, height):
    """Moves the tip along the vertical at 0.1 m/s; the first answer that is no observation, or the last."""
    x, y, z = seen["x_wt"]["position"]
    steps = int(abs(height) / 0.1 * 1000)
    commands = []
    for step in range(1, steps + 1):
        there = {**seen["x_wt"], "position": [x, y, z + height * step / steps]}
        arm = {
            "x_wt": there,
            "stiffness": [1500, 1500, 1500, 60, 60, 60],
            "damping_ratio": 1.0,
            "feed_forward": [0] * 6,
            "posture": seen["positions"],
        }
        commands.append({"arm": {"impedance": arm}, "gripper": {"width": 0.04, "force": 20}})
    answer = {"observation": seen}
    for begin in range(0, steps, 100):
        tell({"step": {"commands": commands[begin : begin + 100]}})
        answer = hear()
        if "observation" not in answer:
            break
    return answer


tell({"observe": {}})
seen = hear()["observation"]
told = move(seen, -seen["x_wt"]["position"][2] - 0.2)["recovered"]
assert told["reason"].startswith("reflex: ") and told["after"] > 0.5, told
standing = told["observation"]
assert standing["time"] > seen["time"] + told["after"], told
lifted = move(standing, 0.05)["observation"]
assert lifted["x_wt"]["position"][2] > standing["x_wt"]["position"][2] + 0.03, lifted
tell({"done": {}})

"""A skill of one's own for `fasten`, without any package: over the hole, then straight down with a growing
force.

    ramp run easy-1 --track state --skill fasten=examples/skills/press.py
    ramp trials fasten-in-f --track state --skill fasten=examples/skills/press.py

It speaks the agents' protocol (docs/src/reference/agents.md); its goal has a `task`.
"""

import json
import sys

STIFFNESS = [1500.0, 1500.0, 1500.0, 60.0, 60.0, 60.0]
FORCE = 20.0  # N
SPEED = 0.03  # m/s


def say(kind, value=None):
    """Sends a message, and returns the answer."""
    print(json.dumps({kind: value or {}}), flush=True)
    answer = json.loads(sys.stdin.readline())
    if "end" in answer:
        sys.exit(0)
    return answer


def turned(quat_wxyz, vector):
    """A vector turned by a quaternion."""
    w, x, y, z = quat_wxyz
    a, b, c = vector
    tx, ty, tz = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx]


def product(p, q):
    """The product of two quaternions."""
    (a, b, c, d), (w, x, y, z) = p, q
    return [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]


def rehearse(task):
    """The motions that this skill asks for: straight down with the peg to its hole, and up again."""
    x, y, z = task["x_goal"]["position"]
    # The hand keeps its orientation: that of the peg, turned back by the orientation of the peg in the hand.
    w, i, j, k = task["held"]["x_tp"]["quat_wxyz"]
    turn = product(task["x_wp"]["quat_wxyz"], [w, -i, -j, -k])
    down = {"position": [x, y, z + task["held"]["x_tp"]["position"][2]], "quat_wxyz": turn}
    straight = {"x_wt": down, "open": task["gripper"]["width"], "around": None, "contact": True}
    say("rehearsal", {"alternatives": [[{"straight": straight}, {"retreat": {}}]]})


def main():
    answer = say("hello", {"protocol": 1, "name": "press", "version": "1", "rehearses": True})
    if "rehearse" in answer:
        return rehearse(answer["rehearse"]["task"])
    task = answer["goal"]["task"]
    hole = task["x_goal"]["position"]
    seen = say("observe")["observation"]
    target = list(seen["x_wt"]["position"])
    turn = seen["x_wt"]["quat_wxyz"]
    for _ in range(200):
        tip = seen["x_wt"]["position"]
        in_hand = turned(seen["x_wt"]["quat_wxyz"], task["held"]["x_tp"]["position"])
        off = [hole[axis] - tip[axis] - in_hand[axis] for axis in range(3)]
        if abs(off[2]) < 0.0003:
            break
        near = max(abs(off[0]), abs(off[1])) < 0.0005
        target[0] += 0.3 * off[0]
        target[1] += 0.3 * off[1]
        if near:
            # No lower under the tip than the spring needs for its force.
            target[2] = max(target[2] - SPEED * 0.05, tip[2] - FORCE / STIFFNESS[2])
        command = {
            "arm": {
                "impedance": {
                    "x_wt": {"position": target, "quat_wxyz": turn},
                    "stiffness": STIFFNESS,
                    "damping_ratio": 1.0,
                    "feed_forward": [0.0] * 6,
                    "posture": task["posture"],
                }
            },
            "gripper": task["gripper"],
            "repeat": 50,
        }
        seen = say("step", {"commands": [command]})["observation"]
    else:
        say("event", {"kind": "fault", "fault": "other", "why": f"the peg stands {-off[2] * 1e3:.1f} mm high"})
    say("done")


if __name__ == "__main__":
    main()

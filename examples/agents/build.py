#!/usr/bin/env python3
"""An agent for RAMP in plain Python: builds frames of beams that stand straight on the clamped one.

    ramp run easy-1 --track state --agent examples/agents/build.py

It reads where the parts are (track `state`), picks up the beams one by one, pushes each to its place, and
pins it with a peg. It uses no force feedback and does not recover from faults. The protocol is
docs/src/reference/agents.md. Metres, newtons and radians; a pose is a pair of a position and a quaternion w,
x, y, z.
"""
import json
import math
import sys

TRAVEL = 0.25  # Height of the tip on its ways, m.
BEAM_GRIP = 0.017  # Height of the tip over the axis of a beam that it grips, m.
PEG_GRIP = 0.020  # The same over the underside of a peg's head.
STIFF = [1500.0] * 3 + [60.0] * 3


# ---- The protocol: one JSON object a line, one answer for each message.


def tell(message):
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


def ask(message):
    tell(message)
    kind, answer = json.loads(sys.stdin.buffer.readline()).popitem()
    if kind == "end":
        print("the episode is over:", answer["reason"], file=sys.stderr)
        sys.exit()
    return answer


def report(kind, **fields):
    ask({"event": {"kind": kind, **fields}})


# ---- Poses.


def turned(q, v):
    """The vector v turned by the quaternion q."""
    w, x, y, z = q
    tx, ty, tz = 2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])
    return [
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    ]


def product(a, b):
    """Two quaternions, one turn after the other."""
    return [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]


def inverse(x):
    q = [x[1][0], -x[1][1], -x[1][2], -x[1][3]]
    return [-c for c in turned(q, x[0])], q


def compose(a, b):
    """x_ab and x_bc make x_ac."""
    return [p + d for p, d in zip(a[0], turned(a[1], b[0]))], product(a[1], b[1])


def pose(x):
    return x["position"], x["quat_wxyz"]


def shifted(x, dx=0.0, dy=0.0, dz=0.0):
    return [x[0][0] + dx, x[0][1] + dy, x[0][2] + dz], x[1]


def yaw_of(x):
    """The direction of a pose's x axis, seen from above."""
    along = turned(x[1], [1, 0, 0])
    return math.atan2(along[1], along[0])


def hand_down(p, yaw):
    """The tip at p, pointing down; it closes across the direction of yaw."""
    return list(p), [0.0, math.cos(yaw / 2), math.sin(yaw / 2), 0.0]


def between(a, b, s):
    """From a to b, as far as s of 0 to 1."""
    qa, qb = a[1], b[1]
    if sum(m * n for m, n in zip(qa, qb)) < 0:
        qb = [-n for n in qb]
    q = [m + s * (n - m) for m, n in zip(qa, qb)]
    size = math.sqrt(sum(n * n for n in q))
    return [m + s * (n - m) for m, n in zip(a[0], b[0])], [n / size for n in q]


# ---- The hand.


class Hand:
    def __init__(self, goal):
        self.seen = ask({"observe": {}})
        self.at = pose(self.seen["x_wt"])
        self.home = goal["arm"]["home"]
        self.gripper = {"width": 0.04, "force": 60.0}
        self.lift = 0.0  # Weight of what is held, N.

    def command(self, x, repeat=1):
        target = {"position": x[0], "quat_wxyz": x[1]}
        spring = {
            "x_wt": target,
            "stiffness": STIFF,
            "damping_ratio": 1.0,
            "feed_forward": [0.0, 0.0, self.lift, 0.0, 0.0, 0.0],
            "posture": self.home,
        }
        return {"arm": {"impedance": spring}, "gripper": self.gripper, "repeat": repeat}

    def wait(self, seconds):
        self.seen = ask({"step": {"commands": [self.command(self.at, round(1000 * seconds))]}})

    def go(self, x, speed):
        """Draws the spring's end in a straight line to x (m/s), softly; a message holds 50 ms of it."""
        way = max(math.dist(self.at[0], x[0]) / speed, 2 * math.dist(self.at[1], x[1]), 0.05)
        periods = round(1500 * way)
        start = self.at
        for begin in range(0, periods, 50):
            steps = [(i + 1) / periods for i in range(begin, min(begin + 50, periods))]
            path = [between(start, x, s * s * (3 - 2 * s)) for s in steps]
            self.seen = ask({"step": {"commands": [self.command(at) for at in path]}})
            self.at = path[-1]

    def grip(self, width):
        self.gripper = {"width": width, "force": 60.0}
        self.wait(0.8)

    def over(self, x):
        """High over x, by way of high over here."""
        self.go(([self.at[0][0], self.at[0][1], TRAVEL], self.at[1]), 0.15)
        self.go(([x[0][0], x[0][1], TRAVEL], x[1]), 0.2)

    def fetch(self, part, x, opened, closed, weight):
        """Grips a part at x. Returns where it is in the hand."""
        self.over(x)
        self.grip(opened)
        self.go(x, 0.1)
        self.wait(0.3)
        self.grip(closed)
        self.lift = weight
        x_tp = compose(inverse(pose(self.seen["x_wt"])), look()[part])
        self.go(shifted(x, dz=0.1), 0.1)
        return x_tp

    def leave(self, opened):
        self.grip(opened)
        self.lift = 0.0
        self.at = pose(self.seen["x_wt"])
        self.go(shifted(self.at, dz=0.1), 0.1)


def look():
    """Where all parts are."""
    return {it["part"]: pose(it["x_wp"]) for it in ask({"read_parts": {}})}


# ---- The work.


def nearest_turn(yaw, step, to=0.1):
    """The yaw that a hand can have as well, a multiple of `step` away, nearest to where the wrist is in its
    middle."""
    return yaw + step * round((to - yaw) / step)


def insert(hand, goal, insertion):
    beam = next(it for it in goal["beams"] if it["name"] == insertion["beam"])
    x_wb, goal_wb = look()[beam["name"]], pose(beam["x_wb_goal"])
    middle = max(joint["p_b"][0] for joint in beam["joints"]) / 2
    spans = [[it["grasp"][0] + 0.011, it["grasp"][1] - 0.011] for it in beam["links"]]
    places = [min(max(middle, low), high) for low, high in spans if low < high]
    s = min(places, key=lambda s: abs(s - middle))
    # Of the two ways to hold it, the one that turns the wrist less from its middle, here and there.
    turn = yaw_of(goal_wb) - yaw_of(x_wb)
    turn = math.remainder(turn, 2 * math.pi)
    here = nearest_turn(yaw_of(x_wb), math.pi, 0.1 - turn / 2)
    grip = hand_down(shifted(compose(x_wb, ([s, 0, 0], [1, 0, 0, 0])), dz=BEAM_GRIP)[0], here)
    x_tb = hand.fetch(beam["name"], grip, 0.038, 0.012, 2.0)
    target = compose(goal_wb, inverse(x_tb))
    dx, dy, dz = insertion["direction_w"]
    back = insertion["distance"]
    start = shifted(target, -dx * back, -dy * back, -dz * back)
    hand.over(start)
    hand.go(start, 0.1)
    # A little further than home: the spring presses it in.
    hand.go(shifted(target, 0.002 * dx, 0.002 * dy, 0.002 * dz), 0.03)
    hand.wait(0.3)
    hand.leave(0.046)


def fasten(hand, goal, connection, peg):
    size = goal["dimensions"]
    x_wp = look()[peg]
    grip = hand_down(shifted(x_wp, dz=PEG_GRIP)[0], nearest_turn(yaw_of(x_wp), math.pi / 2))
    x_tp = hand.fetch(peg, grip, 0.053, 0.039, 0.26)
    female = connection["female"]
    beam = next(it for it in goal["beams"] if female in [joint["name"] for joint in it["joints"]])
    p_b = next(joint["p_b"] for joint in beam["joints"] if joint["name"] == female)
    hole = compose(look()[beam["name"]], (p_b, [1, 0, 0, 0]))[0]
    mouth = hole[2] + size["female_height"] / 2
    seated = compose(([hole[0], hole[1], mouth], hand_yaw(hand, x_tp)), inverse(x_tp))
    start = shifted(seated, dz=size["peg_stem_length"] + 0.006)
    hand.over(start)
    hand.go(start, 0.1)
    hand.go(shifted(seated, dz=-0.015), 0.03)
    hand.wait(0.5)
    hand.leave(0.053)
    return abs(look()[peg][0][2] - mouth) < 0.0005


def hand_yaw(hand, x_tp):
    """The orientation of an upright peg in the hand as it is turned now."""
    yaw = yaw_of(compose(hand.at, x_tp))
    return [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]


def main():
    tell({"hello": {"protocol": 1, "name": "example", "version": "1.0"}})
    goal = json.loads(sys.stdin.buffer.readline())["goal"]
    if goal["track"] != "state":
        sys.exit("this agent believes what it reads: run it on the track `state`")
    hand = Hand(goal)
    pegs = iter(it["name"] for it in goal["pegs"])
    standing = {it["name"] for it in goal["beams"] if it["clamped"]}
    pinned = set()
    for insertion in goal["insertions"]:
        action = {"action": "insert", "beam": insertion["beam"]}
        report("action_begun", **action)
        insert(hand, goal, insertion)
        report("action_ended", **action)
        standing.add(insertion["beam"])
        for connection in goal["connections"]:
            name = connection["name"]
            beams = {connection[side].rsplit("j", 1)[0] for side in ("female", "male")}
            if name not in pinned and beams <= standing:
                peg = next(pegs)
                action = {"action": "fasten", "connection": name, "peg": peg}
                report("action_begun", **action)
                if fasten(hand, goal, connection, peg):
                    report("action_ended", **action)
                else:
                    report("fault", fault="hole_not_found", peg=peg, connection=name)
                pinned.add(name)
    ask({"done": {}})


main()

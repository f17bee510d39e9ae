"""What the agents of the tests share: the hello, and a command that keeps the arm where it is."""
import json
import sys


def tell(message):
    print(json.dumps(message), flush=True)


def hear():
    line = sys.stdin.buffer.readline()
    return json.loads(line) if line else None


def hello(name):
    tell({"hello": {"protocol": 1, "name": name, "version": "1.0"}})
    return hear()["goal"]


def stay(goal, periods, width=0.04, force=10.0):
    return {"arm": {"joint_positions": goal["arm"]["home"]}, "gripper": {"width": width, "force": force}, "repeat": periods}

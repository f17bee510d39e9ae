"""An agent that behaves badly in the way that the goal's name or its own variable asks for."""
import os
import signal
import subprocess
import sys
import time

from common import hear, hello, stay, tell

WAY = os.environ["BAD_WAY"]


def main():
    if WAY == "silent":
        time.sleep(1000)
    if WAY == "dies at once":
        sys.exit(3)
    if WAY == "odd name":
        tell({"hello": {"protocol": 1, "name": "<b>\n", "version": "1.0"}})
    if WAY == "other protocol":
        tell({"hello": {"protocol": 7, "name": "bad", "version": "1.0"}})
    goal = hello("bad")
    # "by goal": every goal of the easy class meets another one.
    way = {"easy-1": "hangs", "easy-2": "floods", "easy-3": "crashes"}[goal["name"]] if WAY == "by goal" else WAY
    tell({"step": {"commands": [stay(goal, 50)]}})
    hear()
    if way == "hangs":
        time.sleep(1000)
    elif way == "crashes":
        raise RuntimeError("it was all too much")
    elif way == "is killed":
        os.kill(os.getpid(), signal.SIGSEGV)
    elif way == "leaves":
        sys.exit(0)
    elif way == "nan":
        tell({"step": {"commands": [dict(stay(goal, 1), arm={"joint_torques": [float("nan")] * 7})]}})
    elif way == "too strong":
        tell({"step": {"commands": [stay(goal, 1, force=1e12)]}})
    elif way == "too long":
        tell({"step": {"commands": [stay(goal, 10**18), stay(goal, 10**19 // 2)]}})
    elif way == "crooked":
        pose = {"position": [0.4, 0.0, 0.3], "quat_wxyz": [1.0, 1.0, 0.0, 0.0]}
        tell({"step": {"commands": [dict(stay(goal, 1), arm={"pose": pose})]}})
    elif way == "misspelt":
        tell({"step": {"comands": []}})
    elif way == "no json":
        print("Hello, robot!", flush=True)
    elif way == "deep":
        print("[" * 200_000, flush=True)
    elif way == "floods":
        while True:
            sys.stdout.write('{"observe": {}}\n' * 1000)
    elif way == "asks for ever":
        while True:
            tell({"observe": {}})
            if hear() is None:
                return
    elif way == "endless line":
        while True:
            sys.stdout.write("x" * 65536)
    elif way == "chatters":
        while True:
            sys.stderr.write("and then, and then, " * 1000)
    elif way in ("leaves children", "kills its parent"):
        for _ in range(3):
            quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL}
            subprocess.Popen(["sleep", os.environ["BAD_SLEEP"]], start_new_session=True, **quiet)
        if way == "kills its parent":
            os.kill(os.getppid(), signal.SIGKILL)
        tell({"done": {}})
    hear()


main()

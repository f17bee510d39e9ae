"""The planner Fast Downward as a planner of the baseline.

    pip install -r examples/planners/requirements.txt
    ramp run easy-1 --planner examples/planners/with_fast_downward.py

Fast Downward (GPL-3.0) comes with the package up-fast-downward. It reads PDDL with conditional effects and
derived predicates. Its search here is lazy and greedy, with the heuristic of FF and its preferred operators.
"""

import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile

SEARCH = "lazy_greedy([ff()], preferred=[ff()])"


def fast_downward():
    """The program's file in its package."""
    package = importlib.util.find_spec("up_fast_downward")
    if package is None or package.origin is None:
        sys.exit("Fast Downward is not installed: pip install up-fast-downward")
    return pathlib.Path(package.origin).parent / "downward" / "fast-downward.py"


def main():
    """Reads a problem, and writes a plan."""
    problem = json.loads(sys.stdin.readline())
    print(json.dumps({"pddl": {}}), flush=True)
    pddl = json.loads(sys.stdin.readline())["pddl"]
    with tempfile.TemporaryDirectory() as folder:
        for name in ("domain", "problem"):
            pathlib.Path(folder, name).write_text(pddl[name], encoding="utf-8")
        command = [sys.executable, fast_downward(), "--plan-file", "plan", "domain", "problem", "--search", SEARCH]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        plan = pathlib.Path(folder, "plan")
        if not plan.exists():
            sys.exit(done.stderr.strip() or f"no plan for {problem['goal']['name']}")
        steps = plan.read_text(encoding="utf-8").splitlines()
    # The last line is a comment with the cost.
    print("\n".join(step for step in steps if step.startswith("(")))


if __name__ == "__main__":
    main()

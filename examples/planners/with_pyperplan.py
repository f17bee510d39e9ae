"""The planner pyperplan as a planner of the baseline.

    pip install -r examples/planners/requirements.txt
    ramp run easy-1 --planner examples/planners/with_pyperplan.py

pyperplan (GPL-3.0) reads STRIPS. Its search here is greedy best-first with the heuristic of FF.
"""

import json
import logging
import pathlib
import sys
import tempfile

from pyperplan.planner import HEURISTICS, SEARCHES, search_plan


def main():
    """Reads a problem, and writes a plan."""
    problem = json.loads(sys.stdin.readline())
    print(json.dumps({"pddl": {}}), flush=True)
    pddl = json.loads(sys.stdin.readline())["pddl"]
    logging.disable(logging.CRITICAL)
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder, name) for name in ("domain.pddl", "problem.pddl")]
        for file, text in zip(files, (pddl["strips_domain"], pddl["strips_problem"]), strict=True):
            file.write_text(text, encoding="utf-8")
        steps = search_plan(*map(str, files), SEARCHES["gbf"], HEURISTICS["hff"])
    if steps is None:
        sys.exit(f"no plan for {problem['goal']['name']}")
    for step in steps:
        print(step.name)


if __name__ == "__main__":
    main()

"""A task planner in plain Python: greedy best-first search on the problem in STRIPS.

    ramp run easy-1 --planner examples/planners/greedy.py

It needs no package. It reads the problem as one line of JSON, asks for the problem in PDDL, and writes its
plan, one action a line (docs/src/tutorials/your-planner.md). The search is guided by the additive heuristic:
the sum, over the goals, of the number of actions that each needs if nothing is ever undone.
"""

import heapq
import json
import re
import sys


def parse(text):
    """The nested lists of a text in PDDL."""
    stack = [[]]
    for word in re.findall(r"[()]|[^\s()]+", re.sub(r";[^\n]*", "", text)):
        if word == "(":
            stack.append([])
        elif word == ")":
            stack[-2].append(stack.pop())
        else:
            stack[-1].append(word)
    return stack[0][0]


def literals(formula):
    """The atoms of a conjunction: those that are true, and those under `not`."""
    parts = formula[1:] if formula[:1] == ["and"] else [formula]
    plain = frozenset(part[0] for part in parts if part and part[0] != "not")
    return plain, frozenset(part[1][0] for part in parts if part and part[0] == "not")


def read(domain, problem):
    """Actions as (name, needs, adds, deletes), the state at the start, and the goals."""
    actions = []
    for part in parse(domain)[1:]:
        if part[0] == ":action":
            fields = dict(zip(part[2::2], part[3::2], strict=True))
            needs, _ = literals(fields.get(":precondition", ["and"]))
            actions.append((part[1], needs, *literals(fields[":effect"])))
    sections = {part[0]: part[1:] for part in parse(problem)[1:]}
    return actions, frozenset(atom[0] for atom in sections[":init"]), literals(sections[":goal"][0])[0]


class Heuristic:
    """The additive heuristic of a state."""

    def __init__(self, actions, goals):
        self.actions, self.goals = actions, goals
        self.users = {}
        for index, (_, needs, _, _) in enumerate(actions):
            for atom in needs:
                self.users.setdefault(atom, []).append(index)

    def __call__(self, state):
        """The estimate; infinite where a goal cannot be reached."""
        cost = dict.fromkeys(state, 0)
        missing = [len(needs) for _, needs, _, _ in self.actions]
        spent = [1] * len(self.actions)
        queue = [(0, atom) for atom in sorted(state)]
        for _, needs, adds, _ in self.actions:
            if not needs:
                self.reach(adds, 1, cost, queue)
        closed = set()
        while queue:
            at, atom = heapq.heappop(queue)
            if atom in closed:
                continue
            closed.add(atom)
            for index in self.users.get(atom, ()):
                missing[index] -= 1
                spent[index] += at
                if missing[index] == 0:
                    self.reach(self.actions[index][2], spent[index], cost, queue)
        return sum(cost.get(goal, float("inf")) for goal in self.goals)

    @staticmethod
    def reach(adds, price, cost, queue):
        """Lowers the costs of what an action adds."""
        for atom in adds:
            if price < cost.get(atom, float("inf")):
                cost[atom] = price
                heapq.heappush(queue, (price, atom))


def saturate(state, free):
    """The state after all actions that delete nothing, which can only help, and their names."""
    names, grown = [], True
    while grown:
        grown = False
        for name, needs, adds, _ in free:
            if needs <= state and not adds <= state:
                state, grown = state | adds, True
                names.append(name)
    return state, names


def search(actions, begin, goals):
    """Names of the actions that lead to the goals; None if there are none."""
    heuristic = Heuristic(actions, goals)
    free = [action for action in actions if not action[3]]
    others = [action for action in actions if action[3]]
    begin, names = saturate(begin, free)
    queue, came, count = [(heuristic(begin), 0, begin)], {begin: (None, names)}, 0
    while queue:
        _, _, state = heapq.heappop(queue)
        if goals <= state:
            steps = []
            while state is not None:
                state, names = came[state]
                steps = names + steps
            return steps
        for name, needs, adds, deletes in others:
            if needs <= state:
                after, names = saturate((state - deletes) | adds, free)
                if after not in came:
                    came[after] = (state, [name, *names])
                    count += 1
                    estimate = heuristic(after)
                    if estimate < float("inf"):
                        heapq.heappush(queue, (estimate, count, after))
    return None


def main():
    """Reads a problem, and writes a plan."""
    problem = json.loads(sys.stdin.readline())
    print(json.dumps({"pddl": {}}), flush=True)
    pddl = json.loads(sys.stdin.readline())["pddl"]
    steps = search(*read(pddl["strips_domain"], pddl["strips_problem"]))
    if steps is None:
        sys.exit(f"no plan for {problem['goal']['name']}")
    for step in steps:
        print(f"({step})")


if __name__ == "__main__":
    main()

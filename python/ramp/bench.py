"""Episodes: one, or many."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import hashlib
import inspect
import os
import pathlib
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from ramp import ray as cluster
from ramp._core import MAX_SEED, InputError, benchmark, integer, run_episode
from ramp.agent import Agent, Skill
from ramp.finder import Finder, finder_name
from ramp.finder import asker as find_asker
from ramp.goal import Goal, as_goal, goals
from ramp.plan import Plan
from ramp.planner import Planner, asker, planner_name
from ramp.result import Result

GoalLike = str | os.PathLike[str] | Goal
Progress = Callable[[float, int, int], None]

# Names of the benchmark's own agents.
RESERVED = ("baseline", "blind-tape")

MAX_JOBS = 1024
"""Largest number of episodes at a time."""


def run(
    goal: GoalLike,
    *,
    agent: Agent | None = None,
    skills: Sequence[Skill] = (),
    plan: Plan | str | os.PathLike[str] | None = None,
    planner: Planner | None = None,
    finder: Finder | None = None,
    domain: str | os.PathLike[str] | None = None,
    arm: str = "panda",
    world: str | os.PathLike[str] = "real",
    start: str | os.PathLike[str] = "moved",
    track: str = "tags",
    seed: int = 1,
    task: str = "build",
    state: str | os.PathLike[str] | None = None,
    parameters: str | os.PathLike[str] | None = None,
    fault: str | None = None,
    record: str | os.PathLike[str] | None = None,
    output: str | os.PathLike[str] | None = None,
    repeat: int = 1,
    progress: Progress | None = None,
) -> Result:
    """Runs an episode: an agent builds a goal in the twin, and the referee counts the pegs.

    With another task the agent takes the frame apart, and the referee counts the parts that are back.

    Args:
        goal: A goal of the benchmark, a goal file, or a goal.
        agent: Who works; the baseline without one.
        skills: Skills that take the place of the baseline's.
        plan: A plan that the baseline carries out, in place of its own: a plan, a file with one, or a folder
            with a file for each goal.
        planner: Makes the plans of the baseline, at the start and whenever it plans again. It gets a
            :class:`ramp.Problem`, and returns a plan, or the text of one as ``ramp plan --from`` reads it.
        finder: Finds the parts in the images of the baseline, on a track that gives images. It gets a
            :class:`ramp.Sight`, and gives a :class:`ramp.Found` for each part that it finds.
        domain: A file of rules for the baseline's planner, in place of the one of its kind.
        arm: ``panda``, or ``fr3`` for a Franka Research 3.
        world: What the physics are drawn from: ``ideal``, ``real``, ``hard``, or a world file.
        start: Where the parts lie: ``moved``, ``sheet``, ``scattered``, ``jumbled``, or a start file.
        track: What the agent may see: ``state``, ``noisy``, ``tags``, ``colour`` or ``depth``.
        seed: All randomness of the episode flows from it.
        task: ``build``, or ``take-apart``: the built frame is taken apart, and each part put back.
        state: A file with the state in which the frame begins, as ``ramp run --state``. The agent is not
            told.
        parameters: A file of numbers of the baseline's skills, as ``ramp run --parameters``.
        fault: What goes wrong on purpose, as ``ramp run --fault``.
        record: File for the log of everything (``.mcap``).
        output: File for the result (``.json``). If it already has a result of this episode, with the same
            arm, world, start, track, seed, task, state, agent and version of the program, that result is
            returned and nothing is run.
        repeat: Which of several runs in a row this is.
        progress: Called now and then with robot time (s), pegs or parts that count, and all of them.

    Ctrl-C ends it with :class:`KeyboardInterrupt`. The lock of Python is not held while the robot works.

    Raises:
        ramp.InputError: Something that was given is wrong.
        ramp.PlanningError: The plan that was given is not possible.

    """
    whole = as_goal(goal)
    _check_parts(agent, bool(skills), plan is not None, planner is not None, finder is not None)
    own = None if agent is None else (agent, _agent_name(agent.name), _name(agent.version), whole)
    parts = [(skill.serves, _skill_name(skill), skill) for skill in skills]
    text = plan.to_json() if isinstance(plan, Plan) else None
    rules = None if domain is None else os.fspath(domain)
    asked = None if planner is None else (asker(planner, whole, rules), planner_name(planner))
    files = None if plan is None or isinstance(plan, Plan) else os.fspath(plan)
    return Result.from_json(
        run_episode(
            benchmark(),
            whole.source,
            arm=arm,
            track=track,
            world=os.fspath(world),
            start=os.fspath(start),
            seed=seed,
            task=task,
            state=None if state is None else os.fspath(state),
            agent=own,
            skills=parts,
            plan=text,
            plans=files,
            planner=asked,
            finder=None if finder is None else (find_asker(finder, whole), finder_name(finder)),
            domain=rules,
            parameters=None if parameters is None else os.fspath(parameters),
            fault=fault,
            record=None if record is None else os.fspath(record),
            output=None if output is None else os.fspath(output),
            repeat=repeat,
            progress=progress,
        )
    )


def _check_parts(agent: Agent | None, skills: bool, plan: bool, planner: bool, finder: bool) -> None:
    """Checks that what replaces parts of the baseline goes together."""
    if agent is not None and (skills or plan):
        raise InputError("an agent of one's own has its own skills and its own plan")
    if planner and (agent is not None or plan):
        raise InputError("a planner of one's own makes the plans of the baseline, and no other plan is carried out")
    if agent is not None and finder:
        raise InputError("a finder of one's own finds the parts for the baseline, and an agent has its own")


def _agent_name(name: str) -> str:
    if name.split("+")[0] in RESERVED:
        raise InputError(f"`{name}` is a name of the benchmark's own agents: give the agent another one")
    return _name(name)


def _skill_name(skill: Skill) -> str:
    """The skill's name, with the start of the hash of its source where Python has it."""
    name = _name(skill.name)
    try:
        source = inspect.getsource(type(skill))
    except (OSError, TypeError):
        return name
    return f"{name}.{hashlib.sha256(source.encode()).hexdigest()[:8]}"


def _name(name: str) -> str:
    fine = all(it.isascii() and (it.isalnum() or it in "._+-") for it in name)
    if not (fine and name and name[0].isalnum() and len(name) <= 64):
        raise InputError(f"`{name}` is no name: letters, digits and . _ + - are expected, a letter or digit first")
    return name


@dataclasses.dataclass(frozen=True)
class Results(Sequence[Result]):
    """Results of many episodes."""

    results: tuple[Result, ...]

    def __getitem__(self, index: Any) -> Any:
        return self.results[index]

    def __len__(self) -> int:
        return len(self.results)

    def __iter__(self) -> Iterator[Result]:
        return iter(self.results)

    def rows(self) -> list[dict[str, Any]]:
        """A row for each episode."""
        return [result.row() for result in self.results]

    def data_frame(self) -> Any:
        """A data frame of pandas (the extra ``frame``) with a row for each episode."""
        import pandas

        return pandas.DataFrame(self.rows())

    @property
    def completion(self) -> float:
        """Mean completion."""
        return sum(it.completion for it in self.results) / max(len(self.results), 1)

    def __str__(self) -> str:
        lines = []
        for goal in dict.fromkeys(it.goal for it in self.results):
            of = [it for it in self.results if it.goal == goal]
            share = sum(it.completion for it in of) / len(of)
            robot = sum(it.time.robot for it in of) / len(of)
            lines.append(f"{goal}: {100 * share:.0f} % of {len(of)} episodes, robot time {robot:.1f} s")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        names = list(self.results[0].row()) if self.results else []
        head = "".join(f"<th>{name}</th>" for name in names)
        body = "".join(
            "<tr>" + "".join(f"<td>{_cell(value)}</td>" for value in row.values()) + "</tr>" for row in self.rows()
        )
        return f"<table><tr>{head}</tr>{body}</table>"


def _cell(value: object) -> str:
    text = f"{value:.2f}" if isinstance(value, float) else str(value)
    return text.replace("&", "&amp;").replace("<", "&lt;")


def bench(
    what: str | Iterable[GoalLike] = "easy",
    *,
    agent: Callable[[], Agent] | None = None,
    skills: Callable[[], Sequence[Skill]] | None = None,
    repeats: int = 5,
    first_seed: int = 1,
    jobs: int = 1,
    backend: str | None = None,
    output: str | os.PathLike[str] | None = None,
    show: bool = True,
    **options: Any,
) -> Results:
    """Runs goals several times, with seeds in a row, and shows how far it is.

    Args:
        what: A class (``easy``, ``medium``, ``hard``, ``open-2026``), a goal, or several.
        agent: Makes an agent for an episode; the baseline without it.
        skills: Makes the skills for an episode.
        repeats: Episodes of each goal.
        first_seed: Seed of the first episode of each goal.
        jobs: Episodes at a time. An agent in Python holds Python's lock while it thinks.
        backend: ``ray`` or ``ray:ADDRESS``: run the episodes on a cluster of Ray, one on each processor.
            Files that options name travel; a lost worker's episode runs again. ``jobs`` has no effect then.
        output: Folder for the result files, for ``ramp report``. Results of these episodes that it already
            has are not run again, by the same rule as ``ramp bench``. A folder is of one arm, world, start,
            agent and version. The log of each episode goes beside its result.
        show: Whether to show progress on standard error.
        options: Passed to :func:`run`: arm, world, start, track, domain and so on.

    """
    integer("repeats", repeats, 1, 2**32 - 1)
    integer("first_seed", first_seed, 0, MAX_SEED - repeats + 1)
    integer("jobs", jobs, 1, MAX_JOBS)
    classes = {"easy", "medium", "hard"}
    names: list[GoalLike]
    if isinstance(what, str):
        is_class = what in classes or re.fullmatch(r"open-(\d+|held-[0-9a-f]{8})", what) is not None
        names = list(goals.of_class(what)) if is_class else [what]
    else:
        names = list(what)
    wanted = [(as_goal(goal), first_seed + it, it + 1) for goal in names for it in range(repeats)]
    folder = None if output is None else pathlib.Path(output)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)

    def place(goal: Goal, seed: int) -> pathlib.Path | None:
        return None if folder is None else folder / f"{goal.name}-{options.get('track', 'tags')}-{seed}.json"

    bar = _Bar(len(wanted)) if show else None
    if backend is not None:
        address = cluster.parse(backend)
        calls = [
            cluster.Call({**options, "goal": goal, "seed": seed, "repeat": repeat}, agent, skills, place(goal, seed))
            for goal, seed, repeat in wanted
        ]
        finished: dict[int, Result] = {}
        for index, text in cluster.episodes(calls, address):
            finished[index] = Result.from_json(text)
            if bar is not None:
                bar.show(list(finished.values()))
        if bar is not None:
            bar.end()
        return Results(tuple(finished[index] for index in range(len(calls))))

    def one(goal: Goal, seed: int, repeat: int) -> Result:
        file = place(goal, seed)
        log = None if file is None else file.with_suffix(".mcap")
        return run(
            goal,
            agent=None if agent is None else agent(),
            skills=() if skills is None else skills(),
            seed=seed,
            repeat=repeat,
            output=file,
            **({"record": log} | options),
        )

    done: list[Result] = []
    with concurrent.futures.ThreadPoolExecutor(max_workers=jobs) as pool:
        if jobs == 1:
            # On this thread, so that Ctrl-C reaches the episode.
            for it in wanted:
                done.append(one(*it))
                if bar is not None:
                    bar.show(done)
        else:
            for result in pool.map(lambda it: one(*it), wanted):
                done.append(result)
                if bar is not None:
                    bar.show(done)
    if bar is not None:
        bar.end()
    return Results(tuple(done))


class _Bar:
    """A line on standard error: one that moves on a terminal, one for each episode elsewhere."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.moves = sys.stderr.isatty()

    def show(self, done: list[Result]) -> None:
        last = done[-1]
        share = 100 * sum(it.completion for it in done) / len(done)
        text = f"{len(done)}/{self.count} episodes  {share:.0f} %  {last.goal} seed {last.seed}"
        if self.moves:
            full = 24 * len(done) // max(self.count, 1)
            print(f"\r{'█' * full}{'░' * (24 - full)} {text}\x1b[K", end="", file=sys.stderr, flush=True)
        else:
            print(text, file=sys.stderr)

    def end(self) -> None:
        if self.moves:
            print(file=sys.stderr)

"""Results of episodes."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
from typing import Any

from ramp._core import current_result, curve_svg, describe_event


def describe(event: dict[str, Any]) -> str:
    """The text of an event for a person, as the command line and reports show it.

    >>> ramp.describe({"t": 1.5, "kind": "fault", "fault": "not_held", "part": "b4"})
    'b4 is not in the hand'
    """
    return describe_event(json.dumps(event))


@dataclasses.dataclass(frozen=True)
class Peg:
    """A peg that counts."""

    connection: str
    """What it pins."""
    joints: tuple[str, str]
    """The female and the male joint."""
    peg: str
    """Its name."""
    t_robot: float
    """Robot time since which it is seated, s."""
    t_total: float
    """The same with planning and computing, s."""

    def __str__(self) -> str:
        female, male = self.joints
        return f"{self.connection}  {male} in {female}  {self.peg}  seated at {self.t_total:.1f} s"


@dataclasses.dataclass(frozen=True)
class Time:
    """Where the time went, s."""

    planning: float
    compute: float
    robot: float
    total: float
    agent_cpu: float | None = None
    """Processor time of an agent that is a program of its own."""
    waiting: float | None = None
    """Share of its time for which the program waited for a processor, 0 to 1."""


@dataclasses.dataclass(frozen=True)
class Result:
    """The result of one episode."""

    goal: str
    track: str
    arm: str
    world: str
    start: str
    seed: int
    repeat: int
    agent: str
    """Name and version of the agent."""
    completion: float
    """Pegs that count, as a share of the goal's."""
    pegs: tuple[Peg | None, ...]
    """For each connection of the goal the peg that counts, or none; empty where the frame was to be taken apart."""
    task: str
    """``build`` or ``take-apart``."""
    back: dict[str, float | None] = dataclasses.field(repr=False)
    """Where the frame was to be taken apart: for each part the robot time since which it is back, s, or none."""
    rejected: tuple[dict[str, Any], ...] = dataclasses.field(repr=False)
    """Pegs that were in their place at the end and do not count: ``connection``, ``peg`` and ``reason``."""
    time: Time
    bound: float | None
    """What no robot with these limits can beat with the baseline's plan, s; none where the result does not
    tell it."""
    reference: float | None
    """The robot time of that plan without looks, searches and tries, s; none where the result does not tell
    it."""
    ended: str
    """``done``, or why the episode ended early."""
    largest_force: float
    """N."""
    deepest_penetration: float
    """m."""
    stops: int
    """How often the arm stopped by a reflex or for its speed and was ready again."""
    state: str
    """Hash of the physics at the end: the same in two runs only if every bit is."""
    events: tuple[dict[str, Any], ...] = dataclasses.field(repr=False)
    """What happened: ``t`` in s, ``kind``, and the fields of that kind. :func:`ramp.describe` gives the text
    of one."""
    json: str = dataclasses.field(repr=False)
    """The result file, of the schema ``data/schema/episode.schema.json``."""

    @staticmethod
    def from_json(text: str) -> Result:
        """From a result file. One of the two schemas before is converted."""
        text = text.removeprefix("\ufeff")
        value = json.loads(text)
        if value.get("schema") in ("ramp-episode-3", "ramp-episode-4"):
            value = json.loads(current_result(text))
        physics = value.get("physics") or {}
        compared = value.get("robot_time") or {}
        pegs = [None if it is None else Peg(**{**it, "joints": tuple(it["joints"])}) for it in value["pegs"]]
        return Result(
            goal=value["goal"],
            track=value["track"],
            arm=value.get("arm", ""),
            world=(value.get("world") or {}).get("name", ""),
            start=(value.get("start") or {}).get("name", ""),
            seed=value["seed"],
            repeat=value["repeat"],
            agent=f"{value['agent']['name']} {value['agent']['version']}",
            completion=value["completion"],
            pegs=tuple(pegs),
            task=value.get("task", "build"),
            back={part["part"]: part["t_robot"] for part in value.get("parts", ())},
            rejected=tuple(value.get("rejected", ())),
            time=Time(**value["time"]),
            bound=compared.get("bound"),
            reference=compared.get("reference"),
            ended=value["ended"]["reason"],
            largest_force=physics.get("largest_force", float("nan")),
            deepest_penetration=physics.get("deepest_penetration", float("nan")),
            stops=physics.get("stops", 0),
            state=physics.get("state", ""),
            events=tuple(value["events"]),
            json=text,
        )

    @property
    def counted(self) -> int:
        """How many pegs count, or how many parts are back."""
        back = sum(time is not None for time in self.back.values())
        return sum(peg is not None for peg in self.pegs) + back

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the result file."""
        pathlib.Path(file).write_text(self.json, encoding="utf-8")

    def row(self) -> dict[str, Any]:
        """The result as a row of a table."""
        return {
            "goal": self.goal,
            "arm": self.arm,
            "world": self.world,
            "start": self.start,
            "track": self.track,
            "agent": self.agent,
            "seed": self.seed,
            "completion": self.completion,
            "pegs": len(self.pegs),
            "counted": self.counted,
            "planning": self.time.planning,
            "compute": self.time.compute,
            "robot": self.time.robot,
            "bound": self.bound,
            "reference": self.reference,
            "total": self.time.total,
            "largest_force": self.largest_force,
            "stops": self.stops,
            "ended": self.ended,
        }

    def curve(self) -> str:
        """Completion over time, as SVG."""
        return curve_svg(self.json)

    def _repr_svg_(self) -> str:
        return self.curve()

    def __str__(self) -> str:
        setting = f"arm {self.arm}, world {self.world}, start {self.start}, track {self.track}"
        head = f"{self.goal}, {setting}, seed {self.seed}"
        what = f"{len(self.back)} parts back" if self.back else f"{len(self.pegs)} pegs"
        lines = [f"{head}: {self.counted} of {what}"]
        lines += [f"  {peg}" for peg in self.pegs if peg is not None]
        if self.ended != "done":
            lines.append(f"ended early: {self.ended}")
        return "\n".join(lines)

"""Goals: what is to be built."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
from collections.abc import Iterator, Sequence
from typing import overload

from ramp._core import benchmark


@dataclasses.dataclass(frozen=True)
class Connection:
    """Two joints that a peg is to pin."""

    name: str
    """Name in the goal, such as ``C1``."""
    female: str
    """The joint with the plate that the peg's head rests on, such as ``b7j1``."""
    male: str
    """The joint that is inside it."""


@dataclasses.dataclass(frozen=True)
class Goal:
    """A goal."""

    name: str
    """Such as ``easy-1``, or the name in its file."""
    class_name: str | None
    """``easy``, ``medium``, ``hard``, a set of the open class such as ``open-2026``, or none."""
    beams: tuple[str, ...]
    """Its beams."""
    base: str
    """The beam that is clamped to the table."""
    connections: tuple[Connection, ...]
    """What pegs are to pin, in the order of results."""
    source: str
    """What it is read from: a name of the benchmark, or a file."""

    @staticmethod
    def load(name_or_file: str | os.PathLike[str]) -> Goal:
        """Reads a goal of the benchmark, or a goal file (``.xml``).

        Raises :class:`ramp.InputError` with file, line and column if something is wrong in it.
        """
        source = os.fspath(name_or_file)
        if source.endswith(".xml"):
            source = str(pathlib.Path(source).resolve())
        known = json.loads(benchmark().goal(source))
        return Goal(
            name=known["name"],
            class_name=known["class"],
            beams=tuple(known["beams"]),
            base=known["base"],
            connections=tuple(Connection(**it) for it in known["connections"]),
            source=source,
        )

    @property
    def text(self) -> str:
        """The goal file."""
        return pathlib.Path(json.loads(benchmark().goal(self.source))["file"]).read_text(encoding="utf-8")

    def svg(self) -> str:
        """The goal from above, as SVG."""
        return benchmark().goal_svg(self.source)

    def _repr_svg_(self) -> str:
        return self.svg()


def as_goal(goal: str | os.PathLike[str] | Goal) -> Goal:
    """A goal, from whatever names it."""
    return goal if isinstance(goal, Goal) else Goal.load(goal)


class Goals(Sequence[str]):
    """The names of the goals, easy ones first; each name leads to its :class:`Goal`."""

    def _names(self) -> list[str]:
        return benchmark().goal_names()

    @overload
    def __getitem__(self, index: int) -> str: ...

    @overload
    def __getitem__(self, index: slice) -> list[str]: ...

    def __getitem__(self, index: int | slice) -> str | list[str]:
        return self._names()[index]

    def __len__(self) -> int:
        return len(self._names())

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def load(self, name: str) -> Goal:
        """The goal of that name."""
        return Goal.load(name)

    def of_class(self, name: str) -> list[str]:
        """The names of the goals of a class: ``easy``, ``medium``, ``hard``, or a set of the open class.

        The set ``open-2026`` is part of the benchmark; it is not among the nine goals of the sequence itself.
        """
        if name.startswith("open-"):
            return benchmark().open_goal_names(name)
        return [goal for goal in self if Goal.load(goal).class_name == name]

    def __repr__(self) -> str:
        return f"goals({', '.join(self)})"


goals = Goals()
"""The goals of the benchmark."""

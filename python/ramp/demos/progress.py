"""How far it is: a line on standard error that moves on a terminal, or one for each episode elsewhere."""

from __future__ import annotations

import sys
from typing import Any

WIDTH = 24
"""Of the bar, characters."""


class Bar:
    """The progress of some episodes."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.moves = sys.stderr.isatty()

    def show(self, facts: list[dict[str, Any]]) -> None:
        """Shows the episodes that are there."""
        done, good = len(facts), sum(bool(it["success"]) for it in facts)
        text = f"{done}/{self.count} episodes, {good} successful: {facts[-1]['task']}, seed {facts[-1]['seed']}"
        if self.moves:
            full = WIDTH * done // max(self.count, 1)
            print(f"\r{'█' * full}{'░' * (WIDTH - full)} {text}\x1b[K", end="", file=sys.stderr, flush=True)
        else:
            print(text, file=sys.stderr, flush=True)

    def end(self) -> None:
        """Ends the line."""
        if self.moves:
            print(file=sys.stderr)

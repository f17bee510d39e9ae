"""What `ramp teleop` starts: `python -m ramp.teleop JSON`.

The arguments come as one object of JSON, which the `ramp` command has checked. Exit status: 0 all pegs count;
1 a peg does not; 2 bad input; 3 the machine failed, such as a full disk.
"""

from __future__ import annotations

import json
import sys

from ramp._core import InputError
from ramp.teleop.session import hold
from ramp.teleop.settings import Settings

DONE, INCOMPLETE, BAD_INPUT, MACHINE, INTERRUPTED = 0, 1, 2, 3, 130


def main(arguments: list[str]) -> int:
    """Holds the session that the arguments describe; the exit status."""
    if len(arguments) != 1:
        print("usage: ramp teleop", file=sys.stderr)
        return BAD_INPUT
    try:
        asked = json.loads(arguments[0])
        result = hold(asked, Settings())
    except (InputError, ImportError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return BAD_INPUT
    except OSError as error:
        print(f"Error: {error}", file=sys.stderr)
        return MACHINE
    except KeyboardInterrupt:
        print("stopped: nothing was recorded", file=sys.stderr)
        return INTERRUPTED
    print(result)
    print(f"result, log, input and demonstration: {asked['output']}")
    return DONE if result.completion == 1.0 else INCOMPLETE


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

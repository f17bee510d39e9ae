"""An agent that asks for everything once, and ends as it should."""
import sys

from common import hear, hello, stay, tell

goal = hello("good")
tell({"plan": {"coarse": 2, "fine": 5, "planning": 0.001}})
assert hear() == {"noted": {}}
tell({"event": {"kind": "start", "what": "stay a while"}})
assert hear() == {"noted": {}}
tell({"step": {"commands": [stay(goal, 60), stay(goal, 40, width=0.05)]}})
seen = hear()["observation"]
assert abs(seen["time"] - 0.1) < 1e-9, seen
tell({"observe": {}})
assert hear()["observation"] == seen
tell({"read_parts": {}})
answer = hear()
if goal["track"] == "tags":
    assert "no poses of parts" in answer["refused"]["reason"], answer
else:
    assert {"b4", "b7", "p1"} <= {part["part"] for part in answer["parts"]}
tell({"look": {"camera": "birds-eye"}})
answer = hear()
if goal["track"] == "noisy":
    assert "refused" in answer
else:
    image = answer["image"]
    pixels = sys.stdin.buffer.read(image["bytes"])
    assert len(pixels) == 3 * image["width"] * image["height"] and len(set(pixels)) > 50
assert "seed" not in str(sorted(goal))
tell({"done": {}})
assert "end" in hear()

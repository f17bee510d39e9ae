"""An agent that asks for everything once, and ends as it should."""
import sys

from common import hear, hello, stay, tell

goal = hello("good")
tell({"plan": {"coarse": 2, "fine": 5, "planning": 0.001}})
assert hear() == {"noted": {}}
# The form of version 0.1.0, and every kind of today.
tell({"event": {"kind": "start", "what": "stay a while"}})
assert hear() == {"noted": {}}
for event in [
    {"kind": "action_begun", "action": "pick_up", "item": {"beam": "b4"}, "grasp": {"link": "b4l1"}},
    {"kind": "action_ended", "action": "stay", "seconds": 0.1},
    {"kind": "fault", "fault": "jammed", "part": "b4", "remaining": 0.003, "force": 25},
    {"kind": "fault", "fault": "other", "why": "a bad day"},
    {"kind": "retry", "step": "insert", "part": "b4", "attempt": 2, "off": 0.001, "because": "it jams"},
    {"kind": "search", "method": "spiral", "part": "C1", "duration": 2.5},
    {"kind": "touched", "part": "b4", "surface": "table", "off": [0.0001, -0.0002]},
    {"kind": "seen", "part": "b4", "off": 0.006},
    {"kind": "diagnosis", "cause": "jam", "part": "b4", "evidence": "25 N"},
    {"kind": "replan", "coarse": 12},
    {"kind": "motion", "cannot": {"grasp": {"beam": "b4", "link": "b4l1", "at": "start"}}, "because": "no way"},
    {"kind": "unusual_grasp", "beam": "b4", "s": 0.2, "reverse": False, "because": "no way"},
    {"kind": "not_rehearsed", "skill": "fasten-by-mine"},
    {"kind": "clipped"},
    {"kind": "note", "text": "that is all"},
]:
    tell({"event": event})
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

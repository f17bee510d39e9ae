"""An agent that keeps notes for its next episode in every way that it knows, and reports what it finds."""
import ctypes
import os
import struct
import tempfile

from common import hear, hello, tell

OWN = os.path.abspath(__file__)
FOLDER = os.path.dirname(OWN)
libc = ctypes.CDLL(None, use_errno=True)


def attempt(work):
    try:
        return work()
    except OSError:
        return None


def by_descriptor():
    file = os.open(OWN, os.O_RDONLY)
    try:
        os.setxattr(file, "user.note", b"x")
    finally:
        os.close(file)


def by_path():
    value = ctypes.create_string_buffer(b"x")
    given = ctypes.create_string_buffer(struct.pack("QII", ctypes.addressof(value), 1, 0))
    libc.syscall(463, -100, OWN.encode(), 0, b"user.newer_note", given, 16)


def write(path):
    with open(path, "w") as file:
        file.write("x")


def mode():
    file = os.open(OWN, os.O_RDONLY)
    try:
        os.fchmod(file, 0o640)
    finally:
        os.close(file)


# The mark of a file that no program reads: that it was read.
MARK = os.path.join(FOLDER, "mark")
NOTES = {
    "attribute": (lambda: os.getxattr(OWN, "user.note"), by_descriptor),
    "newer attribute": (lambda: os.getxattr(OWN, "user.newer_note"), by_path),
    "mode": (lambda: os.stat(OWN).st_mode & 0o777 == 0o640, mode),
    "newer mode": (lambda: os.stat(MARK).st_mode & 0o777 == 0o640, lambda: libc.syscall(452, -100, MARK.encode(), 0o640, 0)),
    "file beside it": (lambda: os.stat(os.path.join(FOLDER, "note")), lambda: write(os.path.join(FOLDER, "note"))),
    "file of its own": (lambda: os.stat(os.path.join(tempfile.gettempdir(), "note")), lambda: write(os.path.join(tempfile.gettempdir(), "note"))),
    "time of access": (lambda: os.stat(MARK).st_atime > 1e6, lambda: open(MARK).read()),
}

hello("notes")
for name, (recall, keep) in NOTES.items():
    found = bool(attempt(recall))
    attempt(keep)
    tell({"event": {"kind": "action_ended", "action": "recall", "note": name, "found": "yes" if found else "no"}})
    hear()
tell({"done": {}})

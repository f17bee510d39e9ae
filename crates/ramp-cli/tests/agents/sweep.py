"""An agent that makes system calls: each number twice, in a process of its own with a limit of time.

The arguments of the first try are all 0, those of the second one all -1. A letter tells what became of a try:

a  it returned, with or without an error
p  EPERM
s  ENOSYS
e  the process ended
k  the process was ended by a signal
w  the process still waited at the limit
"""
import ctypes
import errno
import os
import select
import signal

from common import hear, hello, tell

LIMIT = 0.5
NUMBERS = [*range(0, 520), 1000, 0x40000000, 0x40000000 + 59, 0x40000000 + 101]
LETTERS = {errno.EPERM: b"p", errno.ENOSYS: b"s"}
libc = ctypes.CDLL(None, use_errno=True)
libc.syscall.restype = ctypes.c_long


def tried(number, argument):
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        own = os.getpid()
        arguments = [ctypes.c_long(argument)] * 6
        failed = libc.syscall(ctypes.c_long(number), *arguments) == -1
        letter = LETTERS.get(ctypes.get_errno(), b"a") if failed else b"a"
        # A call may have made one process two.
        if os.getpid() == own:
            os.write(theirs, letter)
        os._exit(0)
    os.close(theirs)
    ready, _, _ = select.select([ours], [], [], LIMIT)
    letter = os.read(ours, 1).decode() if ready else "w"
    os.close(ours)
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if letter:
        return letter
    return "k" if os.WIFSIGNALED(status) and os.WTERMSIG(status) != signal.SIGKILL else "e"


hello("sweep")
for begin in range(0, len(NUMBERS), 50):
    some = NUMBERS[begin:begin + 50]
    found = [f"{number}{tried(number, 0)}{tried(number, -1)}" for number in some]
    for half in (found[:25], found[25:]):
        tell({"event": {"kind": "note", "text": " ".join(half)}})
        hear()
tell({"done": {}})

"""An agent that looks for what it must not know, and for ways out. It reports each door that it tried as an
event.

The event is an action with the argument `door`. If the door was open, `found` is what was behind it.
"""
import ctypes
import fcntl
import glob
import mmap
import os
import platform
import re
import socket
import struct
import sys
import tempfile
import time

from common import hear, hello, stay, tell

goal = hello("spy")
parent = os.getppid()
libc = ctypes.CDLL(None, use_errno=True)
SEED = re.compile(rb"seed[^0-9a-z]{1,4}([0-9]{6,})")
TRUTH = re.compile(rb'"child_frame_id"|ramp\.Verdict|\x89MCAP')


def note(door, found):
    """Tells whether a door is open, and what was behind it."""
    event = {"kind": "action_ended", "action": "try", "door": door}
    if found:
        event["found"] = "".join(c if c.isprintable() and c not in "\"\\" else " " for c in str(found))[:120]
    tell({"event": event})
    assert hear() == {"noted": {}}


def attempt(door, work):
    try:
        note(door, work())
    except Exception as error:
        note(door, None)
        print(f"{door}: {error!r}", file=sys.stderr)


def processes():
    return [int(name) for name in os.listdir("/proc") if name.isdigit() and int(name) != os.getpid()]


def secrets(data):
    """A seed, or something that only a log holds."""
    seed = SEED.search(data)
    if seed:
        return f"seed {seed.group(1).decode()}"
    return "a log" if TRUTH.search(data) else None


def first(found):
    """The first of some findings, where reading one may fail."""
    for work in found:
        try:
            result = work()
        except OSError:
            continue
        if result:
            return result
    return None


def read(path, most=1 << 20):
    with open(path, "rb") as file:
        return file.read(most)


# What it does while its log is being written.
tell({"step": {"commands": [stay(goal, 1000)]}})
hear()

attempt("list of processes", lambda: f"{len(processes())} others" if processes() else None)
attempt("command lines", lambda: first(
    [lambda p=p: secrets(read(f"/proc/{p}/cmdline").replace(b"\0", b" ")) for p in processes()]))
attempt("environment of the run", lambda: f"{len(read(f'/proc/{parent}/environ'))} bytes")
attempt("open files of the run", lambda: first(
    [lambda f=f: os.readlink(f) for f in glob.glob(f"/proc/{parent}/fd/*")]))
attempt("log that is being written", lambda: first(
    [lambda f=f: secrets(read(f)) for f in glob.glob(f"/proc/{parent}/fd/*")]))


def memory():
    """Looks through what the run has in its memory."""
    with open(f"/proc/{parent}/maps") as maps, open(f"/proc/{parent}/mem", "rb") as mem:
        for line in maps:
            area, rights = line.split()[:2]
            low, high = (int(it, 16) for it in area.split("-"))
            if "r" in rights and high - low < 1 << 26:
                mem.seek(low)
                try:
                    found = secrets(mem.read(high - low))
                except OSError:
                    continue
                if found:
                    return found
        return "readable"


attempt("memory of the run", memory)


def vm():
    size = 8
    here = ctypes.create_string_buffer(size)
    local = struct.pack("QQ", ctypes.addressof(here), size)
    remote = struct.pack("QQ", 0x400000, size)
    done = libc.process_vm_readv(parent, local, 1, remote, 1, 0)
    # EFAULT: it might, but there is nothing at this place.
    return "readable" if done >= 0 or ctypes.get_errno() == 14 else None


attempt("memory of the run by system call", vm)


def trace():
    if libc.ptrace(16, parent, 0, 0) != 0:
        return None
    os.waitpid(parent, 0x40000000)
    libc.ptrace(17, parent, 0, 0)
    return "attached"


attempt("debugger on the run", trace)
attempt("signals to the run", lambda: os.kill(parent, 0) or "possible")


def files(limit=3.0):
    """Results, logs and goals that others have left on the disk."""
    end = time.monotonic() + limit
    roots = [os.environ.get("SPY_RESULTS"), os.getcwd(), os.path.expanduser("~"), tempfile.gettempdir(), "/tmp", "/root",
             "/home"]
    for root in filter(None, roots):
        for folder, _, names in os.walk(root):
            if time.monotonic() > end:
                return None
            for name in names:
                if name.endswith((".mcap", ".json")):
                    try:
                        found = secrets(read(os.path.join(folder, name)))
                    except OSError:
                        continue
                    if found:
                        return f"{found} in {name}"
    return None


attempt("results of other episodes", files)
attempt("files of the user", lambda: first(
    [lambda p=p: f"{len(os.listdir(p))} in {p}" for p in ["/root", "/home", os.path.expanduser("~user"), "/tmp", "/var"]]))
attempt("passwords of the system", lambda: f"{len(read('/etc/shadow'))} bytes")


def write(folder):
    def work():
        path = os.path.join(folder, f"spy-{os.getpid()}")
        with open(path, "w") as file:
            file.write("x")
        os.remove(path)
        return "possible"
    return work


attempt("writing beside the agent", write(os.path.dirname(os.path.abspath(__file__))))
attempt("writing to /tmp", write("/tmp"))
attempt("writing to /dev/shm", write("/dev/shm"))
attempt("writing to its own folder", write(tempfile.gettempdir()))
attempt("changing modes of files", lambda: os.chmod(os.path.abspath(__file__), 0o644) or "possible")


def connect(family, kind, place):
    def work():
        with socket.socket(family, kind) as it:
            it.settimeout(1)
            try:
                it.connect(place)
            except (ConnectionRefusedError, FileNotFoundError):
                return "reachable"
            return "connected"
    return work


attempt("network, TCP", connect(socket.AF_INET, socket.SOCK_STREAM, ("127.0.0.1", 9)))
attempt("network, UDP", connect(socket.AF_INET, socket.SOCK_DGRAM, ("127.0.0.1", 9)))
attempt("sockets of the system", connect(socket.AF_UNIX, socket.SOCK_STREAM, "/run/spy"))
attempt("pair of sockets to itself", lambda: socket.socketpair() and "possible")
attempt("other name spaces", lambda: "possible" if libc.unshare(0x10000000) == 0 else None)
attempt("shared memory that stays", lambda: "possible" if libc.shmget(0, 4096, 0o1600) >= 0 else None)

# Calls that the C library may lack. Their numbers are the same on all processors, but for `clone`.
CLONE = {"x86_64": 56}.get(platform.machine(), 220)
CLONE3, FCHMODAT2, SETXATTRAT = 435, 452, 463
NEW_USER = 0x10000000
OWN = os.path.abspath(__file__)


def opened(flags, work):
    """What `work` returns for a descriptor of the agent's own file, which is only read."""
    file = os.open(OWN, flags)
    try:
        return work(file)
    finally:
        os.close(file)


def done(result):
    return "possible" if result >= 0 else None


def ended(pid):
    """The end of a child that was started by its system call."""
    if pid == 0:
        os._exit(0)
    if pid < 0:
        return None
    os.waitpid(pid, 0)
    return "possible"


def attribute_by_path():
    value = ctypes.create_string_buffer(b"x")
    given = ctypes.create_string_buffer(struct.pack("QII", ctypes.addressof(value), 1, 0))
    return done(libc.syscall(SETXATTRAT, -100, OWN.encode(), 0, b"user.spy", given, 16))


def flags(file):
    """Sets the flags that a file has."""
    now = struct.unpack("i", fcntl.ioctl(file, 0x80086601, b"\0" * 4))[0]
    fcntl.ioctl(file, 0x40086602, struct.pack("i", now))
    return "possible"


def clone3():
    given = ctypes.create_string_buffer(struct.pack("8Q", NEW_USER, 0, 0, 0, 17, 0, 0, 0))
    return ended(libc.syscall(CLONE3, given, 64))


def watch():
    file = libc.inotify_init1(0)
    return done(file) and done(libc.inotify_add_watch(file, b"/usr", 0x20))


def datagrams():
    socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    return "possible"


attempt("limits of the run", lambda: done(libc.prlimit(parent, 7, None, ctypes.create_string_buffer(16))))
attempt("scheduling of the run", lambda: done(libc.sched_getscheduler(parent)))
attempt("attributes by a descriptor", lambda: opened(os.O_RDONLY, lambda file: os.setxattr(file, "user.spy", b"x") or "possible"))
attempt("attributes by a path", attribute_by_path)
attempt("modes by a descriptor", lambda: opened(os.O_RDONLY, lambda file: os.fchmod(file, 0o644) or "possible"))
attempt("modes by a newer call", lambda: done(libc.syscall(FCHMODAT2, -100, OWN.encode(), 0o644, 0)))
attempt("flags of files", lambda: opened(os.O_RDONLY, flags))
attempt("name space by clone", lambda: ended(libc.syscall(CLONE, NEW_USER | 17, 0, 0, 0, 0)))
attempt("name space by clone3", clone3)
attempt("watching folders", watch)
attempt("network of the system in /proc", lambda: f"{len(read('/proc/self/net/dev'))} bytes")
attempt("pair of sockets that reach others", datagrams)
attempt("shared memory without a file", lambda: mmap.mmap(-1, 4096) and "possible")
attempt("shared memory by a descriptor", lambda: done(libc.memfd_create(b"spy", 0)))
attempt("names of files that it guesses", lambda: os.stat("/etc/shadow") and "possible")

tell({"done": {}})
assert "end" in hear()

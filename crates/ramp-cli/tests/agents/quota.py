"""A program that takes more disk space and memory than it may, in ways that leave no file with a name."""
import ctypes
import errno
import mmap
import os
import tempfile

MIB = 1 << 20


def unlinked():
    """Fills files without a name; the sum that fits, MiB."""
    files, sum_ = [], 0
    try:
        while sum_ < 512:
            files.append(tempfile.TemporaryFile(buffering=0))
            for _ in range(16):
                if files[-1].write(bytes(MIB)) < MIB:
                    return sum_
                sum_ += 1
    except OSError as error:
        assert error.errno == errno.ENOSPC, error
    return sum_


def refused(work):
    try:
        work()
    except OSError as error:
        return errno.errorcode[error.errno]
    return "possible"


def zeros():
    file = os.open("/dev/zero", os.O_RDWR)
    mmap.mmap(file, 4096, mmap.MAP_SHARED)


def descriptor():
    if ctypes.CDLL(None, use_errno=True).memfd_create(b"x", 0) < 0:
        raise OSError(ctypes.get_errno(), "memfd_create")


print("unlinked", unlinked())
print("shared", refused(lambda: mmap.mmap(-1, 4096)))
print("zeros", refused(zeros))
print("descriptor", refused(descriptor))

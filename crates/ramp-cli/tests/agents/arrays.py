"""An agent that computes with numpy, in a thread and in a process of another program."""
import subprocess
import threading

import numpy as np
from common import hello, tell

hello("numbers")
a = np.random.default_rng(1).random((300, 300))
thread = threading.Thread(target=lambda: np.linalg.svd(a))
thread.start()
thread.join()
np.save("a.npy", a @ a)
assert np.load("a.npy", mmap_mode="r").shape == (300, 300)
assert subprocess.run(["/bin/sh", "-c", "echo $((6 * 7))"], capture_output=True, check=True).stdout == b"42\n"
tell({"done": {}})

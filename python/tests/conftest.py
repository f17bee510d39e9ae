"""What all tests share."""

import os

# Numpy's own threads only disturb.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

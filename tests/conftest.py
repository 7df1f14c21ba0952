"""One BLAS thread: the matrices here are small, and the test workers already take every core."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is first imported

"""One BLAS thread, so that an alternative built on small matrices is timed at its best, not waking threads.

`OPENBLAS_NUM_THREADS=2 make bench` measures the other way.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is first imported

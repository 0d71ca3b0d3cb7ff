"""What holds for every test."""

from __future__ import annotations

import os

# Threads of linear algebra and of OpenMP wait by spinning: on small problems, beside other processes, they cost more
# time than they save. Set before NumPy loads; the processes that tests start inherit it.
for _library in ("OPENBLAS", "OMP"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

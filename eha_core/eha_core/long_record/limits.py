"""From which length on a record is not fitted as a whole, and what is taken of it: every number and its origin.

`tests/long_record/test_limits.py` fails when one of them moves.
"""

from __future__ import annotations

LONGEST_WHOLE = 120.0
"""s; a longer record is fitted in stretches. What a hypothesis has to gain grows with the number of samples (see
`diagnosis.criteria.chance_gain`), and past some 25,000 samples, 8 s of three channels at 1 kHz, it grows as fast as
what there is to gain: more of the same names nothing smaller, and only narrows intervals. The time that a diagnosis
takes is proportional to the length. So a record is cut where at least half of it is left out, which is where a
diagnosis of the whole would take minutes."""

STRETCH = 10.0
"""s; a stretch holds more samples than the 25,000 of above, and its start, which is not compared for 0.3 s, is little
of it."""

STRETCHES = 6
"""How many stretches are fitted. Six of an hour of a simulated rig with 150 N of dry friction gave 150.09 N with a 95 %
interval of 0.12 N; further gain is less than a model's own errors (measured once)."""

ENDS = 0.1
"""Share of a record at either end from which one stretch is taken, so that what drifts or begins late is seen
(assumed)."""

NEARLY = 0.05
"""Share of all that the record shows by which a stretch may show less than the best, to be preferred for lying farther
from the others (assumed)."""

WINDOW = 1.0
"""s; where a model is judged on the whole record its parameters are held, and the piston's state is fitted anew every
so many seconds, as in the windows of a fit. From measured states alone it would err by what differentiating and
smoothing them adds, which under dry friction is ten times the noise."""

ITERATIONS = 4
"""Of fitting those states: as many as judge a fit's held-out windows."""

DEPARTS = 1.5
"""A block departs where the model errs by this many times what it does on the worst of the stretches that it was fitted
to. Of blocks that one model explains alike, errors differ by a few per cent (assumed)."""

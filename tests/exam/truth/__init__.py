"""Tests of the exam's truth; a package, for modules of the same names stand in tests/plant."""

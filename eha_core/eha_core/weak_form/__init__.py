"""Residuals of equations evaluated with measured channels, without simulation, and laws found in them by regression.

After D. A. Messenger and D. M. Bortz, "Weak SINDy", Multiscale Modeling & Simulation 19 (2021).
"""

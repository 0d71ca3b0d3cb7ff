"""Equations held against measured channels without simulating, and laws found in what they lack by sparse regression.

After D. A. Messenger and D. M. Bortz, "Weak SINDy", Multiscale Modeling & Simulation 19 (2021).
"""

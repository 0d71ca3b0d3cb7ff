"""Fits of a plant to recordings: multiple shooting with soft continuity, by Levenberg-Marquardt.

Recordings are read into observations and cut into windows (`segments`, `shooting`). Parameters and the windows'
initial states are fitted together (`problem`, `normal_matrix`, `fit`), several recordings as one (`together`). Models
are validated on held-out windows (`validate`). This package knows neither missing physics nor verdicts.
"""

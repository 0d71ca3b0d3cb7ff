"""A plant fitted to recordings: multiple shooting with soft continuity, by Levenberg-Marquardt.

Recordings are read into observations and cut into windows (`segments`, `shooting`). Parameters and the windows'
states are fitted together (`problem`, `normal_matrix`, `fit`), several recordings as one (`together`). Held-out
windows judge a model (`validate`). Nothing here knows what physics could be missing, nor a verdict.
"""

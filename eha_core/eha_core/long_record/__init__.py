"""Records longer than a diagnosis needs: stretches are fitted, and the whole record judges what was found.

`admission` is the way in, `judging` the way out.
"""

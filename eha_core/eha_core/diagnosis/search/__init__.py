"""Stage 4, name: one search over whole sets of effects, from the equations to a probability for each name.

Over short windows the channels are nearly linear in the sizes of all effects, so one linearisation holds every set.
The best sets of each size by that quadratic model are fitted, the next linearisation stands at the best of all that
were fitted, and the search ends where nothing proposed would be significant.
"""

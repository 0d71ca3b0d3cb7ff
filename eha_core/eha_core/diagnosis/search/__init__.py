"""The search for what is missing: sets of effects proposed, refitted together, compared and thinned out.

Where all is far from the noise, `short_windows` leads the laws that stick to their optimum. `grow` adds to the best
sets what predicts the largest gain until nothing earns its place or only noise is left; where it ends far from the
noise, `joint_start` fits the whole catalogue at once for another beginning. `exchange` lets everything compete for each
member's place; `prune` drops what does not earn its place beside the others.
"""

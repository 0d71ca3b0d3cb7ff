"""The search for what is missing: sets of effects proposed, refitted together, compared and thinned out.

`short_windows` leads the laws that stick to their optimum. `grow` adds to the best set what predicts the largest gain
until nothing earns its place or only noise is left. `exchange` lets everything compete for each member's place;
`simpler_form` goes on from plainer forms of the laws; `prune` drops what does not earn its place beside the others.
"""

"""The search for what is missing: single effects, then sets of them, proposed, refitted together and compared.

`model_comparison` screens the catalogue and refits the single effects that predict most; `time_limited` looks for
those that act over an interval. `sets` goes on from there: `short_windows` leads the laws that stick to their optimum;
`grow` adds to the best set what predicts the largest gain until nothing is significant or only noise is left;
`all_at_once` fits all effects together where that leaves more, and keeps the fewest that explain as much; `exchange`
lets everything compete for each member's place; `simpler_form` goes on from plainer forms of the laws; `prune` drops
what does not earn its place beside the others.
"""

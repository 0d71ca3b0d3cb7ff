"""Other methods on the same recordings, each a command line that writes the same diagnosis.json.

They share one regression: the force balance and the two chambers in weak form, linear in their unknowns. `calibration`
fits the nominal terms and names nothing. `sindy_*` let PySINDy choose among terms that stand for effects of the
catalogue, `forward_bic` takes terms in and drops them one at a time, and `localising_regression` asks blocks of time
that were held out what a term is worth. `black_box` lets gradient boosting predict what the nominal terms leave.
`neural_screen` is a network that was trained on recordings of the exam's simulator.
"""

METHODS = (
    "calibration",
    "sindy_stlsq",
    "sindy_frols",
    "sindy_ensemble",
    "black_box",
    "forward_bic",
    "localising_regression",
    "neural_screen",
)

PEERS: dict[str, str] = {name: "{python} -m eha_exam.peers " + name + " {recording} {answer}" for name in METHODS}
"""Command lines for `eha exam --peers`."""

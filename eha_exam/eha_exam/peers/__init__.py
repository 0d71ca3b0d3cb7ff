"""Other methods on the same recordings, each a command line that writes the same diagnosis.json.

They share one regression: the force balance and the two chambers in weak form, linear in their unknowns. `calibration`
fits the nominal terms and names nothing. `sindy_*` let PySINDy choose among terms that stand for effects of the
catalogue. `black_box` lets gradient boosting predict what the nominal terms leave.
"""

METHODS = ("calibration", "sindy_stlsq", "sindy_frols", "sindy_ensemble", "black_box")

PEERS: dict[str, str] = {name: "{python} -m eha_exam.peers " + name + " {recording} {answer}" for name in METHODS}
"""Command lines for `eha exam --peers`."""

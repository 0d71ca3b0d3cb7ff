"""Where the fit of another form of a law begins, and which initial guesses there are."""

from types import SimpleNamespace

import numpy as np
import pytest

from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Search
from eha_core.diagnosis.search.initial_guesses import initial_guesses
from eha_core.diagnosis.search.proposals import in_another_form
from eha_core.effects import effects
from eha_core.identification.fit import Ending, Fit
from eha_core.identification.free_parameters import coordinates

LAWS = {effect.id: effect for effect in effects()}
FORMS = [LAWS[name] for name in ("coulomb_friction", "presliding_friction", "stribeck_friction")]
SCALES = SimpleNamespace(by_quantity={"force": (0.0, 1000.0), "speed": (0.0, 0.2)})


def forms_of(law: str, **found: float) -> dict[str, list[dict[str, float]]]:
    """The initial guesses of the other forms, by their effect, from a fit of one with these values."""
    values = {f"{law}.{name}": value for name, value in found.items()}
    free = free_effect_parameters(LAWS[law], values)
    at = Fit(free, coordinates(free, values), values, np.zeros((1, 4)), 0.0, 0.0, 1, (), np.eye(len(free)),
             Ending.CONVERGED, 1)  # fmt: skip
    search = Search(None, FORMS, SCALES)
    begun: dict[str, list[dict[str, float]]] = {}
    for proposal in in_another_form(search, Candidate(NOTHING.with_effects([LAWS[law]]), at)):
        (form,) = proposal.hypothesis.ids
        own = {name.rsplit(".", 1)[1]: value for name, value in proposal.values.items() if name.startswith(form)}
        begun.setdefault(form, []).append(own)
    return begun


def test_coulomb_friction_begins_between_friction_at_rest_and_in_motion():
    """A broad Stribeck velocity leaves hardly any force in motion, and yet there is friction at every speed."""
    found = forms_of("stribeck_friction", force=2.0, static_force=660.0, stribeck_velocity=0.3, shape=1.1)
    assert [one["force"] for one in found["coulomb_friction"]] == pytest.approx([331.0] * 2)


def test_forms_that_share_a_parameter_begin_with_its_value():
    found = forms_of("stribeck_friction", force=400.0, static_force=580.0, stribeck_velocity=0.03, shape=2.0)
    for one in found["presliding_friction"]:
        assert (one["force"], one["static_force"], one["stribeck_velocity"]) == (400.0, 580.0, 0.03)
    richer = forms_of("coulomb_friction", force=300.0)["stribeck_friction"]
    assert {one["force"] for one in richer} == {300.0}
    assert all(one["static_force"] > 300.0 for one in richer)


@pytest.mark.parametrize("law", ["presliding_friction", "stribeck_friction"])
def test_every_initial_guess_has_one_to_four_times_as_much_friction_at_rest_as_in_motion(law):
    guesses = initial_guesses(LAWS[law], SCALES)
    pairs = {(one.values[f"{law}.force"], one.values[f"{law}.static_force"]) for one in guesses}
    assert pairs == {(100.0, 200.0), (400.0, 600.0)}

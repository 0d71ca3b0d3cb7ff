"""The exam's page: targets judged by intervals, a matrix of names, shares over tier and noise, linked cases."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from eha_exam.page import as_html
from eha_exam.scoring import Mark, Proportion
from eha_exam.shares import Target, summarise


def marked(number: int, named: str, noise: float = 1.0, tier: str = "single") -> Mark:
    """A rig with dry friction, of which this was named."""
    concealed = () if tier == "null" else ("coulomb_friction",)
    names = (named,) if named else ()
    right = names == concealed
    return Mark(
        name=f"{tier}-{number:04d}", tier=tier, noise=noise, concealed=concealed,
        verdict="missing_physics" if named else "consistent", named=names, outcome="right" if right else "wrong",
        site_right=None if tier == "null" else bool(named), in_stated_set=None, discovery=bool(named and not concealed),
        intervals=(), nominal_intervals=(), held_out_ratio=1.0, curve_r_squared=None, seconds=5.0, decidable=True,
        false=() if right else names,
    )  # fmt: skip


def target(marks: list[Mark], statement: str) -> Target:
    return next(one for one in summarise("tool", marks).targets if one.statement == statement)


@pytest.mark.parametrize(
    ("right", "wrong", "judged"),
    [
        (400, 0, "yes"),  # 99.0 to 100 %
        (100, 0, "open"),  # 96.3 to 100 %
        (97, 3, "open"),  # 91.5 to 99.0 %
        (80, 20, "no"),  # 71.1 to 86.7 %
        (0, 0, "no case"),
    ],
)
def test_a_target_is_met_where_the_whole_interval_says_so(right: int, wrong: int, judged: str) -> None:
    marks = [marked(k, "coulomb_friction") for k in range(right)]
    marks += [marked(right + k, "stribeck_friction") for k in range(wrong)]
    found = target(marks, "single effect named, noise 1x")
    assert found.judged == judged
    assert found.met is {"yes": True, "no": False}.get(judged)
    assert found.reached == str(Proportion(right, right + wrong))


def test_false_discoveries_are_few_only_if_the_upper_end_of_the_interval_is_low() -> None:
    statement = "false discoveries with nothing missing"
    nulls = [marked(k, "", tier="null") for k in range(400)]
    assert target(nulls, statement).judged == "yes"
    assert target(nulls[:20], statement).judged == "open"
    assert target([marked(k, "end_stop", tier="null") for k in range(20)], statement).judged == "no"


def test_what_must_always_hold_is_missed_by_one_case_and_open_without_one() -> None:
    kept = [replace(marked(k, "coulomb_friction"), complete=True) for k in range(300)]
    always = target(kept, "`complete` stated correctly")
    assert (always.aim, always.judged) == ("100 %", "open")
    lied = replace(kept[0], held_out_ratio=1.6)
    assert target([lied, *kept[1:]], "`complete` stated correctly").judged == "no"


def test_the_page_has_key_matrix_shares_and_linked_cases() -> None:
    marks = [marked(k, "coulomb_friction", noise) for k, noise in enumerate((1.0, 1.0, 3.0))]
    marks += [marked(3, "stribeck_friction", 3.0), marked(4, "", 3.0), marked(5, "end_stop", 1.0, "null")]
    page = as_html(
        [summarise("eha diagnose", marks)], {"eha diagnose": marks}, {"seed": 7}, {"single-0003": "a/b.html"}
    )
    key = re.search(r'<ul class="key">(.*?)</ul>', page)
    assert key is not None
    assert re.findall(r"</i>(\w+)", key[1]) == ["right", "abstained", "wrong", "failed"]
    matrix = re.search(r'<table class="names">(.*?)</table>', page, re.DOTALL)
    assert matrix is not None
    columns = re.findall(r"<span>([\w ]+)</span>", matrix[1])
    assert columns == ["coulomb friction", "end stop", "stribeck friction", "nothing"]
    rows = dict(re.findall(r"<tr><th>([\w ]+)</th>(.*?)</tr>", matrix[1]))
    counts = {name: re.findall(r"<td[^>]*>(\d*)</td>", cells) for name, cells in rows.items()}
    assert counts == {"coulomb friction": ["3", "", "1", "1"], "nothing": ["", "1", "", ""]}
    assert "100 %<small>2/2, 34 to 100 %</small>" in page  # single, noise 1x
    assert "33 %<small>1/3, 6 to 79 %</small>" in page  # single, noise 3x
    assert page.count('<a href="a/b.html">single-0003</a>') == 2  # among the lost, and among all
    assert "Wrong or failed cases (3)" in page
    assert '<td data-label="right">50 %<small>3/6, 19 to 81 %</small></td>' in page  # all
    assert "All cases (6)" in page

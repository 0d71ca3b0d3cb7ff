"""A question to a measured rig, and the table of all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

HEAD = ("rig", "question", "known from outside", "answer", "met")


@dataclass(frozen=True)
class Question:
    """One question with its answer.

    `known`: what the answer must be, and who says so. `seal`: the first digits of the hash of what was predicted before
    the answer was read; empty where nothing was predicted.
    """

    rig: str
    asked: str
    known: str
    answer: str
    met: bool
    seal: str = ""


def as_markdown(questions: Sequence[Question]) -> str:
    """The table, with how many are met at its end."""
    lines = [f"| {' | '.join(HEAD)} |", f"|{'---|' * len(HEAD)}"]
    for question in questions:
        answer = f"{question.answer} (sealed {question.seal})" if question.seal else question.answer
        lines.append(
            f"| {question.rig} | {question.asked} | {question.known} | {answer} | {'yes' if question.met else 'no'} |"
        )
    met = sum(question.met for question in questions)
    return "\n".join([*lines, "", f"{met} of {len(questions)} questions are met.", ""])

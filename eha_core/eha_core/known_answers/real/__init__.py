"""The court of measured data: questions to recordings of real rigs whose answers are known from outside.

What is predicted is written down, with a hash, before the answer is read. The data stay where they are.
"""

from eha_core.known_answers.real.court import RIGS, hold
from eha_core.known_answers.real.question import Question, as_markdown

__all__ = ["RIGS", "Question", "as_markdown", "hold"]

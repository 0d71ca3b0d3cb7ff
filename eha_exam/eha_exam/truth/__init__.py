"""The truth: a second actuator, written apart from the model that is examined with it.

Piston and chambers are a hybrid automaton: the piston rests or slips, is in contact with a stop or free of it, and each
change of mode is an event that the integrator (SUNDIALS CVODE) finds as a root. The valve is solved in closed form.
Nothing here imports the plant, the effects or the diagnosis.
"""

from eha_exam.truth.control import PositionController
from eha_exam.truth.record import effect_parameters
from eha_exam.truth.simulate import SteppedTruth, resume_truth, simulate_truth

__all__ = ["PositionController", "SteppedTruth", "effect_parameters", "resume_truth", "simulate_truth"]

"""The plant as an actuator of a MuJoCo model, where MuJoCo moves the load: it needs the extra `mujoco`."""

from __future__ import annotations

import mujoco

from eha_core.errors import EhaError
from eha_core.export.model import ExportedModel, exported_model
from eha_core.plant.coupled import CoupledPlant
from eha_core.plant.state import Row

IMPEDANCE = 0.9999
"""Of the joint's dry friction and of its limits: the largest that MuJoCo takes."""

SOFTNESS = 0.01
"""How much of the softness that IMPEDANCE leaves is kept. Tried: with 1, 9 kg at rest under 350 N creep by 0.4 um/s,
with this by 0.004 um/s; with 1e-4 the solver's friction force is wrong where the joint comes to rest."""

NEEDED = ("constraint", "frictionloss", "limit", "actuation")
"""Flags of a model, without which force, dry friction or the ends of the stroke do not act."""

ROUNDING = 1e-9
"""Of the plant's steps in a timestep, relative to it."""


class EhaActuator:
    """The plant on a slide joint: voltage in `data.ctrl`, the force of pressures, damping and friction on the joint.

    The actuator is one of the model's own, on a slide joint and without dynamics. Its control becomes the valve's
    voltage [V], its force the plant's [N]; its gain and limits of force are overwritten. The moving mass is that of the
    model's bodies: the plant's `moving_mass` is not used. The joint's range ends with the stroke, if not before, and as
    hard as MuJoCo allows. Dry friction becomes the joint's `frictionloss`; what the model gives of that and of
    `armature` remains in addition.

    Make one for each such joint; it changes the model, which then belongs to this `data` alone.

    model, data: `mujoco.MjModel` and its `mujoco.MjData`.
    actuator: its name in the model.
    plant: what acts, from `exported_model`; the nominal plant by default. Its step divides the model's timestep.
    middle: the joint's position at mid stroke [m].

    Raises EhaError for a model that this cannot act on, and ParameterError as `CoupledPlant` does.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        actuator: str,
        plant: ExportedModel | None = None,
        middle: float = 0.0,
    ) -> None:
        plant = plant or exported_model()
        number, joint = _slide_joint(model, actuator)
        self.model, self.data, self.middle = model, data, middle
        self._duration, self._steps = model.opt.timestep, _steps(model.opt.timestep, plant.step_size)
        self.plant = CoupledPlant(plant.values, plant.step_size, composition=plant.composition)
        self._limit(joint)
        self._prepare(number, joint)
        self.reset()

    def _limit(self, joint: int) -> None:
        """End the joint's range where the stroke ends, if not before."""
        stroke, model = self.plant.parameters["actuator_displacement"], self.model
        lower, upper = self.middle - stroke, self.middle + stroke
        given = model.jnt_range[joint] if model.jnt_limited[joint] else (lower, upper)
        model.jnt_range[joint] = [min(max(end, lower), upper) for end in given]
        model.jnt_limited[joint] = 1

    def _prepare(self, number: int, joint: int) -> None:
        """Make the actuator's force a number that we write, and stops hard; keep views of what a step needs."""
        model, data = self.model, self.data
        place, dof = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        model.actuator_gaintype[number] = mujoco.mjtGain.mjGAIN_FIXED
        model.actuator_biastype[number] = mujoco.mjtBias.mjBIAS_AFFINE
        model.actuator_gainprm[number] = model.actuator_biasprm[number] = 0.0
        # the pressures limit the force; a joint's effort in the project's own description is in volts
        model.actuator_forcelimited[number] = model.jnt_actfrclimited[joint] = 0
        self._mass = float(model.dof_M0[dof])  # of all that the joint carries
        model.dof_invweight0[dof] = SOFTNESS / self._mass
        # friction and stroke ends stop the joint within one step
        model.dof_solref[dof] = model.jnt_solref[joint] = 2.0 * self._duration, 1.0
        model.dof_solimp[dof, :2] = model.jnt_solimp[joint, :2] = IMPEDANCE
        self._position, self._velocity = data.qpos[place : place + 1], data.qvel[dof : dof + 1]
        self._control, self._force = data.ctrl[number : number + 1], model.actuator_biasprm[number, :1]
        self._limits = model.actuator_ctrlrange[number].tolist() if model.actuator_ctrllimited[number] else None
        # MuJoCo takes `dof_M0` in place of bodies and armature where the joint is the only one of its body
        self._adapted = [array[dof : dof + 1] for array in (model.dof_armature, model.dof_M0, model.dof_frictionloss)]
        self._own = [float(array[0]) for array in self._adapted]

    def reset(self) -> None:
        """The plant at rest at the joint's position: after `mujoco.mj_resetData`."""
        self.plant.reset(float(self._position[0]) - self.middle)

    @property
    def state(self) -> Row:
        """The plant after the last step: pressures, flows, spool and the rest, but no `friction_force`."""
        return self.plant.state

    def step(self) -> None:
        """One step of the model; with other such actuators on it, `apply` all, then `mj_step`, then `follow` all."""
        self.apply()
        mujoco.mj_step(self.model, self.data)
        self.follow()

    def apply(self) -> None:
        """Give the model what acts on the joint in the next `mj_step`."""
        reaction = self.plant.reaction(self._mass, float(self._velocity[0]), self._duration)
        self._start = float(self._position[0]) - self.middle
        self._force[0] = reaction.force
        added = (reaction.added_mass, reaction.added_mass, reaction.dry_friction)
        for place, own, more in zip(self._adapted, self._own, added, strict=True):
            place[0] = own + more

    def follow(self) -> None:
        """Take the plant along the motion of that step, under the voltage that was the actuator's control."""
        voltage = float(self._control[0])
        if self._limits:
            voltage = min(max(voltage, self._limits[0]), self._limits[1])
        self.plant.follow(voltage, self._start, float(self._position[0]) - self.middle, self._steps)


def _slide_joint(model: mujoco.MjModel, name: str) -> tuple[int, int]:
    """Numbers of the actuator of that name and of its joint; EhaError where the plant cannot act by it."""
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
    if number < 0:
        names = ", ".join(model.actuator(k).name for k in range(model.nu)) or "none"
        raise EhaError(f"the model has no actuator {name}; its actuators: {names}")
    joint = int(model.actuator_trnid[number, 0])
    kind = mujoco.mjtTrn.mjTRN_JOINT
    if model.actuator_trntype[number] != kind or model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_SLIDE:
        raise EhaError(f"actuator {name}: it does not act on a slide joint; give it one with joint=")
    if model.actuator_gear[number, 0] != 1.0:
        raise EhaError(f"actuator {name}: gear = {model.actuator_gear[number, 0]:g}; the piston needs 1")
    if model.actuator_dyntype[number] != mujoco.mjtDyn.mjDYN_NONE:
        raise EhaError(f'actuator {name}: it has dynamics of its own; give dyntype="none"')
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        raise EhaError("integrator RK4 asks for forces within a step; choose Euler, implicit or implicitfast")
    for name in NEEDED:
        if model.opt.disableflags & getattr(mujoco.mjtDisableBit, f"mjDSBL_{name.upper()}"):
            raise EhaError(f"the model's option flag {name} is disabled; enable it: the plant acts by it")
    return number, joint


def _steps(timestep: float, step_size: float) -> int:
    """How many of the plant's steps make one of the model's."""
    steps = round(timestep / step_size)
    if steps < 1 or abs(steps * step_size - timestep) > ROUNDING * timestep:
        raise EhaError(
            f"timestep = {timestep:g} s is no multiple of the plant's step of {step_size:g} s; "
            f"give exported_model(step_size=...) one that is"
        )
    return steps

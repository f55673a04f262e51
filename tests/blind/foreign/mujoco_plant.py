"""The closed-loop arm: MuJoCo integrates it under a controller, with dry friction as a constraint (true stick).

PD control about the reference with the rigid bodies' torque fed forward, a torque of its own held for each step of 1 ms.
Log: motor positions and the torque commanded, then the sensor effects. MuJoCo's friction constraint stands for
Coulomb friction; the other effects enter as applied forces, bodies, or (gear) as a second joint in series.
"""

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from effects import ALTER, POSITION_SENSOR, TORQUE, TORQUE_SENSOR, contact
from plant import Plant, State, smooth_sign

CONTROL_HZ = 1000
SUBSTEPS = 4
SLIDING = 0.02  # rad/s: width of the sign of friction effects, which MuJoCo applies as forces


def logs(rng, arm, effects, motions, rate, duration):
    """Noiseless logs (t, q, tau) of the controlled arm along the motions."""
    stiffness = rng.uniform(6.0, 12.0)  # bandwidth of position control, Hz
    return [Loop(arm, effects, index, stiffness).run(motion, rate, duration) for index, motion in enumerate(motions)]


class Loop:
    """One arm in MuJoCo with a controller."""

    def __init__(self, arm, effects, index, bandwidth_hz):
        self.arm = arm
        self.effects = [effect for effect in effects if not effect.logs or index in effect.logs]
        # Bodies and gravity as the effects make them.
        self.true = Plant(arm, self.effects, SLIDING).model
        self.model, self.motors, self.links = build(arm, self.true, self.effects)
        self.data = mujoco.MjData(self.model)
        self.omega = 2 * np.pi * bandwidth_hz

    def run(self, motion, rate, duration):
        model, data, dof = self.model, self.data, self.arm.dof
        every = int(round(CONTROL_HZ / rate))
        t = np.arange(int(duration * CONTROL_HZ)) / CONTROL_HZ
        delay = sum(e.values()["delay"] for e in self.effects if e.name == "time_delay")
        aim, aim_v, aim_a = motion.at(t)
        data.qpos[self.motors], data.qvel[self.motors] = aim[0], aim_v[0]
        nominal = mujoco.MjData(model)
        q, tau = np.empty((t.size, dof)), np.empty((t.size, dof))
        for k in range(t.size):
            wanted = aim_a[k] + 2 * self.omega * (aim_v[k] - data.qvel[self.motors])
            wanted += self.omega**2 * (aim[k] - data.qpos[self.motors])
            command = self.feed_forward(nominal, aim[k], aim_v[k], wanted)
            q[k], tau[k] = data.qpos[self.motors], command
            for _ in range(SUBSTEPS):
                data.qfrc_applied[:] = 0.0
                data.qfrc_applied[self.motors] = command - self.added(t[k])
                mujoco.mj_step(model, data)
        # A command is held for a control step, which for MuJoCo's integrator is centred half a substep before its middle:
        # the mean of two commands that is centred at the instant of the sample.
        later = 0.5 + 0.5 / SUBSTEPS
        tau[1:] = later * tau[1:] + (1 - later) * tau[:-1]
        if delay:
            tau = np.stack([np.interp(t - delay, t, signal) for signal in tau.T], axis=1)
        for effect in self.effects:
            j = effect.joint
            if effect.name in TORQUE_SENSOR:
                TORQUE_SENSOR[effect.name](effect.values(), t, tau, j)
            if effect.name in POSITION_SENSOR:
                q[:, j] = POSITION_SENSOR[effect.name](effect.values(), q[:, j])
        return t[::every], q[::every], tau[::every]

    def feed_forward(self, nominal, q, v, wanted):
        """The controller's own computed torque, with half of the friction compensated."""
        model = self.model
        nominal.qpos[:], nominal.qvel[:], nominal.qacc[:] = 0.0, 0.0, 0.0
        nominal.qpos[self.motors], nominal.qvel[self.motors], nominal.qacc[self.motors] = q, v, wanted
        if model.nv > self.arm.dof:
            nominal.qpos[self.links] = self.data.qpos[self.links]
        mujoco.mj_fwdPosition(model, nominal)
        mujoco.mj_fwdVelocity(model, nominal)
        torque = np.empty(model.nv)
        mujoco.mj_rne(model, nominal, 1, torque)
        drives = self.arm.drive("armature") * wanted + 0.5 * self.arm.drive("coulomb") * np.tanh(v / 0.05)
        return torque[self.motors] + drives + self.arm.drive("viscous") * v

    def added(self, time):
        """What the effects take of the motors' torque at this instant."""
        data, dof = self.data, self.arm.dof
        out = np.zeros((1, dof))
        if not any(e.name in TORQUE or e.name == "external_contact" for e in self.effects):
            return out[0]
        q, v = data.qpos[self.motors][None], data.qvel[self.motors][None]
        load = data.qfrc_bias[self.motors][None] + self.inertial()
        state = State(np.array([time]), q, v, np.zeros_like(q), load, smooth_sign(SLIDING))
        for effect in self.effects:
            if effect.name in TORQUE:
                j = effect.joint
                own = (state.t, q[:, j], v[:, j], None, load[:, j])
                out[:, j] += TORQUE[effect.name](effect.values(), *own, state.sign)
            if effect.name == "external_contact":
                contact(effect.values(), state, self.true, self.arm.flange, out)
        return out[0]

    def inertial(self):
        """Mass matrix times the acceleration of the step before, rotors left out."""
        model, data = self.model, self.data
        out = np.zeros(model.nv)
        mujoco.mj_mulM(model, data, out, data.qacc)
        return (out - model.dof_armature * data.qacc)[self.motors][None]


def build(arm, true, effects):
    """The MuJoCo model; a joint with an elastic gear or play gets a second hinge behind the motor's."""
    spec = mujoco.MjSpec()
    spec.option.timestep = 1.0 / (CONTROL_HZ * SUBSTEPS)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.gravity = true.gravity.linear
    spec.compiler.degree = False
    gears = {effect.joint: effect for effect in effects if effect.name in ("joint_elasticity", "backlash")}
    parent, motors, links, count = spec.worldbody, [], [], 0
    for k, joint in enumerate(arm.joints):
        parent = parent.add_body(name=f"link_{k + 1}", pos=joint.xyz, quat=quaternion(joint.rpy))
        kind = mujoco.mjtJoint.mjJNT_SLIDE if joint.kind == "prismatic" else mujoco.mjtJoint.mjJNT_HINGE
        body = true.inertias[k + 1]
        parent.mass, parent.ipos, parent.explicitinertial = body.mass, body.lever, True
        inertia = body.inertia
        parent.fullinertia = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        drive = {"damping": joint.viscous, "frictionloss": joint.coulomb, "armature": joint.armature}
        made = parent.add_joint(name=f"joint_{k + 1}", type=kind, axis=joint.axis)
        for name, value in drive.items():
            put(made, name, value)
        motors.append(count)
        count += 1
        if k in gears:
            gear = parent.add_joint(name=f"gear_{k + 1}", type=kind, axis=joint.axis)
            furnish(gear, gears[k], joint)
            links.append(count)
            count += 1
    return spec.compile(), np.array(motors), np.array(links, dtype=int)


def furnish(gear, effect, joint):
    """A spring of the gear's stiffness, or a gap between stiff stops."""
    values = effect.values()
    if effect.name == "joint_elasticity":
        put(gear, "stiffness", 1.0 / values["compliance"])
        put(gear, "damping", 5e-4 / values["compliance"])
    else:
        gear.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        gear.range = [-values["half_gap"], values["half_gap"]]
        gear.solref_limit = [0.001, 1.0]
        gear.solimp_limit = [0.95, 0.999, 1e-4, 0.5, 2]


def put(joint, name, value):
    """Sets a joint's attribute, which some versions keep as an array."""
    current = getattr(joint, name)
    setattr(joint, name, [value] + [0.0] * (len(current) - 1) if np.ndim(current) else value)


def quaternion(rpy):
    x, y, z, w = Rotation.from_euler("xyz", rpy).as_quat()
    return [w, x, y, z]

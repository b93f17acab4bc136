"""Engines of multibody dynamics, given the linkages of linkages.py: MuJoCo and Drake.

Their steps or accuracies follow from the tolerance that is asked for. MuJoCo closes loops by stiff springs with
dampers, as stiff as a step allows; Drake has none in continuous time, so linkages with loops are left out there.
"""

import time


def step_of(tolerance):
    """Of a method of order four: 1.8e-2 s where 1e-3 is asked for, 1e-5 s at 1e-16."""
    return 0.1 * tolerance**0.25


def model_of(linkage):
    """MuJoCo's description."""

    def vector(number):
        return f"{complex(number).real!r} {complex(number).imag!r} 0"

    def body(k):
        bar = linkage.bars[k]
        sites = [(f"p{i}{end}", at) for i, pin in enumerate(linkage.pins) for end, of, at in ends(pin) if of == k]
        if linkage.spring and linkage.spring[1] == k:
            sites.append(("pulled", linkage.spring[2]))
        return (
            f'<body pos="{vector(bar.at)}"><joint axis="0 0 1"/>'
            f'<inertial mass="{bar.mass!r}" pos="{vector(bar.com)}" diaginertia="{f"{bar.moment!r} " * 3}"/>'
            + "".join(f'<site name="{name}" pos="{vector(at)}"/>' for name, at in sites)
            + "".join(body(j) for j, other in enumerate(linkage.bars) if other.parent == k)
            + "</body>"
        )

    def ends(pin):
        return (("a", pin.a, pin.on_a), ("b", pin.b, pin.on_b))

    text = f'<mujoco><option gravity="0 {-linkage.gravity!r} 0" integrator="RK4"><flag contact="disable"/></option>'
    text += "<worldbody>"
    if linkage.spring:
        text += f'<site name="held" pos="{vector(linkage.spring[0])}"/>'
    text += "".join(body(k) for k, bar in enumerate(linkage.bars) if bar.parent < 0) + "</worldbody>"
    if linkage.spring:
        stiffness, rest = linkage.spring[3:]
        text += f'<tendon><spatial stiffness="{stiffness!r}" springlength="{rest!r}">'
        text += '<site site="held"/><site site="pulled"/></spatial></tendon>'
    if linkage.pins:
        pairs = "".join(f'<connect site1="p{i}a" site2="p{i}b"/>' for i in range(len(linkage.pins)))
        text += f"<equality>{pairs}</equality>"
    return text + "</mujoco>"


def relative(linkage, numbers):
    return [x - (numbers[bar.parent] if bar.parent >= 0 else 0.0) for bar, x in zip(linkage.bars, numbers, strict=True)]


def absolute(linkage, numbers):
    result = []
    for bar, x in zip(linkage.bars, numbers, strict=True):
        result.append(x + (result[bar.parent] if bar.parent >= 0 else 0.0))
    return result


def with_mujoco(problem):
    import mujoco

    linkage = problem.linkage
    if linkage is None:
        return {}
    begin = time.perf_counter()
    model = mujoco.MjModel.from_xml_string(model_of(linkage))
    data = mujoco.MjData(model)
    once = time.perf_counter() - begin
    angles = relative(linkage, [bar.angle for bar in linkage.bars])
    rates = relative(linkage, [bar.rate for bar in linkage.bars])

    def with_method(method):
        def go(tolerance):
            steps = round(problem.until / (step_of(tolerance) * min(1.0, problem.until)))
            model.opt.integrator = method
            model.opt.timestep = problem.until / steps
            model.eq_solref[:] = [2.0 * model.opt.timestep, 1.0]
            model.eq_solimp[:] = [0.9999, 0.9999, 0.001, 0.5, 2.0]
            mujoco.mj_resetData(model, data)
            data.qpos[:], data.qvel[:] = angles, rates
            data.qfrc_applied[0] = linkage.torque
            begin = time.perf_counter()
            mujoco.mj_step(model, data, nstep=steps)
            seconds = time.perf_counter() - begin
            return absolute(linkage, data.qpos.tolist()) + absolute(linkage, data.qvel.tolist()), seconds

        return go, once

    return {"MuJoCo, RK4": with_method(mujoco.mjtIntegrator.mjINT_RK4)}


def with_drake(problem):
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint, SpatialInertia, UnitInertia
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator

    linkage = problem.linkage
    if linkage is None or linkage.pins:
        return {}

    def in_space(number):
        return [complex(number).real, complex(number).imag, 0.0]

    begin = time.perf_counter()
    plant = MultibodyPlant(time_step=0.0)
    plant.mutable_gravity_field().set_gravity_vector([0, -linkage.gravity, 0])
    bodies, joints = [], []
    for k, bar in enumerate(linkage.bars):
        com, moment = in_space(bar.com), bar.moment / bar.mass
        about_com = UnitInertia(moment, moment, moment)
        inertia = SpatialInertia(bar.mass, com, about_com.ShiftFromCenterOfMass(com))
        bodies.append(plant.AddRigidBody(f"bar{k}", inertia))
        before = bodies[bar.parent] if bar.parent >= 0 else plant.world_body()
        at = FixedOffsetFrame(f"at{k}", before.body_frame(), RigidTransform(in_space(bar.at)))
        hinge = RevoluteJoint(f"hinge{k}", plant.AddFrame(at), bodies[k].body_frame(), [0, 0, 1])
        joints.append(plant.AddJoint(hinge))
    plant.Finalize()
    once = time.perf_counter() - begin
    angles = relative(linkage, [bar.angle for bar in linkage.bars])
    rates = relative(linkage, [bar.rate for bar in linkage.bars])

    def with_method(method):
        def go(tolerance):
            simulator = Simulator(plant)
            ResetIntegratorFromFlags(simulator, method, 0.1)
            simulator.get_mutable_integrator().set_target_accuracy(tolerance)
            context = simulator.get_mutable_context()
            for joint, angle, rate in zip(joints, angles, rates, strict=True):
                joint.set_angle(context, angle)
                joint.set_angular_rate(context, rate)
            simulator.Initialize()
            begin = time.perf_counter()
            simulator.AdvanceTo(problem.until)
            seconds = time.perf_counter() - begin
            got = [joint.get_angle(context) for joint in joints], [joint.get_angular_rate(context) for joint in joints]
            return absolute(linkage, got[0]) + absolute(linkage, got[1]), seconds

        return go, once

    return {f"Drake, {method}": with_method(method) for method in ("runge_kutta3", "runge_kutta5")}

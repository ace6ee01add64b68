"""Rows beyond lists of poses: a box at rest, and a spring in the loop with a device.

Each function gives a dict of facts, or a sentence if the system cannot take part.
"""

import json
import sqlite3
import struct
import subprocess

import numpy as np
import rows
import shapes
import threads
from systems import HULLS, PERIOD_S, STIFF, Bullet, Drake, MuJoCo, Voxtouch, timed

BOX_M, BOX_KG, SETTLE_STEPS = 0.04, 0.256, 2000

# The device and the hand of `--device sim-phantom --hand pen`: devices/sim/parameters.cpp and
# devices/operator/hand.cpp.
DEVICE_KG, DEVICE_NS_PER_M, FRICTION_N, MAX_FORCE_N = 0.075, 0.005, 0.04, 8.5
HAND_KG, HAND_NS_PER_M, HAND_N_PER_M = 0.1, 4.0, 300.0
ENCODER_M, SUBSTEPS, DELAY_SUBSTEPS = 0.03e-3, 8, 8
RELEASE_S, END_S = 3.0, 5.0
AT_REST_M = 0.0002  # peak to peak over half a second


def settled(heights, times):
    heights = np.asarray(heights)
    return {
        "sink_mm": float(1e3 * (BOX_M / 2 - heights[-1])),
        "creep_mm": float(1e3 * np.ptp(heights[-500:])),
        "us_median": float(np.median(times)),
    }


def box_in_mujoco(system):
    import mujoco

    stiff = STIFF if system.stiff else ""
    half = BOX_M / 2
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{PERIOD_S}"/><worldbody>'
        f'<geom type="box" size="0.1 0.1 0.02" pos="0 0 -0.02"{stiff}/>'
        f'<body pos="0 0 {half}"><freejoint/>'
        f'<geom type="box" size="{half} {half} {half}" mass="{BOX_KG}"{stiff}/></body>'
        "</worldbody></mujoco>"
    )
    data, heights, times = mujoco.MjData(model), [], []
    for _ in range(SETTLE_STEPS):
        times.append(timed(lambda: mujoco.mj_step(model, data))[1])
        heights.append(float(data.qpos[2]))
    return settled(heights, times)


def box_in_bullet():
    import pybullet
    from pybullet_utils import bullet_client

    client = bullet_client.BulletClient(connection_mode=pybullet.DIRECT)
    shape, half = client.createCollisionShape, BOX_M / 2
    client.createMultiBody(
        0, shape(pybullet.GEOM_BOX, halfExtents=[0.1, 0.1, 0.02]), basePosition=[0, 0, -0.02]
    )
    box = client.createMultiBody(
        BOX_KG, shape(pybullet.GEOM_BOX, halfExtents=[half] * 3), basePosition=[0, 0, half]
    )
    client.setGravity(0, 0, -9.81)
    client.setTimeStep(PERIOD_S)
    heights, times = [], []
    for _ in range(SETTLE_STEPS):
        times.append(timed(client.stepSimulation)[1])
        heights.append(client.getBasePositionAndOrientation(box)[0][2])
    return settled(heights, times)


def box_in_drake():
    from pydrake.geometry import Box, SceneGraph  # noqa: F401
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
    from pydrake.multibody.tree import SpatialInertia, UnitInertia
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, PERIOD_S)
    friction = CoulombFriction(0.5, 0.5)
    plant.RegisterCollisionGeometry(
        plant.world_body(), RigidTransform([0, 0, -0.02]), Box(0.2, 0.2, 0.04), "floor", friction
    )
    inertia = SpatialInertia(BOX_KG, np.zeros(3), UnitInertia.SolidBox(BOX_M, BOX_M, BOX_M))
    body = plant.AddRigidBody("box", inertia)
    plant.RegisterCollisionGeometry(
        body, RigidTransform(), Box(BOX_M, BOX_M, BOX_M), "box", friction
    )
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, body, RigidTransform([0, 0, BOX_M / 2]))
    simulator.Initialize()
    heights, times = [], []
    for n in range(SETTLE_STEPS):
        times.append(timed(lambda: simulator.AdvanceTo((n + 1) * PERIOD_S))[1])
        heights.append(plant.EvalBodyPoseInWorld(context, body).translation()[2])
    return settled(heights, times)


def ring(program, scene, folder, *options):
    """A lockstep run of the whole ring: exit status, summary, samples of the contact topic."""
    bag = folder / "bag"
    subprocess.run(["rm", "-rf", bag], check=True)
    run = subprocess.run(
        [program, "up", scene, "--lockstep", "--one-process", "--no-report", "--json"]
        + ["--device", "sim-phantom", "--record", bag, "--record-format", "sqlite3", *options],
        capture_output=True,
        text=True,
    )
    samples = []
    for file in sorted(bag.glob("*.db3")):
        with sqlite3.connect(file) as base:
            samples += [
                data
                for (data,) in base.execute(
                    "select data from messages where topic_id in (select id from topics "
                    "where name like '%/rendering/contact') order by timestamp"
                )
            ]
    summary = json.loads(run.stdout) if run.stdout.startswith("{") else {}
    return run, summary, samples


def refused(run, scene):
    """The last sentence of a run that gave no samples, without the scene's folder."""
    said = run.stderr.strip().splitlines() or [f"exit status {run.returncode}"]
    text = said[-1].removeprefix("error: ").replace(f"{scene.parent}/", "")
    return f"refused: {text.removeprefix(f'{scene.name}: ').rstrip('.')}"


def heights_of(samples, field):
    """z of tool_pose or object_pose of ContactState: CDR has a header of 4 bytes, then 3 x 8."""
    offset = 4 + 24 + (56 if field == "object" else 0) + 16
    return np.array([struct.unpack_from("<d", data, offset)[0] for data in samples])


def box_in_voxtouch(program, folder):
    shapes.write_obj(folder / "static.obj", *shapes.box((0.2, 0.2, 0.04), (0, 0, -0.02)))
    shapes.write_obj(folder / "tool.obj", *shapes.box((BOX_M,) * 3, (0, 0, 0)))
    scene = folder / "voxtouch.yaml"
    scene.write_text(
        "scene: league\nvoxel_size: 0.002\nstatic: [{mesh: static.obj}]\n"
        "dynamic: {mesh: tool.obj}\ncontact: {model: field}\n"
        f"effects: [{{body: {{mass_kg: {BOX_KG}, grab_button: 0}}}}]\n"
        "coupling: {design: auto}\n"
        f"motions: {{rest: {{path: [[0, 0, {BOX_M / 2}]]}}}}\n",
        encoding="utf-8",
    )
    run, _, samples = ring(program, scene, folder, "--motion", "rest", "--duration", "2")
    if len(samples) < SETTLE_STEPS:
        return refused(run, scene)
    return settled(heights_of(samples, "object"), [float("nan")])


class Device:
    """Mass, damper, dry friction, encoder, delay and hand along z; eight substeps a period."""

    def __init__(self, z):
        self.z, self.v, self.line = z, 0.0, [0.0] * DELAY_SUBSTEPS

    def period(self, force, target, held):
        mass = DEVICE_KG + (HAND_KG if held else 0.0)
        dt = PERIOD_S / SUBSTEPS
        for _ in range(SUBSTEPS):
            self.line.append(float(np.clip(force, -MAX_FORCE_N, MAX_FORCE_N)))
            drive = self.line.pop(0) - DEVICE_NS_PER_M * self.v
            if held:
                drive += HAND_N_PER_M * (target - self.z) - HAND_NS_PER_M * self.v
            speed = self.v + dt * drive / mass
            stop = FRICTION_N * dt / mass
            self.v = 0.0 if abs(speed) <= stop else speed - np.sign(speed) * stop
            self.z += dt * self.v

    def measured(self):
        return ENCODER_M * round(self.z / ENCODER_M)


def motion_of(heights, period_s=PERIOD_S):
    """`rests`, or the amplitude over the last half second; `left` if it has moved away."""
    last = np.asarray(heights)[-int(0.5 / period_s) :]
    turns = np.sum(np.diff(np.sign(np.diff(last)[np.diff(last) != 0])) != 0)
    if np.ptp(last) > AT_REST_M and turns >= 4:
        return f"swings {1e3 * np.ptp(last):.2g} mm"
    return "left" if last.mean() > 0.012 else "rests"


def press_row():
    return rows.Row(
        "C3",
        "",
        shapes.box((0.2, 0.2, 0.04), (0, 0, -0.02)),
        shapes.ball(0.01),
        rows.poses_at(np.array([[0.0013, 0.0007, 0.012]])),
        np.zeros((1, 3)),
        path=True,
        ball_m=0.01,
    )


def loop_of_system(system, stiffness, folder):
    row = press_row()
    rows.write_row(row, folder)
    step = system.stepper(row, folder, stiffness)
    device, before, heights, times = Device(0.012), 0.012, [], []
    for n in range(round(END_S / PERIOD_S)):
        target = max(0.0, 0.012 - 0.05 * n * PERIOD_S)
        z = device.measured()
        place = np.array([0.0013, 0.0007, z])
        pull, us = step(place, np.array([0, 0, (z - before) / PERIOD_S]))
        before = z
        device.period(-pull[2], target, n * PERIOD_S < RELEASE_S)
        heights.append(device.z)
        times.append(us)
    release = round(RELEASE_S / PERIOD_S)
    return {
        "held": motion_of(heights[:release]),
        "released": motion_of(heights),
        "warned": "no",
        "us_median": float(np.median(times)),
    }


def loop_of_voxtouch(program, stiffness, folder):
    rows.write_row(press_row(), folder)
    coupling = (
        "{design: auto, kind: shaping_filter}"
        if stiffness < 1000
        else f"{{kind: direct, stiffness_cap_n_per_m: {stiffness:g}}}"
    )
    scene = folder / "voxtouch.yaml"
    scene.write_text(
        "scene: league\nvoxel_size: 0.002\nstatic: [{mesh: static.obj}]\n"
        "dynamic: {mesh: tool.obj}\ncontact: {rendering: virtual_tool}\n"
        f"coupling: {coupling}\n"
        "motions: {press: {path: [[0.0013, 0.0007, 0.012], [0.0013, 0.0007, 0]],"
        " speed_m_per_s: 0.05, hold_s: 0}}\n",
        encoding="utf-8",
    )
    options = ["--motion", "press", "--duration", f"{END_S:g}", "--release-time", f"{RELEASE_S:g}"]
    run, _, samples = ring(program, scene, folder, *options)
    if not samples:
        return refused(run, scene)
    heights = heights_of(samples, "tool")
    return {
        "held": motion_of(heights[: round(RELEASE_S / PERIOD_S)]),
        "released": motion_of(heights),
        "warned": "yes" if run.returncode else "no need",
    }


LOOP_ROWS = {
    "D1": ("box of 40 mm and 0.256 kg at rest on a plane", "rest", 0.0),
    "C3 371 N/m": ("simulated Phantom pressed 12 mm, released after 3 s", "loop", 371.0),
    "C3 2000 N/m": ("the same with a spring of 2000 N/m", "loop", 2000.0),
    "D2l": ("friction from which nut M20 locks on its bolt", "lock", 0.0),
}


def answer(name, system, folder):
    """None if the system has no part in this row."""
    _, judge, stiffness = LOOP_ROWS[name]
    if not system.paths and judge != "rest":
        return None
    folder.mkdir(parents=True, exist_ok=True)
    if judge == "loop":
        if isinstance(system, Voxtouch):
            return loop_of_voxtouch(system.program, stiffness, folder)
        return None if system.name == "MuJoCo SDF" else loop_of_system(system, stiffness, folder)
    if judge == "lock":
        if isinstance(system, Voxtouch):
            return threads.in_voxtouch(system.program, folder)
        return threads.in_mujoco(system, folder) if system.name == "MuJoCo SDF" else HULLS
    if isinstance(system, Voxtouch) and system.paths:
        return box_in_voxtouch(system.program, folder)
    if isinstance(system, MuJoCo) and system.paths and not system.sdf:
        return box_in_mujoco(system)
    if isinstance(system, Bullet) and system.paths and system.setting == "standard":
        return box_in_bullet()
    if isinstance(system, Drake) and system.setting == "standard":
        return box_in_drake()
    return None

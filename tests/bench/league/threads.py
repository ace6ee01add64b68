"""The friction from which an M20 nut locks: it is pressed down on its bolt and may rotate.

Flanks of 60 degrees lock from tan(lead angle) cos(30 degrees) on, at the thread's pitch diameter.
"""

import numpy as np
import rows
import shapes
from systems import PERIOD_S, SDF_SEARCH, STIFF, probe_path, timed

PITCH_DIAMETER_M = 0.018376
LOCKS_FROM = shapes.PITCH_M / (np.pi * PITCH_DIAMETER_M) * np.cos(np.radians(30))
LEAST, MOST, HALVINGS = 0.0, 0.128, 7  # steps of 0.001
SIDES = 128  # per turn: the slope of a facet of 32 exceeds the helix's, and locks by itself
NUT_KG, STEPS = 0.1, 1000
AT_REST_DEG = 1.0  # in the last half second
AT_REST_TORQUE = 0.02  # relative to a nut without friction


def threshold(turns_at):
    """Least friction, to MOST / 2^HALVINGS, at which `turns_at` reports no rotation; a sentence if
    the nut rotates at MOST or is held without friction.
    """
    low, high = LEAST, MOST
    if not turns_at(low):
        return "cannot: the nut does not turn without friction either"
    if turns_at(high):
        return f"cannot: the nut turns with a friction of {MOST} too"
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if turns_at(middle) else (low, middle)
    return high


def facts(friction, times):
    if isinstance(friction, str):
        return friction
    return {"friction": friction, "expected": LOCKS_FROM, "us_median": float(np.median(times))}


def write_meshes(folder):
    shapes.write_obj(folder / "static.obj", *shapes.bolt(0.02, SIDES))
    shapes.write_obj(folder / "tool.obj", *shapes.nut(0.01, rows.THREAD_GAP_M, SIDES))


def in_mujoco(system, folder):
    """A nut of 0.1 kg that falls along the bolt's axis and rotates about it."""
    import mujoco

    write_meshes(folder)
    geom = f'type="sdf" friction="0 0 0" condim="3"{STIFF if system.stiff else ""}'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{PERIOD_S}" cone="elliptic" impratio="10"{SDF_SEARCH}/>'
        f'<asset><mesh name="bolt" file="{folder / "static.obj"}"/>'
        f'<mesh name="nut" file="{folder / "tool.obj"}"/></asset><worldbody>'
        f'<geom mesh="bolt" {geom}/><body><joint type="slide" axis="0 0 1"/>'
        f'<joint name="turn" type="hinge" axis="0 0 1"/>'
        f'<geom mesh="nut" {geom} mass="{NUT_KG}"/></body></worldbody></mujoco>'
    )
    times = []

    def turns_at(friction):
        model.geom_friction[:, 0] = friction
        data, turn = mujoco.MjData(model), []
        data.qpos[0] = -rows.THREAD_PLAY_M
        for _ in range(STEPS):
            times.append(timed(lambda: mujoco.mj_step(model, data))[1])
            turn.append(float(np.degrees(data.qpos[1])))
        return np.ptp(turn[STEPS // 2 :]) > AT_REST_DEG

    return facts(threshold(turns_at), times)


def turned_in_mujoco(row, folder):
    """A nut rotated by the hand and pulled along the bolt by a spring: the spring's wrench."""
    import mujoco

    stiffness, turn_n_m = row.spring_n_per_m, 10.0  # the second: of a rotation, per radian
    geom = f'type="sdf" friction="0 0 0" condim="1"{STIFF}'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{PERIOD_S}" gravity="0 0 0"{SDF_SEARCH}/>'
        f'<asset><mesh name="bolt" file="{folder / "static.obj"}"/>'
        f'<mesh name="nut" file="{folder / "tool.obj"}"/></asset><worldbody>'
        f'<geom mesh="bolt" {geom}/><body><joint type="slide" axis="0 0 1"/>'
        f'<joint type="hinge" axis="0 0 1" armature="0.001"/>'
        f'<geom mesh="nut" {geom} mass="{NUT_KG}"/></body></worldbody></mujoco>'
    )
    data, wrenches, times = mujoco.MjData(model), [], []
    damping = 1.4 * (stiffness * NUT_KG) ** 0.5
    for pose in row.poses:
        turn = 2 * np.arctan2(pose[3], pose[0])
        pull = stiffness * (pose[6] - data.qpos[0])
        twist = turn_n_m * (turn - data.qpos[1])
        data.qfrc_applied[0] = pull - damping * data.qvel[0]
        data.qfrc_applied[1] = twist - 0.14 * data.qvel[1]
        wrenches.append([0, 0, -pull, 0, 0, -twist])
        times.append(timed(lambda: mujoco.mj_step(model, data))[1])
    return np.array(wrenches), np.array(times)


def in_voxtouch(program, folder):
    """A nut that a spring pulls 4 mm down along the bolt: the torque shows whether it rotates."""
    write_meshes(folder)
    z = np.concatenate([np.zeros(100), np.linspace(0, -0.004, 200), np.full(100, -0.004)])
    poses = rows.poses_at(np.column_stack([np.zeros((len(z), 2)), z]))
    rows.write_poses(folder / "poses.csv", poses)
    scene, times = folder / "voxtouch.yaml", []

    def turns_at(friction):
        scene.write_text(
            "scene: league\nvoxel_size: 0.00025\nstatic: [{mesh: static.obj}]\n"
            "dynamic: {mesh: tool.obj}\ncontact: {model: field, rendering: virtual_tool}\n"
            f"effects: [{{friction: {{coulomb: {friction}}}}}]\ncoupling: {{design: auto}}\n",
            encoding="utf-8",
        )
        wrenches, us = probe_path(program, scene, folder / "poses.csv")
        times.extend(us)
        free = abs(wrenches[-1, 2]) * shapes.PITCH_M / (2 * np.pi)
        return abs(wrenches[-1, 5]) > AT_REST_TORQUE * free

    return facts(threshold(turns_at), times)

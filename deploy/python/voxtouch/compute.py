"""Contacts, voxels and couplings, computed in this process by the code that the ring runs."""

import json
import pathlib

import numpy

from . import _core

HERE = pathlib.Path(__file__).resolve().parent
DATA = HERE / "share"
READER = str(
    HERE / "voxtouch_import_mesh"
)  # reads meshes in a separate process: a file that crashes it raises an exception here


def shipped_scenes():
    """Names of the shipped scenes, for `probe` and `design`."""
    return sorted(file.stem for file in (DATA / "scenes").glob("*.yaml"))


def scene_file(scene):
    """The file of a scene: a path, or the name of a shipped one. ValueError for any other name."""
    if pathlib.Path(scene).is_file():
        return str(scene)
    if str(scene) in shipped_scenes():
        return str(DATA / "scenes" / f"{scene}.yaml")
    raise ValueError(
        f"'{scene}' is neither a file nor a shipped scene. Shipped scenes: "
        f"{', '.join(shipped_scenes())}"
    )


def device_word(device):
    """As the C++ half takes it: a name, or the file that describes the device."""
    word = str(device)
    if not word.startswith("sim:"):
        return word
    name = word[len("sim:") :]
    if pathlib.Path(name).is_file():
        return name
    shipped = DATA / "devices" / f"{name}.yaml"
    if not shipped.is_file():
        names = ", ".join(sorted(file.stem for file in (DATA / "devices").glob("*.yaml")))
        raise ValueError(
            f"'{name}' is neither a file nor a shipped device file. Shipped device files: {names}"
        )
    return str(shipped)


def probe(scene, poses, model=None, points=False):
    """Contact wrenches at poses, without memory: neither blend nor hold, no effects, no coupling.
    Bit-identical to `voxtouch probe`.

    scene   file, or the name of a shipped scene
    poses   n rows of qw, qx, qy, qz, x, y, z: the tool in the world [-, m]; quaternions of any norm
            in [1e-3, 1e3]
    model   original, adapted or field; None: the scene's
    points  True adds the ids of the shell points in surface voxels

    A dict: force_n and torque_nm (n x 3, world axes, torque about the tool's origin), surface_hits
    and interior_hits (n), coherence (n, 0 to 1: how much normals agree), warnings (sentences),
    points (a list of n arrays, where asked for). Builds the scene at each call, which takes 0.1 s
    to a few seconds: give it all poses at once. Other threads run meanwhile."""
    return _core.probe(
        scene_file(scene), numpy.asarray(poses, dtype=float), model or "", points, READER
    )


def build(mesh, voxel, scale=1.0, origin=None):
    """Voxels and pointshell of a mesh (OBJ, STL, PLY, glTF/GLB, COLLADA). Bit-identical to
    `voxtouch build`.

    voxel   edge of a voxel [m]
    scale   metres for one unit of the file, such as 0.001 for millimetres
    origin  x, y, z of the grid [m]; None: clear of the mesh's faces

    A dict: surface and interior (n x 3 voxel indices i, j, k), points_m, normals (unit, into the
    solid) and areas_m2 of the shell, a point for each surface voxel in their order by (i, j, k);
    voxel_m, origin_m, closed (whether the mesh has an inside), warnings (sentences)."""
    return _core.build(
        str(mesh),
        float(voxel),
        float(scale),
        None if origin is None else [float(x) for x in origin],
        READER,
    )


def design(
    device,
    scene=None,
    hand=None,
    kind="auto",
    cutoff_hz=5.0,
    gain_margin=2.0,
    stiffness_n_per_m=0.0,
    gripped=False,
    damping=True,
):
    """The virtual coupling that fits a device, the hands that may hold it and a contact: the dict
    that `voxtouch design --json` prints.

    device  sim-phantom, sim-lwr, phantom, lwr, fr3, a device file (.yaml), or sim:NAME of a shipped
            one
    scene   file or shipped name, whose contact and requests are met; None: whatever the device can
            show, or stiffness_n_per_m [N/m, at the hand]
    hand    pen, arm or any_passive; None: the scene's, else how the device is gripped
    kind    auto, shaping_filter, spring_damper or direct
    cutoff_hz, gain_margin  requested cut-off of the filter [Hz], and how much stiffer the worst
    case
                            may get before it is unstable [-]
    gripped the device is always gripped;  damping  injected damping may be used

    "status" says whether anything holds; figures are at the hand.
    """
    return json.loads(
        _core.design(
            device_word(device),
            "" if scene is None else scene_file(scene),
            hand or "",
            kind,
            float(cutoff_hz),
            float(gain_margin),
            float(stiffness_n_per_m),
            bool(gripped),
            bool(damping),
            READER,
        )
    )

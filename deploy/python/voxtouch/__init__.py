"""voxtouch for Python: recorded runs as arrays, contacts and couplings computed in this process,
every topic typed.

    import voxtouch
    bag = voxtouch.open_bag("~/.local/share/voxtouch/recordings/cup-...")      # sqlite3 or MCAP
    force = bag["/haptic/coupling/command"]["wrench"]["force"]["z"]             # [N], a numpy array

    poses = [[1, 0, 0, 0, 0, 0, 0.05]]                                          # qw qx qy qz [-], x
    y z [m]: tool in the world
    voxtouch.probe("cup", poses)["force_n"]                                     # n rows of 3 [N],
    in the world's axes

    voxtouch.design("sim-phantom", "cup")["status"]                             # what `voxtouch
    design --json` says

    from voxtouch.types import TOPICS, join                                     # needs `pip install
    voxtouch[dds]` for state in TOPICS["device/state"].reader(join(domain=0)).take_iter():
        print(state.pose.position)

Lengths are m, forces N, torques Nm, times ns where a name ends in _ns and s else; quaternions w x y
z. Errors are exceptions with a sentence: ValueError for an argument, BagError for a bag,
RuntimeError for a scene, a mesh or a device. """
from ._core import version as __version__
from .bag import Bag, BagError, open_bag
from .compute import build, design, probe, shipped_scenes

__all__ = [
    "Bag",
    "BagError",
    "build",
    "design",
    "open_bag",
    "probe",
    "shipped_scenes",
    "__version__",
]

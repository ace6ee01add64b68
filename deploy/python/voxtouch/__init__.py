"""voxtouch for Python: recordings as arrays, contacts and couplings in this process, typed topics.

    import voxtouch

    # A recording, sqlite3 or MCAP: forces [N] as a numpy array.
    bag = voxtouch.open_bag("~/.local/share/voxtouch/recordings/cup-...")
    force = bag["/haptic/coupling/command"]["wrench"]["force"]["z"]

    # Tool poses in the world, qw qx qy qz [-], x y z [m]: n rows of 3 forces [N], world axes.
    poses = [[1, 0, 0, 0, 0, 0, 0.05]]
    voxtouch.probe("cup", poses)["force_n"]

    # The dict that `voxtouch design --json` prints.
    voxtouch.design("sim-phantom", "cup")["status"]

    # Topics; needs `pip install voxtouch[dds]`.
    from voxtouch.types import TOPICS, join

    for state in TOPICS["device/state"].reader(join(domain=0)).take_iter():
        print(state.pose.position)

Units are m, N, Nm; times are ns if a name ends in _ns, else s; quaternions are w x y z. Errors are
exceptions with a sentence: ValueError for an argument, BagError for a bag, RuntimeError for a
scene, a mesh or a device.
"""

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

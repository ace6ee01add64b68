#!/usr/bin/env python3
"""Forces over time, drawn from a bag that voxtouch has recorded.

usage: plot_forces.py BAG PICTURE.png [--rig haptic] [--from S] [--to S]

Red: magnitude of the collision force that the rendering computed. Orange, in scenes with effects: of all that is for the hand, contact
and effects together, or the grip on a body. Blue: of the force that the coupling returned to the hand. Below: how deep the deepest shell point is in its voxel's tangent plane (one layer at most), and the validator's gap, which is
negative where the objects overlap. Times count from the first contact message in the bag. Needs
python3-matplotlib; reads the bag with the standard library alone.
"""
import argparse
import pathlib
import sqlite3
import struct
import sys


def messages(bag, topic):
    """CDR payloads (without encapsulation) of a topic, in order of arrival."""
    for file in sorted(pathlib.Path(bag).glob("*.db3")):
        connection = sqlite3.connect(f"file:{file}?mode=ro", uri=True)
        yield from (data[4:] for (data,) in connection.execute(
            "SELECT data FROM messages WHERE topic_id = (SELECT id FROM topics WHERE name = ?) ORDER BY id", (topic,)))
        connection.close()


# Where things stand in a ContactState and a ForceCommand, behind the encapsulation (idl/msg): three 64-bit numbers come first.
TOOL, OBJECT, CONTACT_WRENCH, EFFECTS = 24, 80, 136, 424
DEPTH = CONTACT_WRENCH + 48 + 24 + 24
COMMAND_WRENCH = 32


def norm(v):
    return sum(x * x for x in v) ** 0.5


def read(bag, rig):
    """Lists (time s, value) of collision force, all force, returned force, depth, gap, and heights of tool and object."""
    raw, every, returned, depth, gap, tool, lying = [], [], [], [], [], [], []
    for m in messages(bag, f"/{rig}/rendering/contact"):
        _, _, t = struct.unpack_from("<QQq", m)
        force, beside = struct.unpack_from("<3d", m, CONTACT_WRENCH), struct.unpack_from("<3d", m, EFFECTS)
        raw.append((t * 1e-9, norm([a - b for a, b in zip(force, beside)])))
        every.append((t * 1e-9, norm(force)))
        tool.append((t * 1e-9, struct.unpack_from("<3d", m, TOOL)[2] * 1e3))
        lying.append((t * 1e-9, struct.unpack_from("<3d", m, OBJECT)[2] * 1e3))
        depth.append((t * 1e-9, struct.unpack_from("<d", m, DEPTH)[0] * 1e3))
    for m in messages(bag, f"/{rig}/coupling/command"):
        _, _, t = struct.unpack_from("<QQq", m)
        returned.append((t * 1e-9, norm(struct.unpack_from("<3d", m, COMMAND_WRENCH))))
    for m in messages(bag, f"/{rig}/validation"):
        _, _, t = struct.unpack_from("<QQq", m)
        gap.append((t * 1e-9, struct.unpack_from("<d", m, 24)[0] * 1e3))
    return raw, every, returned, depth, gap, tool, lying


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag", help="folder of the bag")
    parser.add_argument("picture", help="file to write; its ending says the format: png, pdf, svg")
    parser.add_argument("--rig", default="haptic", help="rig name (default: haptic)")
    parser.add_argument("--from", dest="begin", type=float, default=0.0, metavar="S", help="first second shown")
    parser.add_argument("--to", dest="end", type=float, default=float("inf"), metavar="S", help="last second shown")
    parser.add_argument("--title", help="default: the bag's name")
    a = parser.parse_args()
    if not any(pathlib.Path(a.bag).glob("*.db3")):
        sys.exit(f"{a.bag}: there is no bag here; name the folder that holds metadata.yaml and a .db3 file.")
    try:
        import matplotlib
    except ImportError:
        sys.exit("plot_forces.py needs matplotlib: apt-get install python3-matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    try:
        raw, every, returned, depth, gap, tool, lying = read(a.bag, a.rig)
    except sqlite3.Error as error:
        sys.exit(f"{a.bag}: the bag cannot be read ({error}); is it whole?")
    if not raw:
        sys.exit(f"{a.bag}: no messages on /{a.rig}/rendering/contact; is this a voxtouch bag, and --rig right?")
    start, length = raw[0][0], raw[-1][0] - raw[0][0]
    if not any(a.begin <= t - start <= a.end for t, _ in raw):
        sys.exit(f"{a.bag}: nothing between --from {a.begin:g} and --to {a.end:g}; the recording lasts {length:.3g} s.")
    cut = lambda s: zip(*[(t - start, v) for t, v in s if a.begin <= t - start <= a.end]) if s else ((), ())
    is_body = any(abs(x[1] - y[1]) > 1e-6 for x, y in zip(tool, lying))
    figure, axes = plt.subplots(3 if is_body else 2, 1, sharex=True, figsize=(10, 7.4 if is_body else 5.6),
                                height_ratios=(2, 1, 1)[:3 if is_body else 2], constrained_layout=True)
    top, bottom = axes[0], axes[-1]
    top.plot(*cut(raw), color="tab:red", lw=0.6, zorder=3, label="collision force (rendering)")
    if any(abs(x[1] - y[1]) > 1e-9 for x, y in zip(raw, every)):
        top.plot(*cut(every), color="tab:orange", lw=0.8, zorder=2,
                 label="grip on the body (rendering)" if is_body else "contact and effects (rendering)")
    if is_body:
        axes[1].plot(*cut(tool), color="tab:blue", lw=1.2, label="height of the tool")
        axes[1].plot(*cut(lying), color="tab:red", lw=1.2, label="height of the body")
        axes[1].set_ylabel("[mm]")
        axes[1].legend(loc="upper right", ncols=2, framealpha=0.9, edgecolor="none")
    top.plot(*cut(returned), color="tab:blue", lw=1.6, label="returned force (coupling)")
    top.set_ylabel("force [N]")
    top.set_title(pathlib.Path(a.bag).resolve().name if a.title is None else a.title)
    top.legend(loc="upper right", frameon=False, ncols=3)
    top.margins(y=0.15)  # room for the legend
    bottom.plot(*cut(depth), color="tab:green", lw=0.8, label="depth of the deepest point (rendering)")
    bottom.plot(*cut(gap), color="black", lw=1.0, ls="--", label="gap, < 0: overlap (validator)")
    bottom.axhline(0, color="0.7", lw=0.6)
    bottom.set_ylim(-8, 12)
    bottom.set_ylabel("[mm]")
    bottom.set_xlabel("time [s]")
    bottom.legend(loc="upper right", ncols=2, framealpha=0.9, edgecolor="none")
    try:
        figure.savefig(a.picture, dpi=110)
    except (OSError, ValueError) as error:
        sys.exit(f"{a.picture} could not be written: {error}")


if __name__ == "__main__":
    main()

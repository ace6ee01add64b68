#!/usr/bin/env python3
"""Forces over time, drawn from a bag that voxtouch has recorded.

usage: plot_forces.py BAG PICTURE.png [--rig haptic] [--from S] [--to S]

Thin line: collision force that the rendering computed. Thick line: force that the coupling returned to the hand (device axes,
here turned back only by their magnitude). Below: how deep the deepest shell point is in its voxel's tangent plane, and the
validator's gap. Needs python3-matplotlib; reads the bag with the standard library alone.
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


def norm(v):
    return sum(x * x for x in v) ** 0.5


def read(bag, rig):
    """Lists (time s, value) of raw force, returned force, depth, gap."""
    raw, returned, depth, gap = [], [], [], []
    for m in messages(bag, f"/{rig}/rendering/contact"):
        _, _, t = struct.unpack_from("<QQq", m)
        force = struct.unpack_from("<3d", m, 24 + 56)
        raw.append((t * 1e-9, norm(force)))
        depth.append((t * 1e-9, struct.unpack_from("<d", m, 24 + 56 + 48 + 48)[0] * 1e3))
    for m in messages(bag, f"/{rig}/coupling/command"):
        _, _, t = struct.unpack_from("<QQq", m)
        returned.append((t * 1e-9, norm(struct.unpack_from("<3d", m, 32))))
    for m in messages(bag, f"/{rig}/validation"):
        _, _, t = struct.unpack_from("<QQq", m)
        gap.append((t * 1e-9, struct.unpack_from("<d", m, 24)[0] * 1e3))
    return raw, returned, depth, gap


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag")
    parser.add_argument("picture")
    parser.add_argument("--rig", default="haptic")
    parser.add_argument("--from", dest="begin", type=float, default=0.0)
    parser.add_argument("--to", dest="end", type=float, default=1e18)
    parser.add_argument("--title", default="")
    a = parser.parse_args()
    try:
        import matplotlib
    except ImportError:
        sys.exit("plot_forces.py needs matplotlib: apt-get install python3-matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    raw, returned, depth, gap = read(a.bag, a.rig)
    if not raw:
        sys.exit(f"{a.bag}: no messages on /{a.rig}/rendering/contact; is this a voxtouch bag, and --rig right?")
    start = raw[0][0]
    cut = lambda s: zip(*[(t - start, v) for t, v in s if a.begin <= t - start <= a.end]) if s else ((), ())
    figure, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(10, 5.6), height_ratios=(2, 1), constrained_layout=True)
    top.plot(*cut(raw), color="tab:red", lw=0.6, label="collision force (rendering)")
    top.plot(*cut(returned), color="tab:blue", lw=1.6, label="returned force (coupling)")
    top.set_ylabel("force [N]")
    top.set_title(a.title)
    top.legend(loc="upper right", frameon=False)
    bottom.plot(*cut(depth), color="tab:green", lw=0.8, label="depth at the deepest point (rendering)")
    bottom.plot(*cut(gap), color="black", lw=1.0, ls="--", label="gap (validator)")
    bottom.axhline(0, color="0.7", lw=0.6)
    bottom.set_ylim(-8, 8)
    bottom.set_ylabel("[mm]")
    bottom.set_xlabel("time [s]")
    bottom.legend(loc="upper right", frameon=False)
    figure.savefig(a.picture, dpi=110)


if __name__ == "__main__":
    main()

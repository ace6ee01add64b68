#!/usr/bin/env python3
"""Draws what a running ring commands: force over the last seconds, and the energy account of the
passivity observer.

It only listens, with best effort: a slow picture never slows the ring. Needs voxtouch[dds,plot].
For example:
    voxtouch up cup --motion slide &
    live_plot.py
"""

import argparse
import collections
import time

import matplotlib
import numpy
from voxtouch.types import TOPICS, join


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--domain", type=int, default=0, help="DDS domain of the ring (default: 0)")
    parser.add_argument("--interface", default="lo", help="network card of the ring (default: lo)")
    parser.add_argument("--rig", default="haptic", help="rig (default: haptic)")
    parser.add_argument(
        "--span", type=float, default=5.0, help="length of the plot [s] (default: 5)"
    )
    parser.add_argument("--seconds", type=float, default=float("inf"), help="duration [s]")
    parser.add_argument(
        "--save",
        metavar="FILE",
        help="writes the last plot to this file, without a window (.png, .svg, .pdf)",
    )
    return parser.parse_args()


def main():
    o = arguments()
    if o.save:
        matplotlib.use("Agg")
    from matplotlib import pyplot

    reader = TOPICS["coupling/command"].reader(join(o.domain, o.interface), rig=o.rig)
    rows = collections.deque()  # (device's time [s], force x, y, z [N], energy [J])
    figure, (upper, lower) = pyplot.subplots(2, 1, sharex=True, figsize=(8, 5))
    lines = [upper.plot([], [], label=name)[0] for name in "xyz"]
    (energy,) = lower.plot([], [], color="black")
    (
        upper.set_ylabel("commanded force [N]"),
        upper.legend(loc="upper left"),
        lower.set_ylabel("energy [J]"),
        lower.set_xlabel("device's time [s]"),
    )
    end = time.monotonic() + o.seconds
    while time.monotonic() < end and (o.save or pyplot.fignum_exists(figure.number)):
        for c in reader.take(N=500):
            if not c.sample_info.valid_data:
                continue
            now = 1e-9 * c.sample_time_ns
            if rows and now < rows[-1][0]:
                rows.clear()  # a new session
            rows.append((now, c.wrench.force.x, c.wrench.force.y, c.wrench.force.z, c.energy_j))
        while rows and rows[-1][0] - rows[0][0] > o.span:
            rows.popleft()
        if rows and not o.save:
            draw(rows, lines, energy, (upper, lower))
            pyplot.pause(0.05)
        else:
            time.sleep(0.02)
    if o.save:
        if not rows:
            raise SystemExit(
                f"No command received on rig {o.rig}, domain {o.domain}, interface "
                f"{o.interface}. Check with `voxtouch status` that a ring runs."
            )
        draw(rows, lines, energy, (upper, lower))
        figure.savefig(o.save)
        print(f"{o.save}: the last {rows[-1][0] - rows[0][0]:.1f} s, {len(rows)} commands")


def draw(rows, lines, energy, axes):
    table = numpy.array(rows)
    for line, column in zip(lines, (1, 2, 3)):
        line.set_data(table[:, 0], table[:, column])
    energy.set_data(table[:, 0], table[:, 4])
    for one in axes:
        one.relim(), one.autoscale_view()


if __name__ == "__main__":
    main()

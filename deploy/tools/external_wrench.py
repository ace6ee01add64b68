#!/usr/bin/env python3
"""A spring from outside the ring: reads /<rig>/pose and writes a WrenchStamped for the effect
`external`, as a remote robot or a simulator would.

usage: external_wrench.py TYPES [--centre X Y Z] [--spring K] [--topic /sim/wrench] [--rig haptic]
       [--domain 0] [--interface lo]

TYPES: the folder that `voxtouch types --python TYPES` wrote; needs `pip install
cyclonedds==11.0.1`. Ends with Ctrl-C; the force then fades.
"""

import argparse
import dataclasses
import pathlib
import sys
import time


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("types", type=pathlib.Path, help="folder that holds voxtouch_types")
    parser.add_argument(
        "--centre",
        type=float,
        nargs=3,
        default=[-0.09, -0.03, 0.05],
        metavar=("X", "Y", "Z"),
        help="target of the spring in the world [m]",
    )
    parser.add_argument(
        "--spring",
        type=float,
        default=30.0,
        help=(
            "stiffness of the spring [N/m]; at 100 poses a second it is unstable above about 100 "
            "N/m"
        ),
    )
    parser.add_argument("--topic", default="/sim/wrench", help="of the scene's effect `external`")
    parser.add_argument("--rig", default="haptic")
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--interface", default="lo")
    parser.add_argument(
        "--seconds", type=float, default=float("inf"), help="duration [s]; default: until Ctrl-C"
    )
    return parser.parse_args()


def main():
    asked = arguments()
    sys.path.insert(0, str(asked.types))
    from voxtouch_types import TOPICS, join

    participant = join(domain=asked.domain, interface=asked.interface)
    poses = TOPICS["pose"].reader(participant, rig=asked.rig)
    row = dataclasses.replace(TOPICS["external"], path=asked.topic.lstrip("/"), outside_rig=True)
    writer, message = row.writer(participant), row.type()
    message.header.frame_id = "world"
    end = time.monotonic() + asked.seconds
    while time.monotonic() < end:
        taken = poses.take(N=64)
        if not taken:
            time.sleep(0.001)
            continue
        at, force = taken[-1].pose.position, message.wrench.force
        force.x, force.y, force.z = (
            asked.spring * (c - x) for c, x in zip(asked.centre, (at.x, at.y, at.z))
        )
        message.header.stamp = taken[-1].header.stamp
        writer.write(message)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass

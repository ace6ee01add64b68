#!/usr/bin/env python3
"""A user-defined effect, from outside the ring: a spring that pulls the tool towards a point,
written as geometry_msgs/WrenchStamped.

A scene uses it if it names the topic as an external effect (see deploy/scenes). The ring then
limits its force and slew, and fades it when it is late. Put your law into `wrench_at`. Needs
voxtouch[dds]. Stops on Ctrl-C; the last wrench then fades.
"""

import argparse
import time

import numpy
from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from voxtouch.types import TOPICS, join
from voxtouch.types.builtin_interfaces import Time
from voxtouch.types.geometry_msgs import Vector3, Wrench, WrenchStamped
from voxtouch.types.std_msgs import Header


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--topic",
        default="/my_effect/wrench",
        help="ROS name of the scene's topic (default: /my_effect/wrench)",
    )
    parser.add_argument(
        "--point",
        type=float,
        nargs=3,
        default=(0.0, 0.0, 0.03),
        metavar=("X", "Y", "Z"),
        help="in the device's base frame [m]",
    )
    parser.add_argument("--stiffness", type=float, default=20.0, help="[N/m] (default: 20)")
    parser.add_argument("--damping", type=float, default=0.2, help="[Ns/m] (default: 0.2)")
    parser.add_argument(
        "--most",
        type=float,
        default=1.0,
        help="largest force [N] (default: 1)",
    )
    parser.add_argument(
        "--frame",
        default="haptic/device",
        help="frame_id of the wrenches (default: haptic/device)",
    )
    parser.add_argument("--domain", type=int, default=0, help="DDS domain of the ring (default: 0)")
    parser.add_argument("--interface", default="lo", help="network card of the ring (default: lo)")
    parser.add_argument("--rig", default="haptic", help="rig (default: haptic)")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="duration [s]")
    return parser.parse_args()


def wrench_at(position, velocity, o):
    """Force [N] on the tool at a position [m] with a velocity [m/s], all in the device's base
    frame.
    """
    force = o.stiffness * (numpy.array(o.point) - position) - o.damping * velocity
    size = numpy.linalg.norm(force)
    return force if size <= o.most else force * (o.most / size)


def main():
    o = arguments()
    participant = join(o.domain, o.interface)
    reader = TOPICS["device/state"].reader(participant, rig=o.rig)
    # Reliable, so that each reader matches; only the last one is kept.
    writer = DataWriter(
        participant,
        Topic(participant, "rt" + o.topic, WrenchStamped),
        qos=Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.Volatile,
            Policy.History.KeepLast(1),
        ),
    )
    news = WaitSet(participant)
    news.attach(ReadCondition(reader, SampleState.NotRead | ViewState.Any | InstanceState.Any))
    end, written, session = time.monotonic() + o.seconds, 0, None
    try:
        while time.monotonic() < end:
            news.wait(duration(milliseconds=100))
            states = [s for s in reader.take(N=500) if s.sample_info.valid_data]
            if not states:
                continue
            s = states[-1]  # the newest only
            if s.session_id != session:
                session = s.session_id
                print(f"follows session {session}", flush=True)
            p, v = s.pose.position, s.twist.linear
            x, y, z = wrench_at(numpy.array([p.x, p.y, p.z]), numpy.array([v.x, v.y, v.z]), o)
            now = time.time_ns()
            writer.write(
                WrenchStamped(
                    header=Header(
                        stamp=Time(sec=now // 10**9, nanosec=now % 10**9), frame_id=o.frame
                    ),
                    wrench=Wrench(force=Vector3(x=x, y=y, z=z)),
                )
            )
            written += 1
    except KeyboardInterrupt:
        pass
    print(f"{written} wrenches written on {o.topic}")
    if not written:
        raise SystemExit(
            f"No sample received on rig {o.rig}, domain {o.domain}, interface {o.interface}. "
            f"Check with `voxtouch status` that a ring runs."
        )


if __name__ == "__main__":
    main()

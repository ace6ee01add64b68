"""The part of rclpy that deploy/examples/ros2_spring.py uses, over PyPI's cyclonedds and
voxtouch.types. ROS_DOMAIN_ID chooses the domain; spin ends after STAND_IN_SECONDS.
"""

import os
import time

from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from voxtouch.types import join


def _qos(depth):
    """The default of rclpy: reliable, volatile, keep last."""
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
    )


class _Publisher:
    def __init__(self, writer):
        self.publish = writer.write


class _Node:
    def __init__(self):
        self.participant = join(int(os.environ["ROS_DOMAIN_ID"]))
        self.subscriptions = []

    def _topic(self, kind, name):
        return Topic(self.participant, "rt" + name, getattr(kind, "TYPE", kind))

    def create_publisher(self, kind, name, depth):
        return _Publisher(DataWriter(self.participant, self._topic(kind, name), qos=_qos(depth)))

    def create_subscription(self, kind, name, callback, depth):
        reader = DataReader(self.participant, self._topic(kind, name), qos=_qos(depth))
        self.subscriptions.append((reader, callback))


def init():
    pass


def create_node(name):
    return _Node()


def spin(node):
    end = time.monotonic() + float(os.environ["STAND_IN_SECONDS"])
    while time.monotonic() < end:
        for reader, callback in node.subscriptions:
            for sample in reader.take(N=100):
                if sample.sample_info.valid_data:
                    callback(sample)
        time.sleep(0.001)

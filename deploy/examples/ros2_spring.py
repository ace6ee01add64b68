#!/usr/bin/env python3
"""A ROS 2 node (rclpy) that pulls the tool to a height of 80 mm with 30 N/m.

Start `voxtouch up cup_external --motion rest` first. The ring limits force, slew rate and energy.
"""

import rclpy
from geometry_msgs.msg import PoseStamped, WrenchStamped

rclpy.init()
node = rclpy.create_node("spring")
wrenches = node.create_publisher(WrenchStamped, "/sim/wrench", 1)


def answer(pose):
    wrench = WrenchStamped(header=pose.header)  # frame "world"; the stamp is not used
    wrench.wrench.force.z = 30.0 * (0.08 - pose.pose.position.z)
    wrenches.publish(wrench)


node.create_subscription(PoseStamped, "/haptic/pose", answer, 1)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass

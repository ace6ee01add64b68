"""Messages that start with zeros, as rclpy's do."""

from voxtouch.types import geometry_msgs as _types

PoseStamped = _types.PoseStamped


def WrenchStamped(header):
    zero = _types.Vector3(x=0.0, y=0.0, z=0.0)
    wrench = _types.Wrench(force=zero, torque=_types.Vector3(x=0.0, y=0.0, z=0.0))
    return _types.WrenchStamped(header=header, wrench=wrench)


WrenchStamped.TYPE = _types.WrenchStamped

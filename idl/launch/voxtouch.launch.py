"""A ring of voxtouch, started and stopped by ROS 2: ros2 launch voxtouch_msgs voxtouch.launch.py
scene:=cup motion:=slide rig:=left

The programs of voxtouch must be on the PATH. `more` has further arguments of `voxtouch up`, as on
its command line.
"""

import os
import shlex

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration

ARGUMENTS = {  # name: (default, meaning); an empty one is left to `voxtouch up`
    "scene": ("cup", "scene file, or the name of one that comes with voxtouch"),
    "device": ("", "haptic device"),
    "motion": ("", "what the simulated hand does"),
    "rig": ("", "namespace of the ring"),
    "more": ("", "further options of `voxtouch up`"),
}
OPTIONS = ("device", "motion", "rig")  # each is an option of `voxtouch up` of the same name


def ring(context):
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    command = ["voxtouch", "up", value["scene"]]
    for name in OPTIONS:
        command += [f"--{name}", value[name]] if value[name] else []
    # In Humble the messages that list nodes have another layout than in later ROS 2 releases.
    command += ["--ros", "humble" if os.environ.get("ROS_DISTRO") == "humble" else "iron"]
    # A ring stops in order, device first: it is given the time for it.
    return [
        ExecuteProcess(
            cmd=command + shlex.split(value["more"]),
            output="screen",
            sigterm_timeout="20",
            on_exit=Shutdown(),
        )
    ]


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument(name, default_value=default, description=what)
            for name, (default, what) in ARGUMENTS.items()
        ]
        + [OpaqueFunction(function=ring)]
    )

"""The message package of a ROS 2 workspace: its dependencies are declared, and its launch file
starts a ring.

usage: workspace_test.py IDL BIN [arguments of unittest]

ROS is not installed: classes with the same arguments replace `launch`.
"""

import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import types
import unittest
import xml.etree.ElementTree

IDL, BIN = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
DOMAIN = "97"


class Package(unittest.TestCase):
    def setUp(self):
        self.package = xml.etree.ElementTree.parse(IDL / "package.xml").getroot()
        self.cmake = (IDL / "CMakeLists.txt").read_text()

    def test_both_files_list_the_packages_of_its_messages(self):
        fields = re.compile(r"^([a-z][a-z0-9_]*)/[A-Z]\w*", re.MULTILINE)
        used = {
            package
            for file in [*IDL.glob("msg/*.msg"), *IDL.glob("srv/*.srv")]
            for package in fields.findall(file.read_text())
        } - {"voxtouch_msgs"}
        self.assertIn("geometry_msgs", used)
        self.assertEqual({tag.text for tag in self.package.findall("depend")}, used)
        for package in used:
            self.assertIn(f"find_package({package} REQUIRED)", self.cmake)
        self.assertEqual(set(re.search(r"DEPENDENCIES ([^)]*)\)", self.cmake)[1].split()), used)

    def test_is_a_rosidl_interface_package(self):
        self.assertEqual(
            (self.package.get("format"), self.package.findtext("name")), ("3", "voxtouch_msgs")
        )
        self.assertEqual(self.package.findtext("member_of_group"), "rosidl_interface_packages")
        self.assertEqual(
            self.package.findtext("export/build_type"), self.package.findtext("buildtool_depend")
        )
        self.assertEqual(self.package.findtext("build_depend"), "rosidl_default_generators")
        self.assertEqual(
            [tag.text for tag in self.package.findall("exec_depend")],
            ["rosidl_default_runtime", "launch"],
        )
        self.assertIn("install(DIRECTORY launch DESTINATION share/${PROJECT_NAME})", self.cmake)


class Launch(unittest.TestCase):
    def described(self):
        """The launch file's description, made of replacements."""

        class Said:
            def __init__(self, *positional, **named):
                self.positional, self.named = positional, named

        class ExecuteProcess(Said):
            def __init__(self, *, cmd, output, sigterm_timeout, on_exit):
                super().__init__(
                    cmd=cmd, output=output, sigterm_timeout=sigterm_timeout, on_exit=on_exit
                )

        class LaunchConfiguration(Said):
            def perform(self, context):
                return context[self.positional[0]]

        launch, actions, substitutions = (
            types.ModuleType(name) for name in ("launch", "launch.actions", "launch.substitutions")
        )
        launch.LaunchDescription = Said
        actions.ExecuteProcess, substitutions.LaunchConfiguration = (
            ExecuteProcess,
            LaunchConfiguration,
        )
        actions.DeclareLaunchArgument, actions.OpaqueFunction, actions.Shutdown = (
            type(name, (Said,), {})
            for name in ("DeclareLaunchArgument", "OpaqueFunction", "Shutdown")
        )
        sys.modules.update({module.__name__: module for module in (launch, actions, substitutions)})
        spec = importlib.util.spec_from_file_location(
            "voxtouch_launch", IDL / "launch/voxtouch.launch.py"
        )
        file = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(file)
        return file.generate_launch_description().positional[0]

    def command(self, **given):
        *arguments, ring = self.described()
        context = {one.positional[0]: one.named["default_value"] for one in arguments}
        self.assertTrue(all(one.named["description"] for one in arguments))
        self.assertLessEqual(set(given), set(context))
        [process] = ring.named["function"](context | given)
        return process.named["cmd"]

    def test_leaves_unset_options_to_up(self):
        os.environ.pop("ROS_DISTRO", None)
        self.assertEqual(self.command(), ["voxtouch", "up", "cup", "--ros", "iron"])
        os.environ["ROS_DISTRO"] = "humble"
        self.assertEqual(self.command(scene="plane")[-2:], ["--ros", "humble"])
        os.environ["ROS_DISTRO"] = "jazzy"
        self.assertEqual(self.command(scene="plane")[-2:], ["--ros", "iron"])

    def test_starts_a_ring_with_every_option(self):
        command = self.command(
            scene="cup",
            device="sim-phantom",
            motion="slide",
            rig="left",
            more=f"--domain {DOMAIN} --no-record --lockstep --duration 0.5",
        )
        environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}
        ran = subprocess.run(
            command, capture_output=True, text=True, timeout=120, check=False, env=environment
        )
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)
        self.assertIn("PASSED", ran.stdout + ran.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""An installation alone: it does not contain the build folder's path, its programs run from any
folder, deploy/examples/contact builds against it, and its bag goes to the user's data folder.

usage: installed_test.py BUILD CMAKE
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
BUILD, CMAKE = pathlib.Path(sys.argv.pop(1)).resolve(), sys.argv.pop(1)


def run(*command, **options):
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=300, **options
    )
    if done.returncode:
        raise AssertionError(
            f"{command} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}"
        )
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="voxtouch_test_installed_")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.at = pathlib.Path(cls.folder.name)
        cls.prefix = cls.at / "moved"
        run(CMAKE, "--install", BUILD, "--prefix", cls.at / "prefix")
        (cls.at / "prefix").rename(cls.prefix)  # it must not depend on its original path
        cls.elsewhere = cls.at / "elsewhere"
        cls.elsewhere.mkdir()

    def environment(self, **more):
        return {
            **{k: v for k, v in os.environ.items() if k != "XDG_DATA_HOME"},
            "HOME": str(self.at / "home"),
            **more,
        }

    def test_names_no_build_folder(self):
        source = HERE.parents[2]
        for file in self.prefix.rglob("*"):
            if (
                file.is_file()
                and not file.is_symlink()
                and file.suffix in (".cmake", ".py", ".yaml", ".hpp", ".xml", ".md", "")
            ):
                if file.parent.name == "bin" and not file.read_bytes().startswith(b"#!"):
                    continue
                self.assertNotIn(str(source).encode() + b"/", file.read_bytes(), file)

    def test_runs_a_scene_by_its_name_from_any_folder(self):
        for program in ("device", "rendering", "coupling", "logger", "validator"):
            self.assertTrue((self.prefix / "bin" / f"voxtouch_{program}").exists(), program)
        output = run(
            self.prefix / "bin/voxtouch",
            "up",
            "cup",
            "--motion",
            "slide",
            "--lockstep",
            "--duration",
            "2",
            "--domain",
            "54",
            "--json",
            cwd=self.elsewhere,
            env=self.environment(),
        )
        summary = json.loads(output)
        self.assertTrue(summary["ok"])
        self.assertEqual(list(self.elsewhere.iterdir()), [])
        bags = list((self.at / "home/.local/share/voxtouch/recordings").iterdir())
        self.assertEqual(
            [re.sub(r"\d", "0", bag.name) for bag in bags], ["cup-00000000-000000-domain00"]
        )

    def test_reports_where_it_cannot_record(self):
        if os.geteuid() == 0:
            home = "/proc"  # none may write there, root neither
        else:
            home = "/"
        done = subprocess.run(
            [
                self.prefix / "bin/voxtouch",
                "up",
                "cup",
                "--lockstep",
                "--duration",
                "1",
                "--domain",
                "54",
            ],
            capture_output=True,
            text=True,
            timeout=60,
            cwd=self.elsewhere,
            env=self.environment(HOME=home),
        )
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"Cannot create .* another (folder|with --record)")

    def test_external_program_builds_against_it(self):
        run(
            CMAKE,
            "-S",
            HERE.parents[2] / "deploy/examples/contact",
            "-B",
            self.at / "consumer",
            f"-DCMAKE_PREFIX_PATH={self.prefix}",
            "-DCMAKE_BUILD_TYPE=Debug",
        )
        run(CMAKE, "--build", self.at / "consumer")
        output = run(self.at / "consumer/contact", self.prefix / "share/voxtouch/scenes/cup.yaml")
        force = float(re.fullmatch(r"([\d.]+) N at most\n", output).group(1))
        self.assertGreater(force, 0.1)  # the slide wants 3 mm of depth in the cup
        self.assertLess(force, 100.0)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""Output of the build progress: a synthetic build folder, and the arithmetic of the remaining
time."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import build_progress

NINJA = """rule cc
  command = true
  description = Building CXX object $out
rule bad
  command = echo 'a.cpp:1: error: planted'; exit 1
  description = Building CXX object $out
build one.o: cc
build two.o: bad
build good: phony one.o
"""


class BuildProgress(unittest.TestCase):
    def test_remaining_time_is_the_mean_rate(self):
        self.assertEqual(build_progress.remaining(60.0, 30, 120), 180.0)
        self.assertIsNone(build_progress.remaining(5.0, 0, 120))
        self.assertIsNone(build_progress.remaining(60.0, 1, 278), "one unit says little")

    def test_durations_are_minutes_and_seconds(self):
        self.assertEqual(
            [build_progress.duration(s) for s in (1.0, 44.0, 59.0, 204.0)],
            ["10 s", "40 s", "1 min 0 s", "3 min 20 s"],
        )

    def test_counts_compilations_only(self):
        lines = (
            "[1/9] Building CXX object a.o",
            "[2/9] Building C object b.o",
            "[3/9] Linking CXX executable c",
            "Building CXX object",
        )
        self.assertEqual(
            [build_progress.compiled(line) for line in lines], ["a.o", "b.o", None, None]
        )

    def test_a_unit_weighs_its_sources(self):
        folder = "tests/runner"
        source = pathlib.Path(build_progress.__file__)
        with tempfile.TemporaryDirectory() as build:
            one = f"{folder}/CMakeFiles/x.dir/{source.name}.o"
            of_one = build_progress.weight(build, one)
            self.assertEqual(of_one, build_progress.HEADERS + source.stat().st_size)
            joined = pathlib.Path(build) / folder / "CMakeFiles/x.dir/Unity/unity_0_cxx.cxx"
            joined.parent.mkdir(parents=True)
            joined.write_text(f'#include "{source}"\n#include "{source}"\n')
            of_two = build_progress.weight(
                build, f"{folder}/CMakeFiles/x.dir/Unity/unity_0_cxx.cxx.o"
            )
            self.assertEqual(of_two, build_progress.HEADERS + 2 * source.stat().st_size)
            self.assertEqual(build_progress.weight(build, "idl/made.c.o"), build_progress.HEADERS)

    def run_in(self, *targets):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "build.ninja").write_text(NINJA)
            return subprocess.run(
                [sys.executable, build_progress.__file__, folder, *targets],
                capture_output=True,
                text=True,
            )

    def test_reports_the_plan_at_once(self):
        done = self.run_in("good")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("building good: 1 units to compile", done.stderr)

    def test_passes_errors_and_status_on(self):
        done = self.run_in("two.o")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("a.cpp:1: error: planted", done.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)

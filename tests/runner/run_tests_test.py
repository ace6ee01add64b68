#!/usr/bin/env python3
"""Output of `deploy/test` for failing tests: planted ones, in a synthetic build folder.

usage: run_tests_test.py RUN_TESTS
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

RUN_TESTS = sys.argv.pop(1)
sys.path.insert(0, str(pathlib.Path(RUN_TESTS).resolve().parent))
import run_tests  # noqa: E402

HEAD = (
    "[==========] Running 3 tests from 1 test suite.\n[ RUN      ] Guard.Holds\n[       OK ]"
    " Guard.Holds (0 ms)\n[ RUN      ] Guard.{0}\n"
)
END = (
    "[  FAILED  ] Guard.{0} (0 ms)\n[ RUN      ] Guard.Last\n[       OK ] Guard.Last (0 ms)\n[ "
    " FAILED  ] Guard.{0}\n"
)
GOOD = "exit 0"
LAST = f"printf '{HEAD.format('Fails')}[  FAILED  ] Guard.Fails (0 ms)\n'; exit 1".replace(
    "\n", "\\n"
)
BAD = f"printf '{HEAD.format('Fails') + END.format('Fails')}'; exit 1".replace("\n", "\\n")
CRASHING = f"printf '{HEAD.format('Crashes')}'; kill -SEGV $$".replace("\n", "\\n")
ONCE = (
    "if [ -e been ]; then exit 0; fi; touch been; printf"
    f" '{HEAD.format('OfALateRing') + END.format('OfALateRing')}'; exit 1".replace("\n", "\\n")
)


class Runner(unittest.TestCase):
    def run_with(self, **programs):
        """(exit status, the final output, the folder) of a run of these shell scripts as tests."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        build = pathlib.Path(folder.name)
        (build / "CTestTestfile.cmake").write_text(
            "".join(f'add_test({name} /bin/sh "{build / name}.sh")\n' for name in programs)
        )
        (build / ".ninja_log").write_text("# ninja log v5\n")
        for name, text in programs.items():
            (build / f"{name}.sh").write_text(text + "\n")
        done = subprocess.run([RUN_TESTS, build], capture_output=True, text=True)
        return done.returncode, done.stderr, build

    def test_prints_nothing_more_on_success(self):
        status, output, build = self.run_with(devices_test=GOOD, wire_test=GOOD)
        self.assertEqual(
            (status, "fail" in output.lower().replace("0 failed", ""), (build / "failed").exists()),
            (0, False, False),
            output,
        )
        self.assertIn("2 passed, 0 failed", output)

    def test_prints_the_plan_at_once(self):
        _, output, _ = self.run_with(devices_test=GOOD, wire_test=GOOD)
        self.assertTrue(output.startswith("running 2 tests"), output)

    def test_remaining_time_is_that_of_the_longer_queue(self):
        tests = {"a": (30.0, True), "b": (50.0, True), "c": (20.0, False), "d": (None, False)}
        self.assertAlmostEqual(run_tests.remaining(tests), 80.0)
        self.assertAlmostEqual(run_tests.remaining({"c": (20.0, False), "e": (60.0, False)}), 40.0)
        self.assertIsNone(run_tests.remaining({"d": (None, False)}))
        self.assertEqual(run_tests.remaining({}), 0.0)

    def test_reads_the_lines_of_ctest(self):
        self.assertEqual(
            run_tests.ended_test(
                "  3/12 Test  #7: All/W.T/l  # GetParam() = l ...   Passed    1.50 sec\n"
            ),
            ("All/W.T/l  # GetParam() = l", 1.5),
        )
        self.assertEqual(
            run_tests.ended_test("12/12 Test #12: bus_test ........***Failed    0.21 sec\n"),
            ("bus_test", 0.21),
        )
        self.assertIsNone(run_tests.ended_test("      Start  7: bus_test\n"))

    def test_reads_the_seconds_that_ctest_keeps(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "Testing/Temporary/CTestCostData.txt"
            file.parent.mkdir(parents=True)
            file.write_text(
                "All/Wire.Touches/lwr  # GetParam() = lwr 1 8.97\nnever_run 0 0\n---\nfailed_test\n"
            )
            self.assertEqual(
                run_tests.known_seconds(pathlib.Path(folder)),
                {"All/Wire.Touches/lwr  # GetParam() = lwr": 8.97},
            )

    def test_hides_programs_of_other_packages(self):
        with tempfile.TemporaryDirectory() as folder:
            planted = pathlib.Path(folder) / "planted"
            planted.write_text("#!/bin/sh\nexit 0\n")
            planted.chmod(0o755)
            with unittest.mock.patch.dict(os.environ, {"PATH": f"{folder}:{os.environ['PATH']}"}):
                status, output, _ = self.run_with(devices_test="planted")
        self.assertEqual(status, 1, output)

    def test_names_the_case_that_fails_twice(self):
        status, output, build = self.run_with(devices_test=BAD, wire_test=GOOD)
        self.assertEqual(status, 1, output)
        last = output[output.index("FAILED twice") :]
        self.assertIn("devices_test: Guard.Fails ", last)
        self.assertNotIn("Guard.Holds", last)
        self.assertNotIn("was running", last)
        self.assertNotIn("passed alone", output)
        self.assertEqual(
            sorted(f.name for f in (build / "failed").iterdir()),
            ["devices_test.alone.txt", "devices_test.with_others.txt"],
        )

    def test_distinguishes_a_failed_last_case_from_a_crash(self):
        _, output, _ = self.run_with(devices_test=LAST)
        self.assertIn("devices_test: Guard.Fails ", output)
        self.assertNotIn("was running", output)

    def test_names_the_case_that_crashes(self):
        status, output, _ = self.run_with(devices_test=CRASHING)
        self.assertEqual(status, 1, output)
        self.assertIn("devices_test: Guard.Crashes (", output[output.index("FAILED twice") :])

    def test_reports_a_single_failure_and_keeps_its_output(self):
        status, output, build = self.run_with(ring_test=ONCE, devices_test=GOOD)
        self.assertEqual(status, 0, output)
        self.assertIn("ring_test: Guard.OfALateRing ", output[output.index("passed alone:") :])
        self.assertNotIn("twice", output)
        self.assertIn("Guard.OfALateRing", (build / "failed/ring_test.with_others.txt").read_text())

    def test_reports_both_kinds_and_fails(self):
        status, output, _ = self.run_with(ring_test=ONCE, devices_test=BAD)
        self.assertEqual(status, 1, output)
        self.assertIn(
            "ring_test", output[output.index("passed alone:") : output.index("FAILED twice")]
        )
        self.assertIn("devices_test", output[output.index("FAILED twice") :])

    def test_many_failures_are_not_rerun(self):
        status, output, build = self.run_with(
            **{f"ring_{n}": ONCE.replace("been", f"been{n}") for n in range(6)}
        )
        self.assertEqual(status, 1, output)
        self.assertIn("6 tests failed", output)
        self.assertEqual(len(list((build / "failed").glob("*.with_others.txt"))), 6)
        self.assertEqual(list((build / "failed").glob("*.alone.txt")), [])


if __name__ == "__main__":
    unittest.main()

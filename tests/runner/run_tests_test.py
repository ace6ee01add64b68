#!/usr/bin/env python3
"""What `deploy/test` says of tests that fail: planted ones, in a build folder that is made up.

usage: run_tests_test.py RUN_TESTS
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

RUN_TESTS = sys.argv.pop(1)
HEAD = "[==========] Running 3 tests from 1 test suite.\n[ RUN      ] Guard.Holds\n[       OK ] Guard.Holds (0 ms)\n[ RUN      ] Guard.{0}\n"
END = "[  FAILED  ] Guard.{0} (0 ms)\n[ RUN      ] Guard.Last\n[       OK ] Guard.Last (0 ms)\n[  FAILED  ] Guard.{0}\n"
GOOD = "exit 0"
LAST = f"printf '{HEAD.format('Fails')}[  FAILED  ] Guard.Fails (0 ms)\n'; exit 1".replace(
    "\n", "\\n"
)
BAD = f"printf '{HEAD.format('Fails') + END.format('Fails')}'; exit 1".replace("\n", "\\n")
CRASHING = f"printf '{HEAD.format('Crashes')}'; kill -SEGV $$".replace("\n", "\\n")
ONCE = f"if [ -e been ]; then exit 0; fi; touch been; printf '{HEAD.format('OfALateRing') + END.format('OfALateRing')}'; exit 1".replace(
    "\n", "\\n"
)


class Runner(unittest.TestCase):
    def run_with(self, **programs):
        """(exit status, what was said at the end, the folder) of a run of these shell scripts as tests."""
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

    def test_says_nothing_more_where_all_is_well(self):
        status, told, build = self.run_with(devices_test=GOOD, wire_test=GOOD)
        self.assertEqual(
            (status, "fail" in told.lower().replace("0 failed", ""), (build / "failed").exists()),
            (0, False, False),
            told,
        )
        self.assertIn("2 passed, 0 failed", told)

    def test_names_the_case_that_fails_twice(self):
        status, told, build = self.run_with(devices_test=BAD, wire_test=GOOD)
        self.assertEqual(status, 1, told)
        last = told[told.index("FAILED twice") :]
        self.assertIn("devices_test: Guard.Fails ", last)
        self.assertNotIn("Guard.Holds", last)
        self.assertNotIn("was running", last)
        self.assertNotIn("passed alone", told)
        self.assertEqual(
            sorted(f.name for f in (build / "failed").iterdir()),
            ["devices_test.alone.txt", "devices_test.beside_others.txt"],
        )

    def test_knows_a_last_case_that_fails_from_one_that_crashes(self):
        _, told, _ = self.run_with(devices_test=LAST)
        self.assertIn("devices_test: Guard.Fails ", told)
        self.assertNotIn("was running", told)

    def test_names_the_case_in_which_a_program_crashes(self):
        status, told, _ = self.run_with(devices_test=CRASHING)
        self.assertEqual(status, 1, told)
        self.assertIn("devices_test: Guard.Crashes (", told[told.index("FAILED twice") :])

    def test_tells_of_a_test_that_fails_once_and_keeps_what_it_said(self):
        status, told, build = self.run_with(ring_test=ONCE, devices_test=GOOD)
        self.assertEqual(status, 0, told)
        self.assertIn("ring_test: Guard.OfALateRing ", told[told.index("passed alone:") :])
        self.assertNotIn("twice", told)
        self.assertIn(
            "Guard.OfALateRing", (build / "failed/ring_test.beside_others.txt").read_text()
        )

    def test_tells_of_both_kinds_and_fails(self):
        status, told, _ = self.run_with(ring_test=ONCE, devices_test=BAD)
        self.assertEqual(status, 1, told)
        self.assertIn("ring_test", told[told.index("passed alone:") : told.index("FAILED twice")])
        self.assertIn("devices_test", told[told.index("FAILED twice") :])

    def test_runs_none_again_where_many_fail(self):
        status, told, build = self.run_with(
            **{f"ring_{n}": ONCE.replace("been", f"been{n}") for n in range(6)}
        )
        self.assertEqual(status, 1, told)
        self.assertIn("6 tests failed", told)
        self.assertEqual(len(list((build / "failed").glob("*.beside_others.txt"))), 6)
        self.assertEqual(list((build / "failed").glob("*.alone.txt")), [])


if __name__ == "__main__":
    unittest.main()

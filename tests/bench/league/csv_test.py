#!/usr/bin/env python3
"""A system that takes part by CSV: a row in every table, and files that cannot be used.

usage: csv_test.py
"""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import figures
import numpy as np

LEAGUE = pathlib.Path(__file__).parent / "league.py"
ROWS = "A1,A2,B,C1,C2,C4,D2,E"  # all but the meshes of 50,000 triangles and more
HEADER = "fx,fy,fz,tx,ty,tz,us"


def league(out, *options):
    return subprocess.run(
        [sys.executable, "-B", LEAGUE, "--out", out, *options], capture_output=True, text=True
    )


class ByCsv(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="voxtouch_league_")
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.rows, cls.answers = cls.folder / "rows", cls.folder / "answers"
        cls.answers.mkdir()
        run = league(cls.rows, "--rows", ROWS, "--only", "none")
        assert run.returncode == 0, run.stderr
        for folder in cls.rows.iterdir():
            if (folder / "poses.csv").exists():
                cls.write_right_answers(folder)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def write_right_answers(cls, row):
        """Forces along the expected direction: of one newton, or of a spring from the hand to
        the contact."""
        right = np.loadtxt(row / "right.csv", delimiter=",", skiprows=1, ndmin=2)
        poses = np.loadtxt(row / "poses.csv", delimiter=",", skiprows=1, ndmin=2)
        force, torque = right.copy(), np.zeros(right.shape)
        if row.name in ("B1t", "B2t", "B3t"):
            force, torque = torque, force
        touch = {"C1": 0.01, "C2": 0.01, "E1s": 0.0, "E3s": 0.04}.get(row.name.split("_")[0])
        if touch is not None:
            force = right * 500.0 * np.maximum(touch - poses[:, 6:7], 0.0)
        if row.name.startswith("C4"):
            depth = 0.05 - np.hypot(poses[:, 4], poses[:, 5])
            spring = float(row.name.split("_")[2])
            force = right * (spring * np.maximum(depth, 0.0))[:, None]
        if row.name == "D2h":
            force[:, 2] = -500.0 * poses[:, 6]
        if row.name == "D2a":
            turn = np.unwrap(2 * np.arctan2(poses[:, 3], poses[:, 0])) / (2 * np.pi)
            force[:, 2] = 500.0 * (0.0025 * turn - poses[:, 6])
        wrench = np.column_stack([force, torque, np.full(len(force), 7.0)])
        np.savetxt(cls.answers / f"{row.name}.csv", wrench, "%.9g", ",", header=HEADER, comments="")

    def add(self, folder, name="Lab 1"):
        return league(self.rows, "--rows", ROWS, "--add", name, "--csv", folder)

    def test_is_in_every_table_with_its_figures(self):
        run = self.add(self.answers)
        self.assertEqual(run.returncode, 0, run.stderr)
        text = (self.rows / "league.md").read_text(encoding="utf-8")
        table = figures.read_page(text)
        played = {row for row in table if not row.startswith(("C3", "D1", "D2l"))}
        self.assertEqual({row for row in table if "Lab 1" in table[row]}, played)
        self.assertEqual(len(played), 34)
        for row in played:
            for figure, value in table[row]["Lab 1"].items():
                if not isinstance(value, str) and (row, figure) != ("D2p", "torque"):
                    facets = row.startswith("C4") and figure == "penetration"
                    self.assertLess(value, 0.06 if facets else 0.002, f"{row} {figure}")
        self.assertIn("| 7 µs |", text)
        self.assertIn("| Lab 1 | by CSV |", text)

    def test_one_file_of_all_rows_gives_the_same_page(self):
        self.add(self.answers)
        by_folder = (self.rows / "league.md").read_text(encoding="utf-8")
        lines = ["row," + HEADER]
        for answer in sorted(self.answers.iterdir()):
            lines += [f"{answer.stem},{line}" for line in answer.read_text().splitlines()[1:]]
        file = self.folder / "all.csv"
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        run = self.add(file)
        self.assertEqual(run.returncode, 0, run.stderr)
        of_tables = by_folder[by_folder.index("## ") :]
        self.assertIn(of_tables, (self.rows / "league.md").read_text(encoding="utf-8"))
        for planted, said in (("A9,0,0,1,0,0,0,5", "'A9'"), ("A1,0,0,1,0,0,0,5", "101")):
            file.write_text("\n".join(lines + [planted]) + "\n", encoding="utf-8")
            run = self.add(file)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(f"{file}:{len(lines) + 1}: ", run.stderr)
            self.assertIn(said, run.stderr)

    def refused(self, text, row="A1"):
        """The message about this file: it begins with the file and the line."""
        with tempfile.TemporaryDirectory(prefix="voxtouch_league_") as folder:
            (pathlib.Path(folder) / f"{row}.csv").write_text(text, encoding="utf-8")
            before = (self.rows / "result.json").read_text(encoding="utf-8")
            run = self.add(folder)
            self.assertNotEqual(run.returncode, 0)
            self.assertEqual((self.rows / "result.json").read_text(encoding="utf-8"), before)
            said = run.stderr.strip().splitlines()[-1]
            self.assertNotIn("Traceback", run.stderr)
            found = re.fullmatch(rf"{re.escape(folder)}/{row}\.csv:(\d+): (.*expected.*)", said)
            self.assertTrue(found, said)
            return int(found[1]), found[2]

    def lines(self, count=100):
        return [HEADER] + ["0,0,1,0,0,0,5"] * count

    def planted(self, line, text):
        lines = self.lines()
        lines[line - 1] = text
        return self.refused("\n".join(lines) + "\n")

    def test_wrong_columns_are_refused(self):
        line, said = self.planted(1, "fx,fy,fz,us")
        self.assertEqual(line, 1)
        self.assertIn(HEADER, said)
        self.assertEqual(self.refused("")[0], 1)
        self.assertEqual(self.planted(8, "0,0,1,0,0,5")[0], 8)
        self.assertEqual(self.planted(8, "")[0], 8)
        self.assertEqual(self.planted(8, "0,0,1,0,0,0,5,6")[0], 8)

    def test_missing_and_more_poses_are_refused(self):
        for count in (0, 99, 101):
            line, said = self.refused("\n".join(self.lines(count)) + "\n")
            self.assertEqual(line, count + 1)
            self.assertIn("100", said)

    def test_nan_and_infinity_are_refused(self):
        for word in ("nan", "inf", "-inf", "", "one"):
            self.assertEqual(self.planted(51, f"0,{word},1,0,0,0,5")[0], 51, word)
        self.assertEqual(self.planted(51, "0,0,1,0,0,0,-5")[0], 51)

    def test_names_and_folders_are_validated(self):
        for name, folder in (("Coal", self.answers), ("a|b", self.answers), ("Lab", "/nowhere")):
            run = self.add(folder, name)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(f"--add {name}", run.stderr)
        with tempfile.TemporaryDirectory() as empty:
            self.assertIn("ROW.csv", self.add(empty).stderr)


if __name__ == "__main__":
    unittest.main()

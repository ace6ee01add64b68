#!/usr/bin/env python3
"""Tests the guard of the league's figures, with planted faults.

usage: figures_test.py PAGE
"""

import pathlib
import re
import sys
import unittest

import figures

PAGE = pathlib.Path(sys.argv.pop())


def worse(value):
    """A figure that is worse than `value`."""
    return "other" if isinstance(value, str) else 2 * value + 1


class Page(unittest.TestCase):
    def setUp(self):
        self.text = PAGE.read_text(encoding="utf-8")
        self.limits = figures.read_limits()

    def faults(self, text):
        return figures.check(figures.read_page(text), self.limits)

    def test_is_within_its_limits(self):
        self.assertEqual(self.faults(self.text), [])

    def test_every_row_has_figures_of_voxtouch(self):
        for row, answers in figures.read_page(self.text).items():
            self.assertTrue([s for s in answers if s.startswith(figures.OURS)], row)

    def test_a_removed_table_is_found(self):
        for row in figures.read_page(self.text):
            without = re.sub(rf"(?ms)^## {re.escape(row)}: .*?(?=^## )", "", self.text)
            self.assertNotEqual(without, self.text)
            found = self.faults(without)
            self.assertTrue(found, row)
            self.assertTrue(all(f.startswith(f"{row}, ") and "missing" in f for f in found), found)

    def test_a_removed_line_is_found(self):
        lines = self.text.splitlines(keepends=True)
        ours = [n for n, line in enumerate(lines) if line.startswith("| voxtouch")]
        tables = self.text.split("## Versions")[0].count("| voxtouch")
        for n in ours[:tables]:
            self.assertTrue(self.faults("".join(lines[:n] + lines[n + 1 :])), lines[n])

    def test_each_worse_figure_is_found(self):
        table = figures.read_page(self.text)
        for key in self.limits:
            row, system, figure = key
            kept = table[row][system][figure]
            table[row][system][figure] = worse(kept)
            self.assertEqual(len(figures.check(table, self.limits)), 1, key)
            table[row][system][figure] = float("nan")
            self.assertEqual(len(figures.check(table, self.limits)), 1, key)
            table[row][system][figure] = kept

    def test_a_worse_figure_on_the_page_is_found(self):
        for ours, planted in (
            ("| voxtouch field | 0 of 60 touched |", "| voxtouch field | 1 of 60 touched |"),
            ("| voxtouch field | 0 of 60 touched |", "| voxtouch field | 0 of 6 touched |"),
            ("0 % |", "1 % |"),
            ("voxtouch virtual tool | 1.000 of k d", "voxtouch virtual tool | 0.900 of k d"),
            ("| rests; left | no need |", "| swings 3 mm; left | no need |"),
        ):
            self.assertIn(ours, self.text)
            self.assertTrue(self.faults(self.text.replace(ours, planted, 1)), planted)

    def test_a_figure_without_a_limit_is_found(self):
        del self.limits[next(iter(self.limits))]
        self.assertEqual(len(self.faults(self.text)), 1)

    def test_competitors_are_not_gated(self):
        self.assertEqual(self.faults(re.sub(r"(?m)^\| Coal .*\n", "", self.text)), [])


class Comparison(unittest.TestCase):
    def test_finds_differences_above_a_tenth(self):
        def with_mean(mean, missed=0):
            return {"A1": {"Coal": {"mean": mean, "missed": missed}}}

        self.assertEqual(figures.compare(with_mean(2.0), with_mean(2.2)), [])
        self.assertEqual(len(figures.compare(with_mean(2.0), with_mean(2.3))), 1)
        self.assertEqual(len(figures.compare(with_mean(2.0), with_mean(2.0, 1))), 1)
        self.assertEqual(len(figures.compare(with_mean(2.0), {})), 2)
        self.assertEqual(figures.compare(with_mean(0.0), with_mean(0.009)), [])

    def test_compares_only_what_both_machines_have(self):
        old = {"A1": {"Coal": {"mean": 2.0}}, "A2": {"Coal": {"mean": 1.0}}}
        new = {"A1": {"Coal": {"mean": 3.0, "missed": 0}}, "A3": {"Coal": {"mean": 1.0}}}
        found = figures.differences(*figures.common(old, new))
        self.assertEqual(found["figures"], 1)
        self.assertEqual(found["differ"], ["A1, Coal, mean: 2 and 3"])

    def test_is_on_the_page(self):
        import page

        self.assertIn("Played once.", page.reproduction({}))
        found = {"figures": 9, "differ": ["A1, Coal, mean: 2 and 3"], "machine": "Some CPU"}
        text = " ".join(page.reproduction({"again": found, "against": found}))
        self.assertEqual(text.count("of 9 errors that both have, 1 differ by more than 10 %"), 2)
        self.assertEqual(text.count("A1, Coal, mean: 2 and 3"), 2)
        self.assertIn("Run on Some CPU", text)

    def test_the_page_names_its_machine(self):
        self.assertRegex(figures.machine_of(PAGE), r"processors, 20\d\d-\d\d-\d\d$")


class Cells(unittest.TestCase):
    def test_are_read_back_as_they_are_written(self):
        import page

        answers = {
            "direction": {
                "mean_deg": 2.5,
                "p95_deg": 4.5,
                "missed": 3,
                "of": 9,
                "torque_ratio": 1.5,
            },
            "free": {"touched": 2, "of": 60},
            "rest": {"sink_mm": 0.25, "creep_mm": 0.5},
            "loop": {"held": "swings 3 mm", "released": "left", "warned": "no"},
            "hammer": {"shift_mm": 0.25, "held": False},
            "lock": {"friction": 0.125, "expected": 0.0625},
            "spring": {
                "passed": False,
                "force_ratio": 1.5,
                "penetration_mm": -0.5,
                "mean_deg": 0.25,
                "noise": 0.005,
            },
            "advance": {"advance_mm": 2.25, "expected_mm": 2.5},
        }
        answers["torque"] = answers["direction"]
        passed = answers["spring"] | {"passed": True, "force_ratio": 0.0}
        for judge, answer in [*answers.items(), ("spring", passed)]:
            first, second, _ = page.cell(judge, answer)
            expected = figures.of_answer(judge, answer)
            self.assertEqual(figures.of_cells(first, second), expected, judge)
        self.assertEqual(figures.of_cells("refused", ""), figures.of_answer("free", "refused: why"))


if __name__ == "__main__":
    unittest.main()

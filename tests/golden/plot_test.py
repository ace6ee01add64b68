#!/usr/bin/python3
"""Pictures drawn by the verbs through voxtouch_plot and by the tool itself: complete, with measured
values; refusals with a sentence.

usage: plot_test.py BIN DEPLOY [arguments of unittest]
"""

import contextlib
import csv
import importlib.util
import io
import json
import math
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

from PIL import Image, ImageColor

BIN, DEPLOY = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
spec = importlib.util.spec_from_file_location("plot", DEPLOY / "tools" / "plot.py")
plot = importlib.util.module_from_spec(spec)
spec.loader.exec_module(plot)
sys.path.insert(
    0, str(pathlib.Path(__file__).resolve().parents[1] / "experiments" / "stability_map")
)
import draw_map  # noqa: E402
import plot_accuracy  # noqa: E402
from plot_accuracy import LEAST_DIRECTION_DEG  # noqa: E402
from plot_forces import read_run  # noqa: E402
from plot_layout import overlap  # noqa: E402

FEW = ["--voxel-sizes", "0.004,0.002", "--contacts", "8"]


def voxtouch(*words, **more):
    return subprocess.run(
        [BIN / "voxtouch", *map(str, words)], capture_output=True, text=True, **more
    )


def with_matplotlib_from(file, *words):
    """Runs the words in a mount namespace in which matplotlib is `file`: the tool takes Debian's
    Python and no other package.
    """
    at = subprocess.run(
        ["/usr/bin/python3", "-I", "-c", "import matplotlib; print(matplotlib.__file__)"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    alone = (
        ["unshare", "--user", "--map-root-user", "--mount"]
        if os.geteuid()
        else ["unshare", "--mount"]
    )
    return subprocess.run(
        [
            *alone,
            "sh",
            "-c",
            'mount --bind "$1" "$2" && shift 2 && exec "$@"',
            "sh",
            file,
            at,
            *map(str, words),
        ],
        capture_output=True,
        text=True,
    )


def tool_alone(*words, **more):
    """The tool as a child process."""
    return subprocess.run(
        [DEPLOY / "tools" / "plot.py", *map(str, words)], capture_output=True, text=True, **more
    )


def tool(*words):
    """The tool within this process, which has loaded matplotlib once and for all."""
    out, err, status = io.StringIO(), io.StringIO(), 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            plot.main(words)
        except SystemExit as end:
            status = 0 if end.code in (None, 0) else 1
            if isinstance(end.code, str):
                print(end.code, file=err)
    return subprocess.CompletedProcess(words, status, out.getvalue(), err.getvalue())


def painted(file, colour):
    """How many pixels of a picture have exactly this colour."""
    image = Image.open(file).convert("RGB")
    return dict((c, n) for n, c in image.getcolors(1 << 24)).get(ImageColor.getrgb(colour), 0)


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.at = pathlib.Path(cls.folder.name)
        run = voxtouch("accuracy", DEPLOY / "scenes/tilted_plane.yaml", *FEW, "--json")
        assert run.returncode == 0, run.stderr
        (cls.at / "run.json").write_text(run.stdout)
        cls.run_json = json.loads(run.stdout)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def refused(self, done, *says):
        """Ended with a status that is not 0 and a sentence, not with a traceback; nothing was left
        behind.
        """
        self.assertEqual(done.returncode, 1, done.stderr)
        for word in says:
            self.assertIn(word, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertEqual([p.name for p in self.at.glob("refused*")], [])

    # -------------------- the verbs
    def test_accuracy_draws_the_measured_models_only(self):
        file = self.at / "models.png"
        done = voxtouch(
            "accuracy",
            DEPLOY / "scenes/tilted_plane.yaml",
            *FEW,
            "--models",
            "adapted,field",
            "--plot",
            file,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, rf"{re.escape(str(file))} .*\b6 settings")
        with Image.open(file) as image:
            self.assertEqual(image.size, (1600, 900))
        for model, (colour, _) in plot.MODELS.items():
            with self.subTest(model):
                check = self.assertGreater if model in ("adapted", "field") else self.assertLess
                check(painted(file, colour), 200)  # the edges of black letters have some grey

    def test_design_region_holds_the_chosen_point_also_as_csv(self):
        file, table = self.at / "region.png", self.at / "region.csv"
        done = voxtouch(
            "design",
            "--device",
            "sim-phantom",
            "--kind",
            "shaping_filter",
            "--plot",
            file,
            "--csv",
            table,
            "--json",
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        data = json.loads(done.stdout)
        region, chosen = data["region"], data["translation"]["displayed_stiffness"]
        with open(table, encoding="utf-8") as lines:
            rows = list(csv.DictReader(lines))
        self.assertEqual(len(rows), 64)
        for key in rows[0]:
            self.assertEqual([float(r[key]) if r[key] else None for r in rows], region[key], key)
        above = next(
            i for i, hz in enumerate(region["cutoff_hz"]) if hz >= data["coupling"]["cutoff_hz"]
        )
        bracket = [region["certified_n_per_m"][i] for i in (above - 1, above)]
        self.assertLessEqual(
            chosen, max(bracket) * 1.001, "the chosen point is not certified in its own region"
        )
        paper, at_5_hz = (
            data["paper_recipe"],
            min(range(64), key=lambda i: abs(region["cutoff_hz"][i] - 5.0)),
        )
        self.assertGreater(
            paper["stiffness_n_per_m"],
            region["critical_undamped_n_per_m"][at_5_hz],
            "released, the paper's recipe is unstable",
        )
        for colour in (plot.BLUE, plot.GREEN, plot.RED):
            self.assertGreater(painted(file, colour), 300, colour)

    def test_design_draws_the_chosen_law_within_its_certificate(self):
        for kind in ("direct", "spring_damper"):
            file = self.at / f"{kind}.png"
            done = voxtouch(
                "design", "--device", "sim-phantom", "--kind", kind, "--plot", file, "--json"
            )
            data = json.loads(
                done.stdout
            )  # a spring-damper is infeasible here, and drawn all the same
            law, displayed = data["region"]["law"], data["translation"]["displayed_stiffness"]
            self.assertEqual(law["kind"], kind)
            place = next(i for i, x in enumerate(law["x"]) if x >= law["chosen"])
            around = [law["certified_n_per_m"][i] for i in (place - 1, place)]
            self.assertTrue(
                0.9 * min(around) < displayed < 1.001 * max(around),
                f"{kind}: {displayed} N/m is not on the border of its region: {around}",
            )
            self.assertAlmostEqual(
                law["critical_n_per_m"][place],
                data["region"]["gain_margin"] * law["certified_n_per_m"][place],
                6,
            )
            with plot.matplotlib.rc_context(plot.STYLE):
                figure = plot.design_figure(data)[0]
                self.judge(figure)
            points = [
                tuple(line.get_xydata()[0])
                for line in figure.axes[1].lines
                if line.get_marker() == "o"
            ]
            self.assertEqual(points, [(law["chosen"], displayed)])
            self.assertGreater(painted(file, plot.GREEN), 300)
        self.assertNotIn(
            "law",
            json.loads(
                voxtouch(
                    "design", "--device", "sim-phantom", "--kind", "shaping_filter", "--json"
                ).stdout
            )["region"],
        )

    def test_missing_matplotlib_is_reported_before_measuring(self):
        (self.at / "broken.py").write_text('raise ImportError("hidden by this test")\n')
        done = with_matplotlib_from(
            self.at / "broken.py",
            BIN / "voxtouch",
            "accuracy",
            DEPLOY / "scenes/tilted_plane.yaml",
            "--json",
            "--plot",
            self.at / "refused.png",
        )
        self.refused(done, "matplotlib", "install python3-matplotlib")
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        reported = json.loads(done.stdout)
        self.assertIs(reported["ok"], False)
        self.assertIn("install python3-matplotlib", reported["problems"][0])
        done = with_matplotlib_from(
            self.at / "broken.py", BIN / "voxtouch", "design", "--plot", self.at / "refused.png"
        )
        self.refused(done, "install python3-matplotlib")
        self.assertEqual(done.stdout, "")
        self.assertEqual(
            with_matplotlib_from(
                self.at / "broken.py", DEPLOY / "tools/plot.py", "--help"
            ).returncode,
            0,
        )

    def test_unwritable_picture_is_refused_before_measuring(self):
        for verb, name, says in (
            (
                ["accuracy", DEPLOY / "scenes/tilted_plane.yaml"],
                "refused.gif",
                ".png, .svg or .pdf",
            ),
            (["design"], "none/refused.png", "cannot be written"),
        ):
            done = voxtouch(*verb, "--plot", self.at / name)
            self.refused(done, name, says)
            self.assertEqual(done.stdout, "")
            self.assertNotIn(" %]", done.stderr)

    def test_picture_name_may_resemble_an_option_or_have_blanks(self):
        for name in ("--help.png", "a b; c.png"):
            done = voxtouch("design", f"--plot={name}", cwd=self.at)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((self.at / name).exists())

    # -------------------- the tool
    def test_pictures_are_complete_and_reproducible(self):
        for ending in ("svg", "pdf", "png"):
            files = [self.at / f"{name}.{ending}" for name in ("a", "b")]
            for file in files:
                self.assertEqual(tool("accuracy", self.at / "run.json", file).returncode, 0)
            self.assertEqual(files[0].read_bytes(), files[1].read_bytes(), ending)
        self.assertTrue(xml.parse(self.at / "a.svg").getroot().tag.endswith("svg"))
        self.assertTrue((self.at / "a.pdf").read_bytes().startswith(b"%PDF"))
        self.assertTrue((self.at / "a.pdf").read_bytes().rstrip().endswith(b"%%EOF"))

    def test_forces_of_a_bag_match_the_run(self):
        bag, file = self.at / "bag", self.at / "forces.png"
        run = voxtouch(
            "up",
            DEPLOY / "scenes/cup.yaml",
            "--device",
            "sim-phantom",
            "--motion",
            "slide",
            "--duration",
            "2",
            "--lockstep",
            "--one-process",
            "--record",
            bag,
            "--no-report",
            "--json",
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        summary = json.loads(run.stdout)
        self.assertGreater(summary["contact_samples"], 100)
        contact, returned, _ = read_run(bag, "haptic")
        self.assertEqual(len(contact["t"]), summary["samples"])
        self.assertEqual(
            sum(1 for force in contact["all"] if force > 1e-9), summary["contact_samples"]
        )
        self.assertAlmostEqual(max(returned["force"]), summary["max_force_n"], 5)
        self.assertGreater(max(contact["depth"]), 0.1)
        self.assertLess(max(contact["depth"]), 10.0)
        done = tool("forces", bag, file, "--note", "cup, slide, lockstep")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(
            f"{summary['samples']} samples, {summary['contact_samples']} with contact", done.stdout
        )
        for colour in (plot.ORANGE, plot.BLUE, plot.PURPLE):
            self.assertGreater(painted(file, colour), 200, colour)
        with plot.matplotlib.rc_context(plot.STYLE):
            figure = plot.forces_figure(bag)[0]
            self.judge(figure)
            self.assertIn(f" {max(returned['force']):.2g} N", figure._suptitle.get_text())
            self.assertTrue(
                any(
                    "not displayed directly" in " ".join(text.get_text().split())
                    for text in figure.axes[0].texts
                )
            )
            self.judge(plot.forces_figure(bag, note="conditions " * 40)[0])
        self.refused(tool("forces", bag, self.at / "refused.png", "--from", "50"), "--from 50")
        self.refused(
            tool("forces", bag, self.at / "refused.png", "--rig", "other"),
            "/other/rendering/contact",
        )

    def test_plots_the_distance_of_a_virtual_tool_next_to_forces(self):
        bag = self.at / "virtual_tool"
        run = voxtouch(
            *("up", "cup_virtual_tool", "--motion", "slide", "--duration", "2", "--lockstep"),
            *("--one-process", "--record", bag, "--no-report", "--json"),
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        contact, _, _ = read_run(bag, "haptic")
        self.assertTrue(contact["constrained"].any())
        with plot.matplotlib.rc_context(plot.STYLE):
            figure = plot.forces_figure(bag)[0]
            self.judge(figure)
        self.assertEqual(len(figure.axes), 2, "no row of a body")
        title = figure._suptitle.get_text()
        self.assertIn(f"{max(contact['stretch']):.2g} mm from the virtual tool", title)

    def test_tool_prints_the_version_of_its_build(self):
        reported, of_build = (
            subprocess.run(
                [BIN / program, "--version"], capture_output=True, text=True, timeout=60, check=True
            ).stdout
            for program in ("voxtouch_plot", "voxtouch")
        )
        self.assertEqual(reported, of_build)

    def test_compared_runs_have_common_axes_and_empty_bags_fail(self):
        for scene in ("cup", "cup_virtual_tool"):
            done = voxtouch(
                "up",
                DEPLOY / f"scenes/{scene}.yaml",
                "--device",
                "sim-phantom",
                "--motion",
                "hit",
                "--duration",
                "3.2",
                "--lockstep",
                "--record",
                self.at / scene,
            )
            self.assertEqual(done.returncode, 0, done.stderr)
        with plot.matplotlib.rc_context(plot.STYLE):
            figure, _ = plot.comparison_figure([self.at / "cup", self.at / "cup_virtual_tool"])
            self.judge(figure)
        self.assertEqual([len(axis.lines) for axis in figure.axes], [2, 2])
        self.refused(
            tool("compare", self.at / "cup", self.at / "nothing", self.at / "refused.png"),
            "nothing",
        )

    def test_undrawable_data_is_refused_with_a_message(self):
        (self.at / "words.json").write_text("not json")
        (self.at / "problems.json").write_text(
            '{"ok": false, "problems": ["the scene is not there"]}'
        )
        (self.at / "empty").mkdir(exist_ok=True)
        (self.at / "broken").mkdir(exist_ok=True)
        (self.at / "broken" / "a.db3").write_text(
            "no database, but long enough to be read as one" * 10
        )
        picture = self.at / "refused.png"
        self.refused(tool("accuracy", self.at / "none.json", picture), "none.json")
        self.refused(
            tool("design", self.at / "words.json", picture), "is not JSON", "voxtouch design"
        )
        self.refused(tool("design", self.at / "run.json", picture), "voxtouch design --json")
        self.refused(tool("accuracy", self.at / "problems.json", picture), "the scene is not there")
        (self.at / "old.json").write_text('{"rows": [], "request": null}')
        self.refused(tool("accuracy", self.at / "old.json", picture), "version")
        self.refused(tool("forces", self.at / "empty", picture), str(self.at / "empty"))
        self.refused(tool("forces", self.at / "broken", picture), "read (")
        self.refused(tool("check", self.at / "empty.png" / "refused.png"), "empty.png/refused.png")
        for name in ("refused.gif", "refused"):
            self.refused(
                tool("accuracy", self.at / "run.json", self.at / name), name, ".png, .svg or .pdf"
            )

    def test_full_disk_leaves_no_partial_picture(self):
        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        self.refused(
            tool_alone(
                "accuracy", self.at / "run.json", self.at / "refused.svg", preexec_fn=small_files
            ),
            "refused.svg",
        )

    # -------------------- visible content
    def judge(self, figure):
        """Every text lies within the figure, and no legend covers a curve or a mark."""
        with plot.matplotlib.rc_context(plot.STYLE):
            figure.draw_without_rendering()
        page = figure.bbox
        texts = list(figure.texts)
        for axis in figure.axes:
            texts += [axis.title, axis._left_title, axis.xaxis.label, axis.yaxis.label, *axis.texts]
            texts += axis.get_legend().get_texts() if axis.get_legend() else []
        for text in (t for t in texts if t.get_visible() and t.get_text()):
            box = text.get_window_extent()
            self.assertGreater(
                overlap(box, page),
                0.98 * box.width * box.height,
                f"'{text.get_text()}' leaves the picture",
            )
        for axis in figure.axes:
            for word in (axis.get_xlabel(), axis.get_ylabel()):
                self.assertTrue(not word or "[" in word, f"'{word}' has no unit")
            for legend in [axis.get_legend()] if axis.get_legend() else []:
                box = legend.get_window_extent()
                for line in axis.lines:
                    points = line.get_transform().transform(line.get_xydata())
                    inside = [p for p in points if math.isfinite(p[1]) and box.contains(*p)]
                    self.assertEqual(len(inside), 0, f"the legend covers '{line.get_label()}'")

    def test_texts_and_legends_fit_and_every_row_is_drawn(self):
        with plot.matplotlib.rc_context(plot.STYLE):
            figure, _ = plot.accuracy_figure(self.run_json)
            self.judge(figure)
            drawn = {tuple(point) for line in figure.axes[0].lines for point in line.get_xydata()}
            for row in self.run_json["rows"]:
                self.assertIn(
                    (row["median_us"], max(row["direction_mean_deg"], LEAST_DIRECTION_DEG)), drawn
                )
            figure, _ = plot.page_figure(self.run_json)
            self.judge(figure)
            own = [
                r
                for r in self.run_json["rows"]
                if r["voxel_m"] == self.run_json["scene_voxel_m"] and r["weights"] == "area"
            ]
            self.assertEqual(len(figure.axes[3].get_yticklabels()), len(own))
            drawn = {tuple(point) for line in figure.axes[0].lines for point in line.get_xydata()}
            for row in own:
                for at in row["depths"]:
                    self.assertIn((at["edges"], at["force_ratio"]), drawn)
            advised, best = json.loads(json.dumps(self.run_json)), self.run_json["rows"][0]
            advised["advice"]["row"] = 0
            figure, _ = plot.accuracy_figure(advised)
            self.judge(figure)
            self.assertIn(f"{best['model']} at ", figure._suptitle.get_text())
            self.assertRegex(
                figure._suptitle.get_text(),
                rf"\b{best['direction_mean_deg']:.2g} deg .*\b{best['median_us']:.2g} µs",
            )
            design = json.loads(
                voxtouch("design", "--scene", DEPLOY / "scenes/cup.yaml", "--json").stdout
            )
            figure = plot.design_figure(design)[0]
            self.judge(figure)
            self.assertIn(
                f"{design['translation']['displayed_stiffness']:.4g} N/m ",
                figure._suptitle.get_text(),
            )

    def test_the_title_names_the_worst_depth(self):
        def row(model, *ratios):
            return {
                "model": model,
                "depths": [
                    {"edges": e, "force_ratio": r} for e, r in zip((0.25, 1.0, 4.0), ratios)
                ],
            }

        title = plot_accuracy.page_title(
            [
                row("adapted", 2.4, 0.48, 0.99),
                row("field", 0.92, 0.9, 0.95),
                row("virtual_tool", 0.88, 0.96, 0.99),
            ]
        )
        self.assertTrue(title.endswith("field 90 % (1 e), adapted 240 % (0.25 e)"), title)

    def test_stability_map_is_grey_without_contact(self):
        table = self.at / "map.csv"
        with open(table, "w", encoding="utf-8") as out:
            out.write(
                "model,radius_voxels,depth_voxels,tilt_deg,energy_share,energy_per_crossing,mean_force_n,largest_step\n"
            )
            for model in draw_map.BOUND:
                for radius, depth, tilt in (
                    (r, d, t) for r in (2.5, 5.0, 20.0) for d in (0.1, 1.0) for t in (0.0, 45.0)
                ):
                    touches = not (model == "adapted" and depth == 0.1 and tilt == 0.0)
                    out.write(
                        f"{model},{radius},{depth},{tilt},{1e-2 / radius if depth < 1 else -1e-3},0,{1 if touches else 0},0\n"
                    )
        with plot.matplotlib.rc_context(plot.STYLE):
            figure, _ = draw_map.stability_figure(table)
            self.judge(figure)
        self.assertIn("0.4 %", figure._suptitle.get_text())
        with contextlib.redirect_stdout(io.StringIO()):
            draw_map.main(table, self.at / "map.png")
        with self.assertRaisesRegex(SystemExit, "stability_map --out"):
            draw_map.stability_figure(self.at / "words.json")
        self.assertGreater(
            painted(self.at / "map.png", "#d9d9d9"), 5000, "the cell without contact is not grey"
        )

    def test_goals_zeros_and_no_rows_are_drawn(self):
        requested = json.loads(json.dumps(self.run_json))
        requested["request"].update(direction_deg=0.5, noise=0.02, within_us=3.0)
        requested["rows"][0].update(direction_mean_deg=0.0, magnitude_noise=0.0)
        nothing = json.loads(json.dumps(self.run_json))
        for row in nothing["rows"]:
            row.update(
                median_us=None, direction_mean_deg=None, magnitude_noise=None, refused="too large"
            )
        nothing["advice"].update(row=None, front=[], knee=None, met=None)
        for name, data in (("requested", requested), ("nothing", nothing)):
            with self.subTest(name), plot.matplotlib.rc_context(plot.STYLE):
                self.judge(plot.accuracy_figure(data)[0])
                self.judge(plot.page_figure(data)[0])
                plot.save(plot.accuracy_figure(data)[0], self.at / f"{name}.png")
        self.assertGreater(
            painted(self.at / "requested.png", plot.RED), painted(self.at / "nothing.png", plot.RED)
        )


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:], verbosity=2)

#!/usr/bin/python3
"""The page of a recorded run: by `voxtouch up`, by `voxtouch report` and by the tool itself. Its
figures are those of the run, counted independently from the bytes of the bag. For a damaged,
foreign or empty bag it prints a sentence.

usage: report_test.py BIN DEPLOY [arguments of unittest]
"""

import html
import html.parser
import json
import math
import os
import pathlib
import random
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time
import unittest

BIN, DEPLOY = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
sys.dont_write_bytecode = True
sys.path.insert(0, str(DEPLOY / "tools"))
import plot  # noqa: E402
import run_data  # noqa: E402
import run_page  # noqa: E402
import run_pictures  # noqa: E402
from plot_layout import new_figure  # noqa: E402

SHELL = {**os.environ, "LC_ALL": "C.UTF-8"}


def voxtouch(*words, **more):
    return subprocess.run(
        [BIN / "voxtouch", *map(str, words)],
        capture_output=True,
        text=True,
        env={**SHELL, **more.pop("env", {})},
        **more,
    )


def up(*words, scene=DEPLOY / "scenes/cup.yaml", **more):
    return voxtouch(
        "up", scene, "--device", "sim-phantom", "--one-process", "--json", *words, **more
    )


def mcap_chunks(data):
    """The chunks of an MCAP file, as ranges of its bytes, without their headers. A record is its
    kind in a byte, its length in eight, and its content.
    """
    chunks, at = [], len(b"\x89MCAP0\r\n")
    while at + 9 <= len(data):
        kind, length = struct.unpack_from("<BQ", data, at)
        at += 9
        if kind == 6:
            chunks.append(range(at, at + length))
        at += length
    return chunks


def with_matplotlib_from(file, *words):
    """As `up`, in a mount namespace in which matplotlib is `file`: the report takes Debian's Python
    and no other package.
    """
    at = matplotlib_file()
    alone = (
        ["unshare", "--user", "--map-root-user", "--mount"]
        if os.geteuid()
        else ["unshare", "--mount"]
    )
    command = [
        BIN / "voxtouch",
        "up",
        DEPLOY / "scenes/cup.yaml",
        "--device",
        "sim-phantom",
        "--one-process",
        "--json",
        *map(str, words),
    ]
    return subprocess.run(
        [
            *alone,
            "sh",
            "-c",
            'mount --bind "$1" "$2" && shift 2 && exec "$@"',
            "sh",
            file,
            at,
            *command,
        ],
        capture_output=True,
        text=True,
        env=SHELL,
    )


def matplotlib_file():
    asked = ["/usr/bin/python3", "-I", "-c", "import matplotlib; print(matplotlib.__file__)"]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()


def rows(bag, topic):
    """Messages of a topic without their encapsulation, read by this test alone."""
    with sqlite3.connect(f"file:{next(bag.glob('*.db3'))}?mode=ro", uri=True) as connection:
        return [
            data[4:]
            for (data,) in connection.execute(
                (
                    "SELECT data FROM messages JOIN topics ON topics.id = topic_id WHERE name = ?"
                    " ORDER BY messages.id"
                ),
                (topic,),
            )
        ]


class Page(html.parser.HTMLParser):
    """Content as in a browser: texts by section, attributes, and unclosed elements."""

    VOID = {"meta", "br", "link", "img", "input", "hr"}

    def __init__(self, file):
        super().__init__()
        self.source = file.read_text(encoding="utf-8")
        self.open, self.problems, self.tags, self.text, self.scripts = [], [], [], "", ""
        self.feed(self.source)
        self.close()
        self.problems += [f"<{tag}> is not closed" for tag in self.open]
        self.text = " ".join(self.text.split())
        self.figures = json.loads(self.scripts)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.problems.append(f"</{tag}> closes nothing")

    def handle_data(self, data):
        if self.open and self.open[-1] == "script":
            self.scripts += data
        elif not self.open or self.open[-1] != "style":
            self.text += data + " "

    def every(self, tag, key):
        return [
            attributes[key] for name, attributes in self.tags if name == tag and key in attributes
        ]


class Reports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.at = pathlib.Path(cls.folder.name).resolve()
        cls.bag = cls.at / "a run"
        # Cases that change a bag do so in SQL; the others record as is the default.
        cls.done = up(
            "--motion",
            "slide",
            "--duration",
            "2",
            "--lockstep",
            "--record",
            cls.bag,
            "--record-format",
            "sqlite3",
        )
        assert cls.done.returncode == 0, cls.done.stderr
        cls.summary = json.loads(cls.done.stdout)
        for _ in range(300):  # on a busy machine `up` does not wait for it
            if (cls.bag / "report.html").exists():
                break
            time.sleep(0.1)
        cls.page = Page(cls.bag / "report.html")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def says(self, page, *sentences):
        for sentence in sentences:
            self.assertTrue(
                sentence in page.text,
                f"the page does not say '{sentence}'; it says: {page.text[:600]} ...",
            )

    def report_of(self, bag, *words):
        """The page that the verb writes."""
        file = self.at / "page.html"
        file.unlink(missing_ok=True)
        done = voxtouch("report", bag, "--out", file, *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return Page(file)

    def refused(self, bag, *says):
        done = voxtouch("report", bag, "--out", self.at / "refused.html")
        self.assertEqual(done.returncode, 1, done.stdout)
        for word in says:
            self.assertIn(word, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertEqual(list(self.at.glob("refused*")), [])

    def copy(self, name, *statements):
        """The bag once more, after these statements of SQL."""
        shutil.copytree(self.bag, self.at / name)
        (self.at / name / "report.html").unlink(missing_ok=True)
        with sqlite3.connect(next((self.at / name).glob("*.db3"))) as connection:
            for statement in statements:
                connection.execute(statement)
        connection.close()
        return self.at / name

    def alter(self, bag, topic, at, new, first=0, count=1 << 30):
        """Other bytes at a place, counted behind the encapsulation, of some messages of a topic."""
        with sqlite3.connect(next(bag.glob("*.db3"))) as connection:
            for row, data in connection.execute(
                (
                    "SELECT m.id, data FROM messages m JOIN topics t ON t.id = topic_id WHERE name"
                    " = ? ORDER BY m.id LIMIT ? OFFSET ?"
                ),
                (f"/haptic/{topic}", count, first),
            ).fetchall():
                connection.execute(
                    "UPDATE messages SET data = ? WHERE id = ?",
                    (data[: at + 4] + new + data[at + 4 + len(new) :], row),
                )
        connection.close()
        return bag

    # -------------------- figures
    def test_figures_match_the_summary_and_the_bag(self):
        (figures,) = self.page.figures
        commands = rows(self.bag, "/haptic/coupling/command")
        force = [math.dist((0, 0, 0), struct.unpack_from("<3d", m, 32)) for m in commands]
        states = rows(self.bag, "/haptic/device/state")
        numbers = {struct.unpack_from("<Q", m, 8) for m in states}
        stamps = [struct.unpack_from("<q", m, 16)[0] * 1e-9 for m in states]
        self.assertGreater(self.summary["max_force_n"], 0.1)
        for value in (self.summary["max_force_n"], max(force)):
            self.assertAlmostEqual(figures["max_force_n"], value, 9)
        for value in (
            self.summary["answered"],
            len({struct.unpack_from("<Q", m, 8) for m in commands} & numbers),
        ):
            self.assertEqual(figures["answered"], value)
        for value in (self.summary["rate_hz"], (len(stamps) - 1) / (stamps[-1] - stamps[0])):
            self.assertAlmostEqual(figures["rate_hz"], value, 6)
        self.assertEqual(figures["samples"], self.summary["samples"])
        self.assertEqual(figures["contact_samples"], self.summary["contact_samples"])
        self.assertEqual(figures["latched_samples"], self.summary["latched_samples"])
        for name in ("capped_samples", "bounded_samples"):
            self.assertEqual(figures[name], self.summary["coupling"][name])
        (limit,) = {
            struct.unpack_from("<d", m, 8 + 4 + 12 + 8 + 0)[0]
            for m in rows(self.bag, "/haptic/device/description")
        }
        self.assertAlmostEqual(figures["ratio_to_limit"], max(force) / limit, 9)
        self.says(self.page, f"{max(force):.3g} N")

    def test_layouts_match_offsets_counted_by_hand(self):
        """Against offsets that this test has counted by hand."""
        contact = rows(self.bag, "/haptic/rendering/contact")
        run = run_data.Run(self.bag)
        self.assertEqual(len(run.contact), len(contact))
        for i in (0, len(contact) // 2, len(contact) - 1):
            self.assertEqual(
                tuple(run.contact_force[i]), struct.unpack_from("<3d", contact[i], 184)
            )
            self.assertEqual(run.depth_mm[i], 1e3 * struct.unpack_from("<d", contact[i], 328)[0])
        self.assertEqual(run.scene, "cup")
        self.assertEqual(run.design["status"], self.summary["coupling"]["status"])
        self.assertEqual(run.description["model"], "sim-phantom")

    # -------------------- page
    def test_page_is_self_contained_and_accessible(self):
        self.assertEqual(self.page.problems, [])
        for key in ("src", "href", "xlink:href", "data", "action"):
            for tag in {tag for tag, _ in self.page.tags}:
                self.assertEqual(
                    [link for link in self.page.every(tag, key) if not link.startswith("#")],
                    [],
                    f"<{tag} {key}>",
                )
        for word in ("@import", "url(http", "<img", "<iframe"):
            self.assertNotIn(word, self.page.source)
        ids = [attributes["id"] for _, attributes in self.page.tags if "id" in attributes]
        self.assertEqual(len(ids), len(set(ids)), "two elements have one name")
        pictures = [attributes for tag, attributes in self.page.tags if tag == "svg"]
        self.assertGreaterEqual(len(pictures), 4)
        for picture in pictures:
            self.assertEqual(picture["role"], "img")
            self.assertIn(":", picture["aria-label"])
        self.assertIn("lang", dict(self.page.tags[0][1]))
        self.assertLess(len(self.page.source), 2_000_000)

    def test_light_and_dark_define_all_colours_with_contrast(self):
        light, dark = (
            dict(
                pair.split(":", 1)
                for pair in part.split("}")[0].replace("\n", "").replace(" ", "").split(";")
                if pair.startswith("--")
            )
            for part in run_page.CSS.split(":root")[1:3]
            for part in [part.split("{", 1)[1]]
        )

        def luminance(colour):
            colour = colour if len(colour) == 7 else "#" + "".join(2 * c for c in colour[1:])
            parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
            return sum(
                w * (c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4)
                for w, c in zip((0.2126, 0.7152, 0.0722), parts)
            )

        for theme in (light, dark):
            for name in (
                "ink",
                "quiet",
                "returned",
                "contact",
                "y",
                "z",
                "depth",
                "bad",
                "good",
                "link",
            ):
                for ground in ("panel", "ground"):
                    a, b = sorted(
                        (luminance(theme["--" + name]), luminance(theme["--" + ground])),
                        reverse=True,
                    )
                    self.assertGreater((a + 0.05) / (b + 0.05), 4.5, f"{name} on {ground}")
        for name in run_pictures.THEME.values():
            self.assertIn("--" + name, light)
            self.assertIn("--" + name, dark)
        for name, colour in vars(run_pictures).items():
            self.assertTrue(
                not isinstance(colour, str)
                or not colour.startswith("#")
                or colour in run_pictures.THEME,
                f"{name} does not follow the page",
            )
        drawn = {
            word
            for word in self.page.source.replace(";", " ").replace('"', " ").split()
            if len(word) == 7 and word[0] == "#" and all(c in "0123456789abcdef" for c in word[1:])
        }
        in_css = set(run_page.CSS.replace(";", " ").split())
        self.assertEqual(drawn - in_css, set(), "a colour of a picture does not follow the page")

    def test_titles_describe_the_plot_and_both_forces(self):
        (figures,) = self.page.figures
        self.says(
            self.page,
            f"{figures['max_force_n']:.3g} N",
            f"{figures['max_depth_mm']:.3g} mm",
            "[N]",
            "[mm]",
            "[mJ]",
            "[s]",
            "[%]",
        )
        run = run_data.Run(self.bag)
        for name in ("force", "peak", "distribution", "depth", "latency", "energy"):
            axes = getattr(run_pictures, name + "_picture")([run]).axes
            for axis in axes:
                self.assertRegex(axis.get_ylabel(), r"\[[^ ]+\]$")
            self.assertRegex(axes[-1].get_xlabel(), r"\[[^ ]+\]$")

    def test_coupling_scene_and_faults_are_described(self):
        self.says(self.page, "margin of 2")
        self.says(self.page, "Voxmap of 1")
        on_a_busy_machine = [
            row
            for row in run_data.Run(self.bag).faults()
            if "hang" in row[4] or "stalled" in row[4]
        ]  # a node reports that of another
        self.assertEqual(run_data.Run(self.bag).faults(), on_a_busy_machine)
        unsaid = self.copy(
            "unsaid",
            (
                "DELETE FROM messages WHERE topic_id = (SELECT id FROM topics WHERE name ="
                " '/haptic/node_status')"
            ),
        )
        self.says(self.report_of(unsaid), "None.")
        self.says(self.page, "no latency")

    def test_verdict_comes_first(self):
        verdict = self.bag / "voxtouch_run.json"
        self.assertEqual(json.loads(verdict.read_text()), self.summary)
        self.says(self.page, f"PASSED: all {len(self.summary['limits'])} limits", "swing_s")
        bad = self.at / "bad"
        ended = up(
            "--motion",
            "slide",
            "--duration",
            "0.5",
            "--lockstep",
            "--limit",
            "validated_ratio=1.5",
            "--record",
            bad,
        )
        self.assertEqual(ended.returncode, 1)
        page = Page(bad / "report.html")
        self.assertEqual(page.problems, [])
        self.says(page, "FAILED", *json.loads(ended.stdout)["problems"], "at least 1.5", "not met")
        unjudged = self.copy("unjudged", "")
        (unjudged / verdict.name).unlink()
        self.says(self.report_of(unjudged), "No verdict")
        for broken in (
            "",
            "[1]",
            "{",
            '{"limits": {}}',
            '{"ok": true, "limits": [], "problems": [], "notes": []}',
            '{"ok": true, "limits": {"a": {"value": "b"}}, "problems": [], "notes": []}',
        ):
            (unjudged / verdict.name).write_text(broken)
            self.says(self.report_of(unjudged), "No verdict")

    def test_the_command_of_the_page_makes_the_same_run(self):
        folder, words = run_data.Run(self.bag).command_line()
        self.assertEqual(words, list(map(str, self.done.args)))
        line = self.page.source.split("<pre>")[1].split("</pre>")[0]
        line = html.unescape(line)
        self.assertNotRegex(line, "--record(?!-format sqlite3)")
        again = subprocess.run(
            ["bash", "-c", f"{line} --no-report --record '{self.at / 'again'}'"],
            capture_output=True,
            text=True,
        )
        self.assertEqual(again.returncode, 0, again.stderr)
        for topic in ("device/state", "rendering/contact", "coupling/command"):
            self.assertEqual(
                [m[8:] for m in rows(self.bag, f"/haptic/{topic}")],
                [m[8:] for m in rows(self.at / "again", f"/haptic/{topic}")],
                topic,
            )
        self.assertFalse((self.at / "again" / "report.html").exists())

    def test_two_runs_are_drawn_on_one_scale(self):
        other = self.at / "other"
        self.assertEqual(
            up(
                "--motion", "hit", "--duration", "3", "--lockstep", "--record", other, "--no-report"
            ).returncode,
            0,
        )
        page = self.report_of(self.bag, "--compare-with", other)
        self.assertEqual(page.problems, [])
        self.assertEqual([f["samples"] for f in page.figures], [2000, 3000])
        self.says(page, "a run: at most")
        self.says(page, "other: at most")
        with plot.matplotlib.rc_context(run_pictures.ON_THE_PAGE):
            for picture in (
                run_pictures.force_picture,
                run_pictures.distribution_picture,
                run_pictures.depth_picture,
                run_pictures.energy_picture,
            ):
                left, right = picture([run_data.Run(self.bag), run_data.Run(other)]).axes[:2]
                self.assertEqual(
                    (left.get_ylim(), left.get_xlim()), (right.get_ylim(), right.get_xlim())
                )

    # -------------------- bags of any kind
    def test_page_lists_faults_with_their_times(self):
        """Three stretches without an answer, a latched command and a contact that the reference
        disputes."""
        bag = self.copy(
            "faulty",
            *(
                "DELETE FROM messages WHERE id IN (SELECT m.id FROM messages m JOIN topics t ON"
                " t.id = m.topic_id WHERE t.name = '/haptic/coupling/command' ORDER BY m.id LIMIT"
                f" {n} OFFSET {at})"
                for at, n in ((1500, 30), (1000, 20), (500, 10))
            ),
        )
        for topic, place, at, value in (
            ("coupling/command", 100, 96, 2),
            ("rendering/contact", 200, 600, 128),
            ("validation", 50, 64, 2),
        ):
            self.alter(bag, topic, at, struct.pack("<I", value), place, 1)
        page = self.report_of(bag)
        for words in (
            ("0.500 to 0.509", "10", "without a recorded command"),
            ("1.000 to 1.019", "20", "without a recorded command"),
            ("1.500 to 1.529", "30", "without a recorded command"),
            ("0.100", "1", "the last valid one is used"),
            ("0.200", "1", "tunnelling suspected"),
            ("disagreement of contact and reference",),
        ):
            self.says(page, *words)
        self.assertEqual(page.figures[0]["answered"], 2000 - 60)

    def test_a_time_without_messages_is_a_gap_and_not_a_line(self):
        t = [0.001 * i for i in range(1000)] + [2.0 + 0.001 * i for i in range(1000)]
        x, y = plot.curve(t, [1.0] * 2000, 0.0035)
        self.assertEqual(int(sum(map(math.isnan, y))), 1)
        self.assertTrue(math.isnan(y[1000]))
        many = [1e-5 * i for i in range(20000) if not 4000 <= i < 9000]
        x, y = plot.curve(many, [math.sin(i) for i in range(len(many))], 3.5e-5)
        self.assertEqual(int(sum(map(math.isnan, y))), 1)
        bag = self.copy(
            "gap",
            (
                "DELETE FROM messages WHERE topic_id = (SELECT id FROM topics WHERE name ="
                " '/haptic/rendering/contact') AND timestamp BETWEEN (SELECT min(timestamp) +"
                " 500000000 FROM messages WHERE timestamp > 0) AND (SELECT min(timestamp) +"
                " 900000000 FROM messages WHERE timestamp > 0)"
            ),
        )
        for figure in (run_pictures.force_picture([run_data.Run(bag)]), plot.forces_figure(bag)[0]):
            (line,) = (
                one
                for one in figure.axes[0].lines
                if "contact" in str(one.get_label()) and "effects" not in str(one.get_label())
            )
            self.assertTrue(
                any(math.isnan(v) for v in line.get_ydata()),
                "a line is drawn where nothing was recorded",
            )

    def test_decimation_keeps_every_peak(self):
        n = 600_000
        y = [0.0] * n
        y[123_456], y[400_001] = 7.0, -3.0
        x, drawn = plot.curve([1e-3 * i for i in range(n)], y, 0.0035)
        self.assertLess(len(x), 2 * plot.STRETCHES + 10)
        self.assertEqual((max(drawn), min(drawn)), (7.0, -3.0))
        self.assertAlmostEqual(float(x[list(drawn).index(7.0)]), 123.456, 6)

    def test_one_spike_does_not_squash_the_rest_and_is_marked(self):
        usual = [1.0 + 0.2 * math.sin(0.01 * i) for i in range(4000)]
        self.assertGreater(plot.robust_limit(usual), 1.2)
        spiked = list(usual)
        spiked[2000] = 50.0
        limit = plot.robust_limit(spiked)
        self.assertLess(limit, 3.0)
        half = [0.0] * 3000 + [5.0 * math.sin(math.pi * i / 100) for i in range(100)]
        self.assertGreater(plot.robust_limit(half), 5.0, "a short hit is no spike")
        with plot.matplotlib.rc_context(plot.STYLE):
            figure, axes = new_figure("a", "b")
            axes[0][0].set_xlim(0, 4)
            self.assertEqual(
                plot.mark_beyond(
                    axes[0][0], [1e-3 * i for i in range(4000)], spiked, limit, "N", plot.RED
                ),
                1,
            )
            self.assertIn("up to 50 N at 2.00 s", axes[0][0].texts[-1].get_text())
            self.assertEqual(
                plot.mark_beyond(
                    axes[0][0], [1e-3 * i for i in range(4000)], usual, limit, "N", plot.RED
                ),
                0,
            )

    def test_invalid_or_foreign_bag_is_reported(self):
        (self.at / "empty").mkdir()
        self.refused(self.at / "empty", str(self.at / "empty"))
        (self.at / "mcap").mkdir()
        (self.at / "mcap" / "x.mcap").write_bytes(b"x")
        self.refused(self.at / "mcap", "read (")
        (self.at / "packed").mkdir()
        (self.at / "packed" / "x.db3.zstd").write_bytes(b"x")
        self.refused(self.at / "packed", "compression")
        (self.at / "broken").mkdir()
        (self.at / "broken" / "x.db3").write_text(
            "no database, but long enough to be read as one" * 100
        )
        self.refused(self.at / "broken", "read (")
        (self.at / "foreign").mkdir()
        with sqlite3.connect(self.at / "foreign" / "x.db3") as connection:
            connection.execute(
                "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
                " serialization_format TEXT, offered_qos_profiles TEXT)"
            )
            connection.execute(
                "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
                " data BLOB)"
            )
            connection.execute(
                "INSERT INTO topics VALUES (1, '/chatter', 'std_msgs/msg/String', 'cdr', '')"
            )
            connection.execute("INSERT INTO messages VALUES (1, 1, 5, x'00010000')")
        connection.close()
        self.refused(self.at / "foreign", "not a recording")
        self.refused(self.copy("unsampled", "DELETE FROM messages"), "nothing")
        self.refused(
            self.copy("short", "UPDATE messages SET data = substr(data, 1, 40)"), "this version"
        )

    def test_a_cut_recording_fails(self):
        half = "DELETE FROM messages WHERE id > (SELECT max(id) / 2 FROM messages)"
        page = self.report_of(self.copy("cut", half))
        self.says(page, "FAILED", "recorded messages; the others are lost")

    def test_a_damaged_chunk_fails(self):
        bag = self.at / "damaged"
        run = up("--motion", "slide", "--duration", "4", "--lockstep", "--record", bag)
        self.assertEqual(run.returncode, 0, run.stderr)
        (file,) = bag.glob("*.mcap")
        data = bytearray(file.read_bytes())
        chunks = mcap_chunks(data)
        self.assertGreater(len(chunks), 1, "no chunk would be left to report")
        last = chunks[-1]
        middle = (last.start + last.stop) // 2
        data[middle : middle + 64] = bytes(255 - byte for byte in data[middle : middle + 64])
        file.write_bytes(data)
        self.says(self.report_of(bag), "FAILED", "is only partly readable")

    def test_missing_contact_latency_or_messages_are_reported(self):
        still = self.at / "still"
        self.assertEqual(
            up(
                "--motion",
                "free",
                "--duration",
                "1",
                "--lockstep",
                "--record",
                still,
                "--no-report",
                scene=DEPLOY / "scenes/cup.yaml",
            ).returncode,
            0,
        )
        page = self.report_of(still)
        self.says(page, "no force")
        topic = "DELETE FROM messages WHERE topic_id IN (SELECT id FROM topics WHERE name IN ({}))"
        in_real_time = self.alter(
            self.copy("silent", topic.format("'/haptic/node_status'")),
            "device/state",
            132,
            bytes(4),
        )
        self.says(self.report_of(in_real_time), "not reported", "no latency", "no command line")
        page = self.report_of(
            self.copy(
                "bare",
                topic.format(
                    "'/haptic/coupling/command', '/haptic/coupling/design',"
                    " '/haptic/rendering/plan', '/haptic/device/description', '/haptic/validation'"
                ),
            )
        )
        for sentence in ("no command", "no coupling design", "no plan"):
            self.says(page, sentence)
        page = self.report_of(
            self.copy(
                "states",
                topic.format(
                    "'/haptic/coupling/command', '/haptic/rendering/contact', '/haptic/validation'"
                ),
            )
        )
        self.assertEqual(page.figures[0]["samples"], 2000)

    def test_invalid_numbers_still_give_a_page(self):
        bag = self.copy("nan")
        for topic, at in (
            ("coupling/command", 32),
            ("rendering/contact", 184),
            ("rendering/contact", 328),
            ("coupling/command", 80),
        ):
            self.alter(bag, topic, at, struct.pack("<d", math.nan), 1000, 50)
        page = self.report_of(bag)
        self.assertTrue(math.isfinite(page.figures[0]["max_force_n"]))
        self.assertNotIn("NaN", page.scripts)

    def test_any_bytes_give_a_page_or_a_message(self):
        dice = random.Random(int(os.environ.get("VOXTOUCH_SEED", "1")))
        for turn in range(12):
            bag = self.copy(f"spoiled {turn}")
            with sqlite3.connect(next(bag.glob("*.db3"))) as connection:
                for row, data in connection.execute(
                    "SELECT id, data FROM messages ORDER BY topic_id, id"
                ).fetchall():
                    if dice.random() < (0.3 if len(data) > 200 else 0.002):
                        new = bytearray(data)
                        for _ in range(3):
                            new[dice.randrange(4, len(new))] = dice.choice(
                                (0, 127, 255, dice.randrange(256))
                            )
                        connection.execute(
                            "UPDATE messages SET data = ? WHERE id = ?", (bytes(new), row)
                        )
            connection.close()
            if turn % 4 == 3:
                file, whole = next(bag.glob("*.db3")), next(bag.glob("*.db3")).read_bytes()
                file.write_bytes(whole[: dice.randrange(len(whole))])
            with self.subTest(f"turn {turn}"):
                try:
                    run_page.page([run_data.Run(bag)])
                except run_data.BagError as error:
                    self.assertTrue(str(error).startswith(str(bag)))

    def test_page_of_a_killed_ring_reports_it(self):
        bag = self.at / "killed"
        ring = subprocess.Popen(
            [
                BIN / "voxtouch",
                "up",
                DEPLOY / "scenes/cup.yaml",
                "--motion",
                "slide",
                "--record",
                bag,
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env=SHELL,
        )
        for line in ring.stderr:
            if " samples " in line and int(line.split()[0]) > 1500:
                break
        for process in [
            int(word)
            for word in pathlib.Path(f"/proc/{ring.pid}/task/{ring.pid}/children")
            .read_text()
            .split()
        ] + [ring.pid]:
            os.kill(process, signal.SIGKILL)
        ring.wait()
        ring.stderr.close()
        page = self.report_of(bag)
        self.assertGreater(page.figures[0]["samples"], 1000)
        self.says(page, "not closed")
        self.says(page, "no final status")
        self.says(page, "median latency")
        self.assertFalse((bag / "report.html").exists())

    # -------------------- next to a run
    def test_user_python_settings_change_nothing(self):
        packages = self.at / "packages"
        packages.mkdir()
        for name in ("numpy", "matplotlib", "sqlite3", "json"):
            (packages / f"{name}.py").write_text("raise SystemExit('a package of the user')\n")
        (self.at / "matplotlibrc").write_text("text.usetex: True\nbackend: NoSuchBackend\n")
        settings = {
            "PYTHONPATH": str(packages),
            "PYTHONHOME": str(packages),
            "MPLBACKEND": "NoSuchBackend",
            "MATPLOTLIBRC": str(self.at),
        }
        page = self.at / "isolated.html"
        output = voxtouch("report", self.bag, "--out", page, env=settings, cwd=self.at)
        self.assertEqual(output.returncode, 0, output.stderr)
        self.assertTrue(output.stdout.startswith(f"{page} "), output.stdout)
        self.assertEqual(page.read_bytes(), self.report_of(self.bag).source.encode())

    def test_up_writes_or_skips_it_and_works_without_matplotlib(self):
        self.assertIn(f"report: {self.bag / 'report.html'}", self.done.stderr)
        self.assertNotIn("report", self.summary)
        (self.at / "broken.py").write_text('raise ImportError("hidden by this test")\n')
        done = with_matplotlib_from(
            self.at / "broken.py",
            "--motion",
            "slide",
            "--duration",
            "1",
            "--lockstep",
            "--record",
            self.at / "plain",
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        output = [line for line in done.stderr.splitlines() if "report" in line]
        self.assertEqual(len(output), 1, done.stderr)
        self.assertIn("install python3-matplotlib", output[0])
        self.assertTrue(json.loads(done.stdout)["ok"])
        self.assertFalse((self.at / "plain" / "report.html").exists())

    def test_up_waits_briefly_and_the_page_still_appears(self):
        (self.at / "slow.py").write_text(
            "import time\ntime.sleep(8)\n" + pathlib.Path(matplotlib_file()).read_text()
        )
        begun = time.monotonic()
        done = with_matplotlib_from(
            self.at / "slow.py",
            "--motion",
            "slide",
            "--duration",
            "0.5",
            "--lockstep",
            "--record",
            self.at / "later",
        )
        took = time.monotonic() - begun
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("still being", done.stderr)
        self.assertIn("report: ", done.stderr)
        self.assertLess(took, 15.0)
        for _ in range(300):
            if (self.at / "later" / "report.html").exists():
                break
            time.sleep(0.1)
        self.assertEqual(Page(self.at / "later" / "report.html").figures[0]["samples"], 500)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:], verbosity=2)

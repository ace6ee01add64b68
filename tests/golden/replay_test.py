#!/usr/bin/python3
"""voxtouch replay: recorded runs repeat bit-identically, a planted change is found at its sample,
and an unusable recording gives a sentence.

usage: replay_test.py BIN DEPLOY [arguments of unittest]
"""

import json
import os
import pathlib
import re
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time
import unittest

BIN, DEPLOY = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
STATE, CONTACT, COMMAND = (
    "/haptic/device/state",
    "/haptic/rendering/contact",
    "/haptic/coupling/command",
)
DESIGN = "/haptic/coupling/design"
ASKED, MADE = "/haptic/rendering/change", "/haptic/rendering/made"
HEADER, NUMBER = (
    4,
    12,
)  # bytes of CDR's encapsulation; offset of the sequence number in a ring's message
POSE = 28  # and a device state's pose


def voxtouch(*words, **more):
    return subprocess.run(
        [BIN / "voxtouch", *map(str, words)], capture_output=True, text=True, timeout=400, **more
    )


def up_words(bag, scene, *words):
    return [
        "up",
        scene,
        "--device",
        "sim-phantom",
        "--one-process",
        "--no-report",
        "--record",
        bag,
        "--record-format",
        "sqlite3",
        "--json",
        *words,
    ]


def record(bag, scene, *words):
    ran = voxtouch(*up_words(bag, scene, *words))
    assert (bag / "metadata.yaml").exists(), ran.stderr + ran.stdout


def replay(bag, *words):
    ran = voxtouch("replay", bag, "--json", *words)
    return ran.returncode, json.loads(ran.stdout), ran.stderr


def database(bag):
    return next(bag.glob("*.db3"))


def edit(bag, sql, *values):
    """Changes the messages and the counts in metadata.yaml, as if the bag had been recorded so."""
    count = "SELECT COUNT(*) FROM messages"
    with sqlite3.connect(database(bag)) as connection:
        before = connection.execute(count).fetchone()[0]
        done = connection.execute(sql, values).rowcount
        after = connection.execute(count).fetchone()[0]
    connection.close()
    metadata = pathlib.Path(bag) / "metadata.yaml"
    if metadata.exists():
        metadata.write_text(
            metadata.read_text().replace(f"message_count: {before}\n", f"message_count: {after}\n")
        )
    return done


def messages(bag, topic):
    with sqlite3.connect(f"file:{database(bag)}?mode=ro", uri=True) as connection:
        return connection.execute(
            (
                "SELECT messages.id, data FROM messages JOIN topics ON topics.id = topic_id WHERE"
                " name = ? ORDER BY messages.id"
            ),
            (topic,),
        ).fetchall()


def message_of(bag, topic, number):
    return next(
        (row, data)
        for row, data in messages(bag, topic)
        if struct.unpack_from("<Q", data, NUMBER)[0] == number
    )


def gain_of(design):
    """Offset of the gain in a CouplingDesign: after session, sample, two bools, two texts and two
    numbers.
    """
    at = HEADER + 20
    for _ in range(2):
        at += 4 + struct.unpack_from("<I", design, at)[0]
        at += -(at - HEADER) % 4
    return at + -(at - HEADER) % 8 + 16


def scene_of(folder, name, *replacements):
    """A shipped scene in a temporary folder, with some words replaced."""
    text = (DEPLOY / f"scenes/{name}.yaml").read_text().replace("../meshes", str(DEPLOY / "meshes"))
    for old, new in replacements:
        assert old in text, old
        text = text.replace(old, new)
    file = folder / f"{name}.yaml"
    file.write_text(text)
    return file


class Storages(unittest.TestCase):
    """A bag as is the default, in MCAP, split, is a recorded run as one in sqlite3 is, which the
    other cases change in SQL.
    """

    def test_split_mcap_bag_is_bit_identical_with_its_report(self):
        with tempfile.TemporaryDirectory(prefix="voxtouch_test_replay_") as folder:
            bag = pathlib.Path(folder) / "cup"
            ran = voxtouch(
                "up",
                DEPLOY / "scenes/cup.yaml",
                "--motion",
                "slide",
                "--lockstep",
                "--duration",
                "1.5",
                "--record",
                bag,
                "--record-split-s",
                "0.6",
                "--one-process",
                "--no-report",
            )
            self.assertEqual(ran.returncode, 0, ran.stderr)
            self.assertEqual(
                sorted(file.name for file in bag.glob("*.mcap")),
                ["cup_0.mcap", "cup_1.mcap", "cup_2.mcap"],
            )
            self.assertEqual(list(bag.glob("*.db3")), [])
            status, reported, said = replay(bag)
            self.assertEqual(status, 0, said)
            self.assertEqual(reported["samples"], 1500, reported)
            ran = voxtouch("report", bag)
            self.assertEqual(ran.returncode, 0, ran.stderr + ran.stdout)
            self.assertIn("1500", (bag / "report.html").read_text())


class Replay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.whole = tempfile.TemporaryDirectory(prefix="voxtouch_test_replay_")
        cls.cup = pathlib.Path(cls.whole.name) / "cup"
        record(
            cls.cup,
            DEPLOY / "scenes/cup.yaml",
            "--motion",
            "slide",
            "--lockstep",
            "--duration",
            "2",
        )

    @classmethod
    def tearDownClass(cls):
        cls.whole.cleanup()

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="voxtouch_test_replay_")
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def copy(self, name="copy"):
        return pathlib.Path(shutil.copytree(self.cup, self.folder / name))

    def equal(self, bag, samples):
        status, said, err = replay(bag)
        self.assertEqual(status, 0, f"{said} {err}")
        self.assertEqual(said["contact"]["compared"], samples, said)
        self.assertGreaterEqual(
            said["command"]["compared"], samples, "more where DDS gave the coupling a contact twice"
        )
        self.assertEqual(
            (said["contact"]["differ"], said["command"]["differ"], said["missing"]),
            (0, 0, []),
            said,
        )
        return said

    def refused(self, bag, *words):
        ran = voxtouch("replay", bag, *words)
        self.assertEqual((ran.returncode, ran.stdout), (1, ""), ran.stderr)
        self.assertRegex(ran.stderr.splitlines()[-1], r"^error: .{20,}")
        return ran.stderr

    def test_lockstep_is_bit_identical_and_reported(self):
        said = self.equal(self.cup, 2000)
        self.assertTrue(said["ok"] and said["scene"]["same"] and said["lockstep"])
        self.assertGreater(said["forces"]["returned"]["recorded"]["largest_n"], 0.1)
        self.assertEqual(
            said["forces"]["returned"]["recorded"], said["forces"]["returned"]["replayed"]
        )
        text = voxtouch("replay", self.cup).stdout
        for fact in (
            r"'cup'",
            r"sim-phantom",
            r"lockstep",
            r"2000 samples in 1\.999 s",
            r"contact +2000 samples .* all bit-identical",
            r"command +2000 samples .* all bit-identical",
        ):
            self.assertRegex(text, fact)

    def other_build(self, *lines):
        """A build folder with this build's program, whose output is changed by `lines` of
        Python."""
        program = self.folder / "other/bin/voxtouch"
        program.parent.mkdir(parents=True)
        program.write_text(
            "#!/usr/bin/python3\nimport sqlite3, struct, subprocess, sys\n"
            f"status = subprocess.run([{str(BIN / 'voxtouch')!r}, *sys.argv[1:]]).returncode\n"
            "made = sys.argv[sys.argv.index('--write') + 1]\n"
            + "\n".join(lines)
            + "\nsys.exit(status)\n"
        )
        program.chmod(0o755)
        return program.parents[1]

    def test_replay_of_a_build_is_written_as_a_bag(self):
        made, changed = self.folder / "made", self.folder / "changed"
        self.assertEqual(replay(self.cup, "--write", made)[0], 0)
        self.equal(made, 2000)
        for topic in (STATE, CONTACT, COMMAND, MADE):
            self.assertEqual(
                [data for _, data in messages(made, topic)],
                [data for _, data in messages(self.cup, topic)],
                topic,
            )
        scene = scene_of(self.folder, "cup", ("stiffness_n_per_m: 30}", "stiffness_n_per_m: 15}"))
        self.assertEqual(
            replay(self.cup, "--scene", scene, "--write", changed)[0],
            1,
            "the recording is of the stiffer scene",
        )
        status, said, err = replay(changed, "--scene", scene)
        self.assertEqual(
            (status, said["contact"]["differ"], said["command"]["differ"]), (0, 0, 0), err
        )
        self.assertIn("exists", self.refused(self.cup, "--write", made))

    def test_two_builds_are_compared_on_a_recorded_hand(self):
        status, said, _ = replay(self.cup, "--against", BIN.parent)
        self.assertEqual(
            (status, said["ok"], said["other_build"], said["bag"]),
            (0, True, str(BIN.parent), str(self.cup)),
        )
        bag = self.copy()  # the recorded answers are not used
        row, data = message_of(bag, COMMAND, 900)
        edit(
            bag,
            "UPDATE messages SET data = ? WHERE id = ?",
            data[: NUMBER + 24] + struct.pack("<d", 1.5) + data[NUMBER + 32 :],
            row,
        )
        other = self.other_build(
            "import glob",
            "with sqlite3.connect(glob.glob(made + '/*.db3')[0]) as bag:",
            (
                '    rows = bag.execute("SELECT messages.id, data FROM messages JOIN topics ON'
                f" topics.id = topic_id WHERE name = '{COMMAND}'\").fetchall()"
            ),
            (
                "    row, data = next(r for r in rows if struct.unpack_from('<Q', r[1],"
                f" {NUMBER})[0] == 700)"
            ),
            f"    x = struct.unpack_from('<d', data, {NUMBER + 24})[0]",
            (
                "    bag.execute('UPDATE messages SET data = ? WHERE id = ?',"
                f" (data[:{NUMBER + 24}] + struct.pack('<d', x + 0.25) + data[{NUMBER + 32}:],"
                " row))"
            ),
        )
        picture = self.folder / "builds.svg"
        status, said, err = replay(bag, "--against", other, "--plot", picture)
        self.assertEqual(
            (status, said["contact"]["differ"], said["command"]["differ"]), (1, 0, 1), err
        )
        self.assertEqual(
            [
                said["command"]["first"]["sample"],
                [field["field"] for field in said["command"]["first"]["fields"]],
            ],
            [700, ["wrench.force.x"]],
        )
        self.assertAlmostEqual(said["command"]["largest_force"]["n"], 0.25)
        self.assertIn("other build", picture.read_text())
        self.assertIn(f"replay of {other}", voxtouch("replay", bag, "--against", other).stdout)

    def test_build_without_replay_is_reported(self):
        self.assertIn("'voxtouch'", self.refused(self.cup, "--against", self.folder))
        other = self.other_build("import shutil", "shutil.rmtree(made)")
        self.assertIn("replay --write", self.refused(self.cup, "--against", other))
        shutil.rmtree(other)
        other = self.other_build("import os, signal", "os.kill(os.getpid(), signal.SIGKILL)")
        self.assertIn("signal 9", self.refused(self.cup, "--against", other))

    def test_moving_objects_and_virtual_tool_are_bit_identical(self):
        for scene, motion in (
            ("objects", "slide"),
            ("cup_virtual_tool", "slide"),
            ("block", "fall"),
        ):
            with self.subTest(scene):
                record(
                    self.folder / scene,
                    DEPLOY / f"scenes/{scene}.yaml",
                    "--motion",
                    motion,
                    "--lockstep",
                    "--duration",
                    "2",
                )
                self.equal(self.folder / scene, 2000)

    def test_clutch_is_bit_identical(self):
        scene = scene_of(self.folder, "plane")
        text = re.sub(
            r"^device:.*$",
            "device: {position_scale: 1, force_scale: 1, clutch_button: 0}",
            scene.read_text(),
            flags=re.M,
        )
        scene.write_text(
            re.sub(
                r"^motions:.*$",
                (
                    "motions:\n  clutched: {path: [[0, 0, 0.03], [0, 0, 0.007]], speed_m_per_s:"
                    " 0.1, hold_s: 0.2, press: [{button: 0, from_s: 1, to_s: 1.5}]}"
                ),
                text,
                flags=re.M,
            )
        )
        record(
            self.folder / "bag", scene, "--motion", "clutched", "--lockstep", "--duration", "2.5"
        )
        clutched = [
            data
            for _, data in messages(self.folder / "bag", COMMAND)
            if struct.unpack_from("<3d", data, HEADER + 32) == (0.0, 0.0, 0.0)
        ]
        self.assertGreater(len(clutched), 500)
        self.equal(self.folder / "bag", 2500)

    def change(self, bag, scene, changes, *words):
        """Records a run that is changed while it runs: by numbers of samples in lockstep, else at
        once.
        """
        ring = subprocess.Popen(
            [BIN / "voxtouch", *map(str, up_words(bag, scene, *words))],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            for change in changes:
                for _ in range(60):
                    asked = voxtouch("change", *change)
                    if asked.returncode == 0:
                        break
                    time.sleep(0.1)
                self.assertEqual(asked.returncode, 0, asked.stdout + asked.stderr)
            ring.communicate(timeout=400)
        finally:
            ring.kill()
            ring.communicate()

    def test_changes_and_reloads_hold_from_their_samples(self):
        changes = [
            ("friction", "coulomb=0.2", "--from-sample", 4000),
            ("friction", "stiffness_n_per_m=80", "--from-sample", 10000),
            ("--reload", "--voxel-size", 0.003, "--from-sample", 16000),
        ]
        self.change(
            self.folder / "bag",
            DEPLOY / "scenes/cup_friction.yaml",
            changes,
            "--motion",
            "slide",
            "--lockstep",
            "--duration",
            "20",
        )
        bag = self.folder / "bag"
        self.assertEqual(self.equal(bag, 20000)["changes"], 3)
        self.assertEqual(len(messages(bag, MADE)), 3)
        before = pathlib.Path(shutil.copytree(bag, self.folder / "before"))
        forget = "DELETE FROM messages WHERE topic_id = (SELECT id FROM topics WHERE name = ?)"
        edit(bag, forget, ASKED)
        self.assertEqual(
            self.equal(bag, 20000)["changes"], 3, "the record of what was made is enough"
        )
        edit(before, forget, MADE)
        edit(before, "DELETE FROM topics WHERE name = ?", MADE)
        self.assertEqual(
            self.equal(before, 20000)["changes"], 3, "a bag of before has question and answer"
        )
        edit(bag, forget, MADE)
        status, said, _ = replay(bag)
        self.assertEqual((status, said["changes"]), (1, 0))
        self.assertTrue(
            any(re.search(r"\b3 changes\b.*\b0\b", s) for s in said["missing"]), said["missing"]
        )

    def test_surplus_record_is_reported(self):
        """As in a bag of `ros2 bag record`, which also records an unauthorised record: our
        recorder refuses it (tests/ring/forged_record_test.cpp)."""
        bag = self.copy()
        session = struct.unpack_from("<Q", message_of(bag, STATE, 0)[1], HEADER)[0]
        forged = b"\0\1\0\0" + struct.pack(
            "<QQQI I9s3x I1s7x 3dd I1s",
            0,
            session,
            1000,
            1,
            9,
            b"friction\0",
            1,
            b"\0",
            0.0,
            0.0,
            0.0,
            0.0,
            1,
            b"\0",
        )
        self.assertEqual(
            edit(
                bag,
                (
                    "INSERT INTO messages (topic_id, timestamp, data) SELECT id, ?, ? FROM topics"
                    " WHERE name = ?"
                ),
                1_000_000_000,
                forged,
                MADE,
            ),
            1,
        )
        status, said, err = replay(bag)
        self.assertEqual((status, said["changes"]), (0, 1), f"{said} {err}")
        self.assertIn("sample 1000", said["missing"][0])
        self.assertRegex(said["missing"][1], r"\b1 changes\b.*\b0\b")

    def test_design_shifted_or_off_by_a_bit_is_detected(self):
        bag = self.folder / "bag"
        self.change(
            bag,
            scene_of(self.folder, "cup_friction", ("kind: auto", "kind: shaping_filter")),
            [("friction", "stiffness_n_per_m=80", "--from-sample", 1500)],
            "--motion",
            "slide",
            "--lockstep",
            "--duration",
            "3",
        )
        self.assertEqual(self.equal(bag, 3000)["design"], {"compared": 2, "differ": 0})
        (first, design), (second, later) = messages(bag, DESIGN)
        self.assertEqual(struct.unpack_from("<Q", later, NUMBER)[0], 1500)
        late = bytearray(later[:NUMBER] + struct.pack("<Q", 1600) + later[NUMBER + 8 :])
        late[gain_of(later)] ^= 1
        edit(bag, "UPDATE messages SET data = ? WHERE id = ?", bytes(late), second)
        _, said, _ = replay(bag)
        self.assertTrue(1600 <= said["command"]["first"]["sample"] <= 1700, said)
        edit(bag, "UPDATE messages SET data = ? WHERE id = ?", later, second)
        at = gain_of(design)
        changed = bytearray(design)
        changed[at] ^= 1  # the last bit of the gain
        edit(bag, "UPDATE messages SET data = ? WHERE id = ?", bytes(changed), first)
        status, said, _ = replay(bag)
        self.assertEqual((status, said["design"]), (1, {"compared": 2, "differ": 1}), said)
        self.assertRegex(" ".join(said["notes"]), r"Design 1: gain [0-9.]+ recorded, [0-9.]+ now")
        edit(bag, "DELETE FROM messages WHERE id = ?", second)
        _, said, _ = replay(bag)
        self.assertIn("used 2 designs, recorded: 1", " ".join(said["missing"]))

    def real_time(self, bag):
        """Equal if the bag is complete; otherwise the missing parts are reported."""
        status, said, err = replay(bag)
        self.assertGreater(said["contact"]["compared"], 1000, f"{said} {err}")
        self.assertGreater(said["command"]["compared"], 1000, f"{said} {err}")
        if not said["missing"]:
            self.assertEqual(status, 0, f"{said} {err}")
            self.assertEqual((said["contact"]["differ"], said["command"]["differ"]), (0, 0), said)
        return said

    def test_real_time_run_is_bit_identical_or_reports_gaps(self):
        record(
            self.folder / "bag", DEPLOY / "scenes/cup.yaml", "--motion", "slide", "--duration", "3"
        )
        said = self.real_time(self.folder / "bag")
        self.assertFalse(said["lockstep"])

    def test_real_time_bag_records_where_a_design_holds(self):
        self.change(
            self.folder / "bag",
            DEPLOY / "scenes/cup_friction.yaml",
            [("friction", "stiffness_n_per_m=80", "--from-sample", 2000)],
            "--motion",
            "slide",
            "--duration",
            "6",
        )
        said = self.real_time(self.folder / "bag")
        self.assertEqual(said["changes"], 1)
        starts = [
            struct.unpack_from("<Q", data, NUMBER)[0]
            for _, data in messages(self.folder / "bag", DESIGN)
        ]
        self.assertTrue(len(starts) == 2 and starts[0] == 0 and starts[1] >= 2000, starts)
        self.assertTrue(said["missing"] or said["design"] == {"compared": 2, "differ": 0}, said)

    def test_one_bit_of_a_device_sample_is_found_at_its_sample(self):
        bag = self.copy()
        row, data = message_of(bag, STATE, 1234)
        changed = bytearray(data)
        changed[POSE] ^= 1  # the last bit of the position's x
        edit(bag, "UPDATE messages SET data = ? WHERE id = ?", bytes(changed), row)
        status, said, _ = replay(bag)
        self.assertEqual(status, 1)
        self.assertFalse(said["ok"])
        self.assertEqual(said["contact"]["first"]["sample"], 1234)
        fields = {f["field"]: f for f in said["contact"]["first"]["fields"]}
        self.assertIn("tool_pose.position.x", fields)
        self.assertLess(float(fields["tool_pose.position.x"]["by"]), 1e-15)
        text = voxtouch("replay", bag).stdout
        self.assertIn("sample 1234;", text)
        self.assertIn("tool_pose.position.x: ", text)

    def test_external_wrench_acts_from_its_sample_until_stale(self):
        bag = self.folder / "bag"
        record(
            bag,
            DEPLOY / "scenes/cup_external.yaml",
            "--motion",
            "rest",
            "--lockstep",
            "--duration",
            "1",
        )
        self.equal(bag, 1000)
        session, number, time_ns = struct.unpack_from(
            "<QQq", message_of(bag, STATE, 500)[1], HEADER
        )
        taken = struct.pack("<4xQQq6d", session, number, time_ns, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
        insert = (
            "INSERT INTO messages (topic_id, timestamp, data) SELECT id, ?, ? FROM topics WHERE"
            " name = '/haptic/rendering/external'"
        )
        self.assertEqual(edit(bag, insert, time_ns, b"\x00\x01\x00\x00" + taken[4:]), 1)
        status, said, _ = replay(bag)
        self.assertEqual((status, said["contact"]["first"]["sample"]), (1, 500), said)
        self.assertIn(
            "effects_wrench.force.y", [f["field"] for f in said["contact"]["first"]["fields"]]
        )
        # 50 ms until it is late, 20 ms of fade from 1 N with 50 N/s; the hand rests, so that it
        # gets no energy.
        self.assertTrue(68 <= said["contact"]["differ"] <= 74, said)

    def test_one_bit_of_a_recorded_answer_is_found(self):
        for topic, at, name, field in (
            (CONTACT, HEADER + 24 + 112, "contact", "wrench.force.x"),
            (COMMAND, HEADER + 32, "command", "wrench.force.x"),
            (COMMAND, HEADER + 100, "command", "injected_n"),
        ):
            with self.subTest(topic):
                bag = self.copy(f"{name}.{field}")
                row, data = message_of(bag, topic, 777)
                changed = bytearray(data)
                changed[at] ^= 1
                edit(bag, "UPDATE messages SET data = ? WHERE id = ?", bytes(changed), row)
                status, said, _ = replay(bag)
                self.assertEqual(
                    (status, said["contact"]["differ"] + said["command"]["differ"]), (1, 1), said
                )
                self.assertEqual(
                    (
                        said[name]["first"]["sample"],
                        [f["field"] for f in said[name]["first"]["fields"]],
                    ),
                    (777, [field]),
                )

    def test_another_scene_is_reported_with_both_forces(self):
        scene = scene_of(self.folder, "cup", ("voxel_size: 0.002", "voxel_size: 0.003"))
        picture = self.folder / "forces.png"
        ran = voxtouch("replay", self.cup, "--scene", scene, "--plot", picture)
        self.assertEqual(ran.returncode, 1, ran.stderr)
        self.assertRegex(ran.stdout, r"'cup' \([0-9a-f]{16}\).*'cup' \([0-9a-f]{16}\)")
        self.assertRegex(
            ran.stdout,
            r"returned +\d+\.\d{3} +\d+\.\d{3} +\d+\.\d % +\d+\.\d{3} +\d+\.\d{3} +\d+\.\d %",
        )
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")
        status, said, _ = replay(self.cup, "--scene", scene)
        self.assertEqual((status, said["scene"]["same"]), (1, False))
        self.assertGreater(said["contact"]["differ"], 100)
        self.assertGreater(said["contact"]["largest_force"]["n"], 0.01)
        self.assertNotEqual(
            said["forces"]["rendered"]["recorded"], said["forces"]["rendered"]["replayed"]
        )

    def test_changed_or_missing_scene_file_is_reported(self):
        scene = scene_of(self.folder, "plane")
        record(self.folder / "bag", scene, "--motion", "slide", "--lockstep", "--duration", "1")
        self.equal(self.folder / "bag", 1000)
        scene.write_text(scene.read_text() + "# a word more\n")
        status, said, _ = replay(self.folder / "bag")
        self.assertEqual(
            (status, said["scene"]["same"]),
            (0, False),
            "it is another file, and gives bit-identical results",
        )
        scene.unlink()
        self.assertIn("--scene", self.refused(self.folder / "bag"))

    def test_lost_messages_are_counted_and_reported(self):
        bag = self.copy()
        for topic, number in ((STATE, 500), (CONTACT, 800)):
            edit(bag, "DELETE FROM messages WHERE id = ?", message_of(bag, topic, number)[0])
        status, said, _ = replay(bag)
        self.assertEqual(said["lost"], {"device_state": 1, "contact_state": 1})
        self.assertEqual((said["contact"]["compared"], said["command"]["compared"]), (1998, 2000))
        self.assertIn("sample 500", said["missing"][0])
        self.assertEqual(status, int(said["contact"]["differ"] + said["command"]["differ"] > 0))
        bag = self.copy("late")
        for topic in (STATE, CONTACT, COMMAND):
            for number in (0, 1):
                edit(bag, "DELETE FROM messages WHERE id = ?", message_of(bag, topic, number)[0])
        _, said, _ = replay(bag)
        self.assertTrue(
            any(
                re.search(r"\b2 contacts\b.*\bsample 0\b.*\bsample 2\b", s) for s in said["missing"]
            ),
            said["missing"],
        )
        bag = self.copy("silent")
        for topic in (STATE, CONTACT, COMMAND):
            edit(bag, "DELETE FROM messages WHERE id = ?", message_of(bag, topic, 900)[0])
        _, said, _ = replay(bag)
        self.assertTrue(any("1 contacts" in s for s in said["missing"]), said["missing"])

    def test_a_cut_recording_fails(self):
        """What is there is bit-identical, but half of the messages are gone."""
        bag = self.copy("cut")
        with sqlite3.connect(database(bag)) as connection:
            connection.execute("DELETE FROM messages WHERE id > (SELECT max(id) / 2 FROM messages)")
        connection.close()
        status, said, _ = replay(bag)
        self.assertEqual((status, said["ok"], said["contact"]["differ"]), (1, False, 0))
        self.assertEqual(len(said["losses"]), 1, said)
        self.assertIn("FAILED", voxtouch("replay", bag).stdout)

    def test_a_recording_without_a_topic_fails(self):
        """As a filtered copy: its metadata agrees with the messages that it has."""
        for name in (CONTACT, COMMAND):
            with self.subTest(without=name):
                bag = self.copy("without" + name.replace("/", "_"))
                topic = "topic_id IN (SELECT id FROM topics WHERE name LIKE '%" + name + "')"
                with sqlite3.connect(database(bag)) as connection:
                    gone = connection.execute(f"DELETE FROM messages WHERE {topic}").rowcount
                connection.close()
                self.assertGreater(gone, 0)
                metadata = bag / "metadata.yaml"
                text = metadata.read_text()
                total = int(re.search(r"message_count: (\d+)", text)[1])
                metadata.write_text(
                    text.replace(f"message_count: {total}", f"message_count: {total - gone}")
                )
                status, said, _ = replay(bag)
                self.assertEqual((status, said["ok"], said["losses"]), (1, False, []), said)
                self.assertIn("FAILED: the recording is incomplete", voxtouch("replay", bag).stdout)

    def test_duplicate_command_is_replayed_once(self):
        bag = self.copy()
        edit(
            bag,
            (
                "INSERT INTO messages (topic_id, timestamp, data) SELECT topic_id, timestamp, data"
                " FROM messages WHERE id = ?"
            ),
            message_of(bag, COMMAND, 1300)[0],
        )
        self.assertIn("1 duplicate", self.equal(bag, 2000)["notes"][0])

    def test_unreplayable_bag_is_refused_with_a_message(self):
        bag = self.copy("undescribed")
        edit(
            bag,
            (
                "DELETE FROM messages WHERE topic_id = (SELECT id FROM topics WHERE name ="
                " '/haptic/device/description')"
            ),
        )
        self.assertIn("/haptic/device/description", self.refused(bag))
        bag = self.copy("truncated")
        os.truncate(database(bag), database(bag).stat().st_size // 2)
        self.refused(bag)
        bag = self.copy("strange")
        edit(bag, "UPDATE topics SET name = '/camera' || name, type = 'sensor_msgs/msg/Image'")
        self.assertIn("/<rig>/device/state", self.refused(bag))
        bag = self.copy("other version")
        edit(
            bag,
            (
                "UPDATE messages SET data = substr(data, 1, 100) WHERE topic_id = (SELECT id FROM"
                " topics WHERE name = ?)"
            ),
            STATE,
        )
        self.assertIn("another version", self.refused(bag))
        bag = self.copy("empty")
        edit(bag, "DELETE FROM messages")
        self.assertIn("device samples", self.refused(bag))
        (self.folder / "none").mkdir()
        self.refused(self.folder / "none")
        self.assertRegex(self.refused(self.cup, "--rig", "left"), r"'left'.*haptic")
        ran = voxtouch("replay", self.folder / "none", "--json")
        self.assertFalse(json.loads(ran.stdout)["ok"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

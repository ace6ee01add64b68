"""deploy/python, installed by pip: bits of probe and build against the command line's, bags of both
storages, topics and examples against a ring.

usage: package_test.py ROOT BUILD MAKE_BAG [arguments of unittest]
"""

import csv
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import cyclonedds
import numpy

ROOT, BUILD, MAKE_BAG = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
VOXTOUCH = BUILD / "bin/voxtouch"
EXAMPLES = ROOT / "deploy/examples"
PLACE = tempfile.TemporaryDirectory(prefix="voxtouch_test_package_")
FOLDER = pathlib.Path(PLACE.name)
STREAMS = ("/haptic/device/state", "/haptic/rendering/contact", "/haptic/coupling/command")
DOMAIN = 87


def setUpModule():
    environment = {**os.environ, "VOXTOUCH_BUILD": str(BUILD), "MATPLOTLIBRC": os.devnull}
    installed = subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "install",
            "--quiet",
            "--no-build-isolation",
            "--no-deps",
            "--no-index",
            "--target",
            FOLDER / "site",
            ROOT / "deploy/python",
        ],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
    )
    assert installed.returncode == 0, installed.stdout + installed.stderr
    sys.path.insert(0, str(FOLDER / "site"))
    global voxtouch
    import voxtouch


def run(*words, **more):
    return subprocess.run(
        [str(word) for word in words],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        **more,
    )


def record(name, *words, domain=DOMAIN):
    bag = FOLDER / name
    ran = run(
        VOXTOUCH,
        "up",
        "cup",
        "--motion",
        "slide",
        "--no-report",
        "--one-process",
        "--record",
        bag,
        "--domain",
        domain,
        *words,
    )
    assert (bag / "metadata.yaml").exists(), ran.stderr
    return bag


def table_of(text):
    return list(csv.DictReader(text.splitlines()))


class Computes(unittest.TestCase):
    def poses(self):
        random = numpy.random.default_rng(5)
        return numpy.concatenate(
            [
                random.normal(size=(300, 4)),
                random.uniform([-0.05, -0.05, -0.02], [0.05, 0.05, 0.08], (300, 3)),
            ],
            axis=1,
        )

    def test_the_wrenches_of_probe_bit_by_bit(self):
        poses = self.poses()
        file = FOLDER / "poses.csv"
        file.write_text(
            "qw,qx,qy,qz,tx,ty,tz\n"
            + "\n".join(",".join(map(repr, map(float, row))) for row in poses)
            + "\n"
        )
        touched = 0
        for model in ("original", "adapted", "field", None):
            ran = run(
                VOXTOUCH,
                "probe",
                "cup",
                "--poses",
                file,
                "--points",
                *(["--model", model] if model else []),
            )
            self.assertEqual(ran.returncode, 0, ran.stderr)
            expected = table_of(ran.stdout)
            got = voxtouch.probe("cup", poses, model=model, points=True)
            for n, row in enumerate(expected):
                self.assertEqual(
                    (got["surface_hits"][n], got["interior_hits"][n]),
                    (int(row["nS"]), int(row["nI"])),
                    (model, n),
                )
                ours = (got["coherence"][n], *got["force_n"][n], *got["torque_nm"][n])
                self.assertEqual(
                    ours,
                    tuple(float(row[key]) for key in ("coh", "fx", "fy", "fz", "tx", "ty", "tz")),
                    (model, n),
                )
                self.assertEqual(len(got["points"][n]), got["surface_hits"][n])
            touched += int((got["surface_hits"] > 0).sum())
        self.assertGreater(touched, 50)

    def test_the_voxels_and_points_of_build_bit_by_bit(self):
        mesh = ROOT / "deploy/meshes/cup.obj"
        ran = run(VOXTOUCH, "build", mesh, "--voxel", "0.003", "--out", FOLDER / "built")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        got = voxtouch.build(mesh, 0.003)
        rows = table_of((FOLDER / "built/cup_surface.csv").read_text())
        self.assertEqual(len(rows), len(got["surface"]))
        points = {(int(r["i"]), int(r["j"]), int(r["k"])): r for r in rows}
        self.assertEqual({tuple(map(int, v)) for v in got["surface"]}, set(points))
        ours = sorted(
            (tuple(p), tuple(n)) for p, n in zip(got["points_m"].tolist(), got["normals"].tolist())
        )
        theirs = sorted(
            (
                tuple(float(r[k]) for k in ("px", "py", "pz")),
                tuple(float(r[k]) for k in ("nx", "ny", "nz")),
            )
            for r in rows
        )
        self.assertEqual(ours, theirs)
        runs = table_of((FOLDER / "built/cup_interior.csv").read_text())
        self.assertEqual(
            len(got["interior"]), sum(int(r["k_last"]) - int(r["k_first"]) + 1 for r in runs)
        )
        self.assertTrue(got["closed"])

    def test_the_coupling_of_design(self):
        ran = run(VOXTOUCH, "design", "--device", "sim-phantom", "--scene", "cup", "--json")
        expected, got = json.loads(ran.stdout), voxtouch.design("sim-phantom", "cup")
        self.assertEqual(got, expected)
        self.assertEqual(
            voxtouch.design("sim:touch")["device"],
            json.loads(run(VOXTOUCH, "design", "--device", "sim:touch", "--json").stdout)["device"],
        )

    def test_errors_are_exceptions_with_a_message(self):
        for error, words, call in (
            (
                ValueError,
                "is neither a file nor a shipped scene. Shipped scenes: block, cup",
                lambda: voxtouch.probe("nothing", [[1, 0, 0, 0, 0, 0, 0]]),
            ),
            (ValueError, "n rows of 7", lambda: voxtouch.probe("cup", [1, 2, 3])),
            (
                ValueError,
                "not a finite number",
                lambda: voxtouch.probe("cup", [[1, 0, 0, 0, 0, 0, float("nan")]]),
            ),
            (
                ValueError,
                "quaternion's norm",
                lambda: voxtouch.probe("cup", [[0, 0, 0, 0, 0, 0, 0]]),
            ),
            (
                ValueError,
                "unknown contact model",
                lambda: voxtouch.probe("cup", [[1, 0, 0, 0, 0, 0, 0]], model="soft"),
            ),
            (RuntimeError, "nothing.obj", lambda: voxtouch.build("nothing.obj", 0.002)),
            (ValueError, "voxel is", lambda: voxtouch.build(ROOT / "deploy/meshes/cup.obj", -1)),
            (Exception, "mouse", lambda: voxtouch.design("mouse")),
            (
                ValueError,
                "hand: 'foot' is not one of",
                lambda: voxtouch.design("sim-phantom", hand="foot"),
            ),
            (voxtouch.BagError, "no recording here", lambda: voxtouch.open_bag(EXAMPLES)),
        ):
            with self.assertRaises(error) as caught:
                call()
            self.assertIn(words, str(caught.exception))
        broken = FOLDER / "broken.obj"
        broken.write_bytes(b"v 0 0 0\nf 1 2 3\n")
        with self.assertRaises(RuntimeError) as caught:
            voxtouch.build(broken, 0.002)
        self.assertIn("broken.obj", str(caught.exception))


class Bags(unittest.TestCase):
    def test_both_storages_give_the_same_arrays(self):
        first = voxtouch.open_bag(
            record("sqlite", "--lockstep", "--duration", "2", "--record-format", "sqlite3")
        )
        second = voxtouch.open_bag(
            record("mcap", "--lockstep", "--duration", "2", "--record-split-s", "0.8")
        )
        self.assertEqual(sorted(first), sorted(second))
        self.assertEqual(first.types, second.types)
        self.assertEqual(len(list((FOLDER / "mcap").glob("*.mcap"))), 3)
        for bag in (first, second):
            output = {one["name"]: one["written"] for one in bag.recording()["topics"]}
            self.assertEqual({topic: len(bag[topic]) for topic in bag}, output)
            self.assertEqual(bag.notes, [])
        for topic in STREAMS:
            one, other = (
                numpy.sort(bag[topic], order="sequence_number") for bag in (first, second)
            )
            self.assertEqual(len(one), 2000)
            for name in one.dtype.names:
                if name != "session_id":
                    self.assertEqual(one[name].tobytes(), other[name].tobytes(), (topic, name))
        force = second["/haptic/coupling/command"]["wrench"]["force"]
        self.assertGreater(numpy.hypot(numpy.hypot(force["x"], force["y"]), force["z"]).max(), 0.01)
        # Data that the bag of the other storage lacks is in this one.
        status = second["/haptic/node_status"]
        self.assertIn("rendering", set(status["node"]))
        self.assertIsInstance(status["figures"][0], list)

    def test_frames_have_a_column_for_each_number(self):
        import pandas

        bag = voxtouch.open_bag(record("frames", "--lockstep", "--duration", "0.3"))
        frame = bag.frame("/haptic/device/state")
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(len(frame), 300)
        self.assertTrue(
            {"bag_time_ns", "sequence_number", "pose.position.x", "twist.linear.z", "flags"}
            <= set(frame.columns)
        )
        self.assertTrue((frame["pose.orientation.w"] <= 1).all())
        self.assertEqual(set(bag.frames()), set(bag))

    def test_of_a_recorder_that_was_killed(self):
        for storage in ("sqlite3", "mcap"):
            for more in ((), ("split",)):
                folder = FOLDER / f"killed_{storage}_{len(more)}"
                self.assertEqual(
                    run(MAKE_BAG, folder, "killed", storage, *more).returncode, -signal.SIGKILL
                )
                bag = voxtouch.open_bag(folder)
                states = bag["/haptic/device/state"]
                self.assertEqual(list(states["sequence_number"]), list(range(500)))
                self.assertEqual(
                    list(states["pose"]["position"]["z"]), [0.002 * i for i in range(500)]
                )
                if storage == "mcap":  # a type that no version of voxtouch has
                    self.assertEqual(bag["/haptic/note"]["data"][0], "hello")


def start_ring(bag, domain, log, scene="cup_friction", motion="slide"):
    """A ring in real time that has begun to answer samples."""
    ring = subprocess.Popen(
        [
            VOXTOUCH,
            "up",
            scene,
            "--motion",
            motion,
            "--duration",
            "0",
            "--no-report",
            "--record",
            bag,
            "--domain",
            str(domain),
        ],
        stdout=subprocess.DEVNULL,
        stderr=log,
        text=True,
    )
    until = time.monotonic() + 40
    while (
        " samples  force" not in pathlib.Path(log.name).read_text(encoding="utf-8")
        and time.monotonic() < until
        and ring.poll() is None
    ):
        time.sleep(0.05)
    return ring


def stop_ring(ring):
    ring.send_signal(signal.SIGINT)
    ring.wait(60)


def example(name, *words):
    return run(
        sys.executable,
        "-B",
        EXAMPLES / name,
        *words,
        env={**os.environ, "PYTHONPATH": str(FOLDER / "site"), "MPLBACKEND": "Agg"},
    )


class OwnEffect(unittest.TestCase):
    def test_the_ros2_example_pulls_the_tool(self):
        """With a replacement of rclpy over PyPI's cyclonedds."""
        with open(FOLDER / "ros2.log", "w", encoding="utf-8") as log:
            ring = start_ring(FOLDER / "ros2", DOMAIN, log, scene="cup_external", motion="rest")
            ran = run(
                sys.executable,
                "-B",
                EXAMPLES / "ros2_spring.py",
                env={
                    **os.environ,
                    "PYTHONPATH": f"{pathlib.Path(__file__).parent / 'stand_in'}:{FOLDER / 'site'}",
                    "ROS_DOMAIN_ID": str(DOMAIN),
                    "STAND_IN_SECONDS": "3",
                },
            )
            stop_ring(ring)
        self.assertEqual(ran.returncode, 0, ran.stderr + ran.stdout)
        bag = voxtouch.open_bag(FOLDER / "ros2")
        force = bag["/haptic/rendering/contact"]["effects_wrench"]["force"]["z"]
        height = bag["/haptic/rendering/contact"]["tool_pose"]["position"]["z"]
        at_rest = numpy.flatnonzero(force > 0.5)
        self.assertGreater(len(at_rest), 300)
        middle = at_rest[len(at_rest) // 2]
        self.assertAlmostEqual(force[middle], 30.0 * (0.08 - height[middle]), delta=0.05)

    def test_example_wrench_is_bounded_and_fades_with_its_program(self):
        with open(FOLDER / "own.log", "w", encoding="utf-8") as log:
            ring = start_ring(FOLDER / "own", DOMAIN, log, scene="cup_external", motion="rest")
            ran = example(
                "own_effect.py",
                "--topic",
                "/sim/wrench",
                "--stiffness",
                30,
                "--most",
                1,
                "--domain",
                DOMAIN,
                "--seconds",
                3,
            )
            time.sleep(1.0)  # longer than the effect's timeout and fade
            stop_ring(ring)
        self.assertEqual(ran.returncode, 0, ran.stderr + ran.stdout)
        bag = voxtouch.open_bag(FOLDER / "own")

        def sizes(wrenches):
            return numpy.sqrt(sum(wrenches["force"][axis] ** 2 for axis in "xyz"))

        written = sizes(bag["/haptic/rendering/external"]["wrench"])
        self.assertGreater(len(written), 300, ran.stdout)
        self.assertGreater(written.min(), 0.0)
        self.assertLess(written.max(), 1.0 + 1e-9, "the example's own bound")
        effect_force = sizes(bag["/haptic/rendering/contact"]["effects_wrench"])
        self.assertGreater(effect_force.max(), 0.5)
        self.assertLess(effect_force.max(), 1.5, "the scene's bound")
        self.assertEqual(
            effect_force[-100:].max(), 0.0, "nothing is displayed of a program that has ended"
        )
        self.assertGreater(
            sizes(bag["/haptic/coupling/command"]["wrench"]).max(),
            0.1,
            "the device is asked for it",
        )


class Ring(unittest.TestCase):
    """Next to a ring in real time."""

    def setUp(self):
        self.bag = FOLDER / f"ring_{self.id().rsplit('.', 1)[-1]}"
        self.log = open(FOLDER / "ring.log", "w", encoding="utf-8")
        self.ring = start_ring(self.bag, DOMAIN, self.log)
        self.assertIn(" samples  force", self.said())

    def said(self):
        return pathlib.Path(self.log.name).read_text(encoding="utf-8")

    def tearDown(self):
        stop_ring(self.ring)
        self.log.close()

    def test_the_examples_run(self):
        ran = example("own_effect.py", "--domain", DOMAIN, "--seconds", "1")
        self.assertEqual(ran.returncode, 0, ran.stderr + ran.stdout)
        self.assertGreater(int(ran.stdout.splitlines()[-1].split()[0]), 100, ran.stdout)
        # Debian's Python has matplotlib; of ours it gets cyclonedds.
        dds = FOLDER / "dds"
        dds.mkdir()
        for part in pathlib.Path(cyclonedds.__file__).parents[1].glob("cyclonedds*"):
            (dds / part.name).symlink_to(part)
        ran = run(
            "/usr/bin/python3",
            "-B",
            EXAMPLES / "live_plot.py",
            "--domain",
            DOMAIN,
            "--seconds",
            "1",
            "--save",
            FOLDER / "live.svg",
            env={
                **os.environ,
                "PYTHONPATH": f"{FOLDER / 'site'}:{dds}",
                "MPLCONFIGDIR": str(FOLDER),
            },
        )
        self.assertEqual(ran.returncode, 0, ran.stderr + ran.stdout)
        self.assertIn("commands", ran.stdout)
        self.assertGreater((FOLDER / "live.svg").stat().st_size, 5000)

    def test_played_bag_does_not_change_the_force(self):
        """Every topic of a bag of another session, a change of an effect among them, each message
        in its order, for two seconds.
        """
        from voxtouch.types import TOPICS, join
        from voxtouch.types.voxtouch_msgs import EffectChanged

        with open(FOLDER / "to_play.log", "w", encoding="utf-8") as log:
            other = start_ring(FOLDER / "to_play", DOMAIN + 1, log)
            changed = run(VOXTOUCH, "change", "friction", "coulomb=0.1", "--domain", DOMAIN + 1)
            stop_ring(other)
        self.assertEqual(changed.returncode, 0, changed.stderr)
        bag = voxtouch.open_bag(FOLDER / "to_play")
        self.assertEqual(
            list(bag["/haptic/rendering/changed"]["result"]), [EffectChanged.RESULT_DONE]
        )
        participant = join(DOMAIN)
        by_name = {row.dds_name().removeprefix("rt"): row for row in TOPICS.values()}
        played = {
            topic: (
                by_name[topic].writer(participant),
                [by_name[topic].type.deserialize(data) for _, data in bag.raw(topic)],
            )
            for topic in bag
            if topic in by_name
        }
        self.assertTrue(set(STREAMS) <= set(played))
        # The recorder may have discovered `voxtouch change` too late to receive its request; the
        # rendering's record of the change has the same content.
        played["/haptic/rendering/change"] = (
            played["/haptic/rendering/change"][0],
            played["/haptic/rendering/made"][1],
        )
        self.assertEqual(len(played["/haptic/rendering/change"][1]), 1)
        # Requests before the rendering discovers the writer are not answered, which on a busy
        # machine may take longer than the ring runs.
        until = time.monotonic() + 20
        while (
            len(played["/haptic/rendering/change"][0].get_matched_subscriptions()) < 2
        ):  # the rendering and the logger
            self.assertLess(time.monotonic(), until, "rendering and logger read changes")
            time.sleep(0.05)
        end, written, n = time.monotonic() + 2, 0, 0
        while time.monotonic() < end or written <= 2000:
            for writer, messages in played.values():
                if messages:
                    writer.write(messages[n % len(messages)])
                    written += 1
            n += 1
            time.sleep(0.0005)
        time.sleep(1.0)
        self.assertIsNone(self.ring.poll(), self.said())
        stop_ring(self.ring)
        ours = voxtouch.open_bag(self.bag)
        states = ours["/haptic/device/state"]
        own = numpy.unique(states["session_id"], return_counts=True)
        session = own[0][own[1].argmax()]  # the ring's: the bag has all messages on the wire
        figures = [one for one in ours["/haptic/node_status"] if one["node"] == "device"][-1][
            "figures"
        ]
        most = {one["name"]: one["value"] for one in figures}
        self.assertLess(most["max_force_n"], 1.0)
        commands = ours["/haptic/coupling/command"]
        commands = commands[commands["session_id"] == session]
        self.assertGreater(len(commands), 1500)
        self.assertLess(
            max(numpy.abs(commands["wrench"]["force"][axis]).max() for axis in "xyz"), 1.0
        )
        own_answers = ours["/haptic/rendering/changed"]
        own_answers = own_answers[own_answers["session_id"] == session]
        self.assertEqual(
            set(own_answers["result"]),
            {EffectChanged.RESULT_REFUSED},
            "events of a bag are not applied",
        )
        self.assertIn("session", own_answers["sentence"][0])
        self.assertIn(
            "are refused",
            " ".join(ours["/haptic/node_status"]["message"]),
            "who plays the bag is named",
        )


class Examples(unittest.TestCase):
    def test_each_describes_itself(self):
        for file in sorted(EXAMPLES.glob("*.py")):
            if file.name == "ros2_spring.py":
                continue  # it has no options; OwnEffect runs it
            ran = run(
                sys.executable,
                "-B",
                file,
                "--help",
                env={**os.environ, "PYTHONPATH": str(FOLDER / "site")},
            )
            if file.name == "live_plot.py" and "No module named 'matplotlib'" in ran.stderr:
                continue  # Ring runs it if matplotlib is installed
            self.assertEqual(ran.returncode, 0, ran.stderr)
            self.assertIn("--", ran.stdout)

    def test_accuracy_of_a_part_names_a_setting(self):
        ran = run(
            sys.executable,
            "-B",
            EXAMPLES / "accuracy_of_a_part.py",
            ROOT / "deploy/scenes/cup.yaml",
            "--models",
            "adapted",
            "--contacts",
            "20",
            "--voxel-sizes",
            "0.004",
            "--voxtouch",
            VOXTOUCH,
        )
        self.assertEqual(ran.returncode, 0, ran.stderr + ran.stdout)
        self.assertIn("adapted", ran.stdout)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

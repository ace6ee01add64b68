"""RViz, Foxglove and rclpy with a ring, as far as their rules can be tested without them: readers
with their default QoS, in a process of PyPI's cyclonedds.
"""

import json
import math
import os
import pathlib
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import unittest

BIN, DEPLOY, DOMAIN = (
    pathlib.Path(os.environ["VOXTOUCH_BIN"]),
    pathlib.Path(os.environ["VOXTOUCH_DEPLOY"]),
    94,
)
TYPES = tempfile.TemporaryDirectory()
subprocess.run(
    [BIN / "voxtouch", "types", "--python", TYPES.name], check=True, stdout=subprocess.DEVNULL
)
sys.path[:0] = [TYPES.name, str(DEPLOY.parent / "tests" / "view")]

from cyclonedds.qos import Policy, Qos  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from looker import Looker, join  # noqa: E402
from page_client import Process, fine_scene, until, until_it_runs  # noqa: E402
from rviz_rules import ADD, ARROW, SPHERE_LIST, TEXT, TRIANGLES, seconds  # noqa: E402
from voxtouch_types import TOPICS  # noqa: E402

HERE = pathlib.Path(__file__).parent


def vector(p):
    return (p.x, p.y, p.z)


def deep_tap(participant, path):
    """Loses nothing while this process makes objects of a mesh."""
    return DataReader(
        participant,
        TOPICS[path].topic(participant),
        qos=Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5000)),
    )


def ring(scene, *more):
    return Process("up", str(scene), "--domain", str(DOMAIN), "--no-record", *more)


class Pictures(unittest.TestCase):
    def setUp(self):
        self.participant = join(DOMAIN)

    def test_rviz_draws_tool_objects_forces_and_points(self):
        looker = Looker(self.participant)
        commands, contacts = (
            deep_tap(self.participant, path) for path in ("coupling/command", "rendering/contact")
        )
        forces = {"force_returned": set(), "force_of_contact": set()}

        def listen():
            forces["force_returned"].update(
                vector(c.wrench.force) for c in commands.take(N=5000) if c.sample_info.valid_data
            )
            forces["force_of_contact"].update(
                vector(c.contact_wrench.force)
                for c in contacts.take(N=5000)
                if c.sample_info.valid_data
            )
            return True

        with ring(DEPLOY / "scenes" / "objects.yaml", "--motion", "under") as up:
            until_it_runs(up)
            looker.poll(14.0, listen)
        self.assertEqual(looker.errors(), [])
        self.assertEqual(
            set(looker.frames.of), {"haptic/device", "haptic/tool", "haptic/object/roller"}
        )
        self.assertTrue(looker.frames.of["haptic/device"]["fixed"])
        heights = [place[2] for _, place in looker.frames.of["haptic/object/roller"]["way"]]
        self.assertGreater(
            max(heights) - min(heights), 0.02, "the roller moves, and its mesh with its frame"
        )

        meshes = {
            ns: looker.markers.of(ns) for ns in ("scene", "object/cup", "object/roller", "tool")
        }
        self.assertEqual(
            {ns: {m.header.frame_id for m in ms} for ns, ms in meshes.items()},
            {
                "scene": {"world"},
                "object/cup": {"world"},
                "object/roller": {"haptic/object/roller"},
                "tool": {"haptic/tool"},
            },
        )
        for name_space, shown in meshes.items():
            self.assertTrue(all(m.type == TRIANGLES and m.frame_locked for m in shown), name_space)
        reach = [math.hypot(*vector(p)) for m in meshes["tool"] for p in m.points]
        self.assertAlmostEqual(
            max(reach), 0.01, 6, "the sphere's file has radius 1, its scale is 0.01"
        )
        highest = max(p.z for m in meshes["scene"] for p in m.points)
        self.assertAlmostEqual(highest, 0.0, 6, "the table's top")

        arrays = [m for _, _, m in looker.seen["markers"]]
        for name_space, known in forces.items():
            arrows = [
                m for a in arrays for m in a.markers if m.ns == name_space and m.action == ADD
            ]
            self.assertGreater(len(arrows), 5, name_space)
            for arrow in arrows:
                self.assertEqual(arrow.type, ARROW)
                force = [(b - a) / 0.02 for a, b in zip(*map(vector, arrow.points))]
                nearest = min(math.dist(force, f) for f in known)
                self.assertLess(nearest, 1e-6, f"{name_space} {force} is none that the ring had")
        points = [
            m for a in arrays for m in a.markers if m.ns == "contact_points" and m.action == ADD
        ]
        self.assertGreater(len(points), 5)
        tool = dict(looker.frames.of["haptic/tool"]["way"])
        for m in points:
            self.assertEqual(m.type, SPHERE_LIST)
            at = tool.get(seconds(m.header.stamp))
            for p in m.points if at else []:
                self.assertLess(
                    abs(math.dist(vector(p), at) - 0.01),
                    0.004,
                    "points of a sphere of 10 mm, and of this moment",
                )

        # Meshes were sent twice at first; from then on a round in ten seconds at most.
        begin = looker.markers.corners_sent[0][0]
        late = [corners for at, corners in looker.markers.corners_sent if at > begin + 4.0]
        all_corners = sum(len(m.points) for ms in meshes.values() for m in ms)
        self.assertLessEqual(sum(late), all_corners)

    def test_late_readers_get_meshes_and_a_reload_removes_them(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "two.yaml"
            text = (
                (DEPLOY / "scenes" / "objects.yaml")
                .read_text()
                .replace("../meshes", str(DEPLOY / "meshes"))
            )
            scene.write_text(text)
            first = Looker(self.participant, paths=("tf", "tf_static", "markers"))
            with ring(scene, "--motion", "free") as up:
                until_it_runs(up)
                shown = lambda looker: {
                    key for key, (m, _) in looker.markers.shown.items() if m.type == TRIANGLES
                }
                first.poll(
                    20.0,
                    lambda: (
                        {ns for ns, _ in shown(first)}
                        < {"scene", "object/cup", "object/roller", "tool"}
                    ),
                )
                first.poll(4.0)
                late = Looker(join(DOMAIN), paths=("tf", "tf_static", "markers"))
                begin = time.monotonic()
                late.poll(10.0, lambda: shown(late) != shown(first))
                self.assertEqual(shown(late), shown(first))
                self.assertLess(time.monotonic() - begin, 3.0)
                self.assertEqual(late.errors(), [])

                lines = text.splitlines(keepends=True)
                gone = [n for n, line in enumerate(lines) if "cylinder.obj" in line][0]
                rest = next(n for n in range(gone + 1, len(lines)) if lines[n][:4].strip())
                scene.write_text("".join(lines[:gone] + lines[rest:]))
                answer = subprocess.run(
                    [BIN / "voxtouch", "change", "--reload", "--domain", str(DOMAIN)],
                    capture_output=True,
                    text=True,
                )
                self.assertEqual(answer.returncode, 0, answer.stdout + answer.stderr)
                end = time.monotonic() + 10.0
                while time.monotonic() < end and any(
                    ns == "object/roller" for looker in (first, late) for ns, _ in shown(looker)
                ):
                    first.poll(0.03), late.poll(0.03)
        for looker in (first, late):
            self.assertEqual({ns for ns, _ in shown(looker)}, {"scene", "object/cup", "tool"})
            self.assertIn(("object/roller", 0), looker.markers.deleted)
            self.assertEqual(looker.errors(), [])

    def test_large_mesh_is_drawn_coarser_and_reported(self):
        with tempfile.TemporaryDirectory() as folder:
            n = 160
            scene = fine_scene(folder, n)
            looker = Looker(self.participant)
            with ring(scene, "--motion", "free") as up:
                until_it_runs(up)
                looker.poll(60.0, lambda: not looker.markers.of("note"))
                looker.poll(1.0)
        count = sum(len(m.points) // 3 for m in looker.markers.of("scene"))
        self.assertGreater(count, 1000)
        self.assertLessEqual(count, 20_000)
        note = looker.markers.of("note")[0]
        self.assertEqual(note.type, TEXT)
        self.assertIn(f"{count} of {12 * n * n} triangles", note.text)
        self.assertEqual(looker.errors(), [])

    def test_lockstep_has_simulated_time_and_a_clock(self):
        looker = Looker(self.participant)
        with ring(
            DEPLOY / "scenes" / "plane.yaml", "--motion", "slide", "--lockstep", "--duration", "6"
        ) as up:
            looker.poll(60.0, lambda: up.process.poll() is None)
            self.assertEqual(up.process.returncode, 0, up.output())
        clock = [seconds(m.clock) for _, _, m in looker.seen["clock"]]
        self.assertGreater(len(clock), 20)
        self.assertEqual(clock, sorted(clock))
        self.assertLess(clock[-1] - clock[0], 6.1)
        for _, _, m in looker.seen["pose"]:
            self.assertTrue(clock[0] - 1.0 <= seconds(m.header.stamp) <= clock[-1] + 1.0)
        arrows = [
            a.markers[0].action
            for _, _, a in looker.seen["markers"]
            if a.markers and a.markers[0].ns == "force_returned"
        ]
        self.assertIn(ADD, arrows)
        self.assertTrue(
            any(action != ADD for action in arrows[arrows.index(ADD) :]),
            "gone where the slide lifts off and no force is",
        )
        self.assertEqual(looker.errors(), [])


class Stopped(unittest.TestCase):
    """A suspended reliable reader blocks no writer."""

    def test_costs_neither_the_ring_nor_other_readers(self):
        looker = Looker(join(DOMAIN), paths=("pose", "markers"), depth=1000)
        with ring(DEPLOY / "scenes" / "cup.yaml", "--motion", "slide") as up:
            until_it_runs(up)
            other = subprocess.Popen(
                [sys.executable, "-B", HERE / "looker.py", TYPES.name, str(DOMAIN), "haptic"],
                stdout=subprocess.PIPE,
                text=True,
            )
            self.addCleanup(other.stdout.close)
            self.addCleanup(other.wait)
            self.addCleanup(other.kill)
            self.assertEqual(other.stdout.readline(), "reads\n")
            looker.poll(4.0)
            until(lambda: looker.markers.of("tool"), 10, "meshes")
            latencies = {"runs": [], "stands": []}
            for how, number in (("runs", signal.SIGCONT), ("stands", signal.SIGSTOP)) * 2:
                # New readers make the ring send meshes, of which the suspended one takes none.
                other.send_signal(number)
                output = len(up.output())
                for _n in range(3):
                    more = Looker(join(DOMAIN), paths=("markers",))
                    looker.poll(2.0)
                    more.poll(0.01)
                latencies[how] += [
                    int(x) for x in re.findall(r"latency p50 +(\d+)", up.output()[output:])
                ]
            answered = [float(x) for x in re.findall(r"answered +([\d.]+) %", up.output())]
        print(json.dumps(latencies))
        written = [at for _, at, _ in looker.seen["pose"]]
        gaps = sorted(b - a for a, b in zip(written, written[1:]))
        self.assertLess(gaps[len(gaps) * 999 // 1000], 0.05, f"poses came with gaps: {gaps[-10:]}")
        moments = [
            at
            for at, _, m in looker.seen["markers"]
            if any(k.ns == "force_returned" for k in m.markers)
        ]
        self.assertGreater(
            len(moments), 0.8 * 10 * (moments[-1] - moments[0]), "forces stopped for who looks on"
        )
        self.assertGreater(statistics.median(answered[1:]), 99.0)
        self.assertLess(
            statistics.median(latencies["stands"]), 1.5 * statistics.median(latencies["runs"])
        )


class Layouts(unittest.TestCase):
    """The files for RViz and Foxglove name existing topics and frames."""

    def test_name_existing_topics_and_frames(self):
        known = {row.dds_name()[2:]: row for row in TOPICS.values()}
        rviz = (DEPLOY / "tools" / "voxtouch.rviz").read_text()
        topics = re.findall(r"Value: (/\S+)", rviz)
        self.assertEqual({"/haptic/markers", "/haptic/pose", "/haptic/wrench"}, set(topics))
        self.assertIn("Fixed Frame: world", rviz)
        kinds = {
            "rviz_default_plugins/MarkerArray": "/haptic/markers",
            "rviz_default_plugins/Pose": "/haptic/pose",
            "rviz_default_plugins/Wrench": "/haptic/wrench",
        }
        for kind, topic in kinds.items():
            display = next(part for part in rviz.split("    - ") if f"Class: {kind}\n" in part)
            self.assertIn(f"Value: {topic}", display)
        layout = json.loads((DEPLOY / "tools" / "voxtouch.foxglove.json").read_text())
        text = json.dumps(layout)
        for topic in re.findall(r'"(/(?:haptic/[\w/]+|diagnostics))[".]', text):
            self.assertIn(topic, known)
        panels = set(layout["configById"])
        leaves = set(re.findall(r'"([A-Za-z0-9]+![a-z0-9]+)"', json.dumps(layout["layout"])))
        self.assertEqual(panels, leaves)
        followed = next(c for name, c in layout["configById"].items() if name.startswith("3D!"))
        self.assertIn(followed["followTf"], {"world", "haptic/tool"})


if __name__ == "__main__":
    unittest.main()

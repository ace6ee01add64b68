"""200 random drags of the cup's hand by real pointer events of headless Chromium, at any speed.
Judged by the recorded poses of the tool alone (recorded_tool.py), by the ring's validator, and by
a replay.

VOXTOUCH_SEED sets the seed.
"""

import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy
from browser_test import Browser
from hand_test import led_ring
from page_client import BIN, DEPLOY, scene, until, until_it_runs
from pointer_events import Protocol
from recorded_tool import ConvexTool, deepest, read_obj, rotated_back

sys.path.insert(0, str(DEPLOY / "tools"))
from bag_data import Bag, constants, norm, vector  # noqa: E402

SCENE = "cup_virtual_tool"
DRAGS = int(os.environ.get("VOXTOUCH_DRAGS", "200"))
HANDLE, HANDLE_REACH_M = (0.034, -0.006, 0.085), 0.012  # of the cup: narrow on both sides
MAX_FORCE_N = 8.5  # of the simulated Phantom

# Where the hand wants to be, the camera's axes, the length of a pixel there, the middle of the
# picture, and which page this is.
VIEW = """(() => {
  const hand = voxtouch.hand, {right, up, away} = hand.axes();
  if (!hand.position) hand.grip();
  const box = canvas.getBoundingClientRect();
  return {at: hand.position.toArray(), pixel: hand.pixel(),
    axes: [right, up, away].map(v => v.toArray()),
    middle: [box.x + box.width / 2, box.y + box.height / 2]};
})()"""


def walls_and_tool():
    meshes = DEPLOY / "meshes"
    vertices, triangles = read_obj(meshes / "cup.obj")
    return vertices[triangles], ConvexTool(*read_obj(meshes / "sphere.obj", 0.01))


class RecordedTool(unittest.TestCase):
    """The judge itself, where the depth is known."""

    def setUp(self):
        self.dice, (_, self.tool) = numpy.random.default_rng(45), walls_and_tool()

    def turns(self, count):
        turns = self.dice.normal(size=(count, 4))
        return turns / norm(turns)[:, None]

    def test_depth_in_a_plane_is_that_of_the_deepest_vertex(self):
        plane = numpy.array([[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 2.0, 0.0]]])
        turns = self.turns(300)
        heights = self.dice.uniform(0.0095, 0.01005, 300)
        places = heights[:, None] * [0.0, 0.0, 1.0]
        vertices = numpy.broadcast_to(self.tool.vertices, (300, *self.tool.vertices.shape))
        back = turns * [-1.0, -1.0, -1.0, 1.0]
        true = -(heights + rotated_back(back, vertices)[:, :, 2].min(-1))
        found = deepest(self.tool, plane, places, turns)
        deep = true > 0
        self.assertGreater(deep.sum(), 100)
        self.assertLess(abs(found - true)[deep].max(), 1e-12)
        self.assertTrue((found[~deep] < 0).all())

    def test_meets_a_needle_where_its_tip_is_in_the_tool(self):
        """As deep as the nearest face is above the tip; the needle is thinner than any facet."""
        for turn in self.turns(100):
            tip = self.dice.normal(size=3)
            tip *= self.dice.uniform(0.0099, 0.01005) / norm(tip)
            sides = 1e-9 * self.dice.normal(size=(2, 3))
            needle = numpy.array([[tip, *(3 * tip + sides)]])
            inside = (self.tool.heights - self.tool.normals @ tip).min()
            back = rotated_back((turn * [-1.0, -1.0, -1.0, 1.0])[None], needle)
            (found,) = deepest(self.tool, back, numpy.zeros((1, 3)), turn[None])
            self.assertEqual(found > 0, inside > 0, (found, inside))
            if inside > 0:
                self.assertAlmostEqual(found, inside, delta=1e-8)


class ByPointer(unittest.TestCase):
    def setUp(self):
        self.browser = Browser(960, 600)
        self.addCleanup(self.browser.end)
        self.seed = int(os.environ.get("VOXTOUCH_SEED", "45"))
        self.walls, self.tool = walls_and_tool()

    def goal(self, dice, number):
        """Each fourth one at the handle, the others up to 6 mm off any wall, to either side."""
        if number % 4 == 0:
            while True:
                off = [dice.uniform(-HANDLE_REACH_M, HANDLE_REACH_M) for _ in range(3)]
                if norm(numpy.array(off)) < HANDLE_REACH_M:
                    return numpy.array(HANDLE) + off
        corners = self.walls[dice.randrange(len(self.walls))]
        return corners[0] + [dice.uniform(-0.006, 0.006) for _ in range(3)]

    def drag(self, page, dice, to):
        view = page.value(VIEW)
        path = to - numpy.array(view["at"])
        right, up, away = (float(path @ axis) / view["pixel"] for axis in numpy.array(view["axes"]))
        x, y = view["middle"]
        page.mouse("mouseWheel", x, y, deltaX=0, deltaY=away / -0.3)
        steps, pause_s = dice.choice((1, 2, 4, 8)), dice.choice((0.0, 0.016, 0.04))
        turns = dice.random() < 0.1  # Shift: the same path rotates
        held = {"button": "left", "modifiers": 8 if turns else 0}
        page.mouse("mousePressed", x, y, clickCount=1, **held)
        for n in range(1, steps + 1):
            at = x + right * n / steps, y - up * n / steps
            page.mouse("mouseMoved", *at, buttons=1, **held)
            time.sleep(pause_s)
        page.wait_for(page.mouse("mouseReleased", *at, clickCount=1, **held))
        time.sleep(dice.uniform(0.0, 0.25))

    def lead(self, up):
        until_it_runs(up)
        browser, dice = self.browser, random.Random(self.seed)
        browser.open(up.address())
        ready = "Boolean(voxtouch.hand.facts && voxtouch.frame && voxtouch.scene.meshes.length)"
        until(lambda: browser.js(ready), 40, "the hand")
        page, begin = Protocol(browser.driver), time.monotonic()
        self.addCleanup(page.end)
        for number in range(DRAGS):
            if number % 50 == 0:
                camera = ("home", "front", "side", "top")[number // 50 % 4]
                browser.find(f"[data-camera={camera}]").click()
                took = time.monotonic() - begin
                print(f"{number} of {DRAGS} drags, {took:.0f} s, next: {camera}", flush=True)
            self.drag(page, dice, self.goal(dice, number))
        print(f"{DRAGS} drags in {time.monotonic() - begin:.0f} s", flush=True)
        time.sleep(0.5)

    def test_no_drag_pulls_the_tool_through_a_wall(self):
        print(f"seed {self.seed}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with led_ring(
                scene(SCENE),
                *("--json", "--record", bag, "--no-report", "--validate-every", "10"),
            ) as up:
                self.lead(up)
                up.process.send_signal(signal.SIGINT)
                up.process.wait(60)
                output = up.output()
            run = json.loads(output[output.index("\n{") :])
            self.judge_poses(Bag(bag, requested=["rendering/contact", "coupling/command"]))
            self.judge_run(run)
            self.judge_replay(bag)

    def judge_poses(self, bag):
        contact = bag.tables["rendering/contact"]
        flags = constants("ContactState")
        contact = contact[contact["flags"] & flags["FLAG_NOT_INITIALISED"] == 0]
        pose = contact["object_pose"]
        place, turn = vector(pose["position"]), pose["orientation"]
        quaternions = numpy.stack([turn["x"], turn["y"], turn["z"], turn["w"]], -1)
        begin = time.monotonic()
        depths = deepest(self.tool, self.walls, place, quaternions)
        touches = contact["flags"] & flags["FLAG_CONSTRAINED"] != 0
        contacts = int((touches[1:] & ~touches[:-1]).sum())
        pulled = norm(vector(contact["tool_pose"]["position"]) - place)
        handle = norm(place - HANDLE) < HANDLE_REACH_M + self.tool.outer
        step = norm(place[1:] - place[:-1]).max()
        force = norm(vector(bag.tables["coupling/command"]["wrench"]["force"])).max()
        print(
            f"{len(contact)} samples, {contacts} contacts,"
            f" {100 * touches.mean():.0f} % of the time, {int((touches & handle).sum())} samples at"
            f" the handle; hand up to {1e3 * pulled.max():.1f} mm in, {force:.2f} N;"
            f" {int((depths >= 0).sum())} samples in a wall, longest step {1e3 * step:.2f} mm;"
            f" judged in {time.monotonic() - begin:.0f} s",
            flush=True,
        )
        worst = int(depths.argmax())
        self.assertLess(depths[worst], 0, f"[m] in a wall at {place[worst]} {quaternions[worst]}")
        # Outside at both ends of a step that is shorter than the tool: no wall is between.
        self.assertLess(step, self.tool.heights.min())
        self.assertGreater(contacts, DRAGS // 4)
        self.assertGreater(pulled.max(), 0.002)
        self.assertGreater((touches & handle).sum(), 1000)
        self.assertLess(force, MAX_FORCE_N)

    def judge_run(self, run):
        limits = {name: limit["value"] for name, limit in run["limits"].items()}
        for name in ("passed_through_samples", "tunnelling_suspected_samples"):
            self.assertEqual(limits[name], 0, name)
        validator = run["validator"]
        print(f"validator: {validator}", flush=True)
        self.assertGreater(validator["checked"], 1000)
        self.assertEqual(validator["disagree"], 0, run["problems"])

    def judge_replay(self, bag):
        replay = subprocess.run(
            [BIN / "voxtouch", "replay", bag], capture_output=True, text=True, check=False
        )
        self.assertEqual(replay.returncode, 0, replay.stdout + replay.stderr)


if __name__ == "__main__":
    unittest.main()

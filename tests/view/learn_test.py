"""The learning page: choice of scene, device and mesh, switching the contact model in contact,
the steps of the tour, sound, and saving the last ten seconds."""

import base64
import contextlib
import os
import pathlib
import re
import sys
import tempfile
import time
import unittest
import unittest.mock

from browser_test import Browser
from hand_test import aim, led_ring, newest_frame
from page_client import DEPLOY, WebSocket, size, until, until_it_runs
from selenium.webdriver.common.keys import Keys

sys.path.insert(0, str(DEPLOY / "tools"))
from bag_data import Bag  # noqa: E402


def opened(address, scene, patience_s=90):
    """A socket of the ring that runs this scene, which begins to listen at some time."""
    end = time.monotonic() + patience_s
    while time.monotonic() < end:
        try:
            socket = WebSocket(address)
            plan = socket.facts(lambda m: m["plan"] and m["device"], 20, "a plan")
            if plan["plan"]["scene"] == scene:
                socket.frame(lambda m: "tool" in m, 20, "samples")
                return socket, plan
            socket.close()
        except (OSError, AssertionError):
            pass
        time.sleep(0.3)
    raise AssertionError(f"no ring runs {scene}")


def refusal(socket):
    return socket.wait_for(lambda m: m["type"] == "choice", 60, "a refusal")["sentence"]


def send_mesh(socket, data, ending=".stl", device="sim-phantom", piece=30000):
    for at in range(0, len(data), piece):
        text = base64.b64encode(data[at : at + piece]).decode()
        socket.order(
            mesh={"ending": ending, "device": device, "at": at, "of": len(data), "data": text}
        )
        time.sleep(0.02)


class Choice(unittest.TestCase):
    def test_restarts_with_what_is_offered_and_nothing_else(self):
        with led_ring("plane") as up:
            until_it_runs(up)
            address = up.address()
            socket = WebSocket(address)
            offered = socket.facts(lambda m: m["offered"], 10, "what is offered")["offered"]
            self.assertIn("cup_friction", offered["scenes"])
            self.assertIn("sim:touch", offered["devices"])
            for scene, device in (
                ("../scenes/cup", "sim-phantom"),
                ("/etc/passwd", "sim-phantom"),
                ("cup", "phantom"),
                ("cup", "emulated-lwr"),
                ("cup", "sim:/etc/passwd"),
                ("cup", "--help"),
            ):
                socket.order(choose={"scene": scene, "device": device})
                self.assertIn("not among the offered", refusal(socket), (scene, device))
            for odd in ({}, [], None, {"scene": 1, "device": 2}):
                socket.order(choose=odd)

            # An invalid or too large mesh is refused; the ring continues.
            send_mesh(socket, b"solid nothing\nfacet nonsense\n")
            self.assertTrue(refusal(socket))
            send_mesh(socket, b"x", ending=".yaml")
            self.assertIn("OBJ, STL, PLY or GLB", refusal(socket))
            mesh = {
                "ending": ".stl",
                "device": "sim-phantom",
                "at": 0,
                "of": 1 << 30,
                "data": "AA==",
            }
            socket.order(mesh=mesh)
            self.assertIn("16 MiB", refusal(socket))
            self.assertTrue(newest_frame(socket)["tool"])

            socket.order(choose={"scene": "cup_friction", "device": "sim:touch"})
            socket, facts = opened(address, "cup_friction")
            self.assertNotEqual(facts["device"]["model"], "sim-phantom")
            self.assertTrue(facts["device"]["simulated"])

            # The hand is the page's again.
            start = newest_frame(socket)["tool"]
            aim(socket, (start[0] - 0.01, *start[1:3]), 1.5)
            self.assertLess(abs(newest_frame(socket)["tool"][0] - start[0] + 0.01), 0.004)

            send_mesh(socket, (DEPLOY / "meshes" / "cup_mm.stl").read_bytes())
            socket, _ = opened(address, "dropped")
            socket.close()

    def test_is_not_offered_where_the_run_is_recorded(self):
        with tempfile.TemporaryDirectory() as folder:
            with led_ring("plane", "--record", folder + "/bag", "--no-report") as up:
                until_it_runs(up)
                with WebSocket(up.address()) as socket:
                    self.assertIsNone(socket.facts(lambda m: True, 10, "facts")["offered"])
                    socket.order(choose={"scene": "cup", "device": "sim-phantom"})
                    time.sleep(2)
                    self.assertTrue(newest_frame(socket)["tool"])

    def test_switches_the_contact_model_in_contact(self):
        with led_ring("cup") as up:
            until_it_runs(up)
            with WebSocket(up.address()) as socket:
                for model in ("original", "field", "adapted"):
                    socket.order(model=model)
                    socket.facts(lambda m, is_=model: m["plan"]["model"] == is_, 30, model)
                    self.assertTrue(newest_frame(socket)["tool"])
                socket.order(model="best")
                answer = socket.wait_for(lambda m: m["type"] == "answer", 20, "a refusal")
                self.assertFalse(answer["ok"])

    def test_goes_on_if_the_choice_cannot_be_written(self):
        with led_ring("plane") as up:
            until_it_runs(up)
            with WebSocket(up.address()) as socket:
                choice = choice_file(up.process.pid)
                blocker = pathlib.Path(str(choice) + ".tmp")
                blocker.mkdir()  # its file cannot be made, as on a full disk
                socket.order(choose={"scene": "cup", "device": "sim-phantom"})
                sentence = refusal(socket)
                self.assertIn("Cannot write", sentence)
                self.assertIn("The ring goes on", sentence)
                self.assertTrue(newest_frame(socket)["tool"])
                blocker.rmdir()
                socket.order(choose={"scene": "cup", "device": "sim-phantom"})
                with contextlib.suppress(AssertionError):  # the server ends
                    socket.wait_for(lambda m: False, 5, "the end")
            socket, _ = opened(up.address(), "cup")
            socket.close()


def choice_file(up):
    """Of the page of this `voxtouch up`."""
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if f"PPid:\t{up}\n" in (folder / "status").read_text():
                words = (folder / "cmdline").read_bytes().decode().split("\0")
                if "--choice" in words:
                    return pathlib.Path(words[words.index("--choice") + 1])
    raise AssertionError("no page has a file for its choice")


class Saved(unittest.TestCase):
    def save(self, socket):
        socket.order(save=True)
        # The report is written at the lowest priority.
        return socket.wait_for(lambda m: m["type"] == "saved", 300, "what was saved")

    def test_leaves_a_recording_of_ten_seconds_with_a_report(self):
        with (
            tempfile.TemporaryDirectory() as folder,
            unittest.mock.patch.dict(os.environ, {"XDG_DATA_HOME": folder}),
            led_ring("plane") as up,
        ):
            until_it_runs(up)
            with WebSocket(up.address()) as socket:
                self.assertTrue(socket.facts(lambda m: True, 10, "facts")["saves"])
                start = newest_frame(socket)["tool"]
                aim(socket, (start[0] + 0.02, *start[1:3]), 6)
                aim(socket, start, 6)
                answer = self.save(socket)
                self.assertTrue(answer["ok"], answer)
                self.assertIn("with report.html", answer["sentence"])
                self.assertTrue(newest_frame(socket)["tool"], "the ring goes on")
            (saved,) = (pathlib.Path(folder) / "voxtouch/recordings").glob("plane-last-*")
            self.assertIn(str(saved), answer["sentence"])
            self.assertGreater((saved / "report.html").stat().st_size, 10_000)
            streams = ["device/state", "rendering/contact", "coupling/command"]
            bag = Bag(str(saved), requested=streams)
            for stream in streams:
                self.assertGreater(len(bag.rows[stream].table()), 8000, stream)
                self.assertLess(len(bag.rows[stream].table()), 11000, stream)
            metadata = (saved / "metadata.yaml").read_text()
            entry = metadata[metadata.index("/operator/target") :]
            targets = int(re.search(r"message_count: (\d+)", entry).group(1))
            self.assertGreater(targets, 400)
            self.assertLess(targets, 660)
            at = bag.rows["device/state"].table()["sample_time_ns"]
            self.assertAlmostEqual(1e-9 * int(at[-1] - at[0]), 10.0, delta=0.5)

    def test_is_refused_by_a_full_disk_while_the_ring_goes_on(self):
        with (
            unittest.mock.patch.dict(os.environ, {"XDG_DATA_HOME": "/dev/full"}),
            led_ring("plane") as up,
        ):
            until_it_runs(up)
            with WebSocket(up.address()) as socket:
                answer = self.save(socket)
                self.assertFalse(answer["ok"])
                self.assertIn("Not saved. Cannot create", answer["sentence"])
                self.assertTrue(newest_frame(socket)["tool"])


class InABrowser(unittest.TestCase):
    def setUp(self):
        self.browser = Browser()
        self.addCleanup(self.browser.end)

    def judge(self, name):
        self.browser.picture(name)
        self.assertEqual(self.browser.overlaps(), [], name)
        self.assertEqual(self.browser.low_contrast(), [], name)
        self.assertEqual(self.browser.barriers(), [], name)

    def key(self, kind, name, code):
        self.browser.driver.execute_cdp_cmd(
            "Input.dispatchKeyEvent",
            {"type": kind, "key": name, "code": name, "windowsVirtualKeyCode": code},
        )

    def loudness(self):
        """The largest amplitude of the sound over half a second."""
        return max(
            self.browser.js("(voxtouch.ear.getFloatTimeDomainData(samples), Math.max(...samples))")
            for _ in range(10)
            if time.sleep(0.05) is None
        )

    def feel_of(self, model):
        """What the page says of the contact model, once it is chosen by keys."""
        select = self.browser.find("#model")
        if select.get_attribute("value") != model:
            select.send_keys(model)
        return self.browser.find("#feel").text

    def shows(self, scene):
        return self.browser.js("(voxtouch.facts.plan || {}).scene") == scene and self.browser.js(
            "voxtouch.connected"
        )

    def test_the_tour_works_by_keys_alone_with_sound(self):
        browser = self.browser
        with led_ring("cup_virtual_tool") as up:
            until_it_runs(up)
            browser.open(up.address())
            until(lambda: browser.js("Boolean(voxtouch.facts && voxtouch.frame)"), 40, "facts")
            self.assertIsNone(browser.js("voxtouch.sound.context || null"), "no sound")
            browser.press("l")
            until(lambda: browser.find("#learn").is_displayed(), 5, "the panel")
            self.judge("learn.png")
            until(lambda: "A virtual tool" in browser.find("#feel").text, 20, "what to feel for")
            self.assertFalse(browser.find("#model").is_enabled(), "it has no contact model")
            # Voxels and models are of a scene with penalty forces.
            browser.find("#tour-do").send_keys(Keys.ENTER)
            until(lambda: self.shows("cup"), 90, "the scene of the first step")
            until(lambda: "chatters" in self.feel_of("original"), 40, "what to feel for")
            until(lambda: "smooth" in self.feel_of("field"), 40, "what to feel for")
            until(lambda: browser.js("voxtouch.slice && voxtouch.slice.axis"), 20, "the voxels")
            reached = set()
            for _ in range(60):
                reached.add(browser.js("document.activeElement.id"))
                self.key("rawKeyDown", "Tab", 9)
                self.key("keyUp", "Tab", 9)
            for name in (
                "choose-scene choose-device start mesh model tour-do tour-next save sound"
                " learn-on pause theme help canvas slice shell hand-on through"
            ).split():
                self.assertIn(name, reached)

            browser.find("#tour-next").send_keys(Keys.ENTER)
            browser.find("#tour-do").send_keys(Keys.ENTER)
            until(
                lambda: (
                    browser.js(
                        "voxtouch.scene3d.shell"
                        " ? voxtouch.scene3d.shell.geometry.attributes.position.count : 0"
                    )
                    > 100
                ),
                20,
                "the pointshell",
            )
            self.judge("learn_pointshell.png")
            for step in range(3, 7):
                browser.find("#tour-next").send_keys(Keys.ENTER)
                self.assertIn(f"Step {step} of 6", browser.find("#tour-title").text)
            browser.resize(1024, 768)
            time.sleep(1)
            self.judge("learn_tablet.png")
            browser.resize(1280, 720)

            browser.find("#sound").send_keys(Keys.ENTER)
            browser.js(
                "(voxtouch.ear = voxtouch.sound.listen(),"
                " window.samples = new Float32Array(voxtouch.ear.fftSize))"
            )
            self.assertLess(self.loudness(), 0.01, "silent in free space")
            browser.js("document.activeElement.blur()")  # keys go to the page, not to a button
            self.key(
                "rawKeyDown", "ArrowDown", 40
            )  # down into the cup, until it touches the bottom
            until(lambda: size(browser.frame().get("force")) > 0.5, 40, "contact by keys alone")
            self.assertGreater(self.loudness(), 0.01, "the force is audible")
            self.key("keyUp", "ArrowDown", 40)
            browser.find("#sound").send_keys(Keys.ENTER)
            time.sleep(0.3)
            self.assertEqual(browser.js("voxtouch.sound.context.state"), "suspended")

            # The coupling off and on, by the tour's step: the same page shows each ring.
            for _ in range(2):
                browser.find("#tour-back").send_keys(Keys.ENTER)
            self.assertIn("Coupling", browser.find("#tour-title").text)
            for scene, kind in (("cup_direct", "direct"), ("cup", "shaping filter")):
                browser.find("#tour-do").send_keys(Keys.ENTER)
                until(lambda is_=scene: self.shows(is_), 90, scene)
                until(lambda is_=kind: is_ in browser.find("#design-text").text, 20, kind)

            # A choice by the page: the same page shows the next ring.
            scenes = browser.find("#choose-scene")
            until(
                lambda: (
                    scenes.get_attribute("value") == "cup_friction"
                    or scenes.send_keys(Keys.ARROW_DOWN)
                ),
                20,
                "the scene by keys",
            )
            browser.find("#start").send_keys(Keys.ENTER)
            until(lambda: self.shows("cup_friction"), 90, "the next")
            until(lambda: "leans back" in browser.find("#feel").text, 20, "what to feel for")
            until(lambda: browser.js("voxtouch.hand.facts !== null"), 20, "the hand")
            self.assertEqual([f for f in browser.faults() if "WebSocket" not in f], [])


if __name__ == "__main__":
    unittest.main()

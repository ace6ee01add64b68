"""The learning page: choice of scene, device and mesh, switching the contact model in contact,
the steps of the tour, and saving the last ten seconds."""

import base64
import contextlib
import os
import pathlib
import sys
import tempfile
import time
import unittest
import unittest.mock

from browser_test import BrowserTest
from hand_test import aim, distance, led_ring, newest_frame, recorded_targets
from page_client import DEPLOY, WebSocket, size, until, until_it_runs
from selenium.webdriver.common.keys import Keys

sys.path.insert(0, str(DEPLOY / "tools"))
from bag_data import Bag  # noqa: E402

PATIENCE_S = 150  # a busy machine, which starts a ring or draws the page slowly


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
        with led_ring("plane") as up:
            until_it_runs(up)
            with WebSocket(up.address()) as socket:
                start = newest_frame(socket)["tool"]
                aim(socket, (*start[:2], -0.01), 1.5)
                self.assertGreater(size(newest_frame(socket)["force"]), 0.5, "in contact")
                for model in ("original", "field", "adapted"):
                    socket.order(model=model)
                    socket.facts(lambda m, is_=model: m["plan"]["model"] == is_, 30, model)
                    frames = [newest_frame(socket) for _ in range(15)]
                    for frame in frames:
                        self.assertGreater(size(frame["force"]), 0.3, model)
                        self.assertLess(distance(frame["tool"], frames[0]["tool"]), 0.003, model)
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
            targets = recorded_targets(saved)
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


class InABrowser(BrowserTest):
    """Waits for what the page shows, however slowly a busy machine draws it."""

    def opened(self, up):
        """The page once it shows the ring and its hand, with the panel open."""
        until_it_runs(up)
        self.browser.open(up.address())
        self.until("voxtouch.facts && voxtouch.facts.plan && voxtouch.frame", "facts")
        self.until("voxtouch.hand.facts && voxtouch.scene.meshes.length", "the hand")
        self.browser.press("l")
        until(lambda: self.browser.find("#learn").is_displayed(), PATIENCE_S, "the panel")
        return self.browser

    def until(self, holds, what):
        until(lambda: self.browser.js(f"Boolean({holds})"), PATIENCE_S, lambda: self.state(what))

    def until_says(self, element, words):
        def says():
            return words in self.browser.find(element).text

        until(says, PATIENCE_S, lambda: self.state(f"'{words}' in {element}"))

    def until_shown(self, scene):
        self.until(
            f"voxtouch.connected && (voxtouch.facts.plan || {{}}).scene === '{scene}'", scene
        )

    def state(self, what):
        """For the message of a failure: what was waited for, and what the page says instead."""
        words = [self.browser.find(e).text for e in ("#what", "#pill", "#learn-text", "#answer")]
        return f"{what}; the page says {words}"

    def pick(self, element, value):
        """An option of a list box, by arrow keys."""
        places = f"""(list => [
            list.selectedIndex, [...list.options].findIndex(option => option.value === '{value}')
        ])(document.querySelector('{element}'))"""

        def picked():
            at, to = self.browser.js(places)
            if at != to:
                key = Keys.ARROW_DOWN if at < to else Keys.ARROW_UP
                self.browser.find(element).send_keys(key)
            return at == to

        until(picked, PATIENCE_S, lambda: self.state(f"{value} in {element}"))

    def assert_no_faults(self):
        self.assertEqual([f for f in self.browser.faults() if "WebSocket" not in f], [])

    def test_first_step_leaves_a_virtual_tool_for_voxels(self):
        with led_ring("cup_virtual_tool") as up:
            browser = self.opened(up)
            self.judge("learn.png")
            self.until_says("#feel", "A virtual tool")
            self.assertFalse(browser.find("#model").is_enabled(), "it has no contact model")
            # Voxels and models are of a scene with penalty forces.
            browser.find("#tour-do").send_keys(Keys.ENTER)
            self.until_shown("cup")
            self.until("voxtouch.slice && voxtouch.slice.axis", "the voxels")
            self.until("!document.getElementById('model').disabled", "its contact model")
            self.assert_no_faults()

    def test_tells_what_to_feel_for_in_each_model(self):
        with led_ring("cup") as up:
            self.opened(up)
            for model, words in (("original", "chatters"), ("field", "smooth")):
                self.pick("#model", model)
                self.until_says("#feel", words)
            self.assert_no_faults()

    def test_tour_has_six_steps_all_reached_by_keys(self):
        with led_ring("cup") as up:
            browser = self.opened(up)
            reached = set()
            for _ in range(60):
                reached.add(browser.js("document.activeElement.id"))
                browser.key("rawKeyDown", "Tab", 9)
                browser.key("keyUp", "Tab", 9)
            for name in (
                "choose-scene choose-device start mesh model tour-do tour-next save sound"
                " learn-on pause theme help canvas slice shell hand-on through"
            ).split():
                self.assertIn(name, reached)

            browser.find("#tour-next").send_keys(Keys.ENTER)
            browser.find("#tour-do").send_keys(Keys.ENTER)
            points = "voxtouch.scene3d.shell.geometry.attributes.position.count"
            self.until(f"voxtouch.scene3d.shell && {points} > 100", "the pointshell")
            self.judge("learn_pointshell.png")
            for step in range(3, 7):
                browser.find("#tour-next").send_keys(Keys.ENTER)
                self.assertIn(f"Step {step} of 6", browser.find("#tour-title").text)
            browser.js(
                "document.getElementById('mesh').onclick = event => {"
                " event.preventDefault(), window.picks = true; }"
            )
            browser.find("#tour-do").send_keys(Keys.ENTER)
            self.until("window.picks", "the choice of a file")
            browser.resize(1024, 768)
            drawn = "voxtouch.scene3d.width === voxtouch.scene3d.canvas.clientWidth"
            self.until(f"innerWidth === 1024 && {drawn}", "a tablet's width")
            self.judge("learn_tablet.png")
            self.assert_no_faults()

    def test_saves_the_last_ten_seconds_by_its_button(self):
        with (
            tempfile.TemporaryDirectory() as folder,
            unittest.mock.patch.dict(os.environ, {"XDG_DATA_HOME": folder}),
            led_ring("plane") as up,
        ):
            browser = self.opened(up)
            browser.find("#save").send_keys(Keys.ENTER)
            self.until_says("#learn-text", "with report.html")
            (report,) = pathlib.Path(folder).glob("voxtouch/recordings/plane-last-*/report.html")
            self.assertIn(str(report.parent), browser.find("#learn-text").text)
            self.assert_no_faults()

    def drop(self, file):
        """Drags a file from the desktop over the picture, and drops it there."""
        x, y = self.browser.js(
            "(b => [b.x + b.width / 2, b.y + b.height / 2])(canvas.getBoundingClientRect())"
        )
        data = {"items": [], "files": [str(file)], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.browser.driver.execute_cdp_cmd(
                "Input.dispatchDragEvent", {"type": kind, "x": x, "y": y, "data": data}
            )

    def test_takes_a_mesh_that_is_dropped_on_it(self):
        """Three that are refused first, and the ring goes on."""
        with (
            tempfile.TemporaryDirectory() as folder,
            unittest.mock.patch.dict(os.environ, {"XDG_DATA_HOME": folder}),
            led_ring("cup") as up,
        ):
            self.opened(up)
            at = pathlib.Path(folder)
            large, empty, broken = (at / f"{name}.stl" for name in ("large", "empty", "broken"))
            with open(large, "wb") as file:
                file.truncate((16 << 20) + 1)
            empty.touch()
            broken.write_text("solid nothing\nfacet nonsense\n")
            self.drop(large)
            self.until_says("#learn-text", "larger than 16 MiB")
            self.drop(empty)
            self.until_says("#learn-text", "is empty")
            self.drop(broken)
            self.until_says("#learn-text", "truncated or damaged")
            self.assertEqual(self.browser.facts()["plan"]["scene"], "cup")
            self.drop(DEPLOY / "meshes" / "cup_mm.stl")
            self.until_shown("dropped")
            self.until("voxtouch.hand.facts && voxtouch.scene.meshes.length", "the hand")
            self.assert_no_faults()

    def test_switches_the_coupling_off_and_on(self):
        """By the tour's step: the same page shows each ring."""
        with led_ring("cup") as up:
            browser = self.opened(up)
            for _ in range(3):
                browser.find("#tour-next").send_keys(Keys.ENTER)
            self.assertIn("Coupling", browser.find("#tour-title").text)
            for scene, kind in (("cup_direct", "direct"), ("cup", "shaping filter")):
                browser.find("#tour-do").send_keys(Keys.ENTER)
                self.until_shown(scene)
                self.until_says("#design-text", kind)
            self.assert_no_faults()

    def test_shows_the_ring_that_is_chosen_by_keys(self):
        """By the list of scenes, and by the tour's steps on friction and on models."""
        with led_ring("cup_viscosity") as up:
            browser = self.opened(up)
            for _ in range(4):
                browser.find("#tour-next").send_keys(Keys.ENTER)
            self.assertIn("Friction", browser.find("#tour-title").text)
            browser.find("#tour-do").send_keys(Keys.ENTER)
            self.until_shown("cup_friction")
            self.until_says("#feel", "leans back")
            for _ in range(2):
                browser.find("#tour-back").send_keys(Keys.ENTER)
            self.assertIn("Models", browser.find("#tour-title").text)
            browser.find("#tour-do").send_keys(Keys.ENTER)
            self.until_shown("cup")
            self.pick("#choose-scene", "cup_texture")
            browser.find("#start").send_keys(Keys.ENTER)
            self.until_shown("cup_texture")
            self.until_says("#feel", "ripple")
            self.until("voxtouch.hand.facts", "the hand")
            self.assert_no_faults()


if __name__ == "__main__":
    unittest.main()

"""The hand of a simulated device, led from pages: by a plain client, and by the pointer, the wheel,
the keys, a finger, a pen and a gamepad of headless Chromium.
"""

import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest
import unittest.mock

from browser_test import BrowserTest
from page_client import (
    BIN,
    DEPLOY,
    DOMAIN,
    Process,
    WebSocket,
    page,
    ring,
    scene,
    size,
    until,
    until_it_runs,
)
from pointer_events import Protocol
from selenium.webdriver.common.keys import Keys

UP = (0.0, 0.0, 0.0, 1.0)
PATIENCE_S = 60  # a busy machine, which draws the page slowly

# Whether the view has written the newest target of this page.
DELIVERED = """(hand => {
  if (!hand.position) return true;
  const own = [...hand.position.toArray(), ...hand.orientation.toArray()], last = hand.facts.target;
  return !hand.dirty && last !== null && own.every((x, n) => Math.abs(x - last[n]) < 1e-5);
})(voxtouch.hand)"""


def led_ring(name, *more):
    """A ring that a page leads; on a busy machine samples may be lost."""
    arguments = () if "--record" in more else ("--no-record",)
    return Process("up", name, "--hand-from", "page", "--domain", DOMAIN, *arguments, *more)


def rigid_plane(folder):
    """The shipped plane, with a virtual tool: what is displayed stays outside."""
    text = pathlib.Path(scene("plane")).read_text().replace("../meshes", str(DEPLOY / "meshes"))
    soft = "contact: {model: adapted, stiffness_n_per_m: 30}"
    assert soft in text
    file = pathlib.Path(folder) / "rigid.yaml"
    file.write_text(text.replace(soft, "contact: {model: field, rendering: virtual_tool}"))
    return str(file)


def aim(socket, place, seconds, orientation=UP):
    """Sixty targets a second for so long, as a page sends them."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        socket.order(aim={"p": list(place), "q": list(orientation)})
        time.sleep(1 / 60)


def recorded_targets(bag):
    """How many targets of the hand are in a recording."""
    metadata = (pathlib.Path(bag) / "metadata.yaml").read_text()
    entry = metadata[metadata.index("/operator/target") :]
    return int(re.search(r"message_count: (\d+)", entry).group(1))


def flood(address, place, seconds):
    """Five hundred targets a second for so long, by a client that connects anew before the server
    closes.
    """
    begin, number = time.monotonic(), 0
    while (took := time.monotonic() - begin) < seconds:
        with WebSocket(address) as socket:
            for _ in range(90):
                socket.order(aim={"p": list(place), "q": list(UP)})
                number += 1
                time.sleep(max(0.0, begin + number / 500 - time.monotonic()))
    assert number > 200 * took, "the client is too slow"


def newest_frame(socket):
    """The first frame that was made after this call: those that wait are older."""
    socket.catch_up()
    socket.frame(lambda m: "tool" in m, 10, "a frame")  # it may have been on its way
    return socket.frame(lambda m: "tool" in m, 10, "a frame")


def hand_of(socket):
    return socket.facts(lambda m: m["hand"] is not None, 10, "who has the hand")["hand"]


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a[:3], b[:3])) ** 0.5


class Led(unittest.TestCase):
    def test_first_page_controls_the_hand_until_closed(self):
        with led_ring("plane") as up:
            until_it_runs(up)
            address = up.address()
            first, second = WebSocket(address), WebSocket(address)
            number = first.wait_for(lambda m: m["type"] == "page", 5, "its number")["page"]
            start = newest_frame(first)["tool"]
            goal = (start[0] + 0.02, start[1], start[2] + 0.01)
            aim(first, goal, 1.5)
            self.assertLess(distance(newest_frame(first)["tool"], goal), 0.003)
            aim(second, start, 1.0)
            self.assertLess(distance(newest_frame(second)["tool"], goal), 0.003, "not its hand")
            self.assertEqual(
                second.facts(lambda m: m["hand"]["page"] is not None, 10, "who")["hand"]["page"],
                number,
            )
            first.close()
            second.facts(lambda m: m["hand"]["page"] is None, 10, "that the hand is free")
            aim(second, start, 1.5)
            self.assertLess(distance(newest_frame(second)["tool"], start), 0.003)
            second.close()

    def test_without_the_token_nothing_moves(self):
        with led_ring("plane") as up:
            until_it_runs(up)
            address = up.address()
            with WebSocket(address) as good:
                start = newest_frame(good)["tool"]
                with WebSocket(address, token="0" * 32) as unauthorised:
                    self.assertNotEqual(unauthorised.status, 101)
                    try:
                        aim(unauthorised, (start[0], start[1], start[2] + 0.03), 0.6)
                    except OSError:
                        pass  # the server has closed
                # What is no pose moves nothing either, and the server goes on.
                for odd in (
                    {"p": [0, 0], "q": UP},
                    {"p": ["a", 0, 0], "q": UP},
                    {"p": [0, 0, 0], "q": [0, 0, 0, 0]},
                    {"p": [0, 0, 1e999], "q": UP},
                    [],
                    None,
                ):
                    good.order(aim=odd)
                time.sleep(0.5)
                self.assertLess(distance(newest_frame(good)["tool"], start), 1e-4)

    def test_page_without_up_leads_nothing(self):
        with led_ring("plane") as up, page("--lead-hand") as other_page:
            until_it_runs(up)
            with WebSocket(other_page.address()) as socket:
                start = newest_frame(socket)["tool"]
                aim(socket, (start[0], start[1], start[2] + 0.03), 1.0)
                self.assertLess(distance(newest_frame(socket)["tool"], start), 1e-4)

    def test_a_lost_socket_in_contact_rests_the_hand(self):
        with led_ring("plane") as up:
            until_it_runs(up)
            address = up.address()
            with WebSocket(address) as watching:
                leading = WebSocket(address)
                start = newest_frame(leading)["tool"]
                deep = (start[0], start[1], -0.01)
                aim(leading, deep, 1.5)
                pressed = size(newest_frame(watching)["force"])
                self.assertGreater(pressed, 0.5)
                leading.socket.close()
                frames = []
                end = time.monotonic() + 2.0
                while time.monotonic() < end:
                    frames.append(watching.frame(lambda m: "force" in m, 5, "a frame"))
                sizes = [size(f["force"]) for f in frames]
                for force in sizes:
                    self.assertAlmostEqual(force, pressed, delta=0.15 * pressed)
                places = [f["tool"] for f in frames[len(frames) // 2 :]]
                self.assertLess(max(distance(places[0], p) for p in places), 2e-4, "it rests")
                # Whoever comes next leads on from there.
                aim(watching, start, 1.5)
                self.assertLess(distance(newest_frame(watching)["tool"], start), 0.003)

    def test_dragged_motion_replays_bit_by_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with led_ring("cup_virtual_tool", "--record", bag) as up:
                until_it_runs(up)
                with WebSocket(up.address()) as socket:
                    start = newest_frame(socket)["tool"]
                    for step in range(6):
                        sign = 1 if step % 2 == 0 else 0
                        aim(socket, [x * (1 - 0.6 * sign) for x in start[:3]], 0.5)
                    self.assertGreater(hand_of(socket)["page"], 0)
                up.process.send_signal(signal.SIGINT)
                up.process.wait(60)
                output = up.output()
            self.assertGreater(recorded_targets(bag), 100, output)
            replay = subprocess.run(
                [BIN / "voxtouch", "replay", bag], capture_output=True, text=True, check=False
            )
            self.assertEqual(replay.returncode, 0, replay.stdout + replay.stderr)

    def test_certificate_is_that_of_a_scripted_hand(self):
        """Device, coupling, and the pairs of hand and contact that it is certified for."""

        def certified(up):
            until_it_runs(up)
            with WebSocket(up.address()) as socket:
                facts = socket.facts(lambda m: m["design"] and m["device"], 20, "a design")
            return {name: facts[name] for name in ("device", "design")}

        with led_ring("cup") as up:
            led = certified(up)
        with ring("cup", "--view") as up:
            self.assertEqual(certified(up), led)
        self.assertIn("certified", led["design"]["sentence"])

    def test_passes_on_66_targets_a_second_at_most(self):
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with led_ring("plane", "--record", bag, "--no-report") as up:
                until_it_runs(up)
                with WebSocket(up.address()) as socket:
                    start = newest_frame(socket)["tool"]
                    begin = time.monotonic()
                    flood(up.address(), (start[0] + 0.02, *start[1:3]), 2.0)
                    self.assertGreater(newest_frame(socket)["tool"][0], start[0] + 0.01)
                    took = time.monotonic() - begin
                up.process.send_signal(signal.SIGINT)
                up.process.wait(60)
            count = recorded_targets(bag)
            print(f"{count} targets of a client that sends 500 a second for {took:.2f} s")
            self.assertLessEqual(count, 66 * took + 6)
            self.assertGreater(count, 0.5 * 66 * took, "a client that sends too many leads")


class Tried(unittest.TestCase):
    """`voxtouch try`: in one word a ring whose hand the page moves, in the browser."""

    def setUp(self):
        """A desktop whose browser copies the file that it is to open."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.opened, program = self.folder / "opened", self.folder / "xdg-open"
        program.write_text(
            f'#!/bin/sh\ncat "$1" > {self.opened}.part && mv {self.opened}.part {self.opened}\n'
        )
        program.chmod(0o755)
        desktop = {
            "PATH": f"{folder.name}:{os.environ['PATH']}",
            "DISPLAY": ":1",
            "WAYLAND_DISPLAY": "",
            "XDG_RUNTIME_DIR": folder.name,
        }
        there = unittest.mock.patch.dict(os.environ, desktop)
        there.start()
        self.addCleanup(there.stop)

    def tried(self, *words):
        return Process("try", *words, "--domain", DOMAIN)

    def facts(self, up):
        """Of a ring that runs, once it has a scene and a hand."""
        until_it_runs(up)
        with WebSocket(up.address()) as socket:
            return socket.facts(lambda m: m["plan"] and m["hand"], 20, "a hand")

    def test_opens_the_page_in_the_browser(self):
        with self.tried() as up:
            until(self.opened.exists, 30, "a browser")
            self.assertIn(up.address(), self.opened.read_text())
            (file,) = self.folder.glob("voxtouch-*.html")
            self.assertEqual(file.stat().st_mode & 0o777, 0o600, "it holds the token")
            self.assertEqual(self.facts(up)["plan"]["scene"], "cup_virtual_tool")

    def test_opens_no_browser_without_a_desktop(self):
        with (
            unittest.mock.patch.dict(os.environ, {"DISPLAY": ""}),
            self.tried("cup_friction") as up,
        ):
            self.assertEqual(self.facts(up)["plan"]["scene"], "cup_friction")
            self.assertFalse(self.opened.exists())

    def test_makes_a_scene_of_a_mesh(self):
        mesh = self.folder / "part.stl"
        mesh.write_bytes((DEPLOY / "meshes" / "cup_mm.stl").read_bytes())
        with self.tried(str(mesh), "--no-browser") as up:
            self.assertIn("part", self.facts(up)["plan"]["scene"])
            self.assertFalse(self.opened.exists())
            with WebSocket(up.address()) as socket:
                start = newest_frame(socket)["tool"]
                aim(socket, (start[0] + 0.01, *start[1:3]), 1.5)
                self.assertGreater(newest_frame(socket)["tool"][0], start[0] + 0.005)


class Refused(unittest.TestCase):
    def refusal(self, *arguments):
        done = subprocess.run(
            [BIN / "voxtouch", "up", scene("plane"), "--hand-from", "page", "--no-record"]
            + ["--domain", DOMAIN, *arguments],
            capture_output=True,
            text=True,
            check=False,
            timeout=30,
        )
        self.assertEqual(done.returncode, 1, done.stderr)
        return done.stderr

    def test_by_devices_that_no_page_can_move(self):
        for device in ("phantom", "lwr", "fr3", "emulated-lwr"):
            with self.subTest(device):
                sentence = f"'{device}' is .*: --hand-from page needs"
                self.assertRegex(self.refusal("--device", device), sentence)

    def test_in_lockstep(self):
        sentence = self.refusal("--lockstep", "--duration", "1")
        self.assertIn("--hand-from page runs in wall time", sentence)

    def test_under_security(self):
        with tempfile.TemporaryDirectory() as folder:
            sentence = self.refusal("--security", folder)
            self.assertIn("--hand-from page does not work with --security", sentence)


class Pointer:
    """Real events of a browser by its debugging protocol, in the canvas's own pixels."""

    def __init__(self, browser):
        self.browser = browser
        box = browser.js("(b => [b.x, b.y, b.width, b.height])(canvas.getBoundingClientRect())")
        self.x, self.y = box[0] + box[2] / 2, box[1] + box[3] / 2

    def event(self, kind, **more):
        arguments = {"type": kind, "x": self.x, "y": self.y, **more}
        self.browser.driver.execute_cdp_cmd("Input.dispatchMouseEvent", arguments)

    def press(self, button="left", **more):
        self.event("mousePressed", button=button, clickCount=1, **more)

    def release(self, button="left"):
        self.event("mouseReleased", button=button, clickCount=1)

    def move(self, dx, dy, steps=10, **more):
        for _ in range(steps):
            self.x, self.y = self.x + dx / steps, self.y + dy / steps
            self.event("mouseMoved", **more)

    def drag(self, dx, dy, steps=10, button="left", **more):
        self.press(button, **more)
        self.move(dx, dy, steps, button=button, buttons=2 if button == "right" else 1, **more)
        self.release(button)

    def wheel(self, delta):
        self.event("mouseWheel", deltaX=0, deltaY=delta)

    def touch(self, kind, points):
        self.browser.driver.execute_cdp_cmd(
            "Input.dispatchTouchEvent",
            {"type": kind, "touchPoints": [{"x": x, "y": y, "id": n} for n, (x, y) in points]},
        )


class LedByABrowser(BrowserTest):
    def open(self, up):
        browser = self.browser
        until_it_runs(up)
        browser.open(up.address())
        until(lambda: browser.frame().get("tool"), 20, "a tool")
        until(
            lambda: browser.js("Boolean(voxtouch.hand.facts && voxtouch.scene.meshes.length)"),
            20,
            "the hand",
        )
        browser.find("[data-camera=front]").click()
        time.sleep(0.3)
        return Pointer(browser)

    def tool(self):
        return self.browser.frame()["tool"]

    def resting(self):
        """Where the tool is once the ring has the page's newest target and the tool has not moved
        for 0.3 s of the ring's time.
        """
        until(lambda: self.browser.js(DELIVERED), PATIENCE_S, "that the ring has the target")
        last = [self.browser.frame()]

        def rests():
            before, now = last[0], self.browser.frame()
            if now["t"] < before["t"] + 0.3:
                return False
            last[0] = now
            return distance(before["tool"], now["tool"]) < 1e-4

        until(rests, PATIENCE_S, "rest")
        return last[0]["tool"]

    def steers(self, words, reached):
        """Sets a stick or a trigger until the page's target is there, then lets go of it."""
        place, value = words.rsplit(" = ", 1)
        self.browser.js(words)
        until(lambda: self.browser.js(f"Boolean({reached})"), PATIENCE_S, f"{place}: {reached}")
        self.browser.js(f"{place} = 0")
        return self.resting()

    def test_moves_it_by_pointer_wheel_and_keys(self):
        with led_ring("plane") as up:
            browser, pointer = self.browser, self.open(up)
            start = self.resting()
            pixel = self.browser.js(
                "(voxtouch.hand.position || (voxtouch.hand.grip(),"
                " voxtouch.hand.position), voxtouch.hand.pixel())"
            )
            pointer.drag(60, 0)
            at = self.resting()
            # The front camera looks along +y, with x to the right and z up.
            self.assertAlmostEqual(at[0] - start[0], 60 * pixel, delta=0.002)
            self.assertAlmostEqual(at[1], start[1], delta=0.002)
            self.assertAlmostEqual(at[2], start[2], delta=0.002)
            pointer.wheel(-200)
            deep = self.resting()
            self.assertAlmostEqual(deep[1] - at[1], 200 * 0.3 * pixel, delta=0.003)
            turned_before = self.tool()[3:]
            pointer.drag(40, 0, button="right")
            self.resting()
            turned = abs(sum(a * b for a, b in zip(turned_before, self.tool()[3:])))
            self.assertLess(turned, 0.9999, "the right button rotates")
            again = self.tool()[3:]
            pointer.drag(40, 0, modifiers=8)
            self.resting()
            self.assertLess(
                abs(sum(a * b for a, b in zip(again, self.tool()[3:]))), 0.9999, "Shift"
            )

            # Two hundred events in a second or so: at most sixty targets leave the page.
            browser.js(
                """(() => {
              window.sent = [];
              const send = voxtouch.hand.send;
              voxtouch.hand.send = order => { sent.push(performance.now()), send(order); };
            })()"""
            )
            with Protocol(browser.driver) as page:
                x, y = page.middle()
                page.mouse("mousePressed", x, y, button="left", clickCount=1)
                for n in range(200):
                    page.mouse("mouseMoved", x + n % 20, y, button="left", buttons=1)
                    time.sleep(0.004)
                page.wait_for(page.mouse("mouseReleased", x, y, button="left", clickCount=1))
            time.sleep(0.2)
            sent = browser.js("sent")
            self.assertGreater(len(sent), 5)
            for n, begin in enumerate(sent):
                within = sum(begin <= at < begin + 1000 for at in sent[n:])
                self.assertLessEqual(within, 62, "sixty a second, and one at each end")

            # Keys alone, from wherever the focus is.
            for key, axis, sign in (
                (Keys.ARROW_RIGHT, 0, 1),
                (Keys.ARROW_LEFT, 0, -1),
                (Keys.ARROW_UP, 2, 1),
                (Keys.PAGE_UP, 1, 1),
                (Keys.PAGE_DOWN, 1, -1),
            ):
                before = self.resting()
                for _ in range(4):
                    self.browser.press(key)
                after = self.resting()
                self.assertGreater(sign * (after[axis] - before[axis]), 0.002, repr(key))

            # The camera's own drag, and the hand's again.
            before = self.resting()
            self.browser.press("h")
            pointer.drag(80, 0)
            self.assertLess(distance(self.resting(), before), 1e-4, "the camera is dragged")
            self.browser.press("h")
            self.judge("hand.png")
            self.assertEqual(self.browser.faults(), [])

    def test_tool_stays_outside_the_wall_it_is_dragged_into(self):
        with tempfile.TemporaryDirectory() as folder, led_ring(rigid_plane(folder)) as up:
            browser, pointer = self.browser, self.open(up)
            pointer.press()
            pointer.move(0, 140, 30, button="left", buttons=1)
            until(lambda: size(browser.frame().get("force")) > 0.5, 10, "the wall's force")
            at, wants = self.resting(), browser.js("voxtouch.hand.aimed.toArray()")
            shown = browser.frame()["object"]
            self.assertGreater(shown[2], 0.0095, "the sphere of 10 mm stays outside")
            self.assertLess(wants[2], shown[2] - 0.005, "and the hand wants it deeper")
            self.assertTrue(browser.js("voxtouch.scene3d.pull.visible"))
            frame = browser.frame()
            self.assertGreater(frame["depth"], 0.0005, "the hand's, since the tool has none")
            self.assertAlmostEqual(
                frame["depth"], distance(frame["tool"], frame["object"]), delta=1e-6
            )
            points = len(frame["points"]) // 3
            self.assertGreater(points, 0)
            self.assertEqual(browser.find("#n-hits").text, str(points), "the points that it draws")
            browser.picture("hand_in_contact.png")
            force = size(browser.frame()["force"])

            # A page that is loaded anew in contact: the hand rests, and no other force comes.
            browser.driver.refresh()
            until(lambda: browser.frame().get("tool"), 20, "a tool")
            time.sleep(1)
            self.assertAlmostEqual(size(browser.frame()["force"]), force, delta=0.15 * force)
            self.assertLess(distance(self.tool(), at), 5e-4)

            # Another page sees who has the hand once this one moves it.
            until(lambda: browser.js("Boolean(voxtouch.hand.facts)"), 10, "the hand")
            browser.find("[data-camera=front]").click()
            pointer = Pointer(browser)
            pointer.drag(0, -60)
            number = browser.js("voxtouch.page")
            own = browser.driver.current_window_handle
            browser.driver.switch_to.new_window("tab")
            browser.open(up.address())
            until(
                lambda: f"Page {number} controls the hand" in browser.find("#hand-text").text,
                20,
                "who has the hand",
            )
            before = self.resting()
            Pointer(browser).drag(50, 0)
            self.assertLess(distance(self.resting(), before), 5e-4, "it is not this page's hand")
            browser.driver.close()
            browser.driver.switch_to.window(own)

    def test_moves_it_by_finger_pen_and_gamepad(self):
        """The gamepad is an object of a script in place of navigator.getGamepads: Chromium's
        debugging protocol has no gamepad. What the browser makes of hardware is not tested.
        """
        with led_ring("plane") as up:
            browser, pointer = self.browser, self.open(up)
            before = self.resting()
            x, y = pointer.x, pointer.y
            pointer.touch("touchStart", [(1, (x, y))])
            for n in range(1, 11):
                pointer.touch("touchMove", [(1, (x + 5 * n, y))])
            pointer.touch("touchEnd", [])
            moved = self.resting()
            self.assertGreater(moved[0] - before[0], 0.005, "a finger")

            # Two fingers that come apart: towards the viewer.
            pointer.touch("touchStart", [(1, (x - 20, y)), (2, (x + 20, y))])
            for n in range(1, 11):
                pointer.touch("touchMove", [(1, (x - 20 - 3 * n, y)), (2, (x + 20 + 3 * n, y))])
            pointer.touch("touchEnd", [])
            apart = self.resting()
            self.assertLess(apart[1] - moved[1], -0.005, "two fingers")

            pen = {"pointerType": "pen"}
            pointer.press(force=0.1, **pen)
            for force in (0.2, 0.4, 0.6, 0.8):
                pointer.move(1, 0, 1, button="left", buttons=1, force=force, **pen)
            pointer.event("mouseReleased", button="left", clickCount=1, **pen)
            self.assertGreater(self.resting()[1] - apart[1], 0.004, "a pen's pressure")

            browser.js(
                """(() => {
              window.rumbles = [], window.reads = 0;
              const buttons = Array.from({length: 17}, () => ({value: 0, pressed: false}));
              const other = {axes: Array(8).fill(-1), buttons: [], mapping: ''};
              window.pad = {axes: [0, 0, 0, 0], buttons, mapping: 'standard',
                vibrationActuator: {playEffect: async (_, effect) => {
                  rumbles.push(effect.strongMagnitude);
                }}};
              const copy = p => ({...p, axes: [...p.axes], buttons: p.buttons.map(b => ({...b}))});
              navigator.getGamepads = () => (reads++, [null, copy(other), copy(pad), null]);
            })()"""
            )
            before = self.resting()
            until(lambda: browser.js("reads") > 20, PATIENCE_S, "that the page reads gamepads")
            self.assertLess(distance(self.resting(), before), 1e-4, "another layout moves nothing")
            goes = "voxtouch.hand.position"
            left = self.steers("pad.axes[0] = -1", f"{goes}.x < {before[0] - 0.01}")
            self.assertLess(left[0] - before[0], -0.008, "the left stick")
            far = self.steers("pad.buttons[7].value = 1", f"{goes}.y > {left[1] + 0.01}")
            self.assertGreater(far[1] - left[1], 0.008, "the right trigger")
            near = self.steers("pad.buttons[6].value = 1", f"{goes}.y < {far[1] - 0.01}")
            self.assertLess(near[1] - far[1], -0.008, "the left trigger")
            for axis in (2, 3):
                x, y, z, w = self.tool()[3:]
                alike = f"voxtouch.hand.orientation.dot(new THREE.Quaternion({x}, {y}, {z}, {w}))"
                turned = self.steers(f"pad.axes[{axis}] = 1", f"Math.abs({alike}) < 0.999")[3:]
                alike = abs(sum(a * b for a, b in zip((x, y, z, w), turned)))
                self.assertLess(alike, 0.9995, f"the right stick, axis {axis}")
            self.assertEqual(browser.js("rumbles"), [], "no force")
            browser.js("pad.axes[1] = 1")
            until(lambda: size(browser.frame().get("force")) > 0.5, PATIENCE_S, "the wall's force")
            browser.js("pad.axes[1] = 0")
            self.resting()
            ratio = size(browser.frame()["force"]) / browser.facts()["device"]["max_force_n"]
            browser.js("rumbles.splice(0)")
            (strong, *_) = until(lambda: browser.js("rumbles"), PATIENCE_S, "rumble")
            self.assertAlmostEqual(strong, ratio, delta=0.1 * ratio, msg="of the largest force")


if __name__ == "__main__":
    unittest.main()

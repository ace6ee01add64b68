"""A led hand whose pages fail, in headless Chromium: fifty tabs, a page that is loaded anew, one
that sleeps, one whose socket is lost, one without the token. The hand rests, and the force of the
recorded run has no step above the ramp.
"""

import json
import pathlib
import random
import re
import signal
import sys
import tempfile
import time
import unittest

import hand_test
from browser_test import BrowserTest
from hand_test import Pointer, aim, distance, led_ring, newest_frame, rigid_plane
from page_client import DEPLOY, WebSocket, size, until, until_it_runs
from pointer_events import Protocol

sys.path.insert(0, str(DEPLOY / "tools"))
from bag_data import Bag, norm, vector  # noqa: E402

MAX_FORCE_N, RAMP_S, RATE_HZ = 8.5, 0.1, 1000.0  # of the simulated Phantom and its guard
PATIENCE_S = 150  # a busy machine, which draws the page slowly
RAMP_N = MAX_FORCE_N / RAMP_S / RATE_HZ  # of one sample

# Keeps each WebSocket of a page, so that a test can close it under the page.
KEEP_SOCKETS = """
  window.sockets = [];
  const Real = window.WebSocket;
  window.WebSocket = class extends Real { constructor(...a) { super(...a); sockets.push(this); } };
"""


def largest_step(bag, from_s, to_s):
    """Of the commanded force between two samples in this time since the first one [N]."""
    command = Bag(bag, requested=["coupling/command"]).rows["coupling/command"].table()
    number, time_ns = command["sequence_number"], command["sample_time_ns"]
    force = vector(command["wrench"]["force"])
    follows = numpy_diff(number) == 1
    time_s = 1e-9 * (time_ns[1:] - time_ns[0])
    within = (time_s > from_s) & (time_s < to_s)
    steps = norm(force[1:] - force[:-1])[follows & within]
    assert len(steps) > 1000, "the recording is short"
    return float(steps.max())


def numpy_diff(numbers):
    return numbers[1:].astype("int64") - numbers[:-1].astype("int64")


class OfManyPages(unittest.TestCase):
    """Without a browser: targets as pages send them."""

    def test_passes_no_wall_in_200_drags(self):
        random.seed(45)
        with led_ring("cup_virtual_tool", "--json") as up:
            until_it_runs(up)
            with WebSocket(up.address()) as socket:
                scene = socket.wait_for(
                    lambda m: m["type"] == "scene" and m["meshes"], 30, "the scene"
                )
                points = next(m for m in scene["meshes"] if m["role"] != "dynamic")["positions"]
                at, touched, largest = newest_frame(socket)["tool"][:3], 0, 0.0
                for _ in range(200):
                    n = 3 * random.randrange(len(points) // 3)
                    to = [x + random.uniform(-0.006, 0.006) for x in points[n : n + 3]]
                    steps = random.choice((1, 2, 4, 8, 16))  # any speed
                    for k in range(1, steps + 1):
                        place = [a + (b - a) * k / steps for a, b in zip(at, to)]
                        socket.order(aim={"p": place, "q": list(hand_test.UP)})
                        time.sleep(1 / 60)
                    aim(socket, to, random.uniform(0.1, 0.3))
                    force = size(newest_frame(socket)["force"])
                    at, touched, largest = to, touched + (force > 0.05), max(largest, force)
            up.process.send_signal(signal.SIGINT)
            up.process.wait(60)
            output = up.output()
        limits = json.loads(output[output.index("\n{") :])["limits"]
        print(f"{touched} of 200 drags ended in contact, {largest:.2f} N at most")
        self.assertGreaterEqual(touched, 150)
        self.assertLess(largest, MAX_FORCE_N)
        for name in ("passed_through_samples", "tunnelling_suspected_samples", "swing_s"):
            self.assertEqual(limits[name]["value"], 0, name)

    def test_of_fifty_pages_the_first_has_the_hand(self):
        with tempfile.TemporaryDirectory() as folder, led_ring(rigid_plane(folder)) as up:
            until_it_runs(up)
            with WebSocket(up.address()) as first:
                number = first.wait_for(lambda m: m["type"] == "page", 5, "its number")["page"]
                start = newest_frame(first)["tool"]
                aim(first, (start[0], start[1], 0.004), 2.0)
                rest = newest_frame(first)
                self.assertGreater(size(rest["force"]), 0.5, "in contact")
                others = [WebSocket(up.address()) for _ in range(49)]
                for other in others:
                    other.order(aim={"p": [0.0, 0.0, 0.06], "q": list(hand_test.UP)})
                for other in others:
                    who = other.facts(lambda m: m["hand"]["page"] is not None, 20, "who has it")
                    self.assertEqual(who["hand"]["page"], number)
                    other.close()
                frame = newest_frame(first)
                self.assertLess(distance(frame["tool"], rest["tool"]), 3e-4, "it rests")
                self.assertAlmostEqual(
                    size(frame["force"]), size(rest["force"]), delta=0.1 * size(rest["force"])
                )


class Robust(BrowserTest):
    def setUp(self):
        super().setUp()
        self.browser.driver.execute_cdp_cmd(
            "Page.addScriptToEvaluateOnNewDocument", {"source": KEEP_SOCKETS}
        )

    def cdp(self, name, **arguments):
        return self.browser.driver.execute_cdp_cmd(name, arguments)

    def ready(self):
        until(
            lambda: self.browser.js(
                "Boolean(voxtouch.connected && voxtouch.frame && voxtouch.frame.tool"
                " && voxtouch.hand.facts && voxtouch.scene.meshes.length)"
            ),
            PATIENCE_S,
            "the page",
        )

    def settled(self):
        """A frame of the page once the ring has run on for the time that the hand needs."""
        begin = self.browser.frame()["t"]
        until(lambda: self.browser.frame()["t"] > begin + 0.3, PATIENCE_S, "samples")
        return self.browser.frame()

    def press(self):
        """A drag into the wall that ends in contact, with the button down."""
        self.browser.find("[data-camera=front]").click()
        pointer = Pointer(self.browser)
        pointer.press()
        for _ in range(60):
            pointer.move(0, 6, 1, button="left", buttons=1)
            if size(self.settled()["force"]) > 0.8:
                return pointer
        raise AssertionError("no contact")

    def resting(self, watching):
        """Force and place once the hand rests in contact."""
        frames = [newest_frame(watching)]

        def rests():
            frames.append(later(watching, frames[-1], 0.5))
            return distance(frames[-2]["tool"], frames[-1]["tool"]) < 5e-5

        until(rests, PATIENCE_S, "a hand at rest")
        self.assertGreater(size(frames[-1]["force"]), 0.5, "in contact")
        return size(frames[-1]["force"]), frames[-1]["tool"]

    def assert_rests(self, watching, rest, what):
        force, tool = rest
        begin = frame = newest_frame(watching)
        while frame["t"] < begin["t"] + 1.0:
            frame = newest_frame(watching)
            self.assertAlmostEqual(size(frame["force"]), force, delta=0.1 * force, msg=what)
            self.assertLess(distance(frame["tool"], tool), 3e-4, what)

    def test_rests_through_reload_sleep_and_a_lost_socket(self):
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with led_ring(rigid_plane(folder), "--record", bag, "--no-report") as up:
                until_it_runs(up)
                self.browser.open(up.address())
                self.ready()
                self.press()
                with WebSocket(up.address()) as watching:
                    rest = self.resting(watching)
                    windows = [[newest_frame(watching)["t"]]]

                    # Lost under the page: it comes back as another one, and the hand is free.
                    before = self.browser.js("voxtouch.page")
                    self.browser.js("sockets[sockets.length - 1].close()")
                    until(lambda: self.browser.js("voxtouch.page") > before, PATIENCE_S, "a socket")
                    self.assert_rests(watching, rest, "a lost socket")

                    # Loaded anew with the button down.
                    self.browser.driver.refresh()
                    self.ready()
                    self.assert_rests(watching, rest, "a reload")
                    windows[0].append(newest_frame(watching)["t"])
                    pointer = Pointer(self.browser)
                    pointer.press()
                    pointer.move(0, 4, 2, button="left", buttons=1)
                    page = self.browser.js("voxtouch.page")
                    until(
                        lambda: newest_hand(watching)["page"] == page, PATIENCE_S, "the page's hand"
                    )

                    # Asleep in contact, with the button down until then: nothing is sent, and the
                    # hand is not another page's for ten seconds since the last target.
                    rest = self.resting(watching)
                    windows.append([newest_frame(watching)["t"]])
                    self.cdp("Page.setWebLifecycleState", state="frozen")
                    aim(watching, [x + 0.02 for x in rest[1][:3]], 0.5)
                    self.assert_rests(watching, rest, "asleep, it keeps the hand")
                    time.sleep(8)
                    windows[1].append(newest_frame(watching)["t"])

                    def is_free():
                        aim(watching, [*rest[1][:2], 0.04], 1.0)
                        return newest_frame(watching)["tool"][2] > 0.03

                    until(is_free, PATIENCE_S, "that the hand is free")
                    self.cdp("Page.setWebLifecycleState", state="active")
                up.process.send_signal(signal.SIGINT)
                up.process.wait(60)
            for window in windows:
                self.assertLess(largest_step(bag, *window), RAMP_N)

    def test_stops_where_it_is_once_its_page_sends_no_more(self):
        """Along the wall, to a target far beyond it."""
        with tempfile.TemporaryDirectory() as folder:
            with led_ring(rigid_plane(folder)) as up:
                until_it_runs(up)
                with WebSocket(up.address()) as watching:
                    leading = WebSocket(up.address())
                    start = newest_frame(leading)["tool"]
                    aim(leading, (start[0], start[1], 0.005), 1.0)
                    aim(leading, (start[0] + 5.0, start[1], 0.005), 0.1)
                    leading.close()
                    time.sleep(1.5)
                    first = newest_frame(watching)["tool"]
                    time.sleep(0.5)
                    self.assertLess(distance(newest_frame(watching)["tool"], first), 3e-4)
                    self.assertLess(first[0] - start[0], 0.5 * (0.1 + 0.3 + 0.1) + 0.1)

    def open_tab(self, address, number):
        """In a window of their own, so that the first tab stays in view as well."""
        return self.cdp(
            "Target.createTarget",
            url=address,
            newWindow=number == 0,
            background=number > 0,
        )["targetId"]

    def test_of_fifty_tabs_the_first_controls_the_hand(self):
        """It holds the hand in contact, with the button down, while 49 others open and read."""
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with led_ring(rigid_plane(folder), "--record", bag, "--no-report") as up:
                until_it_runs(up)
                address = up.address()
                self.browser.open(address)
                self.ready()
                self.press()
                with WebSocket(address) as watching:
                    rest = self.resting(watching)
                    begin = newest_frame(watching)["t"]
                number = self.browser.js("voxtouch.page")
                tabs = [self.open_tab(address, n) for n in range(49)]
                pages = {self.leading_page(tab, number) for tab in tabs}
                self.assertEqual(len(pages), 49, "each is a page of its own")
                with WebSocket(address) as watching:
                    self.assert_rests(watching, rest, "fifty pages are open")
                    for tab in tabs[::10]:
                        self.cdp("Target.activateTarget", targetId=tab)
                        with Protocol(self.browser.driver, tab) as page:
                            page.drag(*page.middle(), 30, -60)
                            page.wait_for(page.key("ArrowUp", 38))
                        self.assert_rests(watching, rest, "it is not this page's hand")
                    end = newest_frame(watching)["t"]
                self.assertEqual(self.browser.js("voxtouch.page"), number, "it was never lost")
                up.process.send_signal(signal.SIGINT)
                up.process.wait(60)
            self.assertLess(largest_step(bag, begin, end), RAMP_N)

    def leading_page(self, tab, leading):
        """Waits until this tab says which page leads the hand; its own number."""
        notice = "(document.getElementById('hand-text') || {}).textContent || ''"
        with Protocol(self.browser.driver, tab) as page:
            words = until(
                lambda: re.fullmatch(
                    rf"Page {leading} controls the hand; this is page (\d+)\.", page.value(notice)
                ),
                60,
                "which page controls the hand",
            )
        return int(words.group(1))

    def test_without_the_token_no_page_opens_and_nothing_moves(self):
        with led_ring("plane") as up:
            until_it_runs(up)
            address = up.address()
            with WebSocket(address) as watching:
                start = newest_frame(watching)["tool"]
                self.browser.open(address[:-4] + "0000")
                self.assertIn("token", self.browser.find("body").text)
                # The page's own scripts, from the page that is refused.
                said = self.browser.driver.execute_async_script(
                    """const done = arguments[0], url = `ws://${location.host}/ring`;
                    const ends = ['', '?token=', `?token=${'0'.repeat(32)}`];
                    const all = ends.map(end => new Promise(ok => {
                      const socket = new WebSocket(url + end, 'voxtouch-view');
                      socket.onopen = () => {
                        socket.send(JSON.stringify({aim: {p: [0, 0, 0.1], q: [0, 0, 0, 1]}}));
                        ok('open');
                      };
                      socket.onerror = () => ok('refused');
                    }));
                    Promise.all(all).then(done);"""
                )
                self.assertEqual(said, ["refused"] * 3)
                time.sleep(0.6)
                self.assertLess(distance(newest_frame(watching)["tool"], start), 1e-4)


def newest_hand(socket):
    """Who has the hand: the first facts that were written after this call."""
    socket.catch_up()
    hand_test.hand_of(socket)  # they may have been on their way
    return hand_test.hand_of(socket)


def later(socket, frame, seconds):
    """The first frame of the ring that long after this one."""
    return socket.frame(lambda m: "tool" in m and m["t"] >= frame["t"] + seconds, 60, "samples")


if __name__ == "__main__":
    unittest.main()

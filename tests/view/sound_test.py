"""The page's sound in headless Chromium, by an analyser of its output: off at first, louder with a
larger force, a click at each contact, and a texture that is audible while the tool slides over it.
"""

import pathlib
import tempfile
import time
import unittest

from browser_test import BrowserTest
from hand_test import aim, distance, led_ring, newest_frame, rigid_plane
from page_client import WebSocket, size, until, until_it_runs
from selenium.webdriver.common.keys import Keys

PATIENCE_S = 150  # a busy machine, which draws the page slowly
BLOCK_S = 0.005
CLICK = 0.2  # the difference between two samples, which the encoders' steps do not reach

# For each block of time the largest amplitude, and the largest difference between two samples:
# noise has one, a hum of 110 Hz has hardly any. Eight analysers, of 0.74 s each, record one after
# the other, so that a page may be five seconds late.
ANALYSE = """(() => {
  const out = voxtouch.sound.listen(), context = out.context, rate = context.sampleRate;
  const block = Math.round(0.005 * rate), recent = new Float32Array(32768);
  const ears = [0, 1, 2, 3, 4, 5, 6, 7].map(number => {
    const late = 0.7 * number, delay = context.createDelay(6), ear = context.createAnalyser();
    delay.delayTime.value = late, ear.fftSize = recent.length;
    out.connect(delay).connect(ear);
    return {ear, late};
  });
  window.blocks = new Map();
  window.analyse = () => {
    const now = context.currentTime;
    for (const {ear, late} of ears) {
      const begin = Math.round((now - late) * rate) - recent.length;
      ear.getFloatTimeDomainData(recent);
      for (let n = 1; n < recent.length; ++n) {
        const at = Math.floor((begin + n) / block), [size, change] = blocks.get(at) || [0, 0];
        blocks.set(at, [Math.max(size, Math.abs(recent[n])),
                       Math.max(change, Math.abs(recent[n] - recent[n - 1]))]);
      }
    }
    return [...blocks].map(([at, loudest]) => [at, ...loudest]);
  };
  setInterval(analyse, 1000);
  window.clicks = 0;
  const click = voxtouch.sound.click.bind(voxtouch.sound);
  voxtouch.sound.click = (...of) => (++clicks, click(...of));
})()"""


class Sound(BrowserTest):
    def until(self, holds, what):
        until(lambda: self.browser.js(f"Boolean({holds})"), PATIENCE_S, what)

    def opened(self, up):
        until_it_runs(up)
        self.browser.open(up.address())
        self.until("voxtouch.facts && voxtouch.facts.device && voxtouch.frame", "facts")
        self.assertIsNone(self.browser.js("voxtouch.sound.context || null"), "off at first")
        return self.browser

    def switched_on(self, up):
        self.opened(up).press("m")
        self.until("voxtouch.sound.context.state === 'running'", "sound")
        self.browser.js(ANALYSE)
        return WebSocket(up.address())

    def clicks(self):
        return self.browser.js("clicks")

    def now(self):
        return self.browser.js("voxtouch.sound.context.currentTime")

    def wait(self, seconds):
        """For sound, not for the clock."""
        self.until(f"voxtouch.sound.context.currentTime > {self.now() + seconds}", "sound")

    def while_moved(self, socket, begin, end, seconds, touches=False):
        """The times between which sound comes from this straight motion of the hand, and from the
        rest after it.
        """
        at, start = self.now(), time.monotonic()
        while (ratio := (time.monotonic() - start) / seconds) < 1.0:
            aim(socket, [a + (b - a) * ratio for a, b in zip(begin, end)], 1 / 60)
        places = [begin]

        def rests():
            aim(socket, end, 0.5)
            frame = newest_frame(socket)
            places.append(frame["tool"])
            still = distance(places[-2], places[-1]) < 1e-4
            return still and (not touches or size(frame["force"]) > 0.1)

        until(rests, PATIENCE_S, "rest")
        drawn = newest_frame(socket)["t"]
        self.until(f"voxtouch.frame.t > {drawn}", "the page's frame")
        self.wait(0.5)
        return at, self.now()

    def measured(self, times):
        """Amplitudes and differences of the blocks between two times."""
        blocks = self.browser.js("analyse()")
        within = [b for b in blocks if times[0] <= b[0] * BLOCK_S < times[1]]
        return [b[1] for b in within], [b[2] for b in within]

    def test_keys_alone_switch_it_and_press_an_audible_force(self):
        with led_ring("cup") as up:
            browser = self.opened(up)
            browser.find("#sound").send_keys(Keys.ENTER)
            self.until("voxtouch.sound.context.state === 'running'", "sound")
            browser.js(ANALYSE)
            begin = self.now()
            self.wait(1.0)
            self.assertLess(
                max(self.measured((begin, self.now()))[0]), 1e-3, "silent in free space"
            )
            browser.js("document.activeElement.blur()")  # keys go to the page, not to a button
            browser.press("1")  # from the front: down into the cup, until it touches the bottom
            browser.key("rawKeyDown", "ArrowDown", 40)
            until(lambda: size(browser.frame().get("force")) > 0.5, PATIENCE_S, "contact by keys")

            def is_audible():
                begin = self.now()
                self.wait(0.2)
                return max(self.measured((begin, self.now()))[0], default=0.0) > 0.01

            until(is_audible, PATIENCE_S, "an audible force")
            browser.key("keyUp", "ArrowDown", 40)
            browser.find("#sound").send_keys(Keys.ENTER)
            self.until("voxtouch.sound.context.state === 'suspended'", "silence")
            self.assertEqual(browser.faults(), [])

    def test_clicks_at_each_contact_and_hums_by_the_force(self):
        with tempfile.TemporaryDirectory() as folder, led_ring(rigid_plane(folder)) as up:
            with self.switched_on(up) as socket:
                x, y, z = newest_frame(socket)["tool"][:3]

                def to(height, seconds=1.0, dx=0.0):
                    at, end = newest_frame(socket)["tool"][:3], (x + dx, y, height)
                    return self.while_moved(socket, at, end, seconds, height < 0.01)

                free = self.measured(to(0.0115))
                self.assertLess(max(free[0]), 1e-3, "silent in free space")
                self.assertEqual(self.clicks(), 0, "in free space")
                hums = []
                for contacts, depth in enumerate((0.002, 0.004), 1):
                    touch = self.measured(to(0.01 - depth, 1.5))
                    self.assertGreater(max(touch[1]), CLICK, "a click at contact")
                    slide = self.measured(to(0.01 - depth, 1.0, 0.004))
                    hums.append(sorted(slide[0])[len(slide[0]) // 2])
                    to(0.0115)
                    self.assertEqual(self.clicks(), contacts, "one for each contact")
                self.assertGreater(hums[0], 1e-3, "contact is audible")
                self.assertGreater(hums[1], 1.5 * hums[0], "a larger force is louder")

                # A page that gets no more frames says nothing of a contact that may be gone.
                to(0.008)
                self.browser.js("voxtouch.sound.take = () => 0")
                self.wait(1.0)
                begin = self.now()
                self.wait(0.5)
                self.assertLess(
                    max(self.measured((begin, self.now()))[0]), 1e-3, "silent at the end"
                )

    def test_texture_is_audible_where_the_tool_slides(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(rigid_plane(folder))
            texture = (
                "{pattern: grating, wavelength_m: 0.006, direction: [1, 0, 0], force_n: 0.3,"
                " full_force_n: 0.3, reach_m: 0.02}"
            )
            text = file.read_text()
            self.assertIn("effects: []", text)
            file.write_text(text.replace("effects: []", f"effects: [texture: {texture}]"))
            with led_ring(str(file)) as up, self.switched_on(up) as socket:
                x, y = newest_frame(socket)["tool"][:2]
                begin, end = (x, y, 0.009), (x + 0.06, y, 0.009)
                self.while_moved(socket, (x, y, 0.0115), begin, 1.0)
                rough = sum(self.measured(self.while_moved(socket, begin, end, 1.5))[1])
                rest = sum(self.measured(self.while_moved(socket, end, end, 1.5))[1])
                socket.order(change=["texture", "off"])
                socket.facts(lambda m: not m["effects"][0]["on"], PATIENCE_S, "no texture")
                smooth = sum(self.measured(self.while_moved(socket, end, begin, 1.5))[1])
                self.assertGreater(rough, 5 * smooth, "a texture, and a smooth plane")
                self.assertGreater(rough, 5 * rest, "a texture under a tool at rest")


if __name__ == "__main__":
    unittest.main()

"""The page's sound in headless Chromium, by an analyser of its output: off at first, louder with a
larger force, a click at each contact, and a texture that is audible while the tool slides over it.
"""

import unittest

from browser_test import BrowserTest
from hand_test import led_ring
from page_client import size, until, until_it_runs
from selenium.webdriver.common.keys import Keys

PATIENCE_S = 150  # a busy machine, which draws the page slowly


class Sound(BrowserTest):
    def until(self, holds, what):
        until(lambda: self.browser.js(f"Boolean({holds})"), PATIENCE_S, what)

    def opened(self, up):
        until_it_runs(up)
        self.browser.open(up.address())
        self.until("voxtouch.facts && voxtouch.facts.device && voxtouch.frame", "facts")
        self.assertIsNone(self.browser.js("voxtouch.sound.context || null"), "off at first")
        return self.browser

    def loudness(self):
        """The largest amplitude of the last 0.7 s."""
        return self.browser.js(
            "(voxtouch.ear.getFloatTimeDomainData(samples), Math.max(...samples))"
        )

    def test_keys_alone_switch_it_and_press_an_audible_force(self):
        with led_ring("cup") as up:
            browser = self.opened(up)
            browser.find("#sound").send_keys(Keys.ENTER)
            self.until("voxtouch.sound.context.state === 'running'", "sound")
            browser.js(
                "(voxtouch.ear = voxtouch.sound.listen(), voxtouch.ear.fftSize = 32768,"
                " window.samples = new Float32Array(32768))"
            )
            begin = browser.js("voxtouch.sound.context.currentTime")
            self.until(f"voxtouch.sound.context.currentTime > {begin} + 1", "a second of sound")
            self.assertLess(self.loudness(), 0.01, "silent in free space")
            browser.js("document.activeElement.blur()")  # keys go to the page, not to a button
            browser.press("1")  # from the front: down into the cup, until it touches the bottom
            browser.key("rawKeyDown", "ArrowDown", 40)
            until(lambda: size(browser.frame().get("force")) > 0.5, PATIENCE_S, "contact by keys")
            until(lambda: self.loudness() > 0.01, PATIENCE_S, "an audible force")
            browser.key("keyUp", "ArrowDown", 40)
            browser.find("#sound").send_keys(Keys.ENTER)
            self.until("voxtouch.sound.context.state === 'suspended'", "silence")
            self.assertEqual(browser.faults(), [])


if __name__ == "__main__":
    unittest.main()

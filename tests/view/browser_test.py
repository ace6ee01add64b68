"""The page in a real browser: headless Chromium, driven by Selenium. Its pictures are stored in
VOXTOUCH_PICTURES, for inspection."""

import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from page_client import BIN, DOMAIN, Process, page, ring, scene, size, state_of, until
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

PICTURES = pathlib.Path(os.environ["VOXTOUCH_PICTURES"])
SCRIPT_TIMEOUT_S = 200  # axe-core on a busy machine


class Browser:
    """Without a graphics card and without rights of root."""

    def __init__(self, width=1280, height=720):
        options = Options()
        for argument in (
            "--headless=new",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--disable-gpu",
            "--enable-unsafe-swiftshader",
            "--hide-scrollbars",
            f"--window-size={width},{height}",
        ):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.driver.set_script_timeout(SCRIPT_TIMEOUT_S)
        self.resize(width, height)

    def resize(self, width, height):
        self.driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
        )

    def open(self, address):
        self.driver.get(address)

    def js(self, text):
        return self.driver.execute_script("return " + text)

    def frame(self):
        return self.js("voxtouch.frame") or {}

    def facts(self):
        return self.js("voxtouch.facts") or {"nodes": []}

    def find(self, css):
        return self.driver.find_element(By.CSS_SELECTOR, css)

    def press(self, keys):
        self.find("body").send_keys(keys)

    def key(self, kind, name, code):
        """A key goes down (rawKeyDown) or up (keyUp)."""
        self.driver.execute_cdp_cmd(
            "Input.dispatchKeyEvent",
            {"type": kind, "key": name, "code": name, "windowsVirtualKeyCode": code},
        )

    def picture(self, name):
        PICTURES.mkdir(parents=True, exist_ok=True)
        self.driver.save_screenshot(str(PICTURES / name))

    def faults(self):
        """The content of the console, without messages about pictures without a graphics card."""
        return [
            line["message"]
            for line in self.driver.get_log("browser")
            if line["level"] in ("SEVERE", "WARNING")
            and "GPU stall due to ReadPixels" not in line["message"]
        ]

    def overlaps(self):
        """Pairs of overlapping panels and words, and words cut off at the window's edge."""
        return self.js(
            """(() => {
          const faults = [], of = s => [...document.querySelectorAll(s)].filter(e => e.offsetParent !== null && !e.hidden);
          const box = e => e.getBoundingClientRect();
          const apart = (a, b) => a.right <= b.left + 1 || b.right <= a.left + 1 || a.bottom <= b.top + 1 || b.bottom <= a.top + 1;
          const say = e => e.id || e.className || e.tagName;
          for (const group of ['main > section, #design', '#numbers, #cameras, #cut, #legend, #player, #flags, #hand-panel, #learn', '.chart', '.chart h2, .chart .plot', 'header > *']) {
            const all = of(group);
            all.forEach((a, i) => all.slice(i + 1).forEach(b => { if (!apart(box(a), box(b))) faults.push(say(a) + ' over ' + say(b)); }));
          }
          for (const e of of('.chart h2 > *, #numbers *, header *')) if (box(e).right > innerWidth || box(e).left < 0) faults.push(say(e) + ' beyond the edge');
          return faults;
        })()"""
        )

    def low_contrast(self):
        """Words with a contrast to the background under 4.5:1 (WCAG), also over the picture,
        where axe-core cannot measure it."""
        return self.js(
            """(() => {
          const parse = c => c.match(/[\\d.]+/g).map(Number);
          const light = c => { const f = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; return 0.2126 * f(c[0]) + 0.7152 * f(c[1]) + 0.0722 * f(c[2]); };
          const ground = e => { for (; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor); if (c.length < 4 || c[3] > 0.5) return c; } return [255, 255, 255]; };
          const faults = [];
          for (const e of document.querySelectorAll('body *')) {
            if (e.offsetParent === null || ![...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim())) continue;
            const a = light(parse(getComputedStyle(e).color)), b = light(ground(e)), ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
            if (ratio < 4.5) faults.push((e.id || e.className || e.tagName) + ' "' + e.textContent.trim().slice(0, 20) + '" ' + ratio.toFixed(2));
          }
          return faults;
        })()"""
        )

    def barriers(self):
        """Accessibility faults found by axe-core: rule and element."""
        (axe,) = pathlib.Path(os.environ["VOXTOUCH_PYTHON"]).glob(
            "lib/python3*/site-packages/axe_playwright_python/axe.min.js"
        )
        self.driver.execute_script(axe.read_text(encoding="utf-8"))
        found = self.driver.execute_async_script(
            "const done = arguments[0]; axe.run(document).then(done, error => done({violations:"
            " [{id: String(error), nodes: []}]}))"
        )
        return [
            (rule["id"], [node["html"][:100] for node in rule["nodes"]])
            for rule in found["violations"]
        ]

    def end(self):
        self.driver.quit()


class BrowserTest(unittest.TestCase):
    def setUp(self):
        self.browser = Browser()
        self.addCleanup(self.browser.end)

    def judge(self, name):
        self.browser.picture(name)
        self.assertEqual(self.browser.overlaps(), [], name)
        self.assertEqual(self.browser.low_contrast(), [], name)
        self.assertEqual(self.browser.barriers(), [], name)


class InABrowser(BrowserTest):
    def test_shows_a_ring_and_changes_it(self):
        browser = self.browser
        with page() as shown:
            browser.open(shown.address())
            self.assertIn("waiting", browser.find("#pill").text)
            browser.driver.execute_script(
                """window.seen = {}; setInterval(() => {
              if (voxtouch.frame && voxtouch.frame.hits > 0 && !('contact' in seen)) seen.contact = performance.now();
              if ('contact' in seen && !('shown' in seen) && Number(document.getElementById('n-force').textContent) > 0.05) seen.shown = performance.now();
            }, 5);"""
            )
            with ring("cup_viscosity") as first:
                seen = until(
                    lambda: browser.js("'shown' in window.seen && window.seen"),
                    40,
                    "contact, and a force that is shown",
                )
                self.assertLess(
                    seen["shown"] - seen["contact"],
                    1000,
                    "ms from the first sample in contact to its force on the page",
                )
                places = {
                    tuple(
                        until(
                            lambda: browser.js(
                                "voxtouch.scene3d && voxtouch.scene3d.tool.position.toArray()"
                            ),
                            10,
                            "a tool",
                        )
                    )
                    for _ in range(6)
                    if time.sleep(0.3) is None
                }
                self.assertGreater(len(places), 3, "the tool moves")
                until(
                    lambda: browser.js("voxtouch.scene3d.arrows.returned.visible"), 10, "an arrow"
                )
                until(lambda: len(browser.frame().get("points", [])) > 0, 20, "points in contact")
                time.sleep(3)  # for charts that show something
                until(lambda: browser.frame().get("hits", 0) > 0, 10, "contact")
                self.judge("ring_light.png")
                browser.press("t")
                time.sleep(1)
                self.judge("ring_dark.png")
                browser.resize(1024, 768)
                time.sleep(1)
                self.judge("ring_tablet.png")
                browser.resize(1280, 720)

                browser.press("vv")
                until(
                    lambda: browser.js("voxtouch.slice && voxtouch.slice.axis") == "y",
                    15,
                    "a plane through the voxels",
                )
                self.assertTrue(browser.js("voxtouch.scene3d.slice.visible"))
                until(lambda: "mm" in browser.find("#slice-text").text, 5, "its place")
                time.sleep(1)
                self.judge("slice.png")
                browser.press("vv")
                until(lambda: browser.js("voxtouch.scene3d.slice") is None, 5, "no plane any more")

                until(lambda: size(browser.frame().get("effects_force")) > 0.005, 10, "drag")
                browser.find(".effect input[role=switch]").click()
                until(lambda: browser.find("#answer").text.startswith("✓"), 10, "the answer")
                until(
                    lambda: size(browser.frame().get("effects_force")) == 0.0,
                    10,
                    "no drag any more",
                )
                browser.find(".effect summary").click()
                value = browser.find(".effect .value input")
                value.send_keys(Keys.CONTROL + "a")
                value.send_keys("100000", Keys.ENTER)
                until(lambda: browser.find("#answer").text.startswith("✕"), 10, "the refusal")
                self.judge("refused.png")
                until(
                    lambda: browser.find(".effect .value input").get_attribute("value") == "1",
                    10,
                    "the value as it is",
                )

                browser.find("#pause").click()
                time.sleep(0.5)
                before = browser.js("voxtouch.scene3d.tool.position.toArray()")
                time.sleep(1)
                self.assertEqual(
                    browser.js("voxtouch.scene3d.tool.position.toArray()"), before, "paused"
                )
                browser.find("#pause").click()

                pid = next(n["pid"] for n in browser.facts()["nodes"] if n["node"] == "coupling")
                os.kill(pid, signal.SIGKILL)
                until(
                    lambda: state_of(browser.facts(), "coupling") in ("hangs", "gone"),
                    15,
                    "the dead node",
                )
                until(
                    lambda: (
                        browser.find("[data-node=coupling] .state").text.strip("✕ ")
                        in ("hangs", "gone")
                    ),
                    10,
                    "its row",
                )
                first.process.wait(30)
                until(lambda: "no samples" in browser.find("#pill").text, 20, "that nothing comes")
                self.judge("ring_gone.png")
            with ring("cup_viscosity"):
                until(
                    lambda: state_of(browser.facts(), "coupling") == "running",
                    30,
                    "the node's return",
                )
                until(lambda: "live" in browser.find("#pill").text, 20, "samples again")
            self.assertEqual(browser.faults(), [])

    def test_plays_a_bag_to_its_end(self):
        browser = self.browser
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with Process(
                "up",
                scene("objects"),
                "--motion",
                "slide",
                "--domain",
                DOMAIN,
                "--lockstep",
                "--duration",
                "8",
                "--record",
                bag,
            ) as run:
                self.assertEqual(run.process.wait(60), 0, run.output())
            with page(bag) as shown:
                browser.open(shown.address())
                until(lambda: size(browser.frame().get("force")) > 0.05, 15, "force")
                browser.press(Keys.SPACE)
                until(lambda: not browser.facts()["bag"]["playing"], 5, "a pause")
                self.judge("bag.png")
                at = browser.facts()["bag"]["t"]
                browser.press(Keys.ARROW_LEFT)
                until(lambda: browser.facts()["bag"]["t"] < at - 0.5, 5, "a step back")
                browser.press(Keys.SPACE)
                browser.js(
                    "document.getElementById('speed').value = '4',"
                    " document.getElementById('speed').dispatchEvent(new Event('change'))"
                )
                until(
                    lambda: (
                        browser.facts()["bag"]["t"] >= browser.facts()["bag"]["duration"] - 0.01
                    ),
                    20,
                    "the end",
                )
                browser.press("?")
                time.sleep(0.5)
                browser.picture("keys.png")
                self.assertEqual(browser.faults(), [])
            report = pathlib.Path(folder) / "report.html"
            subprocess.run(
                [BIN / "voxtouch", "report", bag, "--out", report],
                check=True,
                stdout=subprocess.DEVNULL,
            )
            browser.open(report.as_uri())
            browser.picture("report.png")
            self.assertEqual(browser.barriers(), [])


if __name__ == "__main__":
    unittest.main()

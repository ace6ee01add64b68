"""page_rate.py [N]: frame rate of headless Chromium for a bag with a scene of 12 N N triangles (N =
289: a million), run manually with Debian's Python.

Prints pictures a second, frames of the server a second, and the time of a picture in milliseconds
of the page's thread. A browser without a graphics card draws on the CPU. Needs VOXTOUCH_BIN,
VOXTOUCH_DEPLOY, VOXTOUCH_PICTURES.
"""

import json
import pathlib
import sys
import tempfile
import time

from browser_test import Browser
from page_client import DOMAIN, Process, fine_scene, page, until

TIMED = """(() => {
  const s = voxtouch.scene3d, draw = s.draw.bind(s), gl = s.renderer.getContext(), one = new Uint8Array(4);
  window.cost = {n: 0, ms: 0};
  s.draw = () => {
    const from = performance.now(), drawn = draw();
    if (drawn) gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, one), cost.n++, cost.ms += performance.now() - from;
    return drawn;
  };
})()"""


def main():
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 289
    with tempfile.TemporaryDirectory() as folder:
        bag = str(pathlib.Path(folder) / "bag")
        with Process(
            "up",
            str(fine_scene(folder, n)),
            "--motion",
            "slide",
            "--domain",
            DOMAIN,
            "--lockstep",
            "--duration",
            "12",
            "--record",
            bag,
        ) as run:
            assert run.process.wait(300) == 0, run.output()
        browser = Browser()
        with page(bag) as shown:
            began = time.monotonic()
            browser.open(shown.address())
            scene = until(
                lambda: browser.js(
                    "voxtouch.scene && voxtouch.scene.meshes.length && voxtouch.scene.meshes.map(m"
                    " => [m.triangles, m.shown])"
                ),
                60,
                "a scene",
            )
            found = {
                "triangles": scene,
                "s_until_they_are_there": round(time.monotonic() - began, 1),
            }
            until(
                lambda: "once more" not in browser.facts().get("scene_note", "once more"),
                200,
                "voxels: building them takes the processors from the browser",
            )
            browser.js(
                "document.getElementById('seek').value = 0,"
                " document.getElementById('seek').dispatchEvent(new Event('change'))"
            )
            time.sleep(0.5)
            if not browser.facts()["bag"]["playing"]:
                browser.find("#play").click()
            time.sleep(1)

            def rate(seconds):
                at, pictures, frames = browser.js(
                    "[performance.now(), voxtouch.pictures, voxtouch.frames]"
                )
                time.sleep(seconds)
                to, more, others = browser.js(
                    "[performance.now(), voxtouch.pictures, voxtouch.frames]"
                )
                return [
                    round(1000 * (b - a) / (to - at), 1)
                    for a, b in ((pictures, more), (frames, others))
                ]

            found["pictures_and_frames_per_s"] = rate(4)
            browser.driver.execute_script(TIMED)
            rate(3)
            found["ms_of_drawing"] = browser.js("cost.ms / cost.n")
            print(json.dumps(found))
        browser.end()


if __name__ == "__main__":
    main()

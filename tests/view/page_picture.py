#!/usr/bin/python3
"""Takes a picture of the page of `voxtouch up --view` in the middle of a run, in headless Chromium.

usage: page_picture.py SCENE PICTURE [--motion M | --hand] [--after S] [--dark] [--domain N]

--hand: no motion; the pointer drags the hand against the nearest surface and along it.
"""

import argparse
import io
import os
import pathlib
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
for name, folder in (
    ("VOXTOUCH_BIN", "build/bin"),
    ("VOXTOUCH_DEPLOY", "deploy"),
    ("VOXTOUCH_PICTURES", "build/tests/view"),
):
    os.environ.setdefault(name, str(ROOT / folder))
from browser_test import Browser  # noqa: E402
from hand_test import Pointer  # noqa: E402
from page_client import Process, until  # noqa: E402
from PIL import Image  # noqa: E402

MOST_BYTES = 200_000


# From the target to 6 mm behind the surface point that is nearest to it: wheel in depth, and pixels
# in the plane of the screen.
WAY = """(() => {
  const hand = voxtouch.hand;
  if (!hand.position) hand.grip();
  let nearest = null, least = Infinity;
  for (const mesh of voxtouch.scene.meshes.filter(m => m.role !== 'dynamic'))
    for (let n = 0; n < mesh.positions.length; n += 3) {
      const way = new THREE.Vector3(...mesh.positions.slice(n, n + 3)).sub(hand.position);
      if (way.length() < least) nearest = way, least = way.length();
    }
  nearest.setLength(least + 0.006);
  const {right, up, away} = hand.axes(), pixel = hand.pixel();
  return [nearest.dot(away) / (-0.3 * pixel), nearest.dot(right) / pixel,
          -nearest.dot(up) / pixel];
})()"""


def drag_along(browser):
    """To the scene and along its surface; the button stays down."""
    until(
        lambda: browser.js(
            "Boolean(voxtouch.hand.facts && voxtouch.scene.meshes.length"
            " && voxtouch.frame && voxtouch.frame.tool)"
        ),
        40,
        "the hand",
    )
    wheel, dx, dy = browser.js(WAY)
    pointer = Pointer(browser)
    for _ in range(10):
        pointer.wheel(wheel / 10)
    pointer.press()
    pointer.move(dx, dy, 20, button="left", buttons=1)
    for up in (-25, 50, -50, 25):
        pointer.move(0.2 * up, up, 30, button="left", buttons=1)


def take(browser, address, after_s, dark, hand):
    """A moment in contact, with points and ten seconds of charts, and no force at its limit."""
    browser.open(address)
    browser.js(f"localStorage.setItem('voxtouch-theme', '{'dark' if dark else 'light'}')")
    browser.open(address + "&smooth")
    time.sleep(after_s)
    if hand:
        drag_along(browser)

    def touches():
        return browser.js(
            "(f => f && f.t > 10 && (f.points || []).length > 0 &&"
            " ![...f.flags, ...f.limits].some(w => ['saturated', 'clamped'].includes(w)) &&"
            " Math.hypot(...f.force) > 0.1)(voxtouch.frame)"
        )

    def picture():
        if not touches():
            return None
        time.sleep(0.3)  # what is drawn follows
        png = browser.driver.get_screenshot_as_png()
        return png if touches() else None

    return until(picture, 60, "a moment in contact")


def small(png):
    """In as many colours as fit into MOST_BYTES."""
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    for colours in 256, 128, 64, 32:
        out = io.BytesIO()
        picture.quantize(colours, dither=Image.Dither.NONE).save(out, "PNG", optimize=True)
        if out.tell() <= MOST_BYTES:
            return out.getvalue()
    sys.exit(f"the picture does not fit into {MOST_BYTES} bytes")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene"), parser.add_argument("picture")
    (
        parser.add_argument("--motion", default="slide"),
        parser.add_argument("--after", type=float, default=6.0),
    )
    parser.add_argument("--hand", action="store_true")
    parser.add_argument("--dark", action="store_true"), parser.add_argument("--domain", default="0")
    o = parser.parse_args()
    moved = ("--hand-from", "page") if o.hand else ("--motion", o.motion, "--view")
    with Process("up", o.scene, *moved, "--no-record", "--domain", o.domain) as ring:
        browser = Browser()
        try:
            png = take(browser, ring.address(), o.after, o.dark, o.hand)
        finally:
            browser.end()
    pathlib.Path(o.picture).write_bytes(small(png))


if __name__ == "__main__":
    main()

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


# Wheel in depth, and pixels in the plane of the screen, from the hand's target to a place given in
# the camera's axes from the middle of the scene, in radii of the scene: right, up.
WAY = """((right, up) => {
  const hand = voxtouch.hand, scene = voxtouch.scene3d, axes = hand.axes(), pixel = hand.pixel();
  const way = scene.middle.clone().addScaledVector(axes.right, right * scene.radius)
    .addScaledVector(new THREE.Vector3(0, 0, 1), up * scene.radius).sub(hand.position);
  return [way.dot(axes.away) / (-0.3 * pixel), way.dot(axes.right) / pixel,
          -way.dot(axes.up) / pixel];
})"""


def begin_drag(browser):
    """Around the scene to its left side and against it; the button stays down."""
    until(
        lambda: browser.js(
            "Boolean(voxtouch.hand.facts && voxtouch.scene.meshes.length"
            " && voxtouch.frame && voxtouch.frame.tool) && voxtouch.hand.grip()"
        ),
        40,
        "the hand",
    )
    pointer = Pointer(browser)
    pointer.press()
    for right, up in ((-1.0, 0.8), (-1.0, 0.1), (-0.4, 0.1)):
        for _ in range(3):  # the target stays in sight of the tool, which follows
            wheel, dx, dy = browser.js(f"{WAY}({right}, {up})")
            pointer.wheel(wheel)
            pointer.move(dx, dy, 3, button="left", buttons=1)
            time.sleep(0.3)
    browser.js("voxtouch.scene3d.look('home')")  # scene and tool, which is near it now
    return pointer


def slide(pointer):
    for up in (30, -30):
        pointer.move(0, up, 5, button="left", buttons=1)


def take(browser, address, after_s, dark, hand):
    """A moment in contact, with points and ten seconds of charts, and no force at its limit."""
    browser.open(address)
    browser.js(f"localStorage.setItem('voxtouch-theme', '{'dark' if dark else 'light'}')")
    browser.open(address + "&smooth")
    time.sleep(after_s)
    pointer = begin_drag(browser) if hand else None

    def touches():
        return browser.js(
            "(f => f && f.t > 10 && (f.points || []).length > 0 &&"
            " ![...f.flags, ...f.limits].some(w => ['saturated', 'clamped'].includes(w)) &&"
            " Math.hypot(...f.force) > 0.1)(voxtouch.frame)"
        )

    def picture():
        if pointer:
            slide(pointer)
        if not touches():
            return None
        time.sleep(0.3)  # the drawing follows
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

"""hand_measure.py latency|drags [N]: latency and limits of a page's hand, run manually with
Debian's Python.

latency: a pointer step of 6 pixels into a wall, N times (60): milliseconds from the event to the
first picture with an increased force, median and 95 %. drags: N random drags (200) over a cup at
any speed: samples in which the tool passed something, of the run's verdict. Needs VOXTOUCH_BIN,
VOXTOUCH_DEPLOY, VOXTOUCH_PICTURES.
"""

import json
import random
import signal
import sys
import time

from browser_test import Browser
from hand_test import Pointer, led_ring
from page_client import size, until, until_it_runs

# Of each pointer event the time, and of each picture that was drawn the force in it.
WATCH = """(() => {
  window.events = [], window.pictures = [];
  canvas.addEventListener('pointermove', () => events.push(performance.now()), true);
  const s = voxtouch.scene3d, draw = s.draw.bind(s);
  s.draw = () => {
    const drawn = draw();
    const force = Number(document.getElementById('n-force').textContent);
    if (drawn) pictures.push([performance.now(), force]);
    return drawn;
  };
})()"""


def opened(browser, up, camera):
    until_it_runs(up)
    browser.open(up.address())
    until(lambda: browser.frame().get("tool"), 20, "a tool")
    until(lambda: browser.js("Boolean(voxtouch.hand.facts)"), 20, "the hand")
    browser.find(f"[data-camera={camera}]").click()
    time.sleep(0.5)
    return Pointer(browser)


def latency(browser, count):
    with led_ring("plane") as up:
        pointer = opened(browser, up, "front")
        pointer.press()
        while size(browser.frame().get("force")) < 0.3:  # as deep as the first newtons
            pointer.move(0, 2, 1, button="left", buttons=1)
            time.sleep(0.15)
        browser.js(WATCH)
        seen = []
        for _ in range(count):
            time.sleep(0.6 + 0.1 * random.random())
            before = browser.js("pictures.length ? pictures[pictures.length - 1][1] : 0")
            browser.js("(events.length = 0, pictures.length = 0)")
            pointer.move(0, 6, 1, button="left", buttons=1)
            time.sleep(0.6)
            begun, drawn = browser.js("[events[0], pictures]")
            after = [t for t, force in drawn if t > begun and force > before + 0.03]
            seen.append(after[0] - begun if after else float("inf"))
            pointer.move(0, -6, 1, button="left", buttons=1)
        pointer.release()
    seen.sort()
    return {
        "n": count,
        "median_ms": round(seen[len(seen) // 2], 1),
        "p95_ms": round(seen[int(0.95 * (len(seen) - 1))], 1),
        "max_ms": round(seen[-1], 1),
    }


# A drag to a random point of the scene's surface: wheel in depth, and pixels in the plane of the
# screen, from the hand's target. Up to 6 mm off the surface, to either side.
DRAG = """(() => {
  const hand = voxtouch.hand, near = () => 0.012 * (Math.random() - 0.5);
  if (!hand.position) hand.grip();
  const meshes = voxtouch.scene.meshes.filter(m => m.role !== 'dynamic'),
    p = meshes[Math.floor(Math.random() * meshes.length)].positions;
  const n = 3 * Math.floor(Math.random() * p.length / 3);
  const to = new THREE.Vector3(p[n] + near(), p[n + 1] + near(), p[n + 2] + near());
  const way = to.sub(hand.position), {right, up, away} = hand.axes(), pixel = hand.pixel();
  return [way.dot(away) / (-0.3 * pixel), way.dot(right) / pixel, -way.dot(up) / pixel];
})()"""


def drags(browser, count, scene="cup_virtual_tool"):
    """So many drags, each to a random point of the scene's surface in 1 to 8 events; the verdict of
    the run, and how many ended in contact.
    """
    with led_ring(scene, "--json") as up:
        pointer = opened(browser, up, "home")
        x, y = pointer.x, pointer.y
        random.seed(45)
        touched, largest = 0, 0.0
        for _ in range(count):
            wheel, dx, dy = browser.js(DRAG)
            pointer.x, pointer.y = x, y  # a drag may begin anywhere: its length counts
            if abs(wheel) > 1:
                pointer.wheel(wheel)
            pointer.drag(dx, dy, random.choice((1, 2, 4, 8)))
            time.sleep(random.uniform(0.1, 0.4))
            force = browser.js("Math.hypot(...(voxtouch.frame.force || [0]))")
            touched, largest = touched + (force > 0.05), max(largest, force)
        up.process.send_signal(signal.SIGINT)
        up.process.wait(60)
        output = up.output()
    limits = json.loads(output[output.index("\n{") :])["limits"]
    expected = (
        "passed_through_samples",
        "tunnelling_suspected_samples",
        "validator_disagreements",
        "slewed_samples",
        "swing_s",
        "clamped_ratio",
    )
    met = {name: limits[name] for name in expected if name in limits}
    return {"drags": count, "in_contact": touched, "largest_n": round(largest, 2), "met": met}


def main():
    what, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else None
    browser = Browser()
    try:
        found = latency(browser, count or 60) if what == "latency" else drags(browser, count or 200)
        print(json.dumps(found, indent=2))
    finally:
        browser.end()


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Takes a picture of the page of `voxtouch up --view` in the middle of a run, in headless Chromium.

usage: page_picture.py SCENE PICTURE [--motion M] [--after S] [--dark] [--bin DIR] [--domain N]
"""
import argparse
import io
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIZE = (1280, 720)
MOST_BYTES = 200_000


def browser():
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    options = Options()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu", "--enable-unsafe-swiftshader"):
        options.add_argument(argument)
    driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": SIZE[0], "height": SIZE[1], "deviceScaleFactor": 1, "mobile": False})
    return driver


def wait_for(holds, patience_s, what):
    end = time.monotonic() + patience_s
    while time.monotonic() < end:
        if value := holds():
            return value
        time.sleep(0.05)
    sys.exit(f"not within {patience_s} s: {what}")


def take(driver, address, after_s, dark):
    """A moment in contact, with points and ten seconds of charts."""
    driver.get(address)
    driver.execute_script("localStorage.setItem('voxtouch-theme', arguments[0])", "dark" if dark else "light")
    driver.get(address + "&smooth")
    time.sleep(after_s)

    def touches():
        return driver.execute_script("const f = voxtouch.frame; return f && f.t > 10 && f.depth > 0 && (f.points || []).length > 0 && "
                                     "Math.hypot(...f.force) > 0.1")

    def picture():
        if not touches():
            return None
        time.sleep(0.3)  # what is drawn follows
        png = driver.get_screenshot_as_png()
        return png if touches() else None

    return wait_for(picture, 60, "a moment in contact")


def small(png):
    """In as many colours as fit into MOST_BYTES."""
    from PIL import Image
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    for colours in 256, 128, 64, 32:
        out = io.BytesIO()
        picture.quantize(colours, dither=Image.Dither.NONE).save(out, "PNG", optimize=True)
        if out.tell() <= MOST_BYTES:
            return out.getvalue()
    sys.exit(f"the picture does not fit into {MOST_BYTES} bytes")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene"), parser.add_argument("picture")
    parser.add_argument("--motion", default="slide"), parser.add_argument("--after", type=float, default=6.0)
    parser.add_argument("--dark", action="store_true"), parser.add_argument("--domain", default="0")
    parser.add_argument("--bin", default=ROOT / "build" / "bin", type=pathlib.Path)
    o = parser.parse_args()
    with tempfile.NamedTemporaryFile() as told:
        ring = subprocess.Popen([o.bin / "voxtouch", "up", o.scene, "--motion", o.motion, "--view", "--no-record", "--domain", o.domain],
                                stdout=told, stderr=subprocess.STDOUT)
        try:
            text = wait_for(lambda: re.search(rb"http://\S+", pathlib.Path(told.name).read_bytes()), 20, "the page's address")
            driver = browser()
            try:
                png = take(driver, text.group().decode(), o.after, o.dark)
            finally:
                driver.quit()
        finally:
            ring.terminate()
            ring.wait(30)
    pathlib.Path(o.picture).write_bytes(small(png))


if __name__ == "__main__":
    main()

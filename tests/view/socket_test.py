"""The page's server with a plain client: access, limits, and the ring's data."""

import contextlib
import json
import os
import pathlib
import signal
import sqlite3
import tempfile
import time
import unittest
import urllib.parse

from page_client import (
    DOMAIN,
    Process,
    WebSocket,
    fine_scene,
    page,
    pid_of,
    request,
    ring,
    scene,
    size,
    state_of,
    until,
)


class Guards(unittest.TestCase):
    def setUp(self):
        self.page = page()
        self.addCleanup(self.page.end)
        self.address = self.page.address()
        self.parts = urllib.parse.urlsplit(self.address)

    def test_needs_the_token(self):
        self.assertEqual(request(self.address)[0], 200)
        self.assertEqual(request(self.address, "/")[0], 403)
        (token,) = urllib.parse.parse_qs(self.parts.query)["token"]
        for other in ("0" * 32, token[:-1], token + "0", token[::-1], ""):
            self.assertEqual(request(self.address, f"/?token={other}")[0], 403, other)
        with (
            WebSocket(self.address) as good,
            WebSocket(self.address, token="0" * 32) as bad,
            WebSocket(self.address, token="") as none,
        ):
            self.assertEqual(
                [good.status, bad.status == 101, none.status == 101], [101, False, False]
            )

    def test_refuses_pages_of_other_sites(self):
        own = f"http://{self.parts.netloc}"
        for origin, admitted in (
            (own, True),
            ("http://example.org", False),
            ("null", False),
            (own + "0", False),
            (own.replace("http:", "https:"), False),
        ):
            with WebSocket(self.address, origin=origin) as socket:
                self.assertEqual(socket.status == 101, admitted, origin)
        self.assertEqual(request(self.address, headers=["Origin: http://example.org"])[0], 403)

    def test_refuses_names_of_other_sites(self):
        local = f"localhost:{self.parts.port}"
        for host, admitted in (
            (local, True),
            ("example.org", False),
            (f"example.org:{self.parts.port}", False),
            ("127.0.0.1:1", False),
        ):
            with WebSocket(self.address, host=host) as socket:
                self.assertEqual(socket.status == 101, admitted, host)
            self.assertEqual(request(self.address, host=host)[0], 200 if admitted else 403, host)

    def test_disconnects_a_flooding_client(self):
        with WebSocket(self.address) as socket:
            socket.send('{"words": "' + "x" * 70000 + '"}')
            self.assertEqual(socket.code_of_the_end(5), 1009)
        with WebSocket(self.address) as socket:
            for _ in range(200):
                try:
                    socket.send("{}")
                except OSError:
                    break
            self.assertIn(socket.code_of_the_end(5), (1008, 1006))
        self.assertEqual(request(self.address)[0], 200)

    def test_serves_64_pages_and_no_more(self):
        sockets = [WebSocket(self.address) for _ in range(66)]
        self.assertEqual(sum(s.status == 101 for s in sockets), 66)
        for refused in sockets[64:]:
            message = refused.receive()
            self.assertEqual(message["type"], "refused")
            self.assertIn("64 pages are open", message["sentence"])
            self.assertIsNone(refused.receive())
        for s in sockets:
            s.close()
        time.sleep(0.5)
        with WebSocket(self.address) as socket:
            self.assertEqual(socket.status, 101)

    def test_a_page_that_answers_no_ping_loses_its_place(self):
        frozen = [WebSocket(self.address) for _ in range(64)]
        time.sleep(25)
        with WebSocket(self.address) as socket:
            self.assertNotEqual(socket.receive()["type"], "refused")
        for s in frozen:
            s.close()

    def test_names_the_remedy_for_a_tunnel_at_another_port(self):
        status, _, body = request(self.address, host="localhost:1")
        self.assertEqual(status, 403)
        self.assertIn(b"ssh -L", body)

    def test_serves_the_pages_files_and_no_others(self):
        for path in "/main.js", "/page.css", "/three.js", "/orbit.js", "/dygraph.js":
            status, head, body = request(self.address, path)
            self.assertEqual(status, 200, path)
            self.assertGreater(len(body), 500, path)
            self.assertIn("content-security-policy: default-src 'none'", head)
        for path in (
            "/../CMakeLists.txt",
            "/%2e%2e/view.cpp",
            "/etc/passwd",
            "//etc/passwd",
            "/index.html.bak",
            "/voxtouch_page/main.js",
        ):
            self.assertNotEqual(request(self.address, path)[0], 200, path)

    def test_invalid_messages_change_nothing(self):
        with WebSocket(self.address) as socket:
            for text in (
                "",
                "[]",
                "{",
                '{"change": 5}',
                '{"change": [1]}',
                '{"seek": "x"}',
                '{"play": true}',
                "\x00",
            ):
                socket.send(text)
            socket.order(change=["viscosity"])
            answer = socket.wait_for(
                lambda m: m["type"] == "answer", 10, "an answer to half a change"
            )
            self.assertFalse(answer["ok"])
            self.assertIn("missing", answer["sentence"])

    def test_takes_another_port_if_none_is_requested(self):
        port = str(self.parts.port)
        with Process("view", "--domain", DOMAIN, "--port", port) as second:
            self.assertEqual(second.process.wait(10), 1)
            self.assertIn("in use", second.output())
        with (
            Process("view", "--domain", DOMAIN) as one,
            Process("view", "--domain", DOMAIN) as other,
        ):
            self.assertNotEqual(
                urllib.parse.urlsplit(one.address()).port,
                urllib.parse.urlsplit(other.address()).port,
            )
            self.assertNotEqual(one.address().split("=")[1], other.address().split("=")[1])


class Live(unittest.TestCase):
    def test_shows_force_effects_and_dead_nodes(self):
        with page() as shown, WebSocket(shown.address()) as socket:
            with ring("cup_viscosity") as first:
                drawn = socket.wait_for(
                    lambda m: m["type"] == "scene" and m["meshes"],
                    20,
                    "the scene that the ring names",
                )
                self.assertEqual({m["role"] for m in drawn["meshes"]}, {"static", "dynamic"})
                # The page may join while the tool leaves its first contact: the next one counts
                # too.
                force = socket.frame(
                    lambda m: m.get("hits", 0) > 0 and size(m.get("force")) > 0.05,
                    20,
                    "force in contact",
                )
                points = socket.frame(
                    lambda m: len(m.get("points", [])) >= 3, 20, "points in contact"
                )
                self.assertEqual(len(points["points"]) % 3, 0)
                socket.frame(lambda m: size(m.get("effects_force")) > 0.005, 10, "drag")

                socket.order(change=["viscosity", "off"])
                facts = socket.facts(
                    lambda m: m["effects"] and not m["effects"][0]["on"], 10, "the effect off"
                )
                self.assertEqual(facts["answers"][-1]["result"], "done")
                off_at = socket.frame(lambda m: size(m.get("effects_force")) == 0.0, 10, "no drag")[
                    "t"
                ]
                later = socket.frame(lambda m: m["t"] > off_at + 1.0, 10, "a second more")
                self.assertEqual(size(later["effects_force"]), 0.0)

                socket.order(change=["viscosity", "damping_ns_per_m=1e5"])
                facts = socket.facts(
                    lambda m: m["answers"] and m["answers"][-1]["result"] == "refused",
                    10,
                    "a refusal",
                )
                self.assertGreater(len(facts["answers"][-1]["sentence"]), 20)

                facts = socket.facts(
                    lambda m: state_of(m, "coupling") == "running" and m["latency"] and m["design"],
                    10,
                    "all that is known",
                )
                self.assertGreater(facts["latency"]["samples"], 100)
                self.assertRegex(facts["design"]["sentence"], r"certified [\d.]+ N/m")
                tasks = [
                    t.read_text().rsplit(")", 1)[1].split()
                    for t in pathlib.Path(f"/proc/{shown.process.pid}/task").glob("*/stat")
                ]
                self.assertTrue(
                    all(int(t[16]) >= 10 and t[38] == "0" for t in tasks),
                    "a thread of the page is as urgent as those that feel",
                )
                rate = socket.facts(
                    lambda m: any(n["node"] == "device" and n["rate_hz"] for n in m["nodes"]),
                    10,
                    "a rate",
                )
                self.assertTrue(rate)
                os.kill(pid_of(facts, "coupling"), signal.SIGKILL)
                socket.facts(
                    lambda m: state_of(m, "coupling") in ("hangs", "gone"), 15, "the dead node"
                )
                first.process.wait(30)
            with ring("cup_viscosity"):
                socket.facts(
                    lambda m: state_of(m, "coupling") == "running", 30, "the node's return"
                )
                socket.frame(
                    lambda m: m["session"] != force["session"] and size(m.get("force")) > 0.05,
                    20,
                    "force of the next session",
                )


class Slices(unittest.TestCase):
    def test_cut_the_voxels_of_the_scene(self):
        """The plane's block fills 0 > z > -20 mm: the page's data is checked against that, cell
        by cell."""
        with page() as shown, WebSocket(shown.address()) as socket, ring("plane"):
            socket.frame(lambda m: m.get("tool"), 20, "samples")
            for axis, at in ("z", -0.009), ("x", 0.011), ("z", 0.05):
                socket.order(slice={"axis": axis, "at": at})
                cut = socket.wait_for(
                    lambda m: (
                        m["type"] == "slice" and m["axis"] == axis and abs(m["at"] - at) < 1e-9
                    ),
                    20,
                    f"a plane across {axis}",
                )
                self.assertEqual(len(cut["cells"]), cut["columns"] * cut["rows"])
                low, step, seen = cut["low"], cut["step"], {"0": 0, "1": 0, "2": 0}
                for n, kind in enumerate(cut["cells"]):
                    u, v = (
                        low[0] + (n % cut["columns"] + 0.5) * step,
                        low[1] + (n // cut["columns"] + 0.5) * step,
                    )
                    x, y, z = {"x": (at, u, v), "z": (u, v, at)}[axis]
                    depth = min(0.12 - abs(x), 0.12 - abs(y), -z, z + 0.02)  # in the block: above 0
                    seen[kind] += 1
                    if depth < -1.5 * step:
                        self.assertEqual(kind, "0", (x, y, z))
                    if depth > 1.5 * step:
                        self.assertEqual(kind, "2", (x, y, z))
                if at == 0.05:
                    self.assertEqual(seen["1"] + seen["2"], 0)
                else:
                    self.assertGreater(min(seen["1"], seen["2"]), 100, seen)
            socket.order(slice={"axis": "z"})  # the tool's position
            cut = socket.wait_for(
                lambda m: m["type"] == "slice" and m["at"] != at, 10, "a plane at the tool"
            )
            frame = socket.frame(lambda m: True, 5, "the tool")
            self.assertAlmostEqual(cut["at"], frame["object"][2], delta=0.01)


class Large(unittest.TestCase):
    def test_meshes_are_drawn_coarser_without_delay(self):
        with (
            tempfile.TemporaryDirectory() as folder,
            page(str(fine_scene(folder, 160))) as shown,
            WebSocket(shown.address()) as socket,
        ):
            facts = 0
            while not (message := socket.receive()).get("meshes"):
                facts += message["type"] == "facts"
            self.assertGreater(facts, 0, "the page receives nothing while a mesh is read")
            count = [(m["triangles"], m["shown"]) for m in message["meshes"]]
            self.assertEqual(count[0][0], 12 * 160 * 160)
            self.assertEqual(count[1], (1280, 1280), "what is small is drawn whole")
            self.assertGreater(count[0][1], 10_000)
            self.assertLessEqual(count[0][1] + count[1][1], 20_000)
            self.assertIn(f"{count[0][1]} of {count[0][0]} triangles", message["notes"][0])


class Together(unittest.TestCase):
    def test_up_serves_the_page_within_two_seconds_and_ends_it(self):
        began = time.monotonic()
        with ring("cup", "--view") as run:
            with WebSocket(run.address()) as socket:
                socket.wait_for(lambda m: m["type"] == "scene" and m["meshes"], 10, "the scene")
                took = time.monotonic() - began
                socket.frame(lambda m: "tool" in m, 20, "a sample")
                run.end()
                while socket.receive() is not None:
                    pass
            address = run.address()
        self.assertLess(took, 2.0)
        with self.assertRaises(OSError):
            request(address)

    def test_up_reports_that_its_page_was_killed(self):
        with ring("cup", "--view") as run:
            run.address()
            children = f"/proc/{run.process.pid}/task/{run.process.pid}/children"
            for child in pathlib.Path(children).read_text().split():
                words = pathlib.Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")
                if words[1:2] == [b"view"]:
                    os.kill(int(child), signal.SIGKILL)
            until(lambda: "the page ended by signal 9" in run.output(), 20, run.output())


class Status(unittest.TestCase):
    @staticmethod
    def status(*more):
        with Process("status", "--domain", DOMAIN, *more) as run:
            return run.process.wait(20), run.output()

    def test_names_all_rigs_with_their_nodes(self):
        code, output = self.status()
        self.assertEqual((code, "No node" in output), (1, True), output)
        with ring("cup") as here, ring("plane", "--rig", "left"):
            until(lambda: here.output().count("samples") > 2, 30, here.output())
            code, output = self.status("--json")
            found = json.loads(output)
            self.assertEqual((code, found["ok"]), (0, True), output)
            self.assertEqual(sorted(found["rigs"]), ["haptic", "left"])
            device = found["rigs"]["left"][0]
            self.assertEqual((device["node"], device["state"]), ("device", "running"))
            self.assertGreater(device["rate_hz"], 300)
            self.assertGreater(device["answered_ratio"], 0.1)
            self.assertNotIn("haptic", self.status("--rig", "left")[1])
            dead = found["rigs"]["haptic"]
            os.kill(next(n["pid"] for n in dead if n["node"] == "validator"), signal.SIGSTOP)
            output = self.status()[
                1
            ]  # a hung node reports nothing to late clients; the others name it
            os.kill(next(n["pid"] for n in dead if n["node"] == "validator"), signal.SIGCONT)
            self.assertIn("validator hangs", output)


class Recorded(unittest.TestCase):
    def test_latency_of_a_recorded_ring_matches_its_logger(self):
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with Process(
                "up",
                scene("cup"),
                "--motion",
                "slide",
                "--domain",
                DOMAIN,
                "--duration",
                "5",
                "--record",
                bag,
                "--record-format",
                "sqlite3",
            ) as run:
                run.process.wait(60)
            with page(bag) as shown, WebSocket(shown.address()) as socket:
                socket.order(speed=4)
                facts = socket.facts(
                    lambda m: not m["bag"]["playing"] and m["latency"] and m["counts"],
                    30,
                    "the end",
                )
                output = json.loads((pathlib.Path(bag) / "voxtouch_run.json").read_text())
                self.assertEqual(
                    facts["bag"]["verdict"], {"good": output["ok"], "problems": output["problems"]}
                )
            self.assertGreater(
                facts["counts"]["latency_p50_us"], 0, "what the device measured stands next to it"
            )
            taken = {"/haptic/device/state": {}, "/haptic/coupling/command": {}}
            for file in pathlib.Path(bag).glob("*.db3"):
                with contextlib.closing(sqlite3.connect(file)) as db:
                    for name, time_ns, data in db.execute(
                        "select name, timestamp, data from messages join topics on topics.id ="
                        " topic_id"
                    ):
                        if name in taken:
                            taken[name][int.from_bytes(data[12:20], "little")] = time_ns
            states, commands = taken.values()
            us = sorted(
                (commands[n] - states[n]) * 1e-3
                for n in commands
                if n in states and commands[n] >= states[n]
            )
            self.assertEqual(facts["latency"]["samples"], len(us))
            self.assertEqual(sum(facts["latency"]["counts"]), len(us))
            self.assertAlmostEqual(facts["latency"]["p50_us"], us[len(us) // 2], delta=2.0)
            self.assertAlmostEqual(
                facts["latency"]["counts"][0], sum(x < 25.0 for x in us), delta=2
            )

    def test_plays_seeks_and_ends(self):
        with tempfile.TemporaryDirectory() as folder:
            bag = str(pathlib.Path(folder) / "bag")
            with Process(
                "up",
                scene("cup"),
                "--motion",
                "slide",
                "--domain",
                DOMAIN,
                "--lockstep",
                "--duration",
                "6",
                "--record",
                bag,
                "--record-split-s",
                "2.5",
            ) as run:  # in MCAP; the case above plays one in sqlite3
                self.assertEqual(run.process.wait(60), 0, run.output())
            with page(bag) as shown, WebSocket(shown.address()) as socket:
                socket.frame(lambda m: size(m.get("force")) > 0.05, 10, "force")
                socket.order(speed=4)
                end = socket.facts(lambda m: not m["bag"]["playing"], 15, "the end")
                self.assertAlmostEqual(end["bag"]["t"], end["bag"]["duration"], 2)
                self.assertAlmostEqual(end["bag"]["duration"], 6.0, delta=1.0)
                self.assertEqual(state_of(end, "device"), "stopped")
                self.assertIsNone(end["latency"], "lockstep: simulated times measure nothing")
                socket.order(seek=2.0)
                past = socket.wait_for(
                    lambda m: m["type"] == "past" and m["rows"], 10, "what was before"
                )
                self.assertLess(past["rows"][-1][0], 2.1)
                self.assertGreater(len(past["rows"]), 200)
                frame = socket.frame(lambda m: True, 5, "the place")
                self.assertAlmostEqual(frame["t"], 2.0, delta=0.1)
                socket.order(play=True, speed=1)
                socket.frame(lambda m: m["t"] > 2.5, 5, "that it goes on")


if __name__ == "__main__":
    unittest.main()

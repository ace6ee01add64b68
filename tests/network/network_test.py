"""A ring on three hosts, over a network with delay, loss and cuts: device and logger on one,
rendering and coupling on one each, in private network namespaces with `emulated_link` as the
switch.

usage: network_test.py CASE|all BIN [TIMES]
plain           the plain network: all nodes connect within 2 s, and the run passes
peers           the same with a switch without multicast, with --discovery-peer
secured         the run passes without multicast, with --security
delay_2, _10    milliseconds in each direction: reported if the coupling was not designed for them;
                with --network-delay the contact is displayed, or refused with a sentence
loss_1, _5, _10 percent of the frames, without multicast: stable, no step above the ramp
cut_0.5         seconds without a frame: zero within 30 ms of the device's samples, back within
                0.5 s of healing
cut_3, _5       beyond DDS's lease of 2 s: zero as above, the session ends with a sentence, and a
                restarted device has force
cut_peers       3 s without multicast
Exit status 77, with a sentence: this machine allows no network namespaces.
"""

import fcntl
import json
import math
import os
import pathlib
import re
import signal
import socket
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
SCENE = REPOSITORY / "deploy/scenes/press_virtual_tool.yaml"
LEASE_S = 2.0  # after which DDS treats a participant as lost
HEADER = 4
failures = []
RINGS = []


def expect(holds, sentence):
    print(("  " if holds else "  FAILED: ") + sentence, flush=True)
    if not holds:
        failures.append(sentence)


def run(*arguments):
    subprocess.run(arguments, check=True, stdout=subprocess.DEVNULL)


class Host:
    """A network namespace with one card, whose other end is here."""

    def __init__(self, name, address):
        self.address = address
        self.holder = subprocess.Popen(
            ["unshare", "-n", "cat"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL
        )
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.holder.pid}/ns/net") == own:
            time.sleep(0.01)
        self.card, self.end = name, name + "_end"
        run("ip", "link", "add", self.end, "type", "veth", "peer", "name", name)
        run("ip", "link", "set", name, "netns", str(self.holder.pid))
        run("ip", "link", "set", self.end, "up")
        for words in (
            ("link", "set", "lo", "up"),
            ("link", "set", name, "up"),
            ("address", "add", address + "/24", "dev", name),
        ):
            run(*self.inside("ip", *words))
        self.mac = json.loads(
            subprocess.run(
                self.inside("ip", "-j", "link", "show", name),
                check=True,
                capture_output=True,
                text=True,
            ).stdout
        )[0]["address"]
        # Frames of a veth have no checksum yet; frames forwarded by a program need one.
        run(
            *self.inside(
                sys.executable,
                "-c",
                (
                    f"import sys; sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r});"
                    f" import network_test; network_test.whole_checksums({name!r})"
                ),
            )
        )

    def inside(self, *arguments):
        return ["nsenter", "-t", str(self.holder.pid), "-n", *map(str, arguments)]

    def end_it(self):
        self.holder.stdin.close()
        self.holder.wait()


def whole_checksums(card):
    """ETHTOOL_STXCSUM 0, as `ethtool -K CARD tx off`."""
    command = struct.pack("II", 0x17, 0)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        import array

        value = array.array("B", command)
        request = struct.pack("16sP", card.encode(), value.buffer_info()[0])
        fcntl.ioctl(any_socket, 0x8946, request)


class Ring:
    """`multicast`: the switch carries it; else all nodes are reported of the other hosts. `cut`:
    from the start on.
    """

    def __init__(
        self,
        bin_folder,
        delay_ms=0.0,
        loss=0.0,
        network_delay_ms=0.0,
        multicast=True,
        cut=False,
        secured=False,
        seed=1,
    ):
        self.folder = tempfile.TemporaryDirectory(prefix="voxtouch_test_network_")
        self.bin, self.bag, self.nodes = bin_folder, pathlib.Path(self.folder.name) / "bag", {}
        self.hosts = {
            name: Host(name, f"10.78.0.{n}")
            for n, name in enumerate(("device", "rendering", "coupling"), 1)
        }
        # A kernel requests the hardware address of another host once a second, which is not tested
        # here: it is set.
        for own in self.hosts.values():
            for other in self.hosts.values():
                if other is not own:
                    run(
                        *own.inside(
                            "ip",
                            "neigh",
                            "replace",
                            other.address,
                            "lladdr",
                            other.mac,
                            "nud",
                            "permanent",
                            "dev",
                            own.card,
                        )
                    )
        self.link = subprocess.Popen(
            [
                bin_folder / "emulated_link",
                str(delay_ms),
                str(loss),
                str(seed),
                *(host.end for host in self.hosts.values()),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        RINGS.append(self)
        self.common = ["--domain", "0"]
        if secured:
            keys = self.folder.name + "/keys"
            run(bin_folder / "voxtouch", "keys", "--out", keys)
            self.common += ["--security", keys]
        if not multicast:
            self.report("no multicast")
        if cut:
            self.report_at("cut")
        self.peers = not multicast
        scene = ("--scene", SCENE)
        self.start("rendering", "rendering", *scene)
        self.start("coupling", "coupling", *scene)
        self.start("logger", "device", "--bag", self.bag, "--record-format", "sqlite3")
        self.device = (
            *scene,
            "--device",
            "sim-phantom",
            "--motion",
            "press",
            "--network-delay",
            network_delay_ms,
            "--fault-records",
            self.folder.name + "/faults",
        )
        self.start("device", "device", *self.device)

    def joined(self, host):
        """How a program on this host joins the ring."""
        others = (
            [other.address for name, other in self.hosts.items() if name != host]
            if self.peers
            else []
        )
        return [
            "--interface",
            self.hosts[host].card,
            *self.common,
            *(word for other in others for word in ("--discovery-peer", other)),
        ]

    def start(self, node, host, *more):
        with open(pathlib.Path(self.folder.name) / f"{node}.txt", "w") as text:
            self.nodes[node] = subprocess.Popen(
                self.hosts[host].inside(self.bin / f"voxtouch_{node}", *self.joined(host), *more),
                stdout=subprocess.DEVNULL,
                stderr=text,
                preexec_fn=os.setsid,
            )

    def said(self, node):
        return (pathlib.Path(self.folder.name) / f"{node}.txt").read_text()

    def refusal(self):
        """Of the coupling, or of the rendering, if no spring of a virtual tool could be
        displayed."""
        return next(
            (
                line
                for node in ("coupling", "rendering")
                for line in self.said(node).splitlines()
                if "No stable coupling" in line
            ),
            "",
        )

    def kill(self):
        """Removes what an aborted case left."""
        for process in (
            *self.nodes.values(),
            self.link,
            *(host.holder for host in self.hosts.values()),
        ):
            if process.poll() is None:
                process.kill()
                process.wait()

    def status(self):
        """Of the device, as `voxtouch status` on its host receives it; that takes 2.5 s."""
        end = subprocess.run(
            self.hosts["device"].inside(
                self.bin / "voxtouch", "status", "--rig", "haptic", *self.joined("device"), "--json"
            ),
            stdout=subprocess.PIPE,
            text=True,
            check=False,
        )
        nodes = json.loads(end.stdout).get("rigs", {}).values()
        return next((node for rig in nodes for node in rig if node["node"] == "device"), {})

    def wait_for_answers(self, patience_s=40.0):
        """A busy machine builds the scene and finds the coupling later. The wait is limited: a
        refused coupling sends none."""
        end = time.monotonic() + patience_s
        while (
            time.monotonic() < end
            and not self.refusal()
            and not (self.status().get("answered_ratio") or 0.0) > 0.5
        ):
            pass

    def wait_until_all_have_joined(self, patience_s=30.0):
        """Each reports what it waits for once it has built what it needs and has joined."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end and not all(
            "waiting for" in self.said(node) for node in ("rendering", "coupling")
        ):
            time.sleep(0.05)
        while time.monotonic() < end and not self.bag.exists():
            time.sleep(0.05)

    def report(self, word):
        self.link.stdin.write(word + "\n")
        self.link.stdin.flush()

    def report_at(self, word):
        """Unix time at which "cut" or "heal" began [s], independent of when this program
        receives it."""
        self.report(word)
        said, when = self.link.stdout.readline().split()
        assert said == word, said
        return float(when)

    def close(self):
        for node in ("device", "logger", "coupling", "rendering"):
            self.nodes[node].send_signal(signal.SIGTERM)
        for node in self.nodes.values():
            node.wait(timeout=30)
        carried, self.lost = map(int, re.findall(r"\d+", self.link.communicate("end\n")[0]))
        self.lost_ratio = self.lost / max(1, carried + self.lost)
        for host in self.hosts.values():
            host.end_it()


def topic(bag, name):
    database = next(bag.glob("*.db3"))
    with sqlite3.connect(f"file:{database}?mode=ro", uri=True) as connection:
        return [
            (1e-9 * taken, data[HEADER:])
            for taken, data in connection.execute(
                (
                    "SELECT timestamp, data FROM messages JOIN topics ON topics.id = topic_id WHERE"
                    " name = ? ORDER BY messages.id"
                ),
                (name,),
            )
        ]


def states(bag):
    """(time of reception here [s], the device's time [s], force on) of each sample of the device,
    whose clock falls behind with each overrun.
    """
    out = []
    for taken, data in topic(bag, "/haptic/device/state"):
        (time_ns,) = struct.unpack_from("<q", data, 16)
        (flags,) = struct.unpack_from("<I", data, 24 + 56 + 48 + 4)
        out.append((taken, 1e-9 * time_ns, bool(flags & 4)))
    return out


def behind_s(samples, at):
    """Lag of the device's clock at about this time, from the sample received with the least
    delay, because a busy machine receives some late."""
    return min(taken - t for taken, t, _ in samples if abs(taken - at) < 0.5)


def commands(bag):
    """(sequence number, force [N]) of each command, by number."""
    out = {}
    for _, data in topic(bag, "/haptic/coupling/command"):
        (number,) = struct.unpack_from("<Q", data, 8)
        out[number] = math.sqrt(sum(x * x for x in struct.unpack_from("<3d", data, 32)))
    return sorted(out.items())


def statuses(bag):
    """(when it was taken here [s], node, session) of each status."""
    out = []
    for taken, data in topic(bag, "/haptic/node_status"):
        texts, at = [], 0
        for _ in ("node", "host"):
            (size,) = struct.unpack_from("<I", data, at)
            texts.append(data[at + 4 : at + 3 + size].decode())
            at += (4 + size + 3) & ~3
        (session,) = struct.unpack_from("<Q", data, (at + 4 + 16 + 7) & ~7)
        out.append((taken, texts[0], session))
    return out


def received_again(bag, healed_at):
    """The first messages of each other host, including the coupling's readiness for the session;
    with times [s].
    """

    def first(times):
        return min((t for t in times if t > healed_at), default=math.inf)

    of = statuses(bag)
    yield from (
        (f"statuses of {node}", first(t for t, name, _ in of if name == node))
        for node in ("rendering", "coupling")
    )
    yield "contacts", first(t for t, _ in topic(bag, "/haptic/rendering/contact"))
    yield (
        "the session of coupling",
        first(t for t, name, session in of if name == "coupling" and session),
    )
    yield "its design", first(t for t, _ in topic(bag, "/haptic/coupling/design"))
    yield "commands", first(t for t, _ in topic(bag, "/haptic/coupling/command"))


# A command is repeated for three periods: the next one is at most so many samples younger.
HELD = 4


def largest_step(forces):
    """Of commands as they may follow each other at a device that loses some [N]."""
    by_number = dict(forces)
    return max(
        (
            abs(by_number[n + k] - force)
            for n, force in forces
            for k in range(1, HELD + 1)
            if n + k in by_number
        ),
        default=0.0,
    )


# So much from one command to the next is the virtual tool's spring at the speeds of `press`, and
# far under the guard's slew limit.
RAMP_N = 0.6


def expect_met(ring, healed_at):
    """From the first forwarded frame to the statuses of all nodes, and to the first command, which
    is sent when the coupling is designed.
    """
    received = statuses(ring.bag)
    session = next(s for _, node, s in received if node == "device" and s)
    met = {
        node: min(
            (
                taken
                for taken, name, s in received
                if name == node and s == session and taken > healed_at
            ),
            default=math.inf,
        )
        for node in ("device", "rendering", "coupling")
    }
    slowest = max(met.values()) - healed_at
    expect(
        slowest < 2.0,
        (
            f"all nodes of three hosts have met after {slowest:.2f} s, the coupling's design among"
            " them"
        ),
    )


def steady(bin_folder, meet=False, seconds=3.0, **network):
    """The device's last message, the fraction of samples with force in the contact, the commands,
    and the coupling's reason for a refusal.
    """
    ring = Ring(bin_folder, cut=meet, **network)
    if meet:
        ring.wait_until_all_have_joined()
        healed_at = ring.report_at("heal")
    ring.wait_for_answers()
    begun = time.time()
    time.sleep(seconds)
    device = ring.status()
    ring.close()
    if meet:
        expect_met(ring, healed_at)
    else:
        expect(
            abs(ring.lost_ratio - network.get("loss", 0.0)) < 0.005,
            f"the network lost {100 * ring.lost_ratio:.1f} % of the frames",
        )
    samples = states(ring.bag)
    pressed = [sample for sample in samples if sample[0] > begun + 1.0]  # the force has ramped in
    fraction = sum(on for _, _, on in pressed) / max(1, len(pressed))
    return device, fraction, commands(ring.bag), ring.refusal()


def expect_force(fraction, forces, least_ratio=0.95):
    expect(
        fraction > least_ratio,
        (
            f"force in {100 * fraction:.1f} % of the samples in contact,"
            f" {max((f for _, f in forces), default=0.0):.2f} N at most"
        ),
    )
    expect(
        largest_step(forces) < RAMP_N,
        f"commands that may follow each other differ by {largest_step(forces):.2f} N at most",
    )


def case_plain(bin_folder, meet=True, **network):
    _, fraction, forces, _ = steady(bin_folder, meet, **network)
    expect_force(fraction, forces)
    expect(max(f for _, f in forces) > 0.5, "the contact is displayed")


def case_delay(bin_folder, delay_ms):
    """Three one-way delays make a round."""
    device, fraction, _, _ = steady(bin_folder, delay_ms=delay_ms)
    sentence = device.get("sentence", "")
    expect(
        fraction < 0.05,
        f"not designed for {delay_ms} ms each way: force in {100 * fraction:.1f} % of the samples",
    )
    expect(
        "No force: commands arrive" in sentence and "--network-delay" in sentence,
        f"the device says so: {sentence}",
    )
    network_ms = 3 * delay_ms + 2
    _, fraction, forces, refusal = steady(
        bin_folder, delay_ms=delay_ms, network_delay_ms=network_ms
    )
    print(f"  designed for {network_ms} ms:", flush=True)
    if refusal and fraction == 0.0:
        return expect(True, f"refused with a sentence, {refusal[:200]}")
    expect_force(fraction, forces)


def case_loss(bin_folder, percent):
    _, fraction, forces, _ = steady(bin_folder, loss=0.01 * percent, multicast=False)
    expect_force(fraction, forces, 0.95 if percent < 10 else 0.8)


def expect_ended(ring):
    """Nodes without `up` keep no role beyond the lease: the participant that returns could be
    another one."""
    try:
        status = ring.nodes["device"].wait(timeout=5)
    except subprocess.TimeoutExpired:
        status = None
    expect(
        status == 1 and "of this session has left" in ring.said("device"),
        f"the device ends with status {status}: {ring.said('device').strip().splitlines()[-1]}",
    )


def case_cut(bin_folder, seconds, **network):
    ring = Ring(bin_folder, **network)
    ring.wait_for_answers()
    time.sleep(1.5)
    cut_at = ring.report_at("cut")
    time.sleep(seconds)
    healed_at = ring.report_at("heal")
    if seconds > LEASE_S:
        expect_ended(ring)
        ring.start("device", "device", *ring.device)
        ring.wait_for_answers(10.0)
    time.sleep(1.5)
    ring.close()
    samples = states(ring.bag)
    last = max(t for _, t, _ in samples if t <= cut_at - behind_s(samples, cut_at))
    expect(next(on for taken, t, on in samples if t == last), "force until the cut")
    forced = max((t for taken, t, on in samples if taken < healed_at and on), default=-math.inf)
    expect(
        forced - last < 0.030,
        (
            f"zero {1e3 * (forced - last):.1f} ms of the device's samples after the cut, and until"
            " it heals"
        ),
    )
    back = next((taken for taken, _, on in samples if taken > healed_at and on), math.inf)
    print(
        "  after healing the logger has "
        + ", ".join(
            f"{what} from {1e3 * (when - healed_at):.0f} ms on"
            for what, when in received_again(ring.bag, healed_at)
        ),
        flush=True,
    )
    expect(
        back < math.inf if seconds > LEASE_S else back - healed_at < 0.5,
        f"force again {1e3 * (back - healed_at):.0f} ms after healing",
    )


CASES = {
    "plain": case_plain,
    "peers": lambda b: case_plain(b, multicast=False),
    "secured": lambda b: case_plain(b, meet=False, multicast=False, secured=True),
    **{f"delay_{ms}": lambda b, ms=ms: case_delay(b, ms) for ms in (2, 10)},
    **{f"loss_{p}": lambda b, p=p: case_loss(b, p) for p in (1, 5, 10)},
    **{f"cut_{s}": lambda b, s=s: case_cut(b, float(s)) for s in ("0.5", "3", "5")},
    "cut_peers": lambda b: case_cut(b, 3.0, multicast=False),
}


def main():
    if "VOXTOUCH_IN_NAMESPACE" not in os.environ:
        if subprocess.run(
            ["unshare", "-n", "true"], stderr=subprocess.DEVNULL, check=False
        ).returncode:
            print("This machine allows no network namespaces.")
            return 77
        return subprocess.run(
            ["unshare", "-n", sys.executable, *sys.argv],
            env=os.environ | {"VOXTOUCH_IN_NAMESPACE": "1"},
            check=False,
        ).returncode
    for case in (list(CASES) if sys.argv[1] == "all" else [sys.argv[1]]) * int((*sys.argv, 1)[3]):
        print(case, flush=True)
        try:
            CASES[case](pathlib.Path(sys.argv[2]))
        finally:
            for ring in RINGS:
                ring.kill()
                for node in ring.nodes if failures else ():
                    print(f"--- {node}: {ring.said(node)[-1500:]}", flush=True)
            RINGS.clear()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

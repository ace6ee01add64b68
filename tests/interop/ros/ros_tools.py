"""Discovery of a ring with default settings by ROS 2 tools, in private network namespaces.

usage: ros_tools.py CASE VOXTOUCH CYCLONE_CLIENT FAST_CLIENT|none PYTHON_WITH_CYCLONEDDS
found: every set-up of rmw_cyclonedds and rmw_fastrtps finds every topic and gets the device's
samples; another host discovers nothing and cannot send. graph_iron, graph_humble: nodes, endpoints
and type hashes, read as rmw_dds_common writes them. doctor: output of `voxtouch doctor` about cards
and a Humble tool, and the environment that it prints. peers: nodes on two hosts without multicast
connect by --discovery-peer, and with CYCLONEDDS_URI the other settings apply. Exit status 77, with
a sentence: this machine allows no network namespaces.
"""

import json
import os
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time

NODES = ["coupling", "device", "rendering", "validator"]
AUTO = (
    "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
)
CYCLONE = {  # configuration that rmw_cyclonedds gives to Cyclone DDS
    "Humble": "",
    "Humble, ROS_LOCALHOST_ONLY=1": (
        "<CycloneDDS><Domain><General><Interfaces><NetworkInterface"
        ' address="127.0.0.1"/></Interfaces></General></Domain></CycloneDDS>'
    ),
    "Jazzy (SUBNET)": f"<CycloneDDS><Domain><Discovery>{AUTO}</Discovery></Domain></CycloneDDS>",
    "Jazzy, LOCALHOST": (
        f"<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General><Discovery>{AUTO}<Peers><Peer"
        ' address="localhost"/></Peers></Discovery></Domain></CycloneDDS>'
    ),
}
FAST = {
    "Humble and Jazzy (SUBNET)": "default",
    "Humble, ROS_LOCALHOST_ONLY=1": "humble_localhost",
    "Jazzy, LOCALHOST": "jazzy_localhost",
}
DOMAIN = "0"
REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
failures = []


def expect(holds, sentence):
    if not holds:
        failures.append(sentence)
        print("FAILED:", sentence, flush=True)


def run(*arguments):
    subprocess.run(arguments, check=True, stdout=subprocess.DEVNULL)


def card(name, address):
    run("ip", "link", "set", name, "up")
    run("ip", "address", "add", address, "dev", name)


class OtherHost:
    """A second network namespace behind a switch."""

    def __init__(self):
        self.holder = subprocess.Popen(
            ["unshare", "-n", "cat"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL
        )  # until this process ends
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.holder.pid}/ns/net") == own:
            time.sleep(0.01)
        run("ip", "link", "add", "switch", "type", "bridge", "mcast_snooping", "0")
        run("ip", "link", "set", "switch", "up")
        for name, port in (("eth0", "port0"), ("far0", "port1")):
            run("ip", "link", "add", name, "type", "veth", "peer", "name", port)
            run("ip", "link", "set", port, "master", "switch", "up")
        run("ip", "link", "set", "far0", "netns", str(self.holder.pid))
        card("eth0", "10.77.0.1/24")
        self.run("ip", "link", "set", "lo", "up")
        self.run("ip", "link", "set", "far0", "up")
        self.run("ip", "address", "add", "10.77.0.2/24", "dev", "far0")

    def inside(self, *arguments):
        return ["nsenter", "-t", str(self.holder.pid), "-n", *arguments]

    def run(self, *arguments):
        run(*self.inside(*arguments))


class Ring:
    def __init__(self, voxtouch, *more, record=("--no-record",), scene="plane"):
        self.up = subprocess.Popen(
            [
                voxtouch,
                "up",
                REPOSITORY / f"deploy/scenes/{scene}.yaml",
                "--device",
                "sim-phantom",
                "--motion",
                "slide",
                "--domain",
                DOMAIN,
                "--duration",
                "600",
                *record,
                *more,
            ],
            stdout=subprocess.PIPE if "--json" in more else subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        for line in self.up.stderr:
            if "samples  force" in line:
                return
        raise SystemExit("the ring did not start")

    def close(self):
        """Its summary, if requested (--json)."""
        self.up.send_signal(signal.SIGINT)
        summary, _ = self.up.communicate(timeout=30)
        return json.loads(summary) if summary else {}


def ask(command):
    """Findings of a client of this folder; empty if it failed."""
    end = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=60, check=False)
    return (
        json.loads(end.stdout)
        if end.returncode == 0
        else {
            "topics": {},
            "samples": 0,
            "first_s": -1.0,
            "standard": {},
            "streams": {},
            "answers_ms": [],
        }
    )


def topics_of(answer):
    return (
        {e[0] for e in answer["endpoints"] if e[3] and e[0].startswith("rt/")}
        if "endpoints" in answer
        else set(answer["topics"])
    )


class Clients:
    def __init__(self, voxtouch, cyclone, fast, python):
        self.types = tempfile.TemporaryDirectory()
        run(voxtouch, "types", "--python", self.types.name)
        self.cyclone, self.fast, self.python = cyclone, fast, python
        if fast == "none":
            print("Fast DDS (libfastrtps-dev) is not here: its set-ups are left out")

    def commands(self, seconds):
        script = str(pathlib.Path(__file__).with_name("pypi_client.py"))
        for how, settings in CYCLONE.items():
            yield f"Cyclone DDS 0.10, {how}", [self.cyclone, DOMAIN, settings, seconds]
            yield (
                f"Cyclone DDS 11, {how}",
                [
                    self.python,
                    "-B",
                    script,
                    self.types.name,
                    DOMAIN,
                    settings,
                    seconds,
                ],
            )
        for how, mode in FAST.items() if self.fast != "none" else ():
            yield f"Fast DDS 2.9, {how}", [self.fast, DOMAIN, mode, seconds]


def found(voxtouch, cyclone, fast, python):
    clients, other, ring = Clients(voxtouch, cyclone, fast, python), OtherHost(), Ring(voxtouch)
    own = set(
        json.loads(
            subprocess.run(
                [
                    python,
                    "-B",
                    "-c",
                    (
                        "import json, sys; sys.path.insert(0, sys.argv[1]); from voxtouch_types"
                        " import TOPICS;print(json.dumps([row.dds_name() for row in"
                        " TOPICS.values()]))"
                    ),
                    clients.types.name,
                ],
                stdout=subprocess.PIPE,
                check=True,
            ).stdout
        )
    )
    expected = own - {
        "rt/haptic/recover",
        "rt/haptic/rendering/change",
        "rt/haptic/operator/target",
        "rt/clock",
        "rt/joint_states",
        "rt/robot_description",
    }  # of an operator; of a page; in simulated time; of arms
    expected -= {
        "rt/haptic/external",
        "rt/haptic/rendering/external",
    }  # of a scene that follows an external program
    seconds = 3.0
    for name, command in clients.commands(str(seconds)):
        answer = ask(command)
        rate = answer["samples"] / (seconds - answer["first_s"]) if answer["samples"] else 0.0
        print(
            (
                f"{name:48} {len(topics_of(answer) & expected)} of {len(expected)} topics,"
                f" {rate:.0f} Hz after {answer['first_s']:.2f} s"
            ),
            flush=True,
        )
        expect(
            topics_of(answer) >= expected,
            f"{name} does not find {sorted(expected - topics_of(answer))}",
        )
        expect(
            rate > 500, f"{name} gets {rate:.0f} samples a second"
        )  # of 1000; the machine may be busy
    for name, command in clients.commands("1.5"):
        answer = ask(other.inside(*command))
        expect(
            not topics_of(answer) and not answer["samples"],
            f"another host, {name}, finds {sorted(topics_of(answer))}",
        )
    datagrams = json.loads(
        subprocess.run(
            other.inside(sys.executable, "-c", LISTENER), stdout=subprocess.PIPE, check=True
        ).stdout
    )
    expect(datagrams == 0, f"{datagrams} datagrams of the ring reach another host")
    ring.close()


LISTENER = """
import socket, time
received, end = 0, time.monotonic() + 1.5
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as group:
    group.bind(("", 7400))
    membership = socket.inet_aton("239.255.0.1") + socket.inet_aton("10.77.0.2")
    group.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
    group.settimeout(0.1)
    while time.monotonic() < end:
        try:
            received += bool(group.recv(65536))
        except TimeoutError:
            pass
print(received)
"""


class Cdr:
    """Little-endian CDR, as needed for ParticipantEntitiesInfo. Offsets count from the end of the
    encapsulation header.
    """

    def __init__(self, data):
        assert data[:2] == b"\x00\x01", data[:4]
        self.data, self.at = data[4:], 0

    def number(self):
        self.at += -self.at % 4
        self.at += 4
        return struct.unpack_from("<I", self.data, self.at - 4)[0]

    def text(self):
        size = self.number()
        self.at += size
        raw = self.data[self.at - size : self.at]
        assert raw.endswith(b"\0")
        return raw[:-1].decode()

    def gid(self, size):
        self.at += size
        gid = self.data[self.at - size : self.at]
        assert not any(gid[16:]), "a GID of Humble is a GUID and zeros"
        return gid[:16].hex()

    def gids(self, size):
        return [self.gid(size) for _ in range(self.number())]


def participant_info(data, size):
    """rmw_dds_common/msg/ParticipantEntitiesInfo: (participant, [(namespace, name, readers,
    writers)]).
    """
    cdr = Cdr(data)
    info = (
        cdr.gid(size),
        [(cdr.text(), cdr.text(), cdr.gids(size), cdr.gids(size)) for _ in range(cdr.number())],
    )
    assert len(cdr.data) - cdr.at < 4, "bytes are left over"
    return info


def key_value(user_data, key):
    """As rmw::impl::cpp::parse_key_value: 'key=value;' pairs."""
    pairs = dict(pair.split("=", 1) for pair in user_data.split(";") if "=" in pair)
    return pairs.get(key)


GRAPH_HASH = (  # as ros2 topic info -v prints it
    "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"
)
HASHES = {  # as ROS 2 publishes them
    "rt/haptic/pose": "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
    "rt/haptic/wrench": "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77",
    "rt/tf": "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "rt/diagnostics": "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    "rt/haptic/markers": "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
}


def expect_array_hash():
    """Of a type with a fixed array, which none of the ring's standard types has."""
    sys.path.insert(0, str(REPOSITORY / "idl"))
    from type_hash import type_hash

    geometry = "geometry_msgs"
    messages = {
        (geometry, "Point"): ([("float64", None, None, 0, axis) for axis in "xyz"], []),
        (geometry, "Quaternion"): ([("float64", None, None, 0, axis) for axis in "xyzw"], []),
        (geometry, "Pose"): (
            [
                ("Point", geometry, None, 0, "position"),
                ("Quaternion", geometry, None, 0, "orientation"),
            ],
            [],
        ),
        (geometry, "PoseWithCovariance"): (
            [("Pose", geometry, None, 0, "pose"), ("float64", None, "fixed", 36, "covariance")],
            [],
        ),
    }
    expect(
        type_hash(messages, geometry, "PoseWithCovariance")
        == "RIHS01_9a7c0fd234b7f45c6098745ecccd773ca1085670e64107135397aee31c02e1bb",
        "type hash of geometry_msgs/msg/PoseWithCovariance",
    )


def graph(voxtouch, fast, distribution, gid_size):
    if fast == "none":
        raise SystemExit(77)
    bags = tempfile.TemporaryDirectory()
    other, ring = (
        OtherHost(),
        Ring(voxtouch, "--ros", distribution, record=("--record", bags.name + "/bag")),
    )
    answer = ask([fast, DOMAIN, "default", "4"])
    ring.close()
    del other
    expect_array_hash()
    newest = {}
    for text in answer[
        "graph"
    ]:  # of each participant the one with the most endpoints: their number changes
        participant, nodes = participant_info(bytes.fromhex(text), gid_size)
        expect(len(nodes) == 1, "one node a participant")
        if participant not in newest or len(nodes[0][2] + nodes[0][3]) > len(
            newest[participant][2] + newest[participant][3]
        ):
            newest[participant] = nodes[0]
    names = sorted(node[1] for node in newest.values())
    expect(names == sorted([*NODES, "logger"]), f"nodes {names}")
    expect(
        {node[0] for node in newest.values()} == {"/haptic"}, "nodes stand in the rig's namespace"
    )
    for participant in newest:
        expect(
            key_value(answer["participants"].get(participant, ""), "enclave") == "/",
            f"enclave of {participant}",
        )
    owner = {
        gid: (node[1], writes)
        for node in newest.values()
        for writes in (False, True)
        for gid in node[2 + writes]
    }
    ours = {
        participant[:24] for participant in newest
    }  # of a GUID; the client sees its own reader too
    graph_writers = [
        e
        for e in answer["endpoints"]
        if e[0] == "ros_discovery_info" and e[3] and e[1][:24] in ours
    ]
    expect(len(graph_writers) == len(newest), f"{len(graph_writers)} writers of the graph")
    for (
        _,
        guid,
        user_data,
        _,
    ) in (
        graph_writers
    ):  # rmw_cyclonedds of Iron and later warns of a writer without it; Humble has none
        expect(
            key_value(user_data, "typehash") == (GRAPH_HASH if distribution != "humble" else None),
            f"type hash of {guid}: '{user_data}'",
        )
    announced = [
        e
        for e in answer["endpoints"]
        if e[0].startswith(("rt/", "rq/", "rr/")) and e[1][:24] in ours
    ]
    expect(
        len(announced) == len(owner) > 30,
        f"{len(announced)} endpoints are announced, and {len(owner)} are nodes'",
    )
    for name, guid, user_data, writes in announced:
        expect(
            owner.get(guid, (None, None))[1] == writes, f"an endpoint on {name} belongs to no node"
        )
        type_hash = key_value(user_data, "typehash") or ""
        expect(
            type_hash.startswith("RIHS01_") and len(type_hash) == 71,
            f"type hash of {name}: '{type_hash}'",
        )
        expect(type_hash == HASHES.get(name, type_hash), f"type hash of {name}: '{type_hash}'")
    for topic, writer in {
        "rt/haptic/device/state": "device",
        "rt/haptic/coupling/command": "coupling",
        "rt/tf": "rendering",
    }.items():
        expect(
            [owner.get(g, (None,))[0] for n, g, _, w in announced if n == topic and w] == [writer],
            f"{topic} is {writer}'s",
        )
    print(f"{len(newest)} nodes, {len(owner)} endpoints of theirs, GIDs of {gid_size} bytes")


def examine(voxtouch, *arguments):
    end = subprocess.run(
        [voxtouch, "doctor", "--domain", DOMAIN, *arguments],
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    return end.returncode, end.stdout


def doctor(voxtouch, cyclone, fast):
    other, ring = OtherHost(), Ring(voxtouch)
    tool = (
        subprocess.Popen([fast, DOMAIN, "default", "6"], stdout=subprocess.DEVNULL)
        if fast != "none"
        else None
    )
    status, text = examine(voxtouch)
    expect(status == 0 and text.count("is up, multicast works") == 2, f"two cards are well: {text}")
    expect(
        f"{len(NODES) + 1} participants of ROS 2 or voxtouch" in text, f"the nodes are seen: {text}"
    )
    if tool:  # it reads the graph without a type's hash, as Humble does
        expect("--ros humble" in text, f"a Humble is seen: {text}")
        tool.wait()
        expect("--ros humble" not in examine(voxtouch)[1], "none is taken for a Humble")
    settings = dict(
        line.removeprefix("export ").split("=", 1)
        for line in text.splitlines()
        if line.startswith("export ")
    )
    expect(settings["ROS_DOMAIN_ID"] == DOMAIN, "the domain is printed")
    run(
        "ip", "link", "set", "eth0", "multicast", "off"
    )  # from now on the ring would not use it, and a tool would
    expect(
        "eth0 (10.77.0.1) is not used" in examine(voxtouch)[1], "a card without multicast is named"
    )
    ring.close()
    ring = Ring(voxtouch)
    answer = ask([cyclone, DOMAIN, settings["CYCLONEDDS_URI"].strip("'"), "2"])
    expect(
        len(topics_of(answer)) >= 10 and answer["samples"] > 500,
        f"the printed environment finds the ring: {answer}",
    )
    ring.close()
    status, text = examine(voxtouch, "--interface", "eth9")
    expect(
        status == 1 and "BAD" in text and "eth9" in text,
        f"a card that is not there is named: {text}",
    )
    del other


def received_from(other, voxtouch, *arguments):
    """Whether `voxtouch status` on the other host receives all nodes over its card; None if it
    receives none.
    """
    command = [voxtouch, "status", "--json", "--domain", DOMAIN, "--interface", "far0", *arguments]
    end = subprocess.run(other.inside(*command), stdout=subprocess.PIPE, text=True, check=False)
    rigs = json.loads(end.stdout)["rigs"]
    received = {node["node"] for nodes in rigs.values() for node in nodes}
    return received == set(NODES) if received else None


def expect_settings_under_those_of_the_environment(voxtouch):
    """DDS's configuration: source and value."""
    with tempfile.NamedTemporaryFile() as trace:
        added = (
            "<CycloneDDS><Domain><Discovery><SPDPInterval>700 ms</SPDPInterval></Discovery>"
            f"<Tracing><Verbosity>config</Verbosity><OutputFile>{trace.name}</OutputFile></Tracing></Domain></CycloneDDS>"
        )
        subprocess.run(
            [voxtouch, "status", "--domain", DOMAIN],
            env={**os.environ, "CYCLONEDDS_URI": added},
            stdout=subprocess.DEVNULL,
            check=False,
        )
        text = pathlib.Path(trace.name).read_text()
    for value in (
        "LeaseDuration/#text: 2 s",
        "ParticipantIndex/#text: auto",
        "SPDPInterval/#text: 700 ms",
        "MulticastTimeToLive/#text: 0",
        "NetworkInterface[@address]: 10.77.0.1",
    ):
        expect(value in text, f"DDS runs with {value}")


def peers(voxtouch):
    other = OtherHost()
    expect_settings_under_those_of_the_environment(voxtouch)
    ring = Ring(voxtouch, "--interface", "eth0")
    expect(received_from(other, voxtouch), "by multicast all nodes are received")
    ring.close()
    for port in ("port0", "port1"):  # from now on no multicast passes the switch
        run("bridge", "link", "set", "dev", port, "mcast_flood", "off")
    ring = Ring(voxtouch, "--interface", "eth0", "--discovery-peer", "10.77.0.2")
    expect(
        received_from(other, voxtouch, "--discovery-peer", "10.77.0.1"),
        "without multicast all nodes are received by peers on both sides",
    )
    expect(received_from(other, voxtouch), "the ring's side asks by itself")
    ring.close()
    ring = Ring(voxtouch, "--interface", "eth0")
    expect(received_from(other, voxtouch) is None, "without multicast and peers none is received")
    expect(
        received_from(other, voxtouch, "--discovery-peer", "10.77.0.1"),
        "one side that asks is enough",
    )
    ring.close()


def enter_own_network():
    """Restarts this program in a new network namespace, unless it runs in one."""
    if os.environ.get("VOXTOUCH_OWN_NETWORK") != "1":
        unshare = ["unshare", "-n"] if os.geteuid() == 0 else ["unshare", "-rn"]
        if subprocess.run([*unshare, "ip", "link", "set", "lo", "up"], check=False).returncode != 0:
            print("This machine allows no network namespaces.")
            raise SystemExit(77)
        os.execvpe(
            "unshare",
            [*unshare, sys.executable, "-B", *sys.argv],
            {**os.environ, "VOXTOUCH_OWN_NETWORK": "1", "CYCLONEDDS_URI": ""},
        )
    run("ip", "link", "set", "lo", "up")


def main():
    case, voxtouch, cyclone, fast, python = sys.argv[1:6]
    enter_own_network()
    if case == "found":
        found(voxtouch, cyclone, fast, python)
    elif case == "doctor":
        doctor(voxtouch, cyclone, fast)
    elif case == "peers":
        peers(voxtouch)
    else:
        graph(voxtouch, fast, *{"graph_iron": ("iron", 16), "graph_humble": ("humble", 24)}[case])
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()

"""Every client that can be had here, with its default settings, at one ring: standard topics, the loop's topics at 1 kHz, changes of an effect.

usage: clients.py VOXTOUCH CYCLONE_CLIENT FAST_CLIENT|none PYTHON_WITH_CYCLONEDDS ROS2_CLIENT [TABLE]
Prints a table, and writes it to TABLE as Markdown. ROS2_CLIENT is built by deploy/interop; where it is not there, the test says so. Lost samples and
times are of the machine as it was: told, and judged here only so far as a busy machine holds them too.
Exit status 77, with a sentence: this machine allows no network namespaces.
"""
import os
import pathlib
import statistics
import sys

from ros_tools import DOMAIN, Clients, OtherHost, Ring, ask, enter_own_network, expect, failures, run

SECONDS, CHANGES = "5", "50"
STANDARD = {"rt/tf", "rt/tf_static", "rt/haptic/pose", "rt/haptic/wrench", "rt/haptic/markers", "rt/diagnostics", "rt/parameter_events", "rt/rosout"}
HEAD = ["client", "standard topics read", "DeviceState, ContactState, ForceCommand lost", "a change answered, median", "longest of 50", "asked by"]


def commands(clients, rust):
    """Name, command and way of asking of each client with the settings that it has by itself."""
    own = dict(clients.commands(SECONDS))
    yield "Cyclone DDS 0.10.2 (C)", own["Cyclone DDS 0.10, Humble"], "service"
    yield "Cyclone DDS 11 (Python)", own["Cyclone DDS 11, Humble"], "service"
    if "Fast DDS 2.9, Humble and Jazzy (SUBNET)" in own:
        yield "Fast DDS 2.9.1 (C++)", own["Fast DDS 2.9, Humble and Jazzy (SUBNET)"], "topic"
    if rust:
        yield "ros2-client 0.12.1 (Rust)", [rust, DOMAIN, SECONDS], "service"


def row_of(name, answer, way):
    read = {topic for topic, count in answer["standard"].items() if count}
    expect(read == STANDARD, f"{name} reads nothing of {sorted(STANDARD - read)}")
    streams = answer["streams"].values()
    for topic, (received, lost) in answer["streams"].items():
        expect(received > 1000 and lost < received, f"{name} gets {received} of {topic} and misses {lost}")  # a process that gets no processor loses much
    answers = answer["answers_ms"]
    expect(len(answers) == int(CHANGES), f"{name}: {len(answers)} of {CHANGES} changes are answered")
    median = statistics.median(answers or [float("inf")])
    expect(median < 20.0, f"{name}: a change is answered after {median:.1f} ms in the middle")
    losses = ", ".join(f"{lost} of {received + lost}" for received, lost in streams)
    return [name, f"{len(read)} of {len(STANDARD)}", losses, f"{median:.1f} ms", f"{max(answers or [float('inf')]):.1f} ms", way]


def table(rows):
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [HEAD, ["---"] * len(HEAD), *rows]) + "\n"


def samples_on_loopback_alone(rust):
    return ask([rust, DOMAIN, "3"])["samples"]


def main():
    voxtouch, cyclone, fast, python, rust = sys.argv[1:6]
    enter_own_network()
    if not pathlib.Path(rust).exists():
        print("ros2-client is not built, and left out: deploy/interop builds it where cargo and crates can be had")
        rust = None
    if rust:  # it hears multicast on cards that say they can, which loopback does not by itself
        ring = Ring(voxtouch)
        print(f"ros2-client on loopback alone: {samples_on_loopback_alone(rust)} samples in 3 s")
        run("ip", "link", "set", "lo", "multicast", "on")
        with_multicast = samples_on_loopback_alone(rust)
        print(f"ros2-client on loopback alone after `ip link set lo multicast on`: {with_multicast} samples in 3 s")
        expect(with_multicast > 1000, "with multicast on loopback ros2-client finds the ring")
        ring.close()
        run("ip", "link", "set", "lo", "multicast", "off")
    clients, other, ring, rows = Clients(voxtouch, cyclone, fast, python), OtherHost(), Ring(voxtouch, scene="cup_friction"), []
    for name, command, way in commands(clients, rust):
        rows.append(row_of(name, ask([*command, CHANGES]), way))
        print(" | ".join(rows[-1]), flush=True)
    ring.close()
    del other
    print(f"load {os.getloadavg()[0]:.1f}\n\n{table(rows)}")
    if len(sys.argv) > 6:
        pathlib.Path(sys.argv[6]).write_text(table(rows))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()

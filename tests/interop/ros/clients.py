"""Every available client, with its default settings, with one ring: standard topics, the loop's
topics at 1 kHz, changes of an effect.

usage: clients.py VOXTOUCH CYCLONE_CLIENT FAST_CLIENT|none PYTHON_WITH_CYCLONEDDS ROS2_CLIENT
       [TABLE]
Prints a table, and writes it to TABLE as Markdown. deploy/interop builds ROS2_CLIENT; without it
the test reports that. Lost samples and times depend on the machine: on busy processors a client of
ordinary priority stalls. Limits are therefore checked only if other programs used little processor
time; otherwise the figures are printed with that fraction. Exit status 77, with a sentence: this
machine allows no network namespaces.
"""

import os
import pathlib
import statistics
import sys

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[2] / "support")]

from processors import QUIET, Processors  # noqa: E402
from ros_tools import (
    DOMAIN,
    Clients,
    OtherHost,
    Ring,
    ask,
    enter_own_network,
    expect,
    failures,
)  # noqa: E402

SECONDS, CHANGES = "5", "50"
STANDARD = {
    "rt/tf",
    "rt/tf_static",
    "rt/haptic/pose",
    "rt/haptic/wrench",
    "rt/haptic/markers",
    "rt/diagnostics",
    "rt/parameter_events",
    "rt/rosout",
}
HEAD = [
    "client",
    "standard topics read",
    "DeviceState, ContactState, ForceCommand lost",
    "a change answered, median",
    "longest of 50",
    "asked by",
    "processors taken by others",
]
MOST_LOST, ANSWERED_MS = (
    0.01,
    20.0,
)  # of a client on a quiet machine: a fraction of each topic, and 19 of 20 changes


def commands(clients, rust):
    """Name, command and method of requests of each client with its default settings."""
    own = dict(clients.commands(SECONDS))
    yield "Cyclone DDS 0.10.2 (C)", own["Cyclone DDS 0.10, Humble"], "service"
    yield "Cyclone DDS 11 (Python)", own["Cyclone DDS 11, Humble"], "service"
    if "Fast DDS 2.9, Humble and Jazzy (SUBNET)" in own:
        yield "Fast DDS 2.9.1 (C++)", own["Fast DDS 2.9, Humble and Jazzy (SUBNET)"], "topic"
    if rust:
        yield "ros2-client 0.12.1 (Rust)", [rust, DOMAIN, SECONDS], "service"


def row_of(name, answer, variant, others):
    read = {topic for topic, count in answer["standard"].items() if count}
    expect(read == STANDARD, f"{name} reads nothing of {sorted(STANDARD - read)}")
    streams = answer["streams"].values()
    for topic, (received, lost) in answer["streams"].items():
        most = MOST_LOST * (received + lost) if others < QUIET else received
        expect(
            received > 1000 and lost <= most,
            (
                f"{name} gets {received} of {topic} and misses {lost}; others took"
                f" {100 * others:.0f} % of the processors"
            ),
        )
    answers = answer["answers_ms"]
    expect(
        len(answers) == int(CHANGES), f"{name}: {len(answers)} of {CHANGES} changes are answered"
    )
    median = statistics.median(answers or [float("inf")])
    expect(
        median < ANSWERED_MS, f"{name}: a change is answered after {median:.1f} ms in the middle"
    )
    late = sum(ms > ANSWERED_MS for ms in answers)
    expect(
        others >= QUIET or late <= len(answers) / 20,
        (
            f"{name}: {late} of {len(answers)} changes are answered after more than"
            f" {ANSWERED_MS:.0f} ms"
        ),
    )
    losses = ", ".join(f"{lost} of {received + lost}" for received, lost in streams)
    return [
        name,
        f"{len(read)} of {len(STANDARD)}",
        losses,
        f"{median:.1f} ms",
        f"{max(answers or [float('inf')]):.1f} ms",
        variant,
        f"{100 * others:.0f} %",
    ]


def table(rows):
    return (
        "\n".join("| " + " | ".join(cells) + " |" for cells in [HEAD, ["---"] * len(HEAD), *rows])
        + "\n"
    )


def own_gaps(summary):
    """A sample that the ring itself has not answered has no ContactState and no ForceCommand that a
    client could lose.
    """
    fraction = 1.0 - summary["limits"]["answered_ratio"]["value"]
    return (
        f"From its first answer on the ring itself left {100 * fraction:.2f} % of its samples"
        f" without"
        " one: their ContactState and ForceCommand were never written, and count as lost above.\n"
    )


def main():
    voxtouch, cyclone, fast, python, rust = sys.argv[1:6]
    enter_own_network()
    if not pathlib.Path(rust).exists():
        print(
            "ros2-client is not built, and left out: deploy/interop builds it where cargo and"
            " crates can be had"
        )
        rust = None
    if rust:  # it has no list of peers and receives multicast alone
        ring = Ring(voxtouch)
        samples = ask([rust, DOMAIN, "3"])["samples"]
        print(f"ros2-client on loopback alone: {samples} samples in 3 s")
        expect(
            samples > 1000, f"ros2-client finds a ring on loopback alone: {samples} samples in 3 s"
        )
        ring.close()
    clients, other, ring, rows = (
        Clients(voxtouch, cyclone, fast, python),
        OtherHost(),
        Ring(voxtouch, "--json", scene="cup_friction"),
        [],
    )
    for name, command, variant in commands(clients, rust):
        processors = Processors()
        answer = ask([*command, CHANGES])
        rows.append(row_of(name, answer, variant, processors.taken_by_others()))
        print(" | ".join(rows[-1]), flush=True)
    written = table(rows) + "\n" + own_gaps(ring.close())
    del other
    print(f"load {os.getloadavg()[0]:.1f}\n\n{written}")
    if len(sys.argv) > 6:
        pathlib.Path(sys.argv[6]).write_text(written)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()

"""A recorded run in numbers: which force was displayed and when, on one time axis; its figures, its
faults, its words. Draws nothing.
"""

import functools
import math
import re
import shlex

import numpy
from bag_data import Bag, BagError, constants, norm, vector

TOUCH_N = 1e-9  # smaller values count as no force
APART_S = 0.05  # samples of one fault closer than this form one stretch
MOST_STRETCHES = 6  # of one fault that are reported one by one

# Texts of flags for a stretch of samples. Normal states (capped, latched, saturated, ramping) are
# reported among the figures.
CONTACT_FAULTS = {
    "FLAG_REFUSED_SAMPLE": "device sample not usable; the last valid one is used",
    "FLAG_FAST": "the tool moved more than half a voxel per sample",
    "FLAG_TUNNELLING_SUSPECTED": "tunnelling suspected: the tool was too fast near the scene",
    "FLAG_NOT_CONVERGED": "virtual tool not converged within the frame",
    "FLAG_NOT_INITIALISED": "virtual tool not initialised: no force displayed",
}
COMMAND_FAULTS = {
    "STATUS_LATCHED_INPUT": "contact missing or not finite; the last valid one is used",
    "STATUS_CLAMPED": "contact force above the device's limit, clamped",
}
STATE_FAULTS = {"FLAG_POSE_LATCHED": "device pose invalid; the last valid one is used"}
# Counts of the device, ten times a second.
DEVICE_FAULTS = {
    "overruns": "periods skipped: the device loop was late",
    "deadline_misses": "deadlines missed: no command for three periods",
    "refused": "commands refused by the force guard",
    "clamped": "commands clamped by the force guard",
    "interruptions": "interruptions or losses of the device's force",
    "foreign_commands": "commands of another writer refused",
}
STATES = {0: "starting", 1: "ready", 2: "running", 3: "stopped", 4: "failed"}


def largest(values):
    """Of the numbers among them; None without any."""
    values = values[numpy.isfinite(values)]
    return float(values.max()) if len(values) else None


class Run:
    """`t`: seconds on the device's clock since the first recorded sample; a later session follows
    at the time at which it was recorded.
    """

    def __init__(self, path, rig="", progress=lambda fraction: None):
        self.bag = Bag(path, rig, progress=progress)
        self.name = self.bag.path.resolve().name
        self.state, self.contact, self.command, self.validation = (
            self.bag.tables[name]
            for name in ("device/state", "rendering/contact", "coupling/command", "validation")
        )
        self.place_sessions()
        self.t_state, self.t_contact, self.t_command, self.t_validation = (
            self.seconds(table)
            for table in (self.state, self.contact, self.command, self.validation)
        )
        self.description = self.last("device/description")
        self.plan, self.design = self.last("rendering/plan"), self.last("coupling/design")
        self.returned, self.contact_force = (
            vector(self.command["wrench"]["force"]),
            vector(self.contact["contact_wrench"]["force"]),
        )
        self.rendered, self.torque = (
            vector(self.contact["wrench"]["force"]),
            vector(self.command["wrench"]["torque"]),
        )
        self.depth_mm, self.gap_mm = (
            1e3 * self.contact["deepest_depth_m"],
            1e3 * self.validation["gap_m"],
        )
        self.read_statuses()

    # -------------------- time
    def place_sessions(self):
        """For each session its first stamp and its place on the axis. Samples of an unauthorised
        writer are excluded."""
        source, name = (
            (self.state, "device/state") if len(self.state) else (self.contact, "rendering/contact")
        )
        times = self.bag.times[name]
        if not len(source):
            raise BagError(
                f"{self.bag.path}: nothing to report: the recording has no sample of"
                f" /{self.bag.rig}/device/state and no contact. "
                + (
                    ""
                    if self.bag.unreadable
                    else "The ring was stopped before its first sample, or was not recorded. "
                )
                + " ".join(self.bag.notes)
            )
        ids, first = numpy.unique(source["session_id"], return_index=True)
        order = numpy.argsort(first)
        self.sessions = {
            int(ids[i]): (int(source["sample_time_ns"][first[i]]), int(times[first[i]] - times[0]))
            for i in order
        }
        for table in ("state", "contact", "command", "validation"):
            rows = getattr(self, table)
            known = numpy.isin(rows["session_id"], list(self.sessions))
            if not known.all():
                self.bag.notes.append(
                    f"{int((~known).sum())} messages ({table}) belong to no recorded session and "
                    f"are skipped."
                )
                setattr(self, table, rows[known])
                key = {
                    "state": "device/state",
                    "contact": "rendering/contact",
                    "command": "coupling/command",
                    "validation": "validation",
                }[table]
                self.bag.times[key] = self.bag.times[key][known]
        if len(self.sessions) > 1:
            self.bag.notes.append(f"The device began {len(self.sessions)} sessions.")

    def seconds(self, table):
        out = numpy.zeros(len(table))
        for session, (begin, offset) in self.sessions.items():
            of = table["session_id"] == session
            out[of] = (table["sample_time_ns"][of] - begin + offset) * 1e-9
        return out

    @functools.cached_property
    def clock(self):
        """When a sample was recorded [s since the first one], and its place on the axis."""
        times, t = (
            (self.bag.times["device/state"], self.t_state)
            if len(self.state)
            else (self.bag.times["rendering/contact"], self.t_contact)
        )
        return int(times[0]), (times - times[0]) * 1e-9, t

    def at(self, recorded_ns):
        """The place of a message without a sample's time: between the samples recorded around
        it."""
        begin, recorded_s, t = self.clock
        return float(numpy.interp((recorded_ns - begin) * 1e-9, recorded_s, t))

    @property
    def length_s(self):
        return max(
            [float(t[-1]) for t in (self.t_state, self.t_contact, self.t_command) if len(t)],
            default=0.0,
        )

    @functools.cached_property
    def lockstep(self):
        if len(self.state):
            return bool(self.state["flags"][0] & constants("DeviceState")["FLAG_LOCKSTEP"])
        return bool(self.description.get("lockstep"))

    # -------------------- words
    def last(self, name):
        every = self.bag.messages(name)
        return every[-1][2] if every else {}

    def read_statuses(self):
        """Every node's last status; their messages with times; the device's counts over time. Of
        the others only the heads are kept."""
        self.nodes, self.said, self.device_figures = {}, [], []
        latest, words, of_device = {}, {}, []
        for row, time, head in self.bag.messages("node_status", last="message"):
            key = head["node"], head["host"], head["pid"]
            latest[key] = row
            if head["node"] == "device":
                of_device.append(row)
            if words.get(key) != (head["state"], head["message"]):
                words[key] = head["state"], head["message"]
                self.said.append(
                    (self.at(time), head["node"], STATES.get(head["state"], "?"), head["message"])
                )
        for _, time, status in self.bag.messages(
            "node_status", rows=sorted({*of_device, *latest.values()})
        ):
            status["values"] = {pair["key"]: pair["value"] for pair in status["values"]}
            status["figures"] = {figure["name"]: figure["value"] for figure in status["figures"]}
            self.nodes[status["node"], status["host"], status["pid"]] = status
            if status["node"] == "device" and "samples" in status["figures"]:
                self.device_figures.append((self.at(time), status["figures"]))

    def node(self, name):
        """The last status of a node of this name; {} without one."""
        every = [status for (node, *_), status in self.nodes.items() if node == name]
        return every[-1] if every else {}

    def counted(self, node, figure):
        return self.node(node).get("figures", {}).get(figure)

    def word(self, node, key):
        return self.node(node).get("values", {}).get(key, "")

    @functools.cached_property
    def apart(self):
        """The object that touches is elsewhere than the tool that the hand moves: a body, or a
        virtual tool.
        """
        return bool(
            (
                norm(
                    vector(self.contact["tool_pose"]["position"])
                    - vector(self.contact["object_pose"]["position"])
                )
                > 1e-6
            ).any()
        )

    @property
    def scene(self):
        return self.plan.get("scene") or self.word("device", "scene") or "unknown"

    @property
    def device(self):
        return self.description.get("model") or self.word("device", "device") or "unknown"

    @property
    def limit_n(self):
        limit = self.description.get("max_force_n", math.nan)
        return limit if limit > 0 else math.nan

    def command_line(self):
        """(folder, words) of the `voxtouch up` that made the run, or None if the bag does not
        state it."""
        values = self.node("up").get("values", {})
        line = "".join(values[key] for key in sorted(values) if re.fullmatch(r"command_\d\d", key))
        try:
            return (values.get("folder", ""), shlex.split(line)) if line else None
        except ValueError:
            return None

    # -------------------- figures
    @functools.cached_property
    def answers(self):
        """Of each recorded command the row of the sample that it answers, or -1."""

        def keys(table):
            out = numpy.empty(len(table), [("session", "<u8"), ("number", "<u8")])
            out["session"], out["number"] = table["session_id"], table["sequence_number"]
            return out

        states = keys(self.state)
        order = numpy.argsort(states)
        if not len(states):
            return numpy.full(len(self.command), -1)
        found = numpy.minimum(
            numpy.searchsorted(states[order], keys(self.command)), len(states) - 1
        )
        return numpy.where(states[order[found]] == keys(self.command), order[found], -1)

    @functools.cached_property
    def latency_us(self):
        """(t, latency) as the logger saw it: from when it took a sample to when it took the command
        for it. Empty in lockstep.
        """
        if self.lockstep:
            return numpy.empty(0), numpy.empty(0)
        known = self.answers >= 0
        spent = (
            self.bag.times["coupling/command"][known]
            - self.bag.times["device/state"][self.answers[known]]
        )
        return self.t_command[known], spent / 1e3

    @functools.cached_property
    def figures(self):
        """Counts of this page over the recorded messages; None if they are missing."""
        force, pushed = norm(self.returned), norm(self.rendered)
        peak = (
            int(numpy.argmax(numpy.where(numpy.isfinite(force), force, -1.0)))
            if len(force)
            else None
        )
        most = largest(force)
        touching = pushed > TOUCH_N
        return {
            "length_s": self.length_s,
            "samples": len(self.state),
            "rate_hz": self.rate_hz,
            "answered": len(numpy.unique(self.answers[self.answers >= 0])),
            "max_force_n": most,
            "max_force_at_s": None if most is None else float(self.t_command[peak]),
            "ratio_to_limit": (
                most / self.limit_n if most is not None and math.isfinite(self.limit_n) else None
            ),
            "max_torque_nm": largest(norm(self.torque)),
            "max_contact_force_n": largest(norm(self.contact_force)),
            "contact_samples": int(touching.sum()),
            "contact_ratio": float(touching.mean()) if len(pushed) else None,
            "max_depth_mm": largest(self.depth_mm),
            "max_energy_j": largest(self.command["energy_j"]),
            "least_energy_j": (
                None
                if largest(-self.command["energy_j"]) is None
                else -largest(-self.command["energy_j"])
            ),
            "capped_samples": self.count(self.command["status"], "ForceCommand", "STATUS_CAPPED"),
            "bounded_samples": self.count(self.command["status"], "ForceCommand", "STATUS_BOUNDED"),
            "latched_samples": self.count(self.contact["flags"], "ContactState", "FLAG_LATCHED"),
            "saturated_samples": self.count(
                self.contact["flags"], "ContactState", "FLAG_SATURATED"
            ),
        }

    @property
    def rate_hz(self):
        """Samples a second of the clock by which the bag was recorded; a pause between two sessions
        is none of its periods.
        """
        recorded, periods, seconds = self.bag.times["device/state"], 0, 0.0
        for session in self.sessions:
            times = recorded[self.state["session_id"] == session]
            if len(times) > 1 and times[-1] > times[0]:
                periods, seconds = periods + len(times) - 1, seconds + (times[-1] - times[0]) * 1e-9
        return periods / seconds if seconds > 0.0 else None

    @staticmethod
    def count(flags, kind, name):
        return int(((flags & constants(kind)[name]) != 0).sum())

    # -------------------- faults
    def overruns(self):
        """(t, periods skipped since the status before), from the device's counts; a bag without
        them has none.
        """
        return self.increments("overruns")

    def increments(self, figure):
        """(t, by how much a count of the device had grown since the status before)."""
        out, before = [], 0.0
        for t, figures in self.device_figures:
            value = figures.get(figure, 0.0)
            if math.isfinite(value) and value > before:
                out.append((t, int(value - before)))
            before = value
        return out

    def faults(self):
        """(from [s], to [s], count, node, text) in order of time."""
        out = []
        for who, table, t, kind, sentences in (
            ("device", self.state["flags"], self.t_state, "DeviceState", STATE_FAULTS),
            ("rendering", self.contact["flags"], self.t_contact, "ContactState", CONTACT_FAULTS),
            ("coupling", self.command["status"], self.t_command, "ForceCommand", COMMAND_FAULTS),
        ):
            for flag, sentence in sentences.items():
                out += stretches(
                    t[(table & constants(kind)[flag]) != 0], who, "samples: " + sentence
                )
        for figure, sentence in DEVICE_FAULTS.items():
            grown = self.increments(figure)
            out += stretches(
                numpy.array([t for t, _ in grown]),
                "device",
                sentence,
                [n for _, n in grown],
                apart_s=0.15,
            )
        out += self.lost_samples()
        bad = self.t_validation[
            self.validation["verdict"] == constants("ValidationReport")["VERDICT_DISAGREE"]
        ]
        out += stretches(
            bad,
            "validator",
            "checked samples with a disagreement of contact and reference",
            apart_s=0.5,
        )
        over = min(
            [
                t
                for t, node, state, _ in self.said
                if node == "device" and state in ("stopped", "failed")
            ],
            default=math.inf,
        )
        for t, node, state, sentence in self.said:
            if state == "failed" or t < over and re.search(r"hang|is silent|lost|refus", sentence):
                out.append((t, t, None, node, f"{state}: {sentence}"))
        out += self.recording_faults()
        return sorted(out, key=lambda row: row[0])

    def lost_samples(self):
        """Samples between the first and the last answer that have none in the bag: not answered, or
        not recorded.
        """
        out = []
        for who, t, table in (
            ("rendering", self.t_contact, self.contact),
            ("coupling", self.t_command, self.command),
        ):
            if not len(table) or not len(self.state):
                continue
            unanswered = ~numpy.isin(self.state["sequence_number"], table["sequence_number"])
            unanswered &= (self.t_state > t[0]) & (self.t_state < t[-1])
            out += stretches(
                self.t_state[unanswered],
                who,
                "samples without a recorded command",
            )
        return out

    def recording_faults(self):
        recording, end = self.bag.recording(), self.length_s
        out = []
        if recording.get("closed") is False:
            out.append(
                (
                    end,
                    end,
                    None,
                    "logger",
                    ("the recording was not closed (logger killed); it is complete up to here"),
                )
            )
        for topic in recording.get("topics", []):
            for key, what in (
                ("dropped", "messages dropped: the disk was too slow"),
                ("lost", "messages lost: the disk refused them"),
            ):
                if topic.get(key):
                    out.append((0.0, end, int(topic[key]), "logger", f"{what} ({topic['name']})"))
        out += [(end, end, None, "logger", sentence) for sentence in recording.get("errors", [])]
        for (node, *_), status in self.nodes.items():
            if (
                status["state"] in (0, 1, 2)
                and status["message"] != "stopped"
                and node not in ("up", "logger")
            ):  # these two are there to the end
                out.append(
                    (
                        end,
                        end,
                        None,
                        node,
                        (
                            "has no final status: the recording ends in state"
                            f" {STATES[status['state']]} ({status['message']})"
                        ),
                    )
                )
        return out


def stretches(times, who, what, counts=None, apart_s=APART_S):
    """Times of a fault as rows of faults(): each stretch by itself, or of many the longest ones and
    one row for the rest.
    """
    if not len(times):
        return []
    counts = numpy.ones(len(times), int) if counts is None else numpy.array(counts)
    ends = numpy.flatnonzero(numpy.diff(times) > apart_s)
    begins, ends = numpy.r_[0, ends + 1], numpy.r_[ends, len(times) - 1]
    rows = [
        (float(times[a]), float(times[b]), int(counts[a : b + 1].sum()), who, what)
        for a, b in zip(begins, ends)
    ]
    if len(rows) <= MOST_STRETCHES:
        return rows
    rows.sort(key=lambda row: -row[2])
    rest = rows[MOST_STRETCHES:]
    return rows[:MOST_STRETCHES] + [
        (
            min(r[0] for r in rest),
            max(r[1] for r in rest),
            sum(r[2] for r in rest),
            who,
            f"{what} (in {len(rest)} further, shorter intervals)",
        )
    ]

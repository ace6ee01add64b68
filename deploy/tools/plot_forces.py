"""Forces over time: of a recorded run, of its replay next to it, and of runs side by side, over the
path of the hand too.
"""

import math
import pathlib
import sys

from plot_layout import *  # noqa: F403

FORCE_NOTE = (
    "Contact force: at the scene's stiffness, not displayed directly. Returned force: on the hand, "
    "after the coupling (capped to the certified stiffness, filtered, damped)"
)
BODY_NOTE = "; the contact acts on the body, and the hand receives the grip's force"
FLAG_CONSTRAINED = 512  # of ContactState: a contact holds the virtual tool away from the hand
VIRTUAL_TOOL_NOTE = (
    "Contact force: of the spring between hand and virtual tool, which stays outside the scene. "
    "Returned force: on the hand, after the coupling (filtered, damped)"
)


def read_run(bag, rig):
    """(contact, returned, gap): for every ContactState, ForceCommand and ValidationReport the
    device's time [s], magnitudes of force [N], depth, heights and gap [mm]. `contact` is the
    contact's force only, `all` includes effects. Throws BagError."""
    from bag_data import Bag, norm, vector

    tables = Bag(bag, rig, ["rendering/contact", "coupling/command", "validation"]).tables
    contact, command, judged = tables.values()
    return (
        {
            "t": contact["sample_time_ns"] * 1e-9,
            "all": norm(vector(contact["wrench"]["force"])),
            "contact": norm(vector(contact["contact_wrench"]["force"])),
            "depth": 1e3 * contact["deepest_depth_m"],
            "tool": 1e3 * contact["tool_pose"]["position"]["z"],
            "body": 1e3 * contact["object_pose"]["position"]["z"],
            "constrained": (contact["flags"] & FLAG_CONSTRAINED) != 0,
            "stretch": 1e3
            * norm(
                vector(contact["tool_pose"]["position"])
                - vector(contact["object_pose"]["position"])
            ),
        },
        {"t": command["sample_time_ns"] * 1e-9, "force": norm(vector(command["wrench"]["force"]))},
        {"t": judged["sample_time_ns"] * 1e-9, "gap": 1e3 * judged["gap_m"]},
    )


def draw_over_time(axis, table, name, end, **more):
    """A curve with a gap if nothing was recorded for more than 3.5 usual periods."""
    t = table["t"]
    usual = sorted(b - a for a, b in zip(t, t[1:]))
    axis.plot(
        *curve(t, table[name], 3.5 * usual[len(usual) // 2] if usual else math.inf, 0.0, end),
        **more,
    )


def forces_figure(bag, rig="haptic", begin=0.0, end=math.inf, note=""):
    from bag_data import BagError

    try:
        contact, returned, gap = read_run(bag, rig)
    except BagError as error:
        sys.exit(str(error))
    if not len(contact["t"]):
        sys.exit(f"{bag}: no messages on /{rig}/rendering/contact; check the recording and --rig.")
    start, length = contact["t"][0], contact["t"][-1] - contact["t"][0]

    def displayed(table):
        rows = (table["t"] - start >= begin) & (table["t"] - start <= end)
        return {
            name: values[rows] - (start if name == "t" else 0.0) for name, values in table.items()
        }

    contact, returned, gap = displayed(contact), displayed(returned), displayed(gap)
    if not len(contact["t"]):
        sys.exit(
            f"{bag}: no messages between --from {begin:g} and --to {end:g}; the recording lasts"
            f" {length:.3g} s."
        )
    virtual_tool = contact["constrained"].any()
    if virtual_tool:  # the tool itself is never deep: the hand is, behind it
        contact["depth"] = contact["stretch"]
    body = not virtual_tool and (abs(contact["tool"] - contact["body"]) > 1e-3).any()
    effects = (abs(contact["all"] - contact["contact"]) > 1e-9).any()
    largest, deepest, last = (
        max(returned["force"], default=0.0),
        max(contact["depth"]),
        contact["t"][-1] + 1e-3,
    )
    figure, axes = new_figure(
        (f"Returned force up to {largest:.2g} N" if largest > 1e-9 else "No returned force")
        + (
            ", no contact"
            if not deepest > 0
            else f", hand up to {deepest:.2g} mm from the virtual tool"
            if virtual_tool
            else f", depth of the {'body' if body else 'tool'} up to {deepest:.2g} mm"
        ),
        (note or f"Recording {pathlib.Path(bag).resolve().name}, rig {rig}")
        + "\n"
        + (VIRTUAL_TOOL_NOTE if virtual_tool else FORCE_NOTE)
        + (BODY_NOTE if body else "")
        + ".",
        3 if body else 2,
        sharex=True,
        height_ratios=(2, 1, 1) if body else (2, 1),
    )
    top, middle, bottom = axes[0][0], axes[1][0], axes[-1][0]
    bottom.set_xlim(contact["t"][0], last)
    draw_over_time(
        top,
        contact,
        "contact",
        last,
        color=CONTACT,
        lw=1.1,
        zorder=4,
        label="contact force\n(rendering)",
    )
    if effects:
        draw_over_time(
            top,
            contact,
            "all",
            last,
            color=PALE_GREEN,
            lw=4.5,
            zorder=2,
            label=f"{'grip force on the body' if body else 'contact and effects'}\n(rendering)",
        )
    draw_over_time(
        top,
        returned,
        "force",
        last,
        color=RETURNED,
        lw=2.0,
        zorder=3,
        label="returned force\n(coupling)",
    )
    top.set_ylabel("force magnitude [N]")
    top.set_ylim(0.0, robust_limit(contact["contact"], contact["all"], returned["force"]))
    for table, name, colour in (
        (contact, "contact", CONTACT),
        (contact, "all", GREEN),
        (returned, "force", RETURNED),
    ):
        if not mark_beyond(top, table["t"], table[name], top.get_ylim()[1], "N", colour):
            continue
        break  # one text names the place; the others leave the plane with it
    if body:
        draw_over_time(middle, contact, "tool", last, color=BLUE, lw=2.4, label="tool")
        draw_over_time(middle, contact, "body", last, color=ORANGE, lw=1.6, ls="--", label="body")
        middle.set_ylabel("height [mm]")
        legend_at_side(middle)
    draw_over_time(
        bottom,
        contact,
        "depth",
        last,
        color=PURPLE,
        lw=1.4,
        label=(
            "hand to virtual tool\n(rendering)"
            if virtual_tool
            else "depth of the deepest\npoint (rendering)"
        ),
    )
    draw_over_time(
        bottom,
        gap,
        "gap",
        last,
        color="black",
        lw=1.6,
        ls="--",
        label="gap, negative: overlap\n(validator)",
    )
    bottom.axhline(0.0, color="0.5", lw=0.8)
    deep = max(1.0, robust_limit(contact["depth"], gap["gap"][gap["gap"] < 0.0]))
    bottom.set_ylim(-1.25 * deep, 2.0 * deep)
    mark_beyond(bottom, contact["t"], contact["depth"], 2.0 * deep, "mm", PURPLE)
    bottom.set_ylabel("distance [mm]")
    bottom.set_xlabel("device time [s]")
    legend_at_side(top, labelspacing=0.8)
    legend_at_side(bottom, labelspacing=0.8)
    pushing = int((contact["contact"] > 1e-9).sum())
    return (
        figure,
        (
            f"shows {contact['t'][-1] - contact['t'][0]:.3f} s: {len(contact['t'])} samples,"
            f" {pushing} with contact, largest contact force {max(contact['contact']):.3f} N,"
            f" largest returned force {largest:.3f} N"
        ),
    )


# -------------------- replay
REPLAY_NOTE = (
    "The hand moves as recorded; it does not react to the replay. Rendered: contact and effects "
    "at the scene's stiffness. Returned: force on the hand after the coupling."
)


def replay_title(data):
    contact, command, returned = data["contact"], data["command"], data["forces"]["returned"]
    if not contact["differ"] and not command["differ"]:
        return (
            f"{'Both builds have' if data.get('other_build') else 'The replay has'}"
            f" bit-identical results"
            f" for {contact['compared']} contacts and {command['compared']} commands"
        )
    if data.get("other_build"):
        return (
            f"Largest returned force: {returned['replayed']['largest_n']:.2g} N in this build,"
            f" {returned['recorded']['largest_n']:.2g} N in the other build"
        )
    now, then = returned["replayed"]["largest_n"], returned["recorded"]["largest_n"]
    return (
        f"Largest returned force: {now:.2g} N in the replay"
        f"{'' if data['scene']['same'] else ' of another scene'}, {then:.2g} N in the recording"
    )


def replay_figure(data):
    curves, scene = data["curves"], data["scene"]
    end = max((c["t_s"][-1] for c in curves.values() if c["t_s"]), default=0.0) + 1e-3
    other = (
        ""
        if scene["same"]
        else f" through the scene {scene['replayed']['name']} ({scene['replayed']['hash']})"
    )
    note = (
        f"Recording {pathlib.Path(data['bag']).resolve().name}, scene"
        f" {scene['recorded']['name']} ({scene['recorded']['hash']}), {data['device']},"
        f" replayed{other}.\n"
    )
    names = (
        {"recorded": "other build", "replayed": "this build"}
        if data.get("other_build")
        else {"recorded": "recorded", "replayed": "replayed"}
    )
    figure, axes = new_figure(
        replay_title(data), note + REPLAY_NOTE, 3, sharex=True, height_ratios=(2, 2, 1)
    )
    for axis, name, what in (
        (axes[0][0], "rendered", "rendered force [N]"),
        (axes[1][0], "returned", "returned force [N]"),
    ):
        rows, returned = curves[name], data["forces"][name]
        table = {
            "t": rows["t_s"],
            "then": [math.nan if f is None else f for f in rows["recorded_n"]],
            "now": [math.nan if f is None else f for f in rows["replayed_n"]],
        }
        for key, label, more in (
            ("then", "recorded", {"color": PALE_GREEN, "lw": 3.2}),
            ("now", "replayed", {"color": CONTACT if name == "rendered" else RETURNED, "lw": 1.4}),
        ):
            of = returned[label]
            draw_over_time(
                axis,
                table,
                key,
                end,
                label=(
                    f"{names[label]}: at most {of['largest_n']:.3g} N,\nrms {of['rms_n']:.3g} N, in"
                    f" contact {100 * of['in_contact_ratio']:.0f} %"
                ),
                **more,
            )
        axis.set_ylabel(what)
        axis.set_ylim(0.0, robust_limit(table["then"], table["now"]))
        legend_at_side(axis, labelspacing=0.8)
        table["difference"] = [b - a for a, b in zip(table["then"], table["now"])]
        draw_over_time(
            axes[2][0],
            table,
            "difference",
            end,
            color=CONTACT if name == "rendered" else RETURNED,
            lw=1.2,
            label=name,
        )
    axes[2][0].set_ylabel("difference\n[N]")
    axes[2][0].set_xlabel("device time [s]")
    axes[2][0].set_xlim(0.0, end)
    legend_at_side(axes[2][0])
    return (
        figure,
        (
            f"shows {end:.3f} s: {data['contact']['differ']} of"
            f" {data['contact']['compared']} contacts and {data['command']['differ']} of"
            f" {data['command']['compared']} commands differ"
        ),
    )


# -------------------- runs side by side
COMPARISON_NOTE = (
    "Returned force: on the hand, after the coupling, within the certified stiffness. Depth of the "
    "hand: distance from the first contact of the first run, along its path to the deepest place."
)


def read_hand(bag, rig):
    """Of every ForceCommand the device's time [s], the size of the returned force [N] and the
    hand's place [m]. Throws BagError.
    """
    from bag_data import Bag, norm, vector

    contact, command = Bag(bag, rig, ["rendering/contact", "coupling/command"]).tables.values()
    at = {int(t): n for n, t in enumerate(contact["sample_time_ns"])}
    rows = [n for n, t in enumerate(command["sample_time_ns"]) if int(t) in at]
    times = command["sample_time_ns"][rows]
    if not len(times):
        return {"t": [], "force": [], "place": []}
    return {
        "t": (times - contact["sample_time_ns"][0]) * 1e-9,
        "force": norm(vector(command["wrench"]["force"]))[rows],
        "place": vector(contact["tool_pose"]["position"])[[at[int(t)] for t in times]],
    }


def comparison_figure(bags, rig="haptic"):
    from bag_data import BagError, norm

    try:
        runs = {pathlib.Path(bag).resolve().name: read_hand(bag, rig) for bag in bags}
    except BagError as error:
        sys.exit(str(error))
    most = {name: max(run["force"], default=0.0) for name, run in runs.items()}
    for name, force in most.items():
        if not force > 1e-9:
            sys.exit(f"{name}: no force returned to the hand, or no recorded run of rig {rig}.")
    first = next(iter(runs.values()))
    touch = first["place"][(first["force"] > 1e-9).argmax()]
    pushed = [
        run["place"][run["force"] > 0.5 * most[name]] for name, run in runs.items()
    ]  # the filter's remaining force on the way out does not count as entry
    deepest = max(
        (places[norm(places - touch).argmax()] for places in pushed),
        key=lambda place: norm(place - touch),
    )
    into = (deepest - touch) / max(norm(deepest - touch), 1e-12)
    figure, axes = new_figure(
        "Largest returned force: "
        + "; ".join(f"{name} {force:.2g} N" for name, force in most.items()),
        COMPARISON_NOTE,
        1,
        2,
        sharey=True,
    )
    over_time, over_depth = axes[0]
    for (name, run), colour in zip(runs.items(), (CONTACT, PURPLE, ORANGE, GREEN)):
        depth = 1e3 * (run["place"] - touch) @ into
        draw_over_time(over_time, run, "force", run["t"][-1] + 1e-3, color=colour, lw=1.8)
        over_depth.plot(depth, run["force"], color=colour, lw=1.8, label=name.replace("_", " "))
    over_time.set_ylabel("returned force [N]")
    over_time.set_xlabel("device time [s]")
    over_depth.set_xlabel("depth of the hand [mm]")
    over_depth.set_xlim(-0.5, 1e3 * norm(deepest - touch) * 1.05 + 0.1)
    over_time.set_ylim(0.0, 1.08 * max(most.values()))
    legend_at_side(over_depth, labelspacing=0.8)
    return figure, "shows " + "; ".join(
        f"{name}: at most {force:.3f} N" for name, force in most.items()
    )

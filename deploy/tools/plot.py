#!/usr/bin/python3
"""Draws what voxtouch measures; the ending of PICTURE says the format: .png, .svg or .pdf. Needs python3-matplotlib.

  %(prog)s accuracy RUN.json PICTURE    what accuracy costs in time: error of every contact model and voxel size over the time of a frame
  %(prog)s costs RUN.json PICTURE       the same on one page: force, direction error and noise over depth, and the time of a frame
  %(prog)s design RUN.json PICTURE      where a designed coupling is stable: contact stiffness over the filter's cut-off
  %(prog)s forces BAG PICTURE           contact force, returned force, depth and gap of a recorded run over time
  %(prog)s replay RUN.json PICTURE      forces of a recorded run and of its replay; voxtouch replay --plot calls it
  %(prog)s report BAG PAGE.html         all of a recorded run on one page; voxtouch report calls it
  %(prog)s check PICTURE                draws nothing: exit status 0 where a picture could be drawn and written there

Where the data come from (each command with --help says more):
  voxtouch accuracy deploy/scenes/cup.yaml --json > run.json         or at once: voxtouch accuracy deploy/scenes/cup.yaml --plot cup.png
  voxtouch design --scene deploy/scenes/cup.yaml --json > run.json   or at once: voxtouch design --scene deploy/scenes/cup.yaml --plot region.png
  voxtouch up deploy/scenes/cup.yaml --motion slide --duration 10 --lockstep --record bag

PNG is 1600 x 900 pixels. The same data give the same picture. Exit status 0 where the picture is written; else 1 and a sentence on stderr.
"""
import argparse
import json
import math
import os
import pathlib
import sys
import textwrap
import warnings

sys.dont_write_bytecode = True  # beside the program stand sources, and nothing else
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from plot_style import *  # noqa: E402, F403
from plot_style import NO_MATPLOTLIB  # noqa: E402
NOTE_WIDTH = 140  # characters
ENDINGS = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}  # metadata that would differ from run to run


# ------------------------------------------------------------------------------------------------------------- figures and files
def new_figure(title, note, rows=1, columns=1, **more):
    """A figure of 16 x 9 and its axes in rows; the title says what, the note under it the conditions: lines that are broken to fit."""
    note = "\n".join(textwrap.fill(line, NOTE_WIDTH) for line in note.splitlines())
    figure = Figure(figsize=(16, 9), dpi=100, layout="constrained")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08)
    axes = figure.subplots(rows, columns, squeeze=False, **more)
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
    axes[0][0].annotate(note, (0.01, 0.945), xycoords="figure fraction", va="top", color="0.25", fontsize=14).set_in_layout(False)
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.955 - 0.03 * note.count("\n")))
    return figure, axes


def legend_beside(axis, **more):
    """Right of the plane, where it covers no data."""
    return axis.legend(loc="upper left", bbox_to_anchor=(1.005, 1.0), borderaxespad=0.0, **more)


def decade_round(values):
    """Limits of a logarithmic axis round `values`, at least a decade apart."""
    low, high = min(values, default=1.0), max(values, default=1.0)
    spread = max(1.45, math.sqrt(10.0 * low / high))
    return low / spread, high * spread


# Where a text may stand beside its mark, best first: stairs of a front leave a mark to the right and upwards.
SIDES = ((1, 0.75), (-1, -0.75), (0, 1), (0, -1), (1, 0), (-1, 0), (-1, 0.75), (1, -0.75))


def overlap(a, b):
    """Area that two boxes share [pixels squared]."""
    return max(0.0, min(a.x1, b.x1) - max(a.x0, b.x0)) * max(0.0, min(a.y1, b.y1) - max(a.y0, b.y0))


def label_marks(axis, marks, ringed=(), radius=11.0):
    """Writes the text of each (x, y, text, colour) beside its mark, where it covers least of the marks, of the rings round the marks
    at `ringed`, and of the other texts. `radius`: of a mark [px]; a ring's is twice that."""
    axis.figure.draw_without_rendering()
    plane, taken, notes = axis.get_window_extent(), [], []
    for places, r in (([mark[:2] for mark in marks], radius), (ringed, 2.0 * radius)):
        taken += [Bbox.from_bounds(x - r, y - r, 2 * r, 2 * r) for x, y in map(axis.transData.transform, places)]
    for x, y, text, colour in marks:
        note = axis.annotate(text, (x, y), textcoords="offset points", xytext=(0, 0), ha="center", va="center", color=colour, fontsize=13,
                             path_effects=[patheffects.withStroke(linewidth=3, foreground="white")])
        note.set_in_layout(False)
        size = note.get_window_extent()

        def cost(offset):
            note.set_position(offset)
            box = note.get_window_extent()
            return box.width * box.height - overlap(box, plane) + sum(overlap(box, other) for other in taken)
        points = 72.0 / axis.figure.dpi
        note.set_position(min(((dx * points * (gap * radius + size.width / 2), dy * points * (gap * radius + size.height / 2))
                               for gap in (1.1, 2.1) for dx, dy in SIDES), key=cost))
        taken.append(note.get_window_extent())
        notes.append(note)
    return notes


def check_picture(picture, endings=tuple(ENDINGS)):
    """Ends with a sentence where a picture cannot be drawn, or not be written there."""
    if picture.suffix.lower() not in endings:
        sys.exit(f"{picture}: the name of a {'picture must end in .png, .svg or .pdf' if '.png' in endings else 'page must end in .html'}.")
    if NO_MATPLOTLIB:
        sys.exit(NO_MATPLOTLIB)
    if picture.is_dir() or not os.access(picture.parent, os.W_OK | os.X_OK):
        sys.exit(f"{picture} could not be written: is its folder there, is there room, and may you write there?")


def keep(file, write):
    """Under its own name only when it is whole."""
    part = file.with_name(file.name + ".part")
    try:
        write(part)
        os.replace(part, file)
    except OSError as error:
        sys.exit(f"{file} could not be written: {error.strerror}.")
    finally:  # broken off by Ctrl-C too
        part.unlink(missing_ok=True)


def save(figure, picture):
    ending = picture.suffix.lower()

    def write(part):
        figure.savefig(part, format=ending[1:], metadata=ENDINGS[ending])
        if ending == ".png":  # matplotlib writes an opaque fourth channel, an eighth of the file
            with Image.open(part) as image:
                image.convert("RGB").save(part, "PNG", optimize=True)
    keep(picture, write)


def read_json(file, verb):
    try:
        data = json.load(sys.stdin if file == "-" else open(file, encoding="utf-8"))
    except OSError as error:
        sys.exit(f"{file} could not be read: {error.strerror}.")
    except ValueError as error:
        sys.exit(f"{file} is not JSON ({error}); write it with: voxtouch {verb} ... --json > {file}")
    if not isinstance(data, dict) or {"accuracy": "rows", "design": "region", "replay": "curves"}[verb] not in data:
        sys.exit(f"{file} holds no result of `voxtouch {verb} --json`" +
                 ("; it says: " + " ".join(data["problems"]) if isinstance(data, dict) and data.get("problems") else "."))
    return data


# ---------------------------------------------------------------------------------------------------------------------- accuracy
LEAST_DIRECTION_DEG, LEAST_NOISE_PERCENT = 1e-3, 1e-2  # lowest that is shown; no hand feels a tenth of it


def size_word(row):
    edge, shell = row["voxel_m"] * 1e3, row["shell_voxel_m"] * 1e3
    return f"{edge:.4g}" if edge == shell else f"{edge:.4g}/{shell:.4g}"


def lines_of(rows):
    """Rows that one thin line joins: of the same model, weights and density of the shell."""
    out = {}
    for row in rows:
        out.setdefault((row["model"], row["weights"], round(row["voxel_m"] / row["shell_voxel_m"], 6)), []).append(row)
    return out


def draw_points(axis, rows, value, labelled):
    """The marks, and for `labelled` their legend and their sizes: filled where points weigh their area, hollow where each weighs one."""
    named, marks = set(), []
    for (model, weights, _), line in lines_of(rows).items():
        colour, mark = MODELS.get(model, (PURPLE, "v"))
        new = labelled and (model, weights) not in named
        named.add((model, weights))
        axis.plot([r["median_us"] for r in line], [value(r) for r in line], "-", marker=mark, color=colour, lw=1.2, ms=11, mew=2.2, zorder=3,
                  mfc=colour if weights == "area" else "white",
                  label=f"{model}, weight {weights}" if new else None)
        marks += [(r["median_us"], value(r), size_word(r), colour) for r in line]
    return marks


def choice_word(advice):
    return "knee" if advice["met"] is None and advice["knee"] is not None else {None: "best", True: "advised", False: "nearest"}[advice["met"]]


def accuracy_title(data, direction):
    if data["advice"]["row"] is None:
        return "What accuracy costs: no setting is to be advised"
    row = data["rows"][data["advice"]["row"]]
    return (f"What accuracy costs; {choice_word(data['advice'])}: {row['model']} at {size_word(row)} mm, "
            f"{direction(row):.2g} deg off in {row['median_us']:.2g} µs a frame")


def accuracy_figure(data):
    rows = [r for r in data["rows"] if r.get("median_us") is not None and r.get("direction_mean_deg") is not None]
    wish, advice, missing = data["wish"], data["advice"], len(data["rows"]) - len(rows)

    def direction(row):
        return max(row["direction_mean_deg"], LEAST_DIRECTION_DEG)

    def noise(row):
        return max(100.0 * (row["magnitude_noise"] or 0.0), LEAST_NOISE_PERCENT)
    shells = any(r["voxel_m"] != r["shell_voxel_m"] for r in rows)
    machine, load = data["conditions"], data["conditions"]["load_after"]
    processor = machine["processor"].replace("(R)", "").replace("(TM)", "").split(" CPU @")[0]
    note = (f"Scene {data['scene']}: {data['options']['contacts']} random contacts, {data['options']['depth_edges']:g} e deep, seed "
            f"{data['options']['seed']}{f'; {missing} settings not measured' if missing else ''}. Lower left is better. "
            "Shell points weigh one each, or their area. A missed contact is 180 deg off.\n"
            f"At the marks: voxel edge e{' / the shell' if shells else ''} [mm]. Time: one thread of {processor[:48]}"
            f"{'' if load is None else f', load average {load:.1f}'}")
    figure, axes = new_figure(accuracy_title(data, direction), note, 2, sharex=True, height_ratios=(2.3, 1))
    top, bottom = axes[0][0], axes[1][0]
    marks = draw_points(top, rows, direction, True)
    draw_points(bottom, rows, noise, False)
    log_axis(bottom.xaxis, *decade_round([r["median_us"] for r in rows] + ([wish["within_us"]] if wish["within_us"] else [])))
    log_axis(top.yaxis, *decade_round([direction(r) for r in rows] + ([wish["direction_deg"]] if wish["direction_deg"] else [])))
    log_axis(bottom.yaxis, *decade_round([noise(r) for r in rows] + ([100 * wish["noise"]] if wish["noise"] else [])))
    front = [data["rows"][i] for i in advice["front"]]
    if front:  # from the top edge down to the fastest, along what can be had for each time, to the right edge
        x, y = [r["median_us"] for r in front], [direction(r) for r in front]
        top.step([x[0]] + x + [top.get_xlim()[1]], [top.get_ylim()[1]] + y + [y[-1]], where="post", color="#222222", lw=1.8, zorder=2,
                 label="Pareto front: least\nerror within each time")
    if advice["row"] is not None:
        row = data["rows"][advice["row"]]
        top.plot([row["median_us"]], [direction(row)], "o", ms=23, mfc="none", mec=RED, mew=2.2, ls="none", zorder=4,
                 label=f"{choice_word(advice)}: {row['model']},\n{row['weights']}, {size_word(row)} mm")
    if wish["direction_deg"]:
        top.axhline(wish["direction_deg"], color=RED, ls="--", label=f"wanted: {wish['direction_deg']:.4g} deg")
    if wish["noise"]:
        bottom.axhline(100 * wish["noise"], color=RED, ls="--")
    if wish["within_us"]:
        top.axvline(wish["within_us"], color=RED, ls="--", label=f"wanted: within {wish['within_us']:.4g} µs")
    if not rows:
        top.text(0.5, 0.5, "nothing could be measured", transform=top.transAxes, ha="center")
    least = any(direction(r) <= LEAST_DIRECTION_DEG for r in rows)
    top.set_ylabel("direction error, mean [deg]" + (f"\nlowest: {LEAST_DIRECTION_DEG:g} or less" if least else ""))
    least = any(noise(r) <= LEAST_NOISE_PERCENT for r in rows)
    bottom.set_ylabel("noise, std / mean [%]" + (f"\nlowest: {LEAST_NOISE_PERCENT:g} or less" if least else ""))
    bottom.set_xlabel("CPU time of one frame, median [µs]")
    if top.get_legend_handles_labels()[0]:
        legend_beside(top, labelspacing=0.8)
    label_marks(top, marks, [] if advice["row"] is None else [(data["rows"][advice["row"]]["median_us"], direction(data["rows"][advice["row"]]))])
    return figure, f"shows the errors of {len(rows)} settings over their times"


# ------------------------------------------------------------------------------------------------- what accuracy costs, on one page
def page_rows(data):
    """At the scene's own voxels, one row a model: points that weigh their area, the shell as dense as the voxels."""
    out = {}
    for row in data["rows"]:
        own = math.isclose(row["voxel_m"], data["scene_voxel_m"]) and row["voxel_m"] == row["shell_voxel_m"] and row["weights"] == "area"
        if own and row.get("median_us") is not None and row["depths"]:
            out.setdefault(row["model"], row)
    return list(out.values())


def page_title(rows):
    if not rows:
        return "What accuracy costs: nothing was measured at the scene's own voxels"
    deepest = max(d["edges"] for r in rows for d in r["depths"])
    least, most = (choose(rows, key=lambda r: abs(math.log(max(r["depths"][-1]["force_ratio"], 1e-6)))) for choose in (max, min))
    share = {r["model"]: f"{100 * r['depths'][-1]['force_ratio']:.2g} %" for r in rows}
    title = f"{deepest:g} e deep, {most['model'].replace('_', ' ')} gives {share[most['model']]} of the true force"
    return title if least is most else f"{title}, {least['model'].replace('_', ' ')} {share[least['model']]}"


def page_figure(data):
    rows, edge = page_rows(data), 1e3 * data["scene_voxel_m"]
    judged = max((d["contacts"] + d["missed"] for r in rows for d in r["depths"]), default=0)
    processor = data["conditions"]["processor"].replace("(R)", "").replace("(TM)", "").split(" CPU @")[0]
    note = (f"Scene {data['scene']}, {judged} random contacts, pressed in slowly; points weigh their area; missed contacts are 180 deg off. Time: one thread of "
            f"{processor[:48]}, compare ratios.\nTruth: the law integrated over the exact tool; for the virtual tool the exact ball that is drawn to the hand.")
    figure, axes = new_figure(page_title(rows), note, 2, 2)
    force, direction, noise, cost = axes[0][0], axes[0][1], axes[1][0], axes[1][1]
    for n, row in enumerate(rows):
        colour, mark = MODELS.get(row["model"], (PURPLE, "v"))
        look = {"color": colour, "marker": mark, "ms": 9, "lw": 2.0, "zorder": 3}
        x = [d["edges"] for d in row["depths"]]
        force.plot(x, [d["force_ratio"] for d in row["depths"]], **look)
        direction.plot(x, [max(d["direction_mean_deg"], LEAST_DIRECTION_DEG) for d in row["depths"]], label=row["model"].replace("_", " "), **look)
        noise.plot(x, [max(100 * d["magnitude_noise"], LEAST_NOISE_PERCENT) for d in row["depths"]], **look)
        cost.plot([row["median_us"], row["worst_us"]], [n, n], "-", color=colour, lw=3, solid_capstyle="butt")
        cost.plot([row["median_us"]], [n], mark, color=colour, ms=12)
        cost.annotate(f"{row['median_us']:.2g}", (row["median_us"], n), textcoords="offset points", xytext=(0, 10), ha="center", fontsize=13, color=colour)
    force.axhline(1.0, color=INK, ls="--", lw=1.6, zorder=2)
    depths = sorted({d["edges"] for r in rows for d in r["depths"]}) or [0.5, 1.0]
    for axis in (force, direction, noise):
        log_axis(axis.xaxis, depths[0] / 1.15, depths[-1] * 1.15)
        axis.set_xticks(depths)
    force.set_ylim(0.0, 1.1 * max([1.2] + [d["force_ratio"] for r in rows for d in r["depths"]]))
    force.set_ylabel("force over the true one [1]")
    log_axis(direction.yaxis, *decade_round([max(d["direction_mean_deg"], LEAST_DIRECTION_DEG) for r in rows for d in r["depths"]]))
    direction.set_ylabel("direction error, mean [deg]")
    log_axis(noise.yaxis, *decade_round([max(100 * d["magnitude_noise"], LEAST_NOISE_PERCENT) for r in rows for d in r["depths"]]))
    noise.set_ylabel("noise, std / mean [%]")
    for axis in (force, direction, noise):
        axis.set_xlabel(f"depth [e]; 1 e = {edge:g} mm")
    log_axis(cost.xaxis, *decade_round([r[key] for r in rows for key in ("median_us", "worst_us")]))
    cost.set_yticks(range(len(rows)), [r["model"].replace("_", " ") for r in rows])
    cost.set_ylim(len(rows) - 0.4, -0.7)
    cost.set_xlabel("CPU time of one frame, median and up to the worst [µs]")
    if rows:
        legend_beside(direction)
    return figure, f"shows what accuracy costs with {len(rows)} models"


# ------------------------------------------------------------------------------------------------------------------------ design
LAWS = {"shaping_filter": "shaping filter", "spring_damper": "spring-damper", "direct": "direct force"}


def draw_region(axis, x, curves, low, high):
    """Two areas and their upper edges; `curves`: (values, colour, label). None: nothing makes it unstable; what is 0 lies under the plane."""
    for values, colour, label in curves:
        values = [min(high * 10 if k is None else k, high * 10) for k in values]
        axis.fill_between(x, low, values, color=colour, alpha=0.14, lw=0)
        axis.plot(x, values, color=colour, lw=2.5, label=label)


def design_figure(data):
    region, coupling, axis_design, paper = data["region"], data["coupling"], data["translation"], data["paper_recipe"]
    x, law, kind = region["cutoff_hz"], region.get("law"), coupling["kind"]
    undamped, limit = region["critical_undamped_n_per_m"], region["device_limit_n_per_m"]
    shown = axis_design["shown_stiffness"]
    lowest = min([shown or 100.0] + [k for k in undamped if k])
    low = 10.0 ** math.floor(math.log10(min(max(lowest, 0.01), 100.0)))
    high = 2.0 * max(limit or 0.0, axis_design["critical_stiffness"] or 0.0, 100.0)
    note = (f"{data['device']}; hand: {data['hand']}.\nWorst case of them{'' if law else f', damping ratio %.3g' % coupling['damping_ratio']}; injected damping "
            f"{axis_design['injected_damping']:.3g} Ns/m, velocity filter {axis_design['velocity_filter_hz']:.3g} Hz.")
    useful = f"are certified to be stable with a {LAWS.get(kind, kind)}" if data["status"] != "infeasible" else "hold, which is too little to be of use"
    figure, axes = new_figure(f"{shown:.4g} N/m at the hand {useful}" if shown else "No coupling holds here", note, 1, 2 if law else 1, sharey=True)
    axis = axes[0][0]
    log_axis(axis.xaxis, x[0], x[-1])
    log_axis(axis.yaxis, low, high)
    certified = f"certified below\n(gain margin {region['gain_margin']:.3g})"
    draw_region(axis, x, ((region["critical_n_per_m"], BLUE, "stable below"), (region["certified_n_per_m"], GREEN, certified)), low, high)
    if axis_design["injected_damping"] > 0:
        axis.plot(x, [min(k or 10 * high, 10 * high) if k != 0 else 0 for k in undamped], color=BLUE, lw=1.8, ls="--",
                  label="stable below,\nwithout injected damping")
    if any(k is None or k > low for k in region["passive_n_per_m"]):
        axis.plot(x, [10 * high if k is None else min(k, 10 * high) for k in region["passive_n_per_m"]], color=PURPLE, lw=1.8, ls="-.",
                  label="stable below with any hand\n(passivity rule), no\ninjected damping")
    if paper["stiffness_n_per_m"]:
        axis.plot([paper["cutoff_hz"]], [paper["stiffness_n_per_m"]], "s", ms=14, mfc="white", mec=RED, mew=2.5, ls="none", zorder=4,
                  label=f"paper: {paper['cutoff_hz']:g} Hz,\n{paper['stiffness_n_per_m']:.4g} N/m")
    place, word = (axis, f"designed: {coupling['cutoff_hz']:.3g} Hz") if not law else (axes[0][1], f"designed: {law['chosen']:.3g} {law['unit']}")
    if law:
        axis.set_title("a shaping filter with that damping: not chosen", loc="left")
        place.set_title(f"the law that was chosen: {LAWS.get(kind, kind)}", loc="left", fontweight="bold")
        log_axis(place.xaxis, law["x"][0], law["x"][-1])
        draw_region(place, law["x"], ((law["critical_n_per_m"], BLUE, None), (law["certified_n_per_m"], GREEN, None)), low, high)
        place.set_xlabel(f"{law['over']} [{law['unit']}]")
    if shown and (law["chosen"] > 0 if law else kind == "shaping_filter"):
        place.plot([law["chosen"] if law else coupling["cutoff_hz"]], [shown], "o", ms=14, color="#111111", ls="none", zorder=4, label=f"{word},\n{shown:.4g} N/m")
    for one in axes[0]:
        if limit:
            one.axhline(limit, color=GREY, lw=1.8, ls=":", label=f"most that the device\ncan show: {limit:.4g} N/m" if one is axis else None)
    axis.set_xlabel("cut-off of the shaping filter, w0 / 2π [Hz]")
    axis.set_ylabel("contact stiffness at the hand [N/m]")
    handles, labels = (sum(pair, []) for pair in zip(*(one.get_legend_handles_labels() for one in axes[0])))
    axes[0][-1].legend(handles, labels, loc="upper left", bbox_to_anchor=(1.005, 1.0), borderaxespad=0.0, labelspacing=0.9)
    return figure, f"shows where the loop is stable with a {LAWS.get(kind, kind)}"


# ------------------------------------------------------------------------------------------------------------------------ forces
FELT_NOTE = ("Contact: what the voxels give at the scene's own stiffness, felt by nobody as it is. Returned: what the coupling made of it for the hand; capped to "
             "the stiffness that is certified, filtered, damped, so later and usually smaller")
BODY_NOTE = "; the contact is the body's here, and the hand feels its grip on it"


def read_run(bag, rig):
    """(contact, returned, gap): of every ContactState, ForceCommand and ValidationReport the device's time [s], sizes of force [N], depth, heights
    and gap [mm]; `contact` is the contact's force alone, `all` with what effects add. Throws BagError."""
    from bag_data import Bag, norm, vector
    tables = Bag(bag, rig, ["rendering/contact", "coupling/command", "validation"]).tables
    contact, command, judged = tables.values()
    return ({"t": contact["sample_time_ns"] * 1e-9, "all": norm(vector(contact["wrench"]["force"])), "contact": norm(vector(contact["contact_wrench"]["force"])),
             "depth": 1e3 * contact["deepest_depth_m"], "tool": 1e3 * contact["tool_pose"]["position"]["z"], "body": 1e3 * contact["object_pose"]["position"]["z"]},
            {"t": command["sample_time_ns"] * 1e-9, "force": norm(vector(command["wrench"]["force"]))},
            {"t": judged["sample_time_ns"] * 1e-9, "gap": 1e3 * judged["gap_m"]})


def draw_over_time(axis, table, name, end, **more):
    """A curve that leaves a gap where nothing was recorded for longer than three and a half times as usual."""
    t = table["t"]
    usual = sorted(b - a for a, b in zip(t, t[1:]))
    axis.plot(*curve(t, table[name], 3.5 * usual[len(usual) // 2] if usual else math.inf, 0.0, end), **more)


def forces_figure(bag, rig="haptic", begin=0.0, end=math.inf, note=""):
    from bag_data import BagError
    try:
        contact, returned, gap = read_run(bag, rig)
    except BagError as error:
        sys.exit(str(error))
    if not len(contact["t"]):
        sys.exit(f"{bag}: no messages on /{rig}/rendering/contact; is this a voxtouch bag, and --rig right?")
    start, length = contact["t"][0], contact["t"][-1] - contact["t"][0]

    def shown(table):
        rows = (table["t"] - start >= begin) & (table["t"] - start <= end)
        return {name: values[rows] - (start if name == "t" else 0.0) for name, values in table.items()}
    contact, returned, gap = shown(contact), shown(returned), shown(gap)
    if not len(contact["t"]):
        sys.exit(f"{bag}: nothing between --from {begin:g} and --to {end:g}; the recording lasts {length:.3g} s.")
    body = (abs(contact["tool"] - contact["body"]) > 1e-3).any()
    effects = (abs(contact["all"] - contact["contact"]) > 1e-9).any()
    felt, deepest, last = max(returned["force"], default=0.0), max(contact["depth"]), contact["t"][-1] + 1e-3
    figure, axes = new_figure(f"{f'At most {felt:.2g} N' if felt > 1e-9 else 'No force'} came back to the hand; " +
                              (f"{'the body' if body else 'the tool'} was at most {deepest:.2g} mm deep" if deepest > 0 else "nothing was touched"),
                              (note or f"Bag {pathlib.Path(bag).resolve().name}, rig {rig}") + "\n" + FELT_NOTE + (BODY_NOTE if body else "") + ".",
                              3 if body else 2, sharex=True, height_ratios=(2, 1, 1) if body else (2, 1))
    top, middle, bottom = axes[0][0], axes[1][0], axes[-1][0]
    bottom.set_xlim(contact["t"][0], last)
    draw_over_time(top, contact, "contact", last, color=CONTACT, lw=1.1, zorder=4, label="of the contact\n(rendering)")
    if effects:
        draw_over_time(top, contact, "all", last, color=PALE_GREEN, lw=4.5, zorder=2,
                       label="grip on the body\n(rendering)" if body else "contact and effects\n(rendering)")
    draw_over_time(top, returned, "force", last, color=RETURNED, lw=2.0, zorder=3, label="returned to the hand\n(coupling)")
    top.set_ylabel("size of the force [N]")
    top.set_ylim(0.0, robust_limit(contact["contact"], contact["all"], returned["force"]))
    for table, name, colour in ((contact, "contact", CONTACT), (contact, "all", GREEN), (returned, "force", RETURNED)):
        if not mark_beyond(top, table["t"], table[name], top.get_ylim()[1], "N", colour):
            continue
        break  # one text tells of the place; the others leave the plane with it
    if body:
        draw_over_time(middle, contact, "tool", last, color=BLUE, lw=2.4, label="tool")
        draw_over_time(middle, contact, "body", last, color=ORANGE, lw=1.6, ls="--", label="body")
        middle.set_ylabel("height [mm]")
        legend_beside(middle)
    draw_over_time(bottom, contact, "depth", last, color=PURPLE, lw=1.4, label="depth of the deepest\npoint (rendering)")
    draw_over_time(bottom, gap, "gap", last, color="black", lw=1.6, ls="--", label="gap, < 0: overlap\n(validator); in free\nair above the plane")
    bottom.axhline(0.0, color="0.5", lw=0.8)
    deep = max(1.0, robust_limit(contact["depth"], gap["gap"][gap["gap"] < 0.0]))
    bottom.set_ylim(-1.25 * deep, 2.0 * deep)
    mark_beyond(bottom, contact["t"], contact["depth"], 2.0 * deep, "mm", PURPLE)
    bottom.set_ylabel("distance [mm]")
    bottom.set_xlabel("time on the device's clock [s]")
    legend_beside(top, labelspacing=0.8)
    legend_beside(bottom, labelspacing=0.8)
    pushing = int((contact["contact"] > 1e-9).sum())
    return figure, (f"shows {contact['t'][-1] - contact['t'][0]:.3f} s: {len(contact['t'])} samples, {pushing} with contact, "
                    f"largest contact force {max(contact['contact']):.3f} N, largest returned force {felt:.3f} N")


# ------------------------------------------------------------------------------------------------------------------------ replay
REPLAY_NOTE = ("The recorded hand, which does not feel what is replayed: it moves as it did. Rendered: contact and effects at the scene's own stiffness. "
               "Returned: what the coupling makes of it for the hand.")


def replay_title(data):
    contact, command, felt = data["contact"], data["command"], data["felt"]["returned"]
    if not contact["differ"] and not command["differ"]:
        return f"The replay of {contact['compared']} contacts and {command['compared']} commands gives the same bits"
    now, then = felt["replayed"]["largest_n"], felt["recorded"]["largest_n"]
    return (f"{'Another scene returns' if not data['scene']['same'] else 'Replayed,'} at most {now:.2g} N to the hand{'' if not data['scene']['same'] else ' come back'} "
            f"instead of {then:.2g} N")


def replay_figure(data):
    curves, scene = data["curves"], data["scene"]
    end = max((c["t_s"][-1] for c in curves.values() if c["t_s"]), default=0.0) + 1e-3
    other = "" if scene["same"] else f" through the scene {scene['replayed']['name']} ({scene['replayed']['hash']})"
    note = f"Bag {pathlib.Path(data['bag']).resolve().name}, scene {scene['recorded']['name']} ({scene['recorded']['hash']}), {data['device']}, replayed{other}.\n"
    figure, axes = new_figure(replay_title(data), note + REPLAY_NOTE, 3, sharex=True, height_ratios=(2, 2, 1))
    for axis, name, what in ((axes[0][0], "rendered", "rendered [N]"), (axes[1][0], "returned", "returned [N]")):
        rows, felt = curves[name], data["felt"][name]
        table = {"t": rows["t_s"], "then": [math.nan if f is None else f for f in rows["recorded_n"]], "now": [math.nan if f is None else f for f in rows["replayed_n"]]}
        for key, label, more in (("then", "recorded", {"color": PALE_GREEN, "lw": 3.2}), ("now", "replayed", {"color": CONTACT if name == "rendered" else RETURNED, "lw": 1.4})):
            of = felt[label]
            draw_over_time(axis, table, key, end, label=f"{label}: at most {of['largest_n']:.3g} N,\nrms {of['rms_n']:.3g} N, in contact {100 * of['in_contact_share']:.0f} %", **more)
        axis.set_ylabel(what)
        axis.set_ylim(0.0, robust_limit(table["then"], table["now"]))
        legend_beside(axis, labelspacing=0.8)
        table["difference"] = [b - a for a, b in zip(table["then"], table["now"])]
        draw_over_time(axes[2][0], table, "difference", end, color=CONTACT if name == "rendered" else RETURNED, lw=1.2, label=name)
    axes[2][0].set_ylabel("difference\n[N]")
    axes[2][0].set_xlabel("time on the device's clock [s]")
    axes[2][0].set_xlim(0.0, end)
    legend_beside(axes[2][0])
    return figure, f"shows {end:.3f} s: {data['contact']['differ']} of {data['contact']['compared']} contacts and {data['command']['differ']} of {data['command']['compared']} commands differ"


# ------------------------------------------------------------------------------------------------------------------------ report
def tell_progress(share):
    """For who started this and waits: a line that is no part of what is said in the end."""
    print(f"progress {100.0 * share:.0f}", file=sys.stderr, flush=True)


def write_report(bag, page, beside=None, rig="", progress=lambda share: None):
    """Writes a run's page; says what it holds. Of what goes wrong a sentence, whatever stands in the bag."""
    progress(0.0)
    import run_page
    from bag_data import BagError
    from run_data import Run
    bags = [bag] + ([beside] if beside else [])
    try:
        runs = [Run(one, rig, lambda share, done=i: progress(0.4 * (done + share) / len(bags))) for i, one in enumerate(bags)]
        text = run_page.page(runs, lambda share: progress(0.4 + 0.6 * share))
    except BagError as error:
        sys.exit(str(error))
    except Exception as error:  # a bag may hold anything
        sys.exit(f"{' or '.join(map(str, bags))} holds what this report was not made for ({type(error).__name__}: {error}).")
    keep(page, lambda part: part.write_text(text, encoding="utf-8", errors="replace"))
    return f"shows {' beside '.join(run.name for run in runs)}: {max(run.length_s for run in runs):.3f} s"


# ----------------------------------------------------------------------------------------------------------------------- command
def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    def command(name, data, what):
        one = commands.add_parser(name, help=what, description=what)
        if data:
            one.add_argument("data", metavar=data[0], help=data[1])
        one.add_argument("picture", metavar="PICTURE", type=pathlib.Path, help="file to write; ends in .png, .svg or .pdf")
        return one
    for verb in ("accuracy", "costs", "design", "replay"):
        printed = f"what `voxtouch {'accuracy' if verb == 'costs' else verb} ... --json` printed" if verb != "replay" else "what `voxtouch replay ... --plot` gives to this tool"
        command(verb, ("RUN.json", printed + "; - reads standard input"), "draws on one page what voxtouch accuracy found" if verb == "costs" else f"draws a result of voxtouch {verb}")
    forces = command("forces", ("BAG", "folder of the bag, which `voxtouch up ... --record BAG` writes"), "draws the forces of a recorded run")
    forces.add_argument("--rig", default="haptic", help="rig name (default: haptic)")
    forces.add_argument("--from", dest="begin", type=float, default=0.0, metavar="S", help="first second shown; 0 is the first contact message")
    forces.add_argument("--to", dest="end", type=float, default=math.inf, metavar="S", help="last second shown")
    forces.add_argument("--note", default="", help="the conditions, under the title; default: the bag's name")
    report = commands.add_parser("report", help="writes the page of a recorded run", description="writes the page of a recorded run")
    report.add_argument("data", metavar="BAG", help="folder of the bag")
    report.add_argument("picture", metavar="PAGE.html", type=pathlib.Path, help="file to write")
    report.add_argument("--beside", metavar="BAG", help="a second run, which stands beside the first")
    report.add_argument("--rig", default="", help="rig name (default: the one that the bag holds)")
    report.add_argument("--progress", action="store_true", help="says on stderr how far it is")
    command("check", None, "draws nothing; says what is missing, if anything")
    a = parser.parse_args(None if arguments is None else [str(word) for word in arguments])
    warnings.simplefilter("ignore")  # what is said goes to a user, who can do nothing about matplotlib's
    check_picture(a.picture, (".html",) if a.command == "report" else tuple(ENDINGS))
    if a.command == "report":
        return print(f"{a.picture} {write_report(a.data, a.picture, a.beside, a.rig, tell_progress if a.progress else lambda share: None)}")
    if a.command == "check":
        return
    with matplotlib.rc_context(STYLE):
        if a.command == "forces":
            figure, shows = forces_figure(a.data, a.rig, a.begin, a.end, a.note)
        else:
            data = read_json(a.data, "accuracy" if a.command == "costs" else a.command)
            try:
                figure, shows = {"accuracy": accuracy_figure, "costs": page_figure, "design": design_figure, "replay": replay_figure}[a.command](data)
            except (KeyError, TypeError) as error:
                sys.exit(f"{a.data} is not as this version of `voxtouch {a.command} --json` prints it: {type(error).__name__} {error}.")
        save(figure, a.picture)
    print(f"{a.picture} {shows}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("stopped before the picture was drawn")
    except ModuleNotFoundError as error:
        sys.exit(f"{pathlib.Path(__file__).resolve()} has to stand in voxtouch's own tree, with what it is made of: {error}.")

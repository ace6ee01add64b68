"""The report of a run as one HTML page that loads nothing: words, tables, and the pictures of
run_pictures.py.
"""

import html
import json
import math
import shlex

import run_pictures
from bag_files import losses
from plot_style import STRETCHES
from run_data import STATES

CSS = """
:root { color-scheme: light; --ground: #f3f5f7; --panel: #fff; --line: #d4dae0; --grid: #e3e6ea; --ink: #17202a; --quiet: #51606e; --returned: #b83a00;
  --contact: #0068a8; --y: #a85400; --z: #00714f; --depth: #7a3e86; --bad: #b3261e; --good: #00714f; --link: #0b57d0;
  --font: "DejaVu Sans", Verdana, system-ui, sans-serif; }
@media (prefers-color-scheme: dark) { :root { color-scheme: dark; --ground: #12161b; --panel: #1b2128; --line: #343d47; --grid: #2d353e; --ink: #e8edf2;
  --quiet: #a3b0bd; --returned: #ff8a4c; --contact: #56b4e9; --y: #e69f00; --z: #2fc79a; --depth: #d79ac0; --bad: #ff8a80; --good: #2fc79a; --link: #8ab4f8; } }
@media print { section, header { break-inside: avoid; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1240px; padding: 20px; background: var(--ground); color: var(--ink); font: 15px/1.5 var(--font); }
h1 { font-size: 26px; margin: 0 0 4px; overflow-wrap: anywhere; } h2 { font-size: 19px; margin: 0 0 8px; } h3 { font-size: 15px; margin: 14px 0 4px; }
p { margin: 0 0 8px; } ul { margin: 0 0 8px; padding-left: 22px; } .quiet, figcaption { color: var(--quiet); font-size: 14px; }
header, section { background: var(--panel); border: 1px solid var(--line); border-radius: 8px; padding: 16px 18px; margin: 0 0 14px; }
figure { margin: 0 0 10px; } svg { display: block; width: 100%; height: auto; } figcaption { margin-top: 6px; }
table { border-collapse: collapse; width: 100%; } th, td { text-align: left; vertical-align: top; padding: 4px 12px 4px 0; border-bottom: 1px solid var(--line);
  overflow-wrap: break-word; } th { font-weight: 600; } td.n, th.n { text-align: right; } td.n { font-variant-numeric: tabular-nums; white-space: nowrap; }
.wide { overflow-x: auto; } .bad { color: var(--bad); } .good { color: var(--good); }
pre { background: var(--ground); border: 1px solid var(--line); border-radius: 6px; padding: 10px; white-space: pre-wrap; overflow-wrap: anywhere; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(max(170px, 22%), 1fr)); gap: 10px; margin: 12px 0 0; }
.tiles div { border: 1px solid var(--line); border-radius: 6px; padding: 8px 10px; } .tiles dt { font-size: 13px; color: var(--quiet); }
.tiles dd { margin: 0; font-size: 21px; font-weight: 600; } .tiles dd small { font-size: 13px; font-weight: 400; color: var(--quiet); display: block; }
.columns { display: grid; grid-template-columns: repeat(auto-fit, minmax(420px, 1fr)); gap: 18px; }
summary { cursor: pointer; color: var(--link); } a { color: var(--link); }
"""


def esc(text):
    return html.escape(str(text), quote=True)


def number(value, unit="", digits=3):
    """A figure for readers; a dash without one."""
    if value is None or not math.isfinite(value):
        return "–" if value is None or math.isnan(value) else "no limit"
    text = (
        f"{value:,.0f}".replace(",", " ")
        if abs(value) >= 1000 or isinstance(value, int)
        else f"{value:.{digits}g}"
    )
    return f"{text}\u00a0{unit}" if unit else text


def percent(fraction, digits=3):
    return (
        "–"
        if fraction is None or not math.isfinite(fraction)
        else f"{100.0 * fraction:.{digits}g} %"
    )


def table(head, rows, numeric=()):
    def row(tag, words):
        scope = ' scope="col"' if tag == "th" else ""
        return (
            "<tr>"
            + "".join(
                f"<{tag}{scope}{' class=n' if i in numeric else ''}>{word}</{tag}>"
                for i, word in enumerate(words)
            )
            + "</tr>"
        )

    body = "".join(row("td", words) for words in rows)
    return (
        f'<div class="wide"><table><thead>{row("th", head)}</thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def listed(sentences):
    return "<ul>" + "".join(f"<li>{esc(s)}</li>" for s in sentences) + "</ul>" if sentences else ""


def section(title, *parts):
    return f"<section><h2>{title}</h2>{''.join(parts)}</section>"


def columns(runs, part):
    """The same of each run; of two in two columns under their names."""
    if len(runs) == 1:
        return part(runs[0])
    return (
        '<div class="columns">'
        + "".join(f"<div><h3>{esc(run.name)}</h3>{part(run)}</div>" for run in runs)
        + "</div>"
    )


# -------------------- sentences
def kind_of_run(run):
    simulated = run.description.get("simulated")
    hand = (
        "moved by a simulated hand"
        if simulated
        else "gripped by a person"
        if run.description
        else "without a recorded description"
    )
    return (
        f"Scene <b>{esc(run.scene)}</b> on device <b>{esc(run.device)}</b>, {hand};"
        f" {'lockstep: simulated time' if run.lockstep else 'real time'}; {run.length_s:.3g} s"
        f" recorded of rig {esc(run.bag.rig)}."
    )


def verdict(run):
    """Whether the run passed, and why not."""
    summary, lost = run.bag.summary(), losses(run.bag.path) + run.bag.unreadable
    ratios = [
        name
        for name, one in summary.get("limits", {}).items()
        if one.get("unit") == "1" and "at_least" in one and (one["value"] or 0) > 1.05
    ]
    lost += [f"{name} is above 1: its counts are inconsistent." for name in ratios]
    if lost:
        return (
            "<p class=bad><b>FAILED:</b></p>"
            f"{listed(lost + summary.get('problems', []))}{listed(summary.get('notes', []))}"
        )
    if not summary:
        return (
            "<p><b>No verdict.</b> The recording has no verdict of <code>voxtouch up</code>: the "
            "run was killed, is of an older version, or its nodes were started one by one.</p>"
        )
    if summary.get("ok") is True and not summary["problems"]:
        return (
            f"<p class=good><b>PASSED: all {len(summary['limits'])} limits were"
            f" met.</b></p>{listed(summary['notes'])}"
        )
    return f"<p class=bad><b>FAILED:</b></p>{listed(summary['problems'])}{listed(summary['notes'])}"


def limit_rows(run):
    limits = run.bag.summary().get("limits", {})
    if not limits:
        return "<p>The recording has no verdict.</p>"

    def bound(one):
        side = "at_most" if "at_most" in one else "at_least"
        return side.replace("_", " ") + (
            " no limit" if one.get(side) is None else f" {one[side]:.4g}"
        )

    return table(
        ["figure", "was", "limit", "unit", "verdict"],
        [
            [
                esc(name),
                number(one.get("value"), digits=4),
                bound(one),
                "1" if one.get("unit") == "1" else esc(one.get("unit", "")),
                "met" if one.get("met") else "<span class=bad>not met</span>",
            ]
            for name, one in limits.items()
        ],
        numeric=(1,),
    )


def tiles(run):
    f = run.figures
    limit = f" of {run.limit_n:.3g} N" if math.isfinite(run.limit_n) else ""
    p50, p99 = run.counted("device", "latency_p50_us"), run.counted("device", "latency_p99_us")
    checked, bad = run.counted("validator", "checked"), run.counted("validator", "disagree")
    rows = [
        (
            "Largest force returned",
            number(f["max_force_n"], "N"),
            (
                "no command recorded"
                if f["max_force_n"] is None
                else (f"{percent(f['ratio_to_limit'])}{limit}, " if limit else "")
                + f"at {f['max_force_at_s']:.2f}\u00a0s"
            ),
        ),
        (
            "With a force",
            percent(f["contact_ratio"]),
            f"{number(f['contact_samples'])} samples, of contact or effects",
        ),
        (
            "Deepest",
            number(f["max_depth_mm"] if f["contact_samples"] else None, "mm"),
            "of a shell point (rendering)",
        ),
        (
            "Samples",
            number(f["samples"]),
            "rate unknown" if f["rate_hz"] is None else f"at {f['rate_hz']:.1f}\u00a0Hz",
        ),
        (
            "Answered",
            percent(f["answered"] / f["samples"], 4) if f["samples"] else "–",
            f"{number(f['answered'])} commands recorded",
        ),
        (
            "Latency, median",
            "–" if run.lockstep else number(p50, "µs"),
            (
                "not measured in lockstep"
                if run.lockstep
                else (
                    f"p99 {number(p99, 'µs')} (device)"
                    if p99 is not None
                    else "not reported by the device"
                )
            ),
        ),
        ("Periods skipped", number(run.counted("device", "overruns")), "reported by the device"),
        (
            "Validator",
            "–" if checked is None else f"{number(bad)} disagree" if bad else "agrees",
            "–" if checked is None else f"{number(checked)} samples checked",
        ),
    ]
    return (
        '<dl class="tiles">'
        + "".join(
            f"<div><dt>{esc(a)}</dt><dd>{esc(b)} <small>{esc(c)}</small></dd></div>"
            for a, b, c in rows
        )
        + "</dl>"
    )


def repeat(run):
    """The command to repeat the run, and what it does not reproduce."""
    known = run.command_line()
    if known is None:
        return (
            f"<p>The recording has no command line (older version, or nodes started one by one). "
            f"Its scene is"
            f" {esc(run.word('rendering', 'scene_file') or run.scene)}, its device"
            f" {esc(run.device)}.</p>"
        )
    folder, words = known
    kept, skip = [], False
    for word in words:  # the bag's folder exists and would be refused
        if skip or word.startswith("--record="):
            skip = False
        elif word == "--record":
            skip = True
        else:
            kept.append(word)
    changes = sum(
        answer["result"] == 2 for _, _, answer in run.bag.messages("rendering/changed")
    )  # 2: done
    text = (
        "<pre>"
        + esc((f"cd {shlex.quote(folder)} && " if folder else "") + shlex.join(kept))
        + "</pre>"
    )
    text += "<p>" + (
        "In lockstep the same program gives bit-identical results. "
        if run.lockstep
        else (
            "In real time the motion is the same; times differ from run to run. "
            if run.description.get("simulated")
            else "The device was moved by a person: the motion is not repeatable. "
        )
    )
    text += f"{changes} changes were made during the run; repeat them. " if changes else ""
    text += (
        "As typed, without <code>--record</code> (its folder exists). "
        if len(kept) < len(words)
        else "As typed. "
    )
    files = run.word("rendering", "scene_hash") or run.plan.get("scene_hash")
    return text + (f"The scene had the hash {esc(files)}." if files else "") + "</p>"


def design_words(run):
    d = run.design
    if not d:
        return "<p>The recording has no coupling design.</p>"
    if d["kind"] == "shaping_filter":
        what = (
            f"a shaping filter of {d['cutoff_hz']:.3g} Hz, damping ratio {d['damping_ratio']:.3g},"
            f" gain {d['gain']:.3g}"
        )
    elif d["kind"] == "spring_damper":
        what = (
            f"a spring-damper of {d['stiffness_n_per_m']:.4g} N/m and"
            f" {d['damping_ns_per_m']:.3g} Ns/m"
        )
    else:
        what = f"{esc(d['kind'])}: the contact force itself, gain {d['gain']:.3g}"
    text = f"<p>The coupling is {what}; status <b>{esc(d['status'])}</b>."
    if d["injected_damping_ns_per_m"] > 0:
        text += f" Injected damping in contact: {d['injected_damping_ns_per_m']:.3g} Ns/m."
    if d["critical_stiffness_n_per_m"] > 0:
        requested, displayed, critical = (
            number(d[f"{word}_stiffness_n_per_m"], "N/m", 4)
            for word in ("requested", "displayed", "critical")
        )
        text += (
            f" Requested {requested}, displayed {displayed} at the hand, certified with a gain "
            f"margin of"
            f" {number(d['gain_margin'])}; the worst case ({esc(d['worst_case'])}) becomes unstable"
            f" at {critical}."
        )
    text += " It is stable with any passive hand.</p>" if d["passive"] else "</p>"
    for title, key in (
        ("Reasons", "reasons"),
        ("Notes", "notes"),
    ):
        text += f"<h3>{title}</h3>{listed(d[key])}" if d[key] else ""
    return text


def plan_words(run):
    p = run.plan
    if not p:
        return "<p>The recording has no plan of the scene.</p>"
    text = (
        f"<p>Contact model <b>{esc(p['contact_model'])}</b> at voxels of"
        f" {1e3 * p['voxel_size_m']:.3g} mm: {number(p['shell_points'])} shell points,"
        f" {number(p['surface_voxels'])} surface voxels;"
        f" {number(p['expected_ns_per_frame'] / 1e3, 'µs')} a frame"
        f" expected.</p>{listed(p['built'])}"
    )
    text += f"<h3>Warnings</h3>{listed(p['warnings'])}" if p["warnings"] else ""
    return text + (
        "<details><summary>Not built"
        f" ({len(p['skipped'])})</summary>{listed(p['skipped'])}</details>"
        if p["skipped"]
        else ""
    )


def when(begin, end):
    return f"{begin:.3f}" if end - begin < 5e-4 else f"{begin:.3f} to {end:.3f}"


def fault_rows(run):
    faults = run.faults()
    if not faults:
        return "<p class=good>None.</p>"
    rows = [
        (when(begin, end), "" if n is None else number(n), esc(who), esc(what))
        for begin, end, n, who, what in faults
    ]
    return table(("time [s]", "count", "who", "what"), rows, (0, 1))


def change_rows(run):
    answers = [(run.at(time), answer) for _, time, answer in run.bag.messages("rendering/changed")]
    words = {1: "waiting", 2: "done", 3: "refused"}
    return (
        table(
            ("time [s]", "result", "what"),
            [(f"{t:.3f}", words.get(a["result"], "?"), esc(a["sentence"])) for t, a in answers],
            (0,),
        )
        if answers
        else ""
    )


def node_rows(run):
    rows = [
        (
            esc(node),
            esc(f"{host}, process {pid}"),
            esc(STATES.get(s["state"], "?")),
            esc(s["message"]),
        )
        for (node, host, pid), s in sorted(run.nodes.items())
    ]
    return (
        table(("node", "on", "last state", "last message"), rows)
        if rows
        else "<p>No node reported its status.</p>"
    )


# Counts of both the page and a node, for comparison.
COUNTED = (
    ("largest force [N]", "max_force_n", "device", "max_force_n"),
    ("rate [Hz]", "rate_hz", "device", "rate_hz"),
    ("samples", "samples", "device", "samples"),
    ("samples with a command", "answered", "device", "answered"),
    (
        "samples with a force of contact or effects",
        "contact_samples",
        "rendering",
        "contact_samples",
    ),
    ("samples with latched depth", "latched_samples", "rendering", "latched_samples"),
    (
        "samples with saturated force",
        "saturated_samples",
        "rendering",
        "saturated_samples",
    ),
    ("samples capped to the certified stiffness", "capped_samples", "coupling", "capped_samples"),
    (
        "samples with limited injected damping",
        "bounded_samples",
        "coupling",
        "bounded_samples",
    ),
)


def counted_rows(run):
    rows = [
        (esc(what), number(run.figures[key], "", 5), number(run.counted(node, figure), "", 5), node)
        for what, key, node, figure in COUNTED
    ]
    return table(("figure", "recorded", "reported by the node", "node"), rows, (1, 2))


# -------------------- pictures
def names(runs, sentence):
    return "; ".join((f"{run.name}: " if len(runs) > 1 else "") + sentence(run) for run in runs)


def force_title(run):
    f = run.figures
    if f["max_force_n"] is None:
        return "no command recorded"
    if not f["contact_samples"] and not f["max_force_n"] > 1e-9:
        return "no contact and no force"
    fraction = (
        f", {percent(f['ratio_to_limit'], 2)} of the device's limit"
        if f["ratio_to_limit"] is not None
        else ""
    )
    return f"at most {number(f['max_force_n'], 'N')} returned to the hand{fraction}"


def peak_title(run):
    peak = run.figures["max_force_n"]
    return (
        "no command recorded"
        if peak is None
        else f"{number(peak, 'N')} at {run.figures['max_force_at_s']:.2f}\u00a0s"
    )


def depth_title(run):
    f = run.figures
    return (
        f"depth at most {number(f['max_depth_mm'], 'mm')}"
        if f["contact_samples"] and (f["max_depth_mm"] or 0.0) > 0
        else "no contact"
    )


def latency_title(run):
    p50, overruns = run.counted("device", "latency_p50_us"), run.counted("device", "overruns")
    if p50 is None:
        return "not reported by the device"
    return (
        f"median latency {number(p50, 'µs')};"
        f" {number(overruns) if overruns else 'no'} periods skipped"
    )


def energy_title(run):
    if not len(run.command):
        return "no command recorded"
    if run.figures["max_energy_j"] is None:
        return "no valid number"
    most, taken = run.figures["max_energy_j"], max(0.0, -run.figures["least_energy_j"])
    text = f"the hand put in at most {number(1e3 * most, 'mJ')} in one contact and "
    return text + f"took out {number(1e3 * taken, 'mJ')} more at most"


# Captions of the pictures.
CAPTIONS = {
    "force": (
        "<b>Force of the contact</b> is the contact force at the scene's stiffness, in world "
        "axes; it is not displayed directly. <b>Force returned</b>"
        " is the force on the hand in device axes, after the coupling: capped to the certified "
        "stiffness, filtered (later) and damped, plus effects. It is usually smaller. A gap is a "
        "time without recorded messages."
    ),
    "apart": (
        "The contact acts on a body or a virtual tool. The hand receives the grip's or the "
        "spring's force."
    ),
    "peak": "One second before and after the largest force; every sample is plotted.",
    "distribution": (
        "Time at each magnitude of the force returned, without samples of zero force. The time "
        "scale is logarithmic."
    ),
    "torque": "Torque about the tool's origin.",
    "depth": (
        "Depth is that of the deepest shell point, 0 without contact. The gap is the validator's "
        "reference at checked samples; a negative gap is an overlap."
    ),
    "latency": (
        "The logger's times from sample to command (largest and median of each interval) include "
        "its own scheduling delay. The device's figures are from its write of a sample to its "
        "command's arrival, over the run so far. Red: periods skipped in the last 0.1 s."
    ),
    "energy": (
        "Net energy of the hand into the current contact, from the coupling's passivity "
        "observer. Each contact starts at zero; below zero the contact has generated energy."
    ),
}


def picture_sections(runs, progress):
    """Title, picture and caption of each; a sentence for one that cannot be drawn."""
    out = []

    def picture(name, title, sentence, fraction, more=""):
        title = f"{title}: {names(runs, sentence)}"
        svg = run_pictures.drawn(getattr(run_pictures, name + "_picture"), runs, name, esc(title))
        out.append(
            section(
                esc(title),
                f"<figure>{svg}<figcaption>{CAPTIONS[name]} {more}</figcaption></figure>",
            )
        )
        progress(fraction)

    commands, contacts = any(len(r.command) for r in runs), any(len(r.contact) for r in runs)
    if commands or contacts:
        picture(
            "force",
            "Force over time",
            force_title,
            0.3,
            CAPTIONS["apart"] if any(r.apart for r in runs) else "",
        )
    if any(len(run.command) > 2 * STRETCHES for run in runs):
        picture("peak", "Samples around the largest force", peak_title, 0.35)
    if commands:
        picture("distribution", "Time at each force", force_title, 0.45)
    if any((r.torque != 0).any() for r in runs):
        picture(
            "torque",
            "Torque over time",
            lambda r: f"at most {number(r.figures['max_torque_nm'], 'Nm')}",
            0.5,
        )
    if contacts:
        picture("depth", "Depth and gap", depth_title, 0.65)
    if any(not r.lockstep for r in runs):
        untold = [
            r.name for r in runs if not r.lockstep and r.counted("device", "latency_p50_us") is None
        ]
        picture(
            "latency",
            "Latency and overruns",
            lambda r: "not measured in lockstep" if r.lockstep else latency_title(r),
            0.8,
            "".join(f"{esc(name)}: no latency reported by the device. " for name in untold),
        )
    else:
        out.append(
            section(
                "Latency and overruns",
                (
                    "<p>In lockstep time is simulated: there is no latency and no skipped "
                    "period.</p>"
                ),
            )
        )
    if commands:
        picture("energy", "Energy", energy_title, 0.95)
    return out


# -------------------- page
def page(runs, progress=lambda fraction: None):
    """The page's text."""
    names_of_runs = " next to ".join(run.name for run in runs)
    notes = [note for run in runs for note in run.bag.notes]
    span = max(run.length_s for run in runs) / STRETCHES
    drawn_from = max(len(run.command) for run in runs)
    decimated = (
        f"Curves have {STRETCHES} intervals of {1e3 * span:.2g} ms each, plotted from smallest "
        f"to largest value, so no peak is lost. "
        if drawn_from > 2 * STRETCHES
        else "Curves show every sample. "
    )
    summaries = columns(runs, lambda run: f"<p>{kind_of_run(run)}</p>{verdict(run)}{tiles(run)}")
    parts = [
        f"<header><h1>{esc(names_of_runs)}</h1>{summaries}"
        + (f"<h3>Notes on the recording</h3>{listed(notes)}" if notes else "")
        + "</header>"
    ]
    parts += picture_sections(runs, progress)
    parts.append(
        section(
            "Faults",
            columns(runs, fault_rows),
            (
                "<p class=quiet>Times are of the device's clock since the first sample. Samples "
                "of one kind less than 50 ms apart are one row.</p>"
            ),
        )
    )
    parts.append(section("Limits of the run", columns(runs, limit_rows)))
    if any(run.bag.rows["rendering/changed"].times for run in runs):
        parts.append(section("Changes during the run", columns(runs, change_rows)))
    parts.append(section("Coupling", columns(runs, design_words)))
    parts.append(section("Built scene", columns(runs, plan_words)))
    parts.append(section("Repeat the run", columns(runs, repeat)))
    parts.append(
        section(
            "Counts of recording and nodes",
            (
                "<p>Counts from the recorded samples, and as reported by the nodes. A difference "
                "means that messages were not recorded, or arrived too late.</p>"
            ),
            columns(runs, counted_rows),
        )
    )
    parts.append(section("Nodes", columns(runs, node_rows)))
    parts.append(
        f"<p class=quiet>{decimated}A triangle at an edge marks a value beyond the plotted "
        f"range. Written by <code>voxtouch report</code> from"
        f" {esc(', '.join(str(run.bag.path) for run in runs))}; this page has no external "
        f"files.</p>"
    )
    data = json.dumps([run.figures for run in runs]).replace("<", "\\u003c")
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport"'
        ' content="width=device-width, initial-scale=1"><meta http-equiv="Content-Security-Policy"'
        " content=\"default-src 'none'; style-src"
        f" 'unsafe-inline'\"><title>{esc(names_of_runs)} – voxtouch"
        f" report</title><style>{CSS}</style></head>\n<body><main>\n"
        + "\n".join(parts)
        + f'\n</main><script type="application/json" id="figures">{data}</script></body></html>\n'
    )

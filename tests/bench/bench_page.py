#!/usr/bin/python3
"""bench_page.py FOLDER: writes the results of deploy/bench as two pages.

FOLDER/contact_speed.md, with two pictures if matplotlib is installed, is from query.json,
meshes.json, build.json and instructions.json. FOLDER/ring_latency.md is from ring.json. Files that
do not exist are left out.
"""

import json
import pathlib
import statistics
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "deploy/tools"))
from machine import machine  # noqa: E402
from plot_style import *  # noqa: E402, F403
from plot_style import NO_MATPLOTLIB  # noqa: E402

READ = "read 12 bytes a point"
UNITS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}


class Medians:
    """Of one program of Google Benchmark, with rows named what/place/size."""

    def __init__(self, result):
        self.context, self.rows, self.skipped = result["context"], {}, {}
        for row in result["benchmarks"]:
            what, *place, size = row["run_name"].split("/")[:3]
            key = what, place[0] if place else "", int(size)
            if row.get("error_occurred"):
                self.skipped[what] = row["error_message"]
            elif row.get("aggregate_name") == "median":
                self.rows[key] = row

    def ns(self, *key):
        row = self.rows.get(key)
        if row is None:
            return None
        return (
            row["s/query"] * 1e9 if "s/query" in row else row["cpu_time"] * UNITS[row["time_unit"]]
        )

    def sizes(self):
        return sorted({key[2] for key in self.rows})


def over(a, b):
    return a / b if a is not None and b else None


def number(value, digits=3):
    return "–" if value is None else f"{value:,.0f}" if value >= 1000 else f"{value:.{digits}g}"


def time_word(ns):
    return (
        "–"
        if ns is None
        else (
            f"{ns:.3g} ns"
            if ns < 1e3
            else (
                f"{ns / 1e3:.3g} µs"
                if ns < 1e6
                else f"{ns / 1e6:.3g} ms"
                if ns < 1e9
                else f"{ns / 1e9:.3g} s"
            )
        )
    )


def table(head, rows):
    return (
        ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
        + ["| " + " | ".join(row) + " |" for row in rows]
        + [""]
    )


def conditions(context):
    kernels = {"0": "plain", "1": "AVX2", "2": "AVX-512"}.get(context.get("instructions", ""), "")
    load = ", ".join(f"{value:.1f}" for value in context["load_avg"])
    return f"{context['date'][:10]}, {machine()}, load at the start {load}" + (
        f", kernels: {kernels}" if kernels else ""
    )


def query_part(m):
    rows = []
    for size in m.sizes():
        read = m.ns(READ, "", size)
        for place in ("far", "near", "light", "heavy"):
            find = m.rows.get(("find", place, size))
            if find is None:
                continue

            def cell(what):
                ns = m.ns(what, place, size)
                return (
                    "–"
                    if ns is None
                    else f"{time_word(ns)}, {ns / size:.3g}"
                    + (f" ({ns / read:.2g})" if read else "")
                )

            rows.append(
                [f"{size:,}", place, f"{find['tested%']:.2f} %", f"{find['hits%']:.1f} %"]
                + [
                    cell(w)
                    for w in (
                        "find",
                        "render original",
                        "render adapted",
                        "of mesh adapted",
                        "of mesh field",
                    )
                ]
            )
    lines = [
        "## Contact query",
        "",
        conditions(m.context) + ".",
        "",
        (
            "CPU time of a frame, and ns a point; in brackets over reading 12 bytes a point"
            f" ({', '.join(f'{n:,}: {time_word(m.ns(READ, str(), n))}' for n in m.sizes())}). The"
            " last two columns are on a cup made of a mesh, whose surface has other voxels."
        ),
        "",
    ]
    lines += table(
        [
            "points",
            "place",
            "tested",
            "hits",
            "find",
            "original",
            "adapted",
            "mesh: adapted",
            "mesh: field",
        ],
        rows,
    )
    slides = [
        (
            size,
            m.ns("virtual tool", "slide", size),
            m.ns("find", "slide", size),
            m.rows[("virtual tool", "slide", size)]["queries"],
        )
        for size in m.sizes()
        if ("virtual tool", "slide", size) in m.rows
    ]
    if slides:
        lines += [
            "A virtual tool that slides on the cup's floor at 0.1 m/s, the hand 2 mm too deep:",
            "",
        ]
        lines += table(
            ["points", "frame", "one find", "over it", "queries a frame"],
            [
                [
                    f"{size:,}",
                    time_word(tool),
                    time_word(find),
                    number(over(tool, find), 2),
                    f"{queries:.2f}",
                ]
                for size, tool, find, queries in slides
            ],
        )
    return lines


def mesh_part(m):
    asked = ("find", "render", "fcl boolean", "fcl contacts", "fcl distance", "gimpact")
    rows = []
    for size in m.sizes():
        for place in ("near", "light", "heavy"):
            ours = m.ns("render", place, size)
            if ours is None:
                continue
            row = m.rows[("render", place, size)]
            cells = []
            for what in asked:
                ns = m.ns(what, place, size)
                found = m.rows.get((what, place, size), {}).get("found")
                cells.append(
                    time_word(ns)
                    + (
                        f" ({number(found)})"
                        if what in ("render", "fcl contacts", "gimpact") and found is not None
                        else ""
                    )
                )
            faster = [
                what
                for what in asked[2:]
                if (ns := m.ns(what, place, size)) is not None and ns < ours
            ]
            rows.append(
                [f"{row['triangles']:,.0f}", place, f"{row['points']:,.0f}"]
                + cells
                + [
                    number(over(m.ns("fcl contacts", place, size), ours)),
                    ", ".join(faster) or "none",
                ]
            )
    lines = [
        "## Next to FCL and Bullet",
        "",
        conditions(m.context) + ".",
        "",
        (
            "A query of the same two meshes at the same poses, one process. `find` and `render`"
            " (adapted) look at the tool's shell at 0.5 mm and do not see the static triangles. In"
            " brackets what was found: points, pairs of triangles, contacts."
        ),
        "",
    ]
    lines += table(
        ["triangles of the cup", "place", "our points"]
        + list(asked)
        + ["fcl contacts over render", "faster than render"],
        rows,
    )
    return lines + [f"`{what}` is left out: {why}." for what, why in m.skipped.items()]


def build_part(m):
    rows = []
    for size in m.sizes():
        key = ("cup", size)
        theirs, bytes_of = (
            m.ns("openvdb", *key),
            lambda what: m.rows.get((what, *key), {}).get("bytes"),
        )
        both = m.ns("voxels and distances", *key)
        rows.append(
            [
                f"{m.rows[('voxels', *key)]['triangles']:,.0f}",
                time_word(m.ns("voxels", *key)),
                time_word(both),
                time_word(m.ns("shell", *key)),
                time_word(theirs),
                number(over(both, theirs), 2),
            ]
            + [
                f"{b / 1e6:.3g} MB" if b else "–"
                for b in map(bytes_of, ("voxels", "voxels and distances", "openvdb"))
            ]
            + [
                number(over(bytes_of(what), bytes_of("openvdb")), 2)
                for what in ("voxels", "voxels and distances")
            ]
        )
    lines = [
        "## Build",
        "",
        conditions(m.context) + ".",
        "",
        (
            "The cup at 0.5 mm, one thread. Our distances reach 2 voxels outside and 12 inside,"
            " OpenVDB's 3 to both sides, its default."
        ),
        "",
    ]
    lines += table(
        [
            "triangles",
            "voxels",
            "voxels and distances",
            "shell of the cup",
            "OpenVDB",
            "time over OpenVDB's",
            "voxels",
            "voxels and distances",
            "OpenVDB",
            "memory over OpenVDB's, voxels",
            "with distances",
        ],
        rows,
    )
    return lines + [f"`{what}` is left out: {why}." for what, why in m.skipped.items()]


def instructions_part(rows):
    whats = list(dict.fromkeys(row["what"] for row in rows))
    of = {(row["place"], row["what"]): row["instructions"] / row["points"] for row in rows}
    return [
        "## Instructions a point",
        "",
        (
            f"{rows[0]['points']:,} points, counted by callgrind with AVX2; `field` on the cup made"
            " of a mesh."
        ),
        "",
    ] + table(
        ["place"] + whats,
        [
            [place] + [number(of[place, what]) for what in whats]
            for place in dict.fromkeys(row["place"] for row in rows)
        ],
    )


def ring_part(ring):
    medians, rounds = ring["medians"], ring["rounds"]

    def ratio(kind, base):
        pairs = [a["p50_us"] / b["p50_us"] for a, b in zip(rounds[kind], rounds[base])]
        return f"{statistics.median(pairs):.2f} ({min(pairs):.2f} to {max(pairs):.2f})"

    rows = []
    for kind, m in medians.items():
        base = "bare, wait sets, one CPU" if "one CPU" in kind else "bare, wait sets"
        rows.append(
            [
                kind,
                f"{m['p50_us']:.0f} µs",
                f"{m['p50_us'] / 3:.0f} µs",
                f"{m['p99_us']:.0f} µs",
                "1" if kind == base else ratio(kind, base),
                "–" if "one CPU" in kind else ratio(kind, "bare, listeners answer"),
            ]
        )
    lines = [
        (
            f"{ring['date']}, {machine()}, load {ring['load']:.1f}. Medians of"
            f" {ring['turns']} turns of {ring['seconds']:g} s, at 1 kHz, on loopback."
        ),
        "",
        (
            "A round is three hops: device to rendering, to coupling, and back to the device."
            " `ours` renders and couples the cup, with logger, validator and `up`. `bare` passes"
            " messages of the same sizes through Cyclone DDS and does nothing else; its threads"
            " wait in wait sets, or its listeners answer. Ratios are of p50 within one turn:"
            " median (least to largest)."
        ),
        "",
    ]
    lines += table(
        ["ring", "p50", "a hop", "p99", "over bare, wait sets", "over bare, listeners answer"], rows
    )
    taps = (
        statistics.median(
            a["p50_us"] / b["p50_us"] for a, b in zip(rounds["ours"], rounds["ours without taps"])
        )
        - 1
    )
    lines += [f"Taps (logger, validator and `up`) add {100 * taps:.0f} % to a round.", ""]
    calls = ring.get("calls", {})
    if calls:
        roles = [(which, role) for which in calls for role in calls[which]]
        names = sorted({name for which, role in roles for name in calls[which][role]})
        lines += ["System calls of the thread that answers, in a second (strace):", ""]
        lines += table(
            ["call"] + [f"{which}, {role}" for which, role in roles],
            [
                [name] + [number(calls[which][role].get(name, 0)) for which, role in roles]
                for name in names
            ],
        )
    return lines


def goals_part(query=None, meshes=None, build=None, ring=None):
    """Figures compared with their targets."""
    rows = []

    def row(what, most, value, at_least=False):
        if value is not None:
            held = value >= most if at_least else value <= most
            rows.append(
                [
                    what,
                    ("at least " if at_least else "") + f"{most:g}",
                    number(value, 2 if value < 10 else 3),
                    "yes" if held else "**no**",
                ]
            )

    if query:
        for place, most in (("near", 0.15), ("light", 1.5), ("heavy", 16)):
            row(
                f"`find`, 1e5 {place}, over reading 12 B a point",
                most,
                over(query.ns("find", place, 100_000), query.ns(READ, "", 100_000)),
            )
        for place, most in (("near", 1 / 50), ("light", 1 / 4), ("heavy", 1.1)):
            row(
                f"`find`, 1e5 {place}, over flat loops without a tree",
                most,
                over(query.ns("find", place, 100_000), query.ns("flat loops", place, 100_000)),
            )
        for place, most in (("light", 1.1), ("heavy", 1.3)):
            row(
                f"`render` over `find`, 1e5 {place}",
                most,
                over(query.ns("render adapted", place, 100_000), query.ns("find", place, 100_000)),
            )
        row(
            "`field` over `adapted`, 1e5 light",
            2,
            over(
                query.ns("of mesh field", "light", 100_000),
                query.ns("of mesh adapted", "light", 100_000),
            ),
        )
        row(
            "virtual tool that slides over one `find`, 1e5",
            3,
            over(query.ns("virtual tool", "slide", 100_000), query.ns("find", "slide", 100_000)),
        )
    if meshes:
        for place, least in (("near", 30), ("light", 120), ("heavy", 250)):
            row(
                f"FCL's contacts over `render`, 1e5 triangles, {place}",
                least,
                over(
                    meshes.ns("fcl contacts", place, 100_000), meshes.ns("render", place, 100_000)
                ),
                True,
            )
    if build:
        row(
            "voxels and distances over OpenVDB's time, 1e5 triangles",
            0.25,
            over(
                build.ns("voxels and distances", "cup", 100_000),
                build.ns("openvdb", "cup", 100_000),
            ),
        )
        for what, most in (("voxels", 1 / 12), ("voxels and distances", 1 / 3)):
            ours, theirs = (
                build.rows.get((name, "cup", 100_000), {}).get("bytes")
                for name in (what, "openvdb")
            )
            row(f"memory of {what} over OpenVDB's", round(most, 3), over(ours, theirs))
    if ring:

        def p50(kind):
            return ring["medians"].get(kind, {}).get("p50_us")

        row(
            "the ring's round over a bare ring of Cyclone DDS",
            1.3,
            over(p50("ours"), p50("bare, wait sets")),
        )
        row(
            "in one process over a bare ring of processes",
            0.25,
            over(p50("ours in one process"), p50("bare, wait sets")),
        )
        row(
            "with logger and validator over without",
            1.05,
            over(p50("ours"), p50("ours without taps")),
        )
    return ["## Goals", ""] + table(["figure", "at most", "here", "held"], rows) if rows else []


def new_plane(columns, title, note):
    matplotlib.rcParams.update(STYLE)
    figure = Figure(figsize=(16, 9), dpi=100, layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False, sharey=True)[0]
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.9))
    figure.suptitle(title, x=0.01, y=0.985, va="top", ha="left", fontweight="bold")
    figure.text(0.01, 0.935, note, va="top", color="0.25", fontsize=14).set_in_layout(False)
    return figure, axes


def tick_at(axis, sizes):
    log_axis(axis, sizes[0] / 1.5, sizes[-1] * 1.5)
    axis.set_ticks(sizes, labels=[f"{n // 1000:,}k" for n in sizes])


def draw_points(m, picture):
    figure, (axis,) = new_plane(
        1,
        "Time of a frame by the number of shell points",
        conditions(m.context) + "; CPU time, medians",
    )
    sizes = m.sizes()
    axis.plot(
        sizes,
        [m.ns(READ, "", n) / 1e3 for n in sizes],
        "--",
        color=GREY,
        lw=2,
        label="reading 12 bytes a point",
    )
    if all(m.ns("flat loops", "heavy", n) for n in sizes):
        axis.plot(
            sizes,
            [m.ns("flat loops", "heavy", n) / 1e3 for n in sizes],
            ":",
            color=GREY,
            lw=2,
            label="heavy, flat loops",
        )
    for place, colour, mark in (("near", GREEN, "D"), ("light", BLUE, "o"), ("heavy", ORANGE, "^")):
        for what, face in (("find", "white"), ("render adapted", colour)):
            axis.plot(
                sizes,
                [m.ns(what, place, n) / 1e3 for n in sizes],
                "-",
                marker=mark,
                color=colour,
                mfc=face,
                ms=11,
                mew=2.2,
                lw=1.4,
                label=f"{place}, {what.split()[0]}",
            )
    axis.axhline(1000.0, color=RED, lw=1.2)
    axis.annotate(
        "the period of a 1 kHz loop",
        (sizes[0], 1000.0),
        xytext=(0, 5),
        textcoords="offset points",
        color=RED,
        fontsize=13,
    )
    tick_at(axis.xaxis, sizes)
    log_axis(axis.yaxis, 0.02, 4e4)
    axis.set_xlabel("shell points")
    axis.set_ylabel("CPU time of a frame [µs]")
    axis.legend(
        loc="upper left",
        bbox_to_anchor=(1.005, 1.0),
        title="hollow: find; filled:\nrender, adapted",
        alignment="left",
    )
    figure.savefig(picture, metadata={"Software": None})


def draw_triangles(m, picture):
    figure, axes = new_plane(
        3,
        "Time of a query by the number of triangles",
        conditions(m.context) + "; CPU time, medians; same meshes and poses",
    )
    sizes = m.sizes()
    lines = (
        ("render", "voxtouch, render", BLUE, "o"),
        ("fcl contacts", "FCL, all contacts", ORANGE, "^"),
        ("gimpact", "Bullet GImpact", PURPLE, "v"),
        ("fcl distance", "FCL, distance", GREEN, "D"),
        ("fcl boolean", "FCL, yes or no", GREY, "s"),
    )
    for axis, place in zip(axes, ("near", "light", "heavy")):
        for what, name, colour, mark in lines:
            values = [m.ns(what, place, n) for n in sizes]
            if all(values):
                axis.plot(
                    sizes,
                    [v / 1e3 for v in values],
                    "-",
                    marker=mark,
                    color=colour,
                    ms=10,
                    lw=1.4,
                    label=name,
                )
        tick_at(axis.xaxis, sizes)
        log_axis(axis.yaxis, 0.1, 4e5)
        axis.set_title(
            {"near": "near, no contact", "light": "light contact", "heavy": "heavy contact"}[place]
        )
        axis.set_xlabel("triangles of each mesh")
    axes[0].set_ylabel("CPU time of a query [µs]")
    axes[-1].legend(
        *axes[0].get_legend_handles_labels(), loc="upper left", bbox_to_anchor=(1.005, 1.0)
    )
    figure.savefig(picture, metadata={"Software": None})


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])

    def read(name):
        file = folder / f"{name}.json"
        try:
            return json.loads(file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except ValueError:
            print(
                f"{file} is not whole: its run was broken off. The page leaves it out.",
                file=sys.stderr,
            )
            return None

    query, meshes, build = (
        Medians(result) if (result := read(name)) else None for name in ("query", "meshes", "build")
    )
    counted, ring = read("instructions"), read("ring")
    if query or meshes or build or counted:
        parts = [head("Contact queries and their time", "query meshes build instructions")]
        parts.append(
            [
                "Medians of interleaved runs, CPU time of one thread. Compare ratios within a"
                " section: its rows ran in one process, in random order.",
                "",
            ]
        )
        parts.append(goals_part(query, meshes, build))
        parts += [
            part(result)
            for part, result in (
                (query_part, query),
                (mesh_part, meshes),
                (build_part, build),
                (instructions_part, counted),
            )
            if result
        ]
        for draw, result, name in (
            (draw_points, query, "points"),
            (draw_triangles, meshes, "triangles"),
        ):
            if result and not NO_MATPLOTLIB:
                draw(result, folder / f"bench_{name}.png")
                parts.append([f"![Time by {name}](../pictures/bench_{name}.png)", ""])
        write(folder / "contact_speed.md", parts)
    if ring:
        parts = [head("Latency of the ring", "ring"), ring_part(ring), goals_part(ring=ring)]
        write(folder / "ring_latency.md", parts)


def head(title, names):
    return [f"# {title}", "", f"Command: `deploy/bench {names}`", ""]


def write(page, parts):
    page.write_text(
        "\n".join(line for part in parts for line in part).rstrip() + "\n", encoding="utf-8"
    )
    print(page)


if __name__ == "__main__":
    main()

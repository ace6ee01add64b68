#!/usr/bin/env python3
"""bench_page.py RESULT.json PAGE.md: the benchmark's medians as one page, each time over reading 12 bytes a point."""
import json
import sys
from pathlib import Path


def medians(result):
    """{(what, place, points): benchmark}; place is '' for reading 12 bytes a point."""
    out = {}
    for row in result["benchmarks"]:
        if row.get("aggregate_name") != "median":
            continue
        what, *place, points = row["run_name"].split("/")
        out[what, place[0] if place else "", int(points)] = row
    return out


def nanoseconds(row):
    return row["cpu_time"] * {"ns": 1.0, "us": 1e3, "ms": 1e6}[row["time_unit"]]


def page(result):
    rows, context = medians(result), result["context"]
    lines = [
        "# Contact query: CPU time of a frame",
        "",
        f"{context['date']}, {context['num_cpus']} CPUs of {context['mhz_per_cpu']} MHz, load {context['load_avg']}. Medians of "
        "interleaved runs of one process; the number in brackets is the time over reading 12 bytes a point.",
        "",
        "| points | place | tested | hits | find | original | adapted | clustered |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for (what, place, points), row in rows.items():
        if what != "find":
            continue
        read = rows.get(("read 12 bytes a point", "", points))

        def cell(name):
            other = rows.get((name, place, points))
            if other is None:
                return "–"
            time = nanoseconds(other)
            return f"{time / 1e3:.3g} µs" + (f" ({time / nanoseconds(read):.2g})" if read else "")

        lines.append(
            f"| {points:,} | {place} | {row['tested%']:.2f} % | {row['hits%']:.1f} % | {cell('find')} | {cell('render original')} "
            f"| {cell('render adapted')} | {cell('render clustered')} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    Path(sys.argv[2]).write_text(page(json.loads(Path(sys.argv[1]).read_text())))

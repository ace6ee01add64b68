#!/usr/bin/env python3
"""Plays the league: the same poses for every contact library, compared with closed forms or exact
triangles.

usage: league.py --voxtouch PROGRAM --out FOLDER [--rows A,B1] [--only NAME,...] [--add NAME --csv
       FILE] [--again] [--against PAGE] [--page-only]

FOLDER receives a folder per row with meshes, poses and expected results, result.json, league.md
and the pictures. README.md describes how another program takes part without this code.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import sys

import by_csv
import figures
import loops
import numpy as np
import page
import rows
import shapes
import systems
import truth

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "deploy/tools"))
from machine import machine  # noqa: E402

LEAST_WRENCH = 1e-9  # N or N m: less is none
PENETRATION_EVERY = 10  # samples
PASSED_SAMPLES = 20  # a contact lost for so long has let the tool through


def curve(row, along):
    """Force along the expected direction [N] over depth [mm], while the hand moves in."""
    deep = np.flatnonzero(row.depth_m > 0)
    deep = deep[: 1 + np.argmax(row.depth_m[deep])]
    chosen = deep[np.unique(np.linspace(0, len(deep) - 1, 40).astype(int))]
    return [[float(1e3 * row.depth_m[n]), float(along[n])] for n in chosen]


def of_spring(row, force):
    """Force over stiffness times depth of the hand, its direction and noise, penetration."""
    count = len(row.poses)
    window = np.arange(count) >= count - 100 if row.window is None else row.window
    along = np.sum(force * row.direction, axis=1)[window]
    depth = row.depth_m[window]
    ratio = along / (row.spring_n_per_m * depth)
    if row.ball_m:
        places = (row.poses[:, 4:] + force / row.spring_n_per_m)[window]
        _, distance = truth.nearest_on(row.static, places[::PENETRATION_EVERY])
        penetration = row.ball_m - distance
    else:
        penetration = depth - along / row.spring_n_per_m
    lost = np.convolve(ratio, np.full(PASSED_SAMPLES, 1 / PASSED_SAMPLES), "valid")
    return {
        "force_ratio": float(ratio.mean()),
        "noise": float(ratio.std()),
        "mean_deg": float(angles(force[window], row.direction[window]).mean()),
        "penetration_mm": float(1e3 * penetration[np.argmax(np.abs(penetration))]),
        "passed": bool(lost.min() < 0.2),
    }


def angles(force, direction):
    size = np.linalg.norm(force, axis=1)
    cosine = np.sum(force * direction, axis=1) / np.maximum(size, 1e-300)
    return np.where(size > LEAST_WRENCH, np.degrees(np.arccos(np.clip(cosine, -1, 1))), 180.0)


def judged(row, wrenches, times):
    force = wrenches[:, :3]
    asked = wrenches[:, 3:] if row.judge == "torque" else force
    facts = {"us_median": float(np.median(times)), "us_worst": float(np.max(times))}
    if row.judge in ("direction", "torque"):
        wrong = angles(asked, row.direction)
        facts |= {
            "mean_deg": float(wrong.mean()),
            "p95_deg": float(np.percentile(wrong, 95)),
            "missed": int(np.sum(np.linalg.norm(asked, axis=1) <= LEAST_WRENCH)),
            "of": len(wrong),
        }
        if row.name == "E3d":
            facts["curve"] = curve(row, np.sum(force * row.direction, axis=1))
        if per_force := row.facts.get("torque_per_force_m"):
            z = np.abs(wrenches[:, 2])
            found = np.abs(wrenches[z > 1e-9, 5]) / z[z > 1e-9]
            facts["torque_ratio"] = float(np.median(found) / per_force) if len(found) else 0.0
    elif row.judge == "advance":
        tool_z = row.poses[:, 6] + force[:, 2] / row.spring_n_per_m
        turn = np.unwrap(2 * np.arctan2(row.poses[:, 3], row.poses[:, 0])) / (2 * np.pi)
        slope = np.polyfit(turn[row.window], tool_z[row.window], 1)[0]
        facts |= {"advance_mm": float(1e3 * slope), "expected_mm": 1e3 * shapes.PITCH_M}
    elif row.judge == "hammer":
        tool_z = row.poses[:, 6] + force[:, 2] / row.spring_n_per_m
        facts |= {
            "shift_mm": float(1e3 * np.max(np.abs(tool_z))),
            "held": bool(abs(tool_z[-1]) < 0.5 * shapes.PITCH_M),
        }
    elif row.judge == "free":
        facts |= {"touched": int(np.sum(np.linalg.norm(force, axis=1) > 1e-9)), "of": len(force)}
    else:
        facts |= of_spring(row, force)
        if row.name == "E3s":
            facts["curve"] = curve(row, np.sum(force * row.direction, axis=1))
    return facts


def reason(error):
    text = str(error).splitlines()[0][:120] if str(error) else ""
    return f"failed: {type(error).__name__}: {text}"


def check_addition(options, everybody):
    """Name and folder of --add; SystemExit with the remedy."""
    if not options.csv or not pathlib.Path(options.csv).exists():
        sys.exit(
            f"--add {options.add}: give --csv FILE of all rows, or FOLDER with one ROW.csv each"
        )
    if options.add in [r.name for r in everybody] or not options.add.replace(" ", "").isalnum():
        sys.exit(f"--add {options.add}: take another name, of letters, digits and spaces")


def play_loops(options, selected, taking_part, out, result):
    names = [name for name, _, _ in taking_part]
    for name, (title, judge, _) in loops.LOOP_ROWS.items():
        if not selected(name):
            continue
        entry = result["rows"].setdefault(name, {"title": title, "judge": judge, "answers": {}})
        for system in systems.everybody(options.voxtouch):
            if system.name not in names:
                continue
            print(f"{name}: {system.name}", file=sys.stderr)
            try:
                given = loops.answer(name, system, out / name.replace(" ", "_").replace("/", "_"))
            except Exception as error:
                given = reason(error)
            if given is not None:
                entry["answers"][system.name] = given


def participants(options):
    """Name, answer and version of every system."""
    everybody = systems.everybody(options.voxtouch)
    if options.add:
        check_addition(options, everybody)
        return [
            (options.add, lambda row, folder: by_csv.answer(options.csv, row, folder), "by CSV")
        ]
    only = options.only.split(",") if options.only else []
    return [
        (r.name, r.answer, r.version())
        for r in everybody
        if not only or any(r.name.startswith(o) for o in only)
    ]


def play(options):
    out = pathlib.Path(options.out).resolve()
    deploy = pathlib.Path(__file__).resolve().parents[3] / "deploy"
    chosen = options.rows.split(",") if options.rows else [""]

    def selected(name):
        return any(name.startswith(begin) for begin in chosen)

    file = out / "result.json"
    result = (
        json.loads(file.read_text(encoding="utf-8"))
        if file.exists()
        else {"rows": {}, "versions": {}}
    )
    taking_part = participants(options)
    answered = 0
    for row in rows.all_rows(deploy, truth.nearest_on, selected):
        folder = out / row.name.replace(" ", "_").replace("/", "_")
        rows.write_row(row, folder)
        entry = result["rows"].setdefault(
            row.name, {"title": row.title, "judge": row.judge, "answers": {}}
        )
        for name, answer, version in taking_part:
            print(f"{row.name}: {name}", file=sys.stderr)
            try:
                given = answer(row, folder)
            except by_csv.CsvError as error:
                sys.exit(str(error))
            except Exception as error:  # a fault of a system is a result, too
                given = reason(error)
            if given is None:
                continue
            answered += 1
            entry["answers"][name] = given if isinstance(given, str) else judged(row, *given)
            result["versions"][name] = version
    if options.add and not answered:
        sys.exit(f"--csv {options.csv}: no ROW.csv is named as one of the rows, such as A1.csv")
    if not options.add:
        play_loops(options, selected, taking_part, out, result)
    result["conditions"] = {
        "date": str(datetime.date.today()),
        "machine": machine(),
        "load": round(os.getloadavg()[0], 1),
        "python": platform.python_version(),
    }
    if not options.add:
        result.pop("reproduced", None)
    out.mkdir(parents=True, exist_ok=True)
    write_page(result, out)


def write_page(result, out):
    (out / "result.json").write_text(json.dumps(result, indent=1), encoding="utf-8")
    (out / "league.md").write_text(page.markdown(result), encoding="utf-8")
    page.pictures(result, out)


def reproduced(options):
    """Adds the results of --again and --against to the result and its page."""
    out = pathlib.Path(options.out).resolve()
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    new, found = figures.read(out / "result.json"), result.setdefault("reproduced", {})
    if options.again:
        second = figures.read(out / "again" / "result.json")
        found["again"] = figures.differences(second, {name: new[name] for name in second})
    if options.against:
        old = figures.read(options.against)
        found["against"] = figures.differences(*figures.common(old, new)) | {
            "machine": figures.machine_of(options.against)
        }
    write_page(result, out)


def play_all(options):
    if not options.page_only:
        play(options)
        if options.again:
            again = argparse.Namespace(**vars(options))
            again.out = pathlib.Path(options.out) / "again"
            (again.out / "result.json").unlink(missing_ok=True)
            play(again)
    if options.page_only or options.again or options.against:
        reproduced(options)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--voxtouch", default="build/bin/voxtouch", help="the program")
    parser.add_argument("--out", default="build/league", help="folder of results")
    parser.add_argument(
        "--rows", default="", help="only rows whose names begin so, with commas between"
    )
    parser.add_argument("--only", default="", help="only these systems")
    parser.add_argument("--add", default="", help="name of a program whose answers are in --csv")
    parser.add_argument("--csv", default="", help="file or folder of answers: README.md")
    parser.add_argument("--again", action="store_true", help="plays twice, into OUT/again, too")
    parser.add_argument("--against", default="", help="league.md or result.json of another machine")
    parser.add_argument("--page-only", action="store_true", help="plays nothing; writes the page")
    chosen_options = parser.parse_args()
    if chosen_options.add and (chosen_options.again or chosen_options.against):
        parser.error("--add goes without --again and --against")
    play_all(chosen_options)

#!/usr/bin/env python3
"""Errors of the league's answers, read from result.json or back from its page, and their limits.

usage: figures.py check FILE        every figure of voxtouch within limits.csv, none missing
       figures.py limits FILE       limits of FILE's figures, for limits.csv
       figures.py compare OLD NEW   figures of any system that differ by more than 10 %

FILE, OLD and NEW are a result.json or a league.md. An error is 0 if the answer is right; a word is
right or not. check and compare print one line for each fault; exit status 1 if there is one.
"""

import csv
import json
import pathlib
import re
import sys

LIMITS = pathlib.Path(__file__).parent / "limits.csv"
OURS = "voxtouch"
DIFFERENCE = 0.1  # of figures in `compare`
SLACK = 0.05  # of a limit over the figure that it is made from
SMALLEST = {"°": 0.01, "%": 0.01, "mm": 0.002, "": 0.002}  # least limit and least difference


UNITS = {"mean": "°", "p95": "°", "noise": "%"} | dict.fromkeys(
    ("sinks", "moves", "shift", "penetration", "advance"), "mm"
)


def unit(figure):
    """Of a figure by its name: degrees, per cent, millimetres or none."""
    return UNITS.get(figure, "")


def of_answer(judge, a):
    """Errors of one answer of result.json by name; a sentence in its place gives its first word."""
    if isinstance(a, str):
        return {"answer": a.split(":")[0]}
    if judge == "advance":
        return {"advance": abs(a["advance_mm"] - a["expected_mm"])}
    if judge in ("direction", "torque"):
        torque = {"torque": abs(a["torque_ratio"] - 1)} if "torque_ratio" in a else {}
        counts = {"missed": a["missed"], "poses": str(a["of"])}
        return {"mean": a["mean_deg"], "p95": a["p95_deg"]} | counts | torque
    if judge == "free":
        return {"touched": a["touched"], "poses": str(a["of"])}
    if judge == "rest":
        return {"sinks": a["sink_mm"], "moves": a["creep_mm"]}
    if judge == "loop":
        return {"held": a["held"], "released": a["released"], "warned": a["warned"]}
    if judge == "hammer":
        return {"shift": a["shift_mm"], "thread": "held" if a["held"] else "skipped"}
    if judge == "lock":
        return {"lock": abs(a["friction"] - a["expected"])}
    inside = {
        "penetration": abs(a["penetration_mm"]),
        "mean": a["mean_deg"],
        "noise": 100 * a["noise"],
    }
    if a["passed"]:
        return {"answer": "passed through"} | inside
    return {"force": abs(a["force_ratio"] - 1)} | inside


def of_cells(first, second):
    """The same from the two cells of a line of the page."""
    number = r"(?:< )?([\d.]+)"
    if found := re.fullmatch(rf"{number}°, {number}°", first):
        counts = re.match(r"(\d+) of (\d+) missed(?:, torque ([\d.]+))?", second)
        errors = {"mean": float(found[1]), "p95": float(found[2]), "missed": int(counts[1])}
        torque = {"torque": abs(float(counts[3]) - 1)} if counts[3] else {}
        return errors | {"poses": counts[2]} | torque
    if found := re.fullmatch(r"(\d+) of (\d+) touched", first):
        return {"touched": int(found[1]), "poses": found[2]}
    if found := re.fullmatch(r"(-?[\d.]+) of k d", first):
        return {"force": abs(float(found[1]) - 1)} | inside_of(second)
    if first == "passed through":
        return {"answer": first} | inside_of(second)
    if found := re.fullmatch(r"(-?[\d.]+) mm a turn", first):
        return {"advance": abs(float(found[1]) - of_number(second))}
    if found := re.fullmatch(r"(-?)([\d.]+|< 0.001) mm", first):
        return {"sinks": of_number(first), "moves": of_number(second)}
    if found := re.fullmatch(r"shifts ([\d.]+) mm", first):
        return {"shift": float(found[1]), "thread": second}
    if found := re.fullmatch(r"from ([\d.]+) on", first):
        return {"lock": abs(float(found[1]) - float(re.search(r"[\d.]+", second)[0]))}
    if "; " in first:
        held, released = first.split("; ")
        return {"held": held, "released": released, "warned": second}
    return {"answer": first.split(":")[0]}


def inside_of(cell):
    names = {"mm": "penetration", "°": "mean", "%": "noise"}
    found = {}
    for part in cell.split(", "):
        name = next(names[unit] for unit in names if part.endswith(unit))
        found[name] = abs(of_number(part))
    return found


def of_number(text):
    return float(re.search(r"-?[\d.]+", text)[0])


def read_page(text):
    """{row: {system: errors}} of a league.md."""
    table, row = {}, None
    for line in text.splitlines():
        if line.startswith("## "):
            row = line[3:].split(": ")[0] if ": " in line else None
        elif row and line.startswith("| ") and not line.startswith("| system "):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            table.setdefault(row, {})[cells[0]] = of_cells(cells[1], cells[2])
    return table


def read(path):
    """{row: {system: errors}} of a result.json or a league.md."""
    text = pathlib.Path(path).read_text(encoding="utf-8")
    if not str(path).endswith(".json"):
        return read_page(text)
    return {
        name: {s: of_answer(row["judge"], a) for s, a in row["answers"].items()}
        for name, row in json.loads(text)["rows"].items()
    }


def read_limits(path=LIMITS):
    """{(row, system, figure): limit}: a number, or the word that is right."""
    with open(path, encoding="utf-8", newline="") as file:
        return {
            (line["row"], line["system"], line["figure"]): line["limit"]
            for line in csv.DictReader(file)
        }


def flat(table):
    return {
        (row, system, figure): value
        for row, answers in table.items()
        for system, errors in answers.items()
        for figure, value in errors.items()
    }


def exceeds(value, limit):
    """Also for a number in place of a word, and for NaN."""
    if isinstance(value, str):
        return value != limit
    return not re.fullmatch(r"[\d.e+-]+", limit) or not value <= float(limit)


def check(table, limits):
    """Sentences: figures of voxtouch that are missing, worse than their limit, or without one."""
    found = {key: value for key, value in flat(table).items() if key[1].startswith(OURS)}
    faults = []
    for key in sorted(limits.keys() | found.keys()):
        name = f"{key[0]}, {key[1]}, {key[2]}"
        if key not in found:
            faults.append(f"{name}: missing; the limit is {limits[key]}")
        elif key not in limits:
            faults.append(f"{name}: {found[key]} has no limit in {LIMITS.name}")
        elif exceeds(found[key], limits[key]):
            faults.append(f"{name}: {found[key]}; the limit is {limits[key]}")
    return faults


def limit_of(figure, value):
    if isinstance(value, str):
        return value
    if figure in ("missed", "touched"):
        return str(value)
    return f"{max((1 + SLACK) * value, SMALLEST[unit(figure)]):.3g}"


def print_limits(table):
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["row", "system", "figure", "limit"])
    for key, value in sorted(flat(table).items()):
        if key[1].startswith(OURS):
            writer.writerow([*key, limit_of(key[2], value)])


def compare(old, new):
    """Sentences: figures that differ by more than DIFFERENCE, or are in one of both only."""
    old, new = flat(old), flat(new)
    faults = []
    for key in sorted(old.keys() | new.keys()):
        a, b = old.get(key), new.get(key)
        words = isinstance(a, str) or isinstance(b, str) or a is None or b is None
        least = SMALLEST[unit(key[2])]
        far = a != b if words else abs(a - b) > max(DIFFERENCE * max(abs(a), abs(b)), least)
        if far:
            show = [v if v is None or isinstance(v, str) else f"{v:.3g}" for v in (a, b)]
            faults.append(f"{key[0]}, {key[1]}, {key[2]}: {show[0]} and {show[1]}")
    return faults


def common(old, new):
    """Both tables, with the figures only that both have."""
    keys = flat(old).keys() & flat(new).keys()
    tables = []
    for table in (old, new):
        chosen = {}
        for row, system, figure in sorted(keys):
            errors = chosen.setdefault(row, {}).setdefault(system, {})
            errors[figure] = table[row][system][figure]
        tables.append(chosen)
    return tables


def differences(old, new):
    """Count of figures, and the sentences of `compare`."""
    return {"figures": len(flat(new)), "differ": compare(old, new)}


def machine_of(path):
    """Date and machine of a result.json or a league.md."""
    text = pathlib.Path(path).read_text(encoding="utf-8")
    if str(path).endswith(".json"):
        conditions = json.loads(text)["conditions"]
        return f"{conditions['machine']}, {conditions['date']}"
    date, _, machine = text.splitlines()[4].rpartition(", load")[0].partition(", ")
    return f"{machine}, {date}"


def main(arguments):
    faults = []
    if arguments[:1] == ["check"] and len(arguments) == 2:
        faults = check(read(arguments[1]), read_limits())
    elif arguments[:1] == ["limits"] and len(arguments) == 2:
        print_limits(read(arguments[1]))
    elif arguments[:1] == ["compare"] and len(arguments) == 3:
        faults = compare(read(arguments[1]), read(arguments[2]))
    else:
        sys.exit(__doc__)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Another lab's answers to the rows, as files of --csv."""

import math
import pathlib

import numpy as np

COLUMNS = ("fx", "fy", "fz", "tx", "ty", "tz", "us")


class CsvError(Exception):
    """An unusable file of --csv: file, line, expected content."""


def values_of(line, place):
    words = [word.strip() for word in line.split(",")]
    if len(words) != len(COLUMNS):
        raise CsvError(
            f"{place}: {len(words)} values; {len(COLUMNS)} are expected: {','.join(COLUMNS)}"
        )
    values = []
    for name, word in zip(COLUMNS, words):
        try:
            value = float(word)
        except ValueError:
            raise CsvError(f"{place}: '{word}' for {name}; a number is expected") from None
        if not math.isfinite(value):
            raise CsvError(f"{place}: {name} is {word}; a finite number is expected")
        if name == "us" and value < 0:
            raise CsvError(f"{place}: us is {word}; a time of 0 or more is expected")
        values.append(value)
    return values


def name_of(row):
    """Of the row's folder, and of its file."""
    return row.name.replace(" ", "_").replace("/", "_")


def check_header(file, lines, columns):
    header = [word.strip() for word in lines[0].split(",")] if lines else []
    if header != list(columns):
        raise CsvError(
            f"{file}:1: '{','.join(header)}'; the header {','.join(columns)} is expected"
        )


def lines_of_file(file, name, known):
    """Numbers and lines of one row in a file of all rows, without their first column."""
    lines = file.read_text(encoding="utf-8").splitlines()
    check_header(file, lines, ("row", *COLUMNS))
    chosen = []
    for n, line in enumerate(lines[1:], 2):
        row, _, rest = line.partition(",")
        if not known(row.strip()):
            raise CsvError(f"{file}:{n}: row '{row}'; the name of a row's folder is expected")
        if row.strip() == name:
            chosen.append((n, rest))
    return chosen


def lines_of_folder(file):
    lines = file.read_text(encoding="utf-8").splitlines()
    check_header(file, lines, COLUMNS)
    while lines[-1].strip() == "":
        lines.pop()
    return list(enumerate(lines[1:], 2))


def answer(source, row, folder):
    """Wrenches (n x 6) and times [us] of SOURCE/ROW.csv, or of ROW's lines in the file SOURCE; None
    if there are none. `folder`: the row's. CsvError if they cannot be used.
    """
    source, name = pathlib.Path(source), name_of(row)
    if source.is_file():
        file = source
        lines = lines_of_file(
            file, name, lambda other: (folder.parent / other / "poses.csv").exists()
        )
        if not lines:
            return None
    else:
        file = source / f"{name}.csv"
        if not file.exists():
            return None
        lines = lines_of_folder(file)
    table = [values_of(line, f"{file}:{n}") for n, line in lines]
    if len(table) != len(row.poses):
        last = lines[-1][0] if lines else 1
        raise CsvError(
            f"{file}:{last}: the last of {len(table)} lines of values; {len(row.poses)} are "
            "expected, one for each line of poses.csv"
        )
    table = np.array(table)
    return table[:, :6], table[:, 6]

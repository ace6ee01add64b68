"""Another lab's answers to the rows, as files of --csv."""

import math
import pathlib

import numpy as np

COLUMNS = ("fx", "fy", "fz", "tx", "ty", "tz", "us")


class CsvError(Exception):
    """A file of --csv that cannot be used: file, line, what is expected."""


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


def answer(folder, row):
    """Wrenches (n x 6) and times [us] of FOLDER/ROW.csv; None without that file. CsvError if it
    cannot be used.
    """
    file = pathlib.Path(folder) / f"{row.name.replace(' ', '_').replace('/', '_')}.csv"
    if not file.exists():
        return None
    lines = file.read_text(encoding="utf-8").splitlines()
    header = [word.strip() for word in lines[0].split(",")] if lines else []
    if header != list(COLUMNS):
        raise CsvError(
            f"{file}:1: '{','.join(header)}'; the header {','.join(COLUMNS)} is expected"
        )
    while lines[-1].strip() == "":
        lines.pop()
    table = [values_of(line, f"{file}:{n}") for n, line in enumerate(lines[1:], 2)]
    if len(table) != len(row.poses):
        raise CsvError(
            f"{file}:{len(lines)}: the last of {len(table)} lines of values; {len(row.poses)} are "
            "expected, one for each line of poses.csv"
        )
    table = np.array(table)
    return table[:, :6], table[:, 6]

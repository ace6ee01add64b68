"""Tests named in the table of hard cases and in other READMEs must exist, as a case of a test
program or as a test of ctest.

usage: check_table.py tests/hard/README.md BUILD_FOLDER [README.md ...]

Every row of the first file's table must name a test; in the other files every test name in
backticks is checked.
"""

import fnmatch
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tests/runner"))
import run_tests

# Commands and pictures are named there too: a test is Suite.Name, a program's name does not begin
# with a capital.
NAME = r"`([A-Z][\w/]*\.[A-Z*][\w*]*)`"


def rows(readme):
    """(case, names) of each row of the table that has four columns, the last of them `test`."""
    for line in readme.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 4 and not set(cells[0]) <= set("-: ") and cells[3] != "test":
            yield cells[0], re.findall(NAME, cells[3])


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def main(readme_file, build, *others):
    known = [case for cases in run_tests.all_cases(pathlib.Path(build)).values() for case in cases]
    table = list(rows(text_of(readme_file)))
    wrong = [f"'{case}' names no test." for case, names in table if not names]
    for case, names in table + [(other, re.findall(NAME, text_of(other))) for other in others]:
        for name in names:
            forms = (
                name,
                "*/" + name,
                name + "/*",
                "*/" + name + "/*",
            )  # the latter: of a test with parameters
            if not any(fnmatch.fnmatchcase(test, form) for test in known for form in forms):
                wrong.append(f"'{case}' names '{name}', which no test program has.")
    print(
        f"{len(table)} rows, {sum(len(names) for _, names in table)} names, {len(known)} tests"
        " known"
    )
    print("\n".join(wrong))
    return 1 if wrong or len(table) < 38 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

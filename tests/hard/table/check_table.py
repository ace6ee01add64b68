"""The README's table of hard cases names tests: each must exist among those that ctest knows.

usage: check_table.py README.md CTEST BUILD_FOLDER
"""
import fnmatch
import re
import subprocess
import sys


def rows(readme):
    """(case, names) of each row of the table below the heading 'Hard cases'."""
    section = readme.split("\n## Hard cases", 1)[1].split("\n## ", 1)[0]
    for line in section.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 4 and not set(cells[0]) <= set("-: ") and cells[3] != "test":
            # Commands and pictures stand there too: a test is Suite.Name.
            yield cells[0], re.findall(r"`([A-Z][\w/]*\.[\w*]+)`", cells[3])


def main(readme_file, ctest, build):
    listed = subprocess.run([ctest, "--test-dir", build, "-N"], capture_output=True, text=True, check=True).stdout
    known = re.findall(r"Test +#\d+: (\S+)", listed)
    with open(readme_file, encoding="utf-8") as file:
        table = list(rows(file.read()))
    wrong = [f"'{case}' names no test." for case, names in table if not names]
    for case, names in table:
        for name in names:
            forms = (name, "*/" + name, name + "/*", "*/" + name + "/*")  # the latter: of a test with parameters
            if not any(fnmatch.fnmatchcase(test, form) for test in known for form in forms):
                wrong.append(f"'{case}' names '{name}', which ctest does not know.")
    print(f"{len(table)} rows, {sum(len(names) for _, names in table)} names, {len(known)} tests known")
    print("\n".join(wrong))
    return 1 if wrong or len(table) < 38 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

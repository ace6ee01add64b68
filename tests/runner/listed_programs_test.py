#!/usr/bin/env python3
"""Which programs tests find: planted packages, and those of this machine."""
import pathlib
import tempfile
import unittest

import listed_programs

STATUS = """Package: dash
Essential: yes
Status: install ok installed
Depends: libc6 (>= 2.36)

Package: libc6
Status: install ok installed

Package: apt
Status: install ok installed

Package: man-db
Status: install ok installed
Pre-Depends: debconf (>= 1.2) | debconf-2.0
Depends: groff-base, pager

Package: cdebconf
Status: install ok installed
Provides: debconf-2.0

Package: groff-base
Status: install ok installed

Package: less
Status: install ok installed
Provides: pager

Package: removed
Status: deinstall ok config-files

Package: zsh
Status: install ok installed
"""


class ListedPrograms(unittest.TestCase):
    def test_leaves_out_benchmarks_and_what_pypi_has(self):
        text = (
            "# a heading\nman-db  # tests: pages\nstrace  # benchmarks: calls\npip:numpy==1  #"
            " tests: arrays\n"
        )
        self.assertEqual(listed_programs.listed(text), ["man-db"])

    def test_follows_dependencies_alternatives_and_virtual_packages(self):
        packages = listed_programs.installed(STATUS)
        self.assertNotIn("removed", packages)
        minimal = {"dash", "libc6", "apt"}
        self.assertEqual(listed_programs.closure(packages, []), minimal)
        self.assertEqual(
            listed_programs.closure(packages, ["man-db"]),
            minimal | {"man-db", "cdebconf", "groff-base", "less"},
        )

    def test_finds_man_only_with_its_package_listed(self):
        if not pathlib.Path("/var/lib/dpkg/info/man-db.list").exists():
            self.skipTest("man-db is not installed")
        with tempfile.TemporaryDirectory() as folder:
            programs = pathlib.Path(folder) / "programs"
            file = pathlib.Path(folder) / "packages.txt"
            for text, has_man in (("man-db  # tests\n", True), ("g++  # compiler\n", False)):
                file.write_text(text, encoding="utf-8")
                listed_programs.link_programs(programs, file)
                self.assertEqual((programs / "man").exists(), has_man, text)
                self.assertTrue((programs / "sh").exists())
                self.assertFalse((programs / "debootstrap").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)

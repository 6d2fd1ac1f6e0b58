#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links and tables of the pages. usage: pages_test.py TOP"""
import pathlib
import re
import sys
import tempfile
import unittest

TOP = pathlib.Path(sys.argv[1]).resolve()
MOST_WORDS, MOST_OF_README = 1500, 950
MADE = {"yaml-reference.md"}  # as long as there are keys
LINK = re.compile(r"\]\(([^)\s]+)\)")


def prose(page):
    """A page's lines that are not in a fenced or indented block."""
    fenced = False
    for number, line in enumerate(page.read_text().split("\n"), 1):
        if re.match(r"\s*```", line):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            yield number, line


def links(page):
    """Files of the project that a page links to."""
    for number, line in prose(page):
        for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
            if "://" not in target and not target.startswith(("#", "mailto:")):
                yield number, (page.parent / target.split("#")[0]).resolve()


def broken(top):
    return [f"{page.relative_to(top)}:{number}: {target}" for page in pages(top) for number, target in links(page)
            if not target.exists()]


def pages(top):
    return sorted([top / "README.md", *(top / "docs").rglob("*.md")])


def unreached(top):
    """Pages of docs/ to which no way leads from README.md."""
    seen, ahead = set(), [top / "README.md"]
    while ahead:
        page = ahead.pop()
        if page in seen or page.suffix != ".md" or not page.exists():
            continue
        seen.add(page)
        ahead += [target for _, target in links(page)]
    return [str(page.relative_to(top)) for page in pages(top) if page not in seen]


def unlinked(top):
    """Pages of docs/, without decisions, that README.md itself does not name."""
    named = {target for _, target in links(top / "README.md")}
    return [page.name for page in sorted((top / "docs").glob("*.md")) if page not in named]


def ragged(top):
    """Rows of tables with more or fewer cells than the row above."""
    found = []
    for page in pages(top):
        cells = None
        for number, line in prose(page):
            if not line.startswith("|"):
                cells = None
                continue
            count = len(re.findall(r"(?<!\\)\|", line))
            if cells is not None and count != cells:
                found.append(f"{page.relative_to(top)}:{number}: {count - 1} cells, {cells - 1} above")
            cells = count
    return found


def long_pages(top):
    """Pages with more words than somebody reads before giving up; tables and examples count."""
    found = []
    for page in pages(top):
        words, most = len(page.read_text().split()), MOST_OF_README if page == top / "README.md" else MOST_WORDS
        if words > most and page.name not in MADE:
            found.append(f"{page.relative_to(top)}: {words} words, {most} allowed")
    return found


class Pages(unittest.TestCase):
    def test_every_link_leads_to_a_file(self):
        self.assertEqual(broken(TOP), [])

    def test_every_page_is_reached_from_the_readme(self):
        self.assertEqual(unreached(TOP), [])

    def test_the_index_of_the_readme_names_every_page(self):
        self.assertEqual(unlinked(TOP), [])

    def test_tables_have_their_columns(self):
        self.assertEqual(ragged(TOP), [])

    def test_no_page_is_long(self):
        self.assertEqual(long_pages(TOP), [])

    def test_faults_are_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            top = pathlib.Path(folder).resolve()
            (top / "docs").mkdir()
            (top / "README.md").write_text("[a](docs/a.md) [gone](docs/gone.md)\n\n| x | y |\n|---|---|\n| |1| | 2 |\n")
            (top / "docs" / "a.md").write_text("`[no](link.md)` [b](b.md#part)\n")
            (top / "docs" / "b.md").write_text("| x |\n|---|\n| 1 \\| 2 |\n")
            (top / "docs" / "alone.md").write_text("alone\n")
            self.assertEqual(broken(top), [f"README.md:1: {top}/docs/gone.md"])
            self.assertEqual(unreached(top), ["docs/alone.md"])
            self.assertEqual(unlinked(top), ["alone.md", "b.md"])
            self.assertEqual(ragged(top), ["README.md:5: 4 cells, 2 above"])
            self.assertEqual(long_pages(top), [])
            for name, words in (("README.md", 951), ("docs/a.md", 1500), ("docs/b.md", 1501), ("docs/yaml-reference.md", 1501)):
                (top / name).write_text("word " * words)
            self.assertEqual(long_pages(top), ["README.md: 951 words, 950 allowed", "docs/b.md: 1501 words, 1500 allowed"])


if __name__ == "__main__":
    unittest.main(argv=["pages_test"])

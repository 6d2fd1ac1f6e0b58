# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: batch_browser_test.py MILLPOSE TOP: the index page of a batch in a headless Chromium: sorting, links, light,
dark and paper at 1400, 800 and 390 pixels."""
import pathlib
import subprocess
import sys
import unittest

MILLPOSE, TOP = sys.argv[1], pathlib.Path(sys.argv[2])
sys.path.insert(0, str(TOP / "tests/report"))
from browser_case import BrowserCase  # noqa: E402

MANIFEST = """millpose_batch: 1
jobs:
  - {{job: {top}/toolpaths/support_pad/job.yaml, name: fine, set: {{toolpath.stepover_mm: {stepover}}}}}
  - {{job: {top}/toolpaths/support_pad/job.yaml, name: coarse, set: {{toolpath.stepover_mm: 20}}}}
  - {{job: {top}/toolpaths/support_pad/job.yaml, name: broken, set: {{toolpath.stepover_mm: -1}}}}
"""


class Index(BrowserCase):
    @classmethod
    def write_pages(cls):
        def batch(out, stepover, *more):
            (cls.folder / "batch.yaml").write_text(MANIFEST.format(top=TOP, stepover=stepover))
            subprocess.run([MILLPOSE, "batch", cls.folder / "batch.yaml", "-o", cls.folder / out, "-q", *more], stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)

        batch("old", 10)
        batch("out", 12, "--baseline", cls.folder / "old")
        batch("out_de", 12, "--baseline", cls.folder / "old", "--lang", "de")
        cls.page = cls.folder / "out/index.html"

    def setUp(self):
        super().setUp()
        self.open()

    def names(self):
        return self.js("[...document.querySelectorAll('tbody')].map(b => b.rows[0].cells[0].textContent.trim())")

    def test_every_head_sorts_both_ways_and_empty_cells_stay_last(self):
        count = self.js("document.querySelectorAll('th').length")
        self.assertGreater(count, 8)
        for column in range(count):
            orders = []
            for direction in ("ascending", "descending"):
                self.js(f"document.querySelectorAll('th button')[{column}].click()")
                self.assertEqual(self.js(f"document.querySelectorAll('th')[{column}].getAttribute('aria-sort')"), direction)
                self.assertEqual(self.js("document.querySelectorAll('th[aria-sort]').length"), 1)
                orders.append(self.js(f"[...document.querySelectorAll('tbody')].map(b => b.rows[0].cells[{column}].dataset.v)"))
            numbers = [[float(v) for v in order if v not in (None, "")] for order in orders]
            if numbers[0]:
                self.assertEqual(numbers[0], sorted(numbers[0]), column)
                self.assertEqual(numbers[1], sorted(numbers[1], reverse=True), column)
                for order in orders:
                    empty = [v in (None, "") for v in order]
                    self.assertEqual(empty, sorted(empty), column)

    def test_sorting_works_by_keys(self):
        self.js("document.querySelectorAll('th button')[0].focus()")
        for kind in ("keyDown", "keyUp"):
            self.browser.call("Input.dispatchKeyEvent", type=kind, key="Enter", code="Enter", text="\r", windowsVirtualKeyCode=13)
        self.assertEqual(self.names(), ["broken", "coarse", "fine"])

    def test_what_is_told_of_a_job_stands_below_it_and_goes_with_it(self):
        told = "[...document.querySelectorAll('tbody')].map(b => b.rows.length > 1 ? b.rows[1].textContent : '')"
        self.js("document.querySelectorAll('th button')[0].click()")
        self.assertEqual(self.names(), ["broken", "coarse", "fine"])
        broken, coarse, fine = self.js(told)
        self.assertIn("toolpath.stepover_mm: given -1", broken)
        self.assertEqual(coarse, "")
        self.assertIn("toolpath.stepover_mm: 10 -> 12", fine)
        # Differences from the baseline are folded: no job takes a screen of its own.
        self.assertLess(self.js("document.body.offsetHeight"), 500)

    def test_every_figure_is_on_paper_and_in_a_narrow_window(self):
        for page in (self.page, self.folder / "out_de/index.html"):
            for width, paper in ((1400, False), (800, False), (390, False), (718, True)):
                self.browser.media("light", paper=paper)
                self.browser.size(width, 900)
                self.browser.open(page.as_uri())
                cut = self.js("[...document.querySelectorAll('td')].filter(c => { const r = c.getBoundingClientRect(); return r.width > 0 && "
                              "(r.right > innerWidth || c.scrollWidth > c.clientWidth + 1); }).map(c => c.textContent)")
                self.assertEqual(cut, [], (page.parent.name, width, paper))

    def test_a_link_opens_the_report(self):
        self.browser.open((self.page.parent / "fine/report.html").as_uri())
        self.assertEqual(self.js("document.querySelector('#job').textContent"), self.js("millpose.data.job"))
        self.assertGreater(self.js("millpose.data.timeline.seconds"), 10)

    def test_fits_every_window_in_light_and_dark_and_on_paper(self):
        grounds = set()
        for look in ("light", "dark", "paper"):
            self.assert_fits("index", looks=(look,))
            grounds.add(self.js("getComputedStyle(document.body).backgroundColor"))
        self.assertEqual(len(grounds), 3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

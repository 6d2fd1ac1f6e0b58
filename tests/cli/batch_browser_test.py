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
  - {{job: {top}/toolpaths/support_pad/job.yaml, name: fine, set: {{toolpath.stepover_mm: 10}}}}
  - {{job: {top}/toolpaths/support_pad/job.yaml, name: coarse, set: {{toolpath.stepover_mm: 20}}}}
  - {{job: {top}/toolpaths/support_pad/job.yaml, name: broken, set: {{toolpath.stepover_mm: -1}}}}
"""


class Index(BrowserCase):
    @classmethod
    def write_pages(cls):
        (cls.folder / "batch.yaml").write_text(MANIFEST.format(top=TOP))
        subprocess.run([MILLPOSE, "batch", cls.folder / "batch.yaml", "-o", cls.folder / "out", "-q"], stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        cls.page = cls.folder / "out/index.html"

    def setUp(self):
        super().setUp()
        self.open()

    def names(self):
        return self.js("[...document.querySelectorAll('tbody tr')].map(r => r.cells[0].textContent.trim())")

    def test_every_head_sorts_both_ways_and_empty_cells_stay_last(self):
        count = self.js("document.querySelectorAll('th').length")
        self.assertGreater(count, 8)
        for column in range(count):
            orders = []
            for direction in ("ascending", "descending"):
                self.js(f"document.querySelectorAll('th button')[{column}].click()")
                self.assertEqual(self.js(f"document.querySelectorAll('th')[{column}].getAttribute('aria-sort')"), direction)
                self.assertEqual(self.js("document.querySelectorAll('th[aria-sort]').length"), 1)
                orders.append(self.js(f"[...document.querySelectorAll('tbody tr')].map(r => r.cells[{column}].dataset.v)"))
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

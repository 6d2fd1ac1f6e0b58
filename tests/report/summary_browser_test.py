# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: summary_browser_test.py WRITE_REPORT_PANEL: the two pages that are signed, in a headless Chromium: nothing is cut
off on paper, whatever the plan is, and nothing needs to be scrolled sideways on a screen."""
import subprocess
import sys
import unittest

from browser_case import BrowserCase

LANGUAGES = ("en", "de", "zh")
SIZES = ((1, 3), (3, 60), (8, 12), (40, 25), (200, 400))  # entries of each list, words of a sentence

# How far the last thing of each page ends above what stands at its foot, px.
ROOM = """[...document.querySelectorAll('.page')].map((page) => { const foot = page.querySelector('.bottom') || page.querySelector('footer');
    const others = [...page.children].filter((e) => !e.matches('footer, .bottom'));
    return foot.getBoundingClientRect().top - Math.max(...others.map((e) => e.getBoundingClientRect().bottom)); })"""
# What is wider than the page's own column.
WIDE = "[...document.querySelectorAll('.page > *')].filter((e) => e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX === 'visible').map((e) => e.className || e.tagName)"


class Summary(BrowserCase):
    @classmethod
    def write_pages(cls):
        cls.pages = {}
        for language in LANGUAGES:
            for many, words in SIZES:
                page = cls.pages[language, many, words] = cls.folder / f"{language}_{many}_{words}.html"
                page.write_text(subprocess.run([sys.argv[1], "--summary", language, str(many), str(words)], capture_output=True, text=True, check=True).stdout)

    def test_nothing_is_cut_off_on_paper(self):
        self.browser.media("light", paper=True)
        self.browser.size(794, 1123)  # A4
        for key, page in self.pages.items():
            self.page = page
            self.open()
            for number, room in enumerate(self.js(ROOM)):
                self.assertGreater(room, -1, (key, number))
            self.assertEqual(self.js(WIDE), [], key)
            self.keep(f"summary_{'_'.join(map(str, key))}_paper.png", self.browser.screenshot())

    def test_fits_every_window(self):
        for language in LANGUAGES:
            self.page = self.pages[language, 8, 12]
            self.assert_fits(f"summary_{language}")


if __name__ == "__main__":
    unittest.main(argv=["summary_browser_test.py"])

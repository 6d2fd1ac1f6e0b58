# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: operations_browser_test.py MILLPOSE TOP: the report of a job of several operations in a headless Chromium: its tabs and
what stands behind them, narrow windows, light, dark and paper."""
import sys
import unittest

from cli_fixture import TOP, run
from operations_sample import CELL, FOLDERS, small

sys.path.insert(0, str(TOP / "tests/report"))
from browser_case import BrowserCase  # noqa: E402

SELECTED = "[...document.querySelectorAll('[role=tab]')].map(t => [t.getAttribute('aria-selected'), t.tabIndex, t === document.activeElement])"


class OperationsReport(BrowserCase):
    @classmethod
    def write_pages(cls):
        (cls.folder / "cell.yaml").write_text(CELL)
        (cls.folder / "job.yaml").write_text(small())
        planned = run("plan", cls.folder / "job.yaml", "-o", cls.folder / "out", "-q")
        assert planned.returncode == 0, planned.stderr
        cls.page = cls.folder / "out/report.html"

    def setUp(self):
        super().setUp()
        self.open()

    def open(self):
        super().open()
        self.assert_shows(0)

    def assert_shows(self, number):
        """The tab is the one that is selected, and the frame has that operation's report, at work."""
        report = (self.page.parent / "operations" / FOLDERS[number] / "report.html").as_uri()
        self.browser.wait("document.readyState === 'complete'")
        url, self.inside = self.in_frame(report)
        self.assertEqual(self.browser.evaluate("millpose.data.job", **self.inside), FOLDERS[number][3:])
        self.assertEqual(self.js("document.querySelector('iframe').title"), FOLDERS[number][3:])
        selected = self.js(SELECTED)
        self.assertEqual([s[0] for s in selected], ["true" if i == number else "false" for i in range(len(FOLDERS))])
        self.assertEqual([s[1] for s in selected], [0 if i == number else -1 for i in range(len(FOLDERS))])
        return selected

    def in_frame(self, report):
        for _ in range(600):
            self.browser.frames()
            url, inside = self.browser.frame()
            if url == report:
                self.browser.wait("document.body && document.body.classList.contains('ready')", **inside)
                return url, inside
        raise AssertionError(f"the frame never shows {report}, but {url}")

    def test_tabs_by_click(self):
        for number in (2, 0, 1):
            self.browser.click_on(f"[role=tab]:nth-child({number + 1})")
            self.assert_shows(number)
        before = self.browser.evaluate("millpose.selected", **self.inside)
        self.browser.evaluate("document.querySelector('#next').click()", **self.inside)
        self.assertEqual(self.browser.evaluate("millpose.selected", **self.inside), before + 1)

    def test_tabs_by_arrow_keys_go_round(self):
        self.js("document.querySelector('[role=tab]').focus()")
        for key, number in (("ArrowRight", 1), ("ArrowRight", 2), ("ArrowRight", 0), ("ArrowLeft", 2), ("ArrowLeft", 1)):
            self.browser.key(key)
            self.assertTrue(self.assert_shows(number)[number][2], "the tab has the focus")

    def test_a_name_in_the_table_opens_the_report_itself(self):
        self.browser.click_on("tbody tr:nth-child(2) a")
        self.browser.wait("window.millpose && document.body.classList.contains('ready')")
        self.assertEqual(self.js("millpose.data.job"), FOLDERS[1][3:])

    def test_fits_every_window_in_light_and_dark(self):
        grounds = set()
        for look in ("light", "dark"):
            self.assert_fits("operations", looks=(look,))
            grounds.add(self.js("getComputedStyle(document.body).backgroundColor"))
            self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth - innerWidth", **self.inside), 0, look)
        self.assertEqual(len(grounds), 2)

    def test_paper_has_the_table_alone(self):
        self.browser.media(paper=True)
        display = "[...document.querySelectorAll('table, iframe, [role=tablist]')].map(e => getComputedStyle(e).display)"
        self.assertEqual(self.js(display), ["table", "none", "none"])
        self.browser.size(718, 900)
        self.assertLessEqual(self.js("document.querySelector('table').getBoundingClientRect().right"), 718)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

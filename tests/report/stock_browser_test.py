# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: stock_browser_test.py MILLPOSE TOP: plays the material of a roughed block in its report."""
import json
import pathlib
import subprocess
import sys
import unittest

from browser_case import BrowserCase

MILLPOSE, TOP = sys.argv[1], pathlib.Path(sys.argv[2])

# Volume of what is drawn, cm³: prisms on the lattice's lines, from the corners on the graphics card.
DRAWN = """(() => { const s = millpose.views.scene.stock, p = s.position, n = s.count, a = s.raw.along; let sum = 0;
    for (let i = 0; i < n; ++i) if (s.stands(i)) sum += p[3 * (n + i) + a] - p[3 * i + a];
    return sum * s.raw.spacing_mm ** 2 / 1000; })()"""


class StockInBrowser(BrowserCase):
    @classmethod
    def write_pages(cls):
        out = cls.folder / "out"
        subprocess.run([MILLPOSE, "plan", TOP / "toolpaths/support_rough/job.yaml", "-o", out, "-q"], check=True,
                       stdout=subprocess.DEVNULL)
        cls.page = out / "report.html"
        cls.stock = json.loads((out / "summary.json").read_text())["stock"]

    def setUp(self):
        super().setUp()
        self.open()

    def tick(self):
        self.js("document.querySelector('#show-stock').click()")

    def seek(self, seconds):
        self.js(f"""(() => {{ const s = document.querySelector('#time'); s.value = {seconds};
            s.dispatchEvent(new Event('input')); }})()""")
        self.browser.settle()

    def test_it_is_hidden_at_first_and_shown_on_request(self):
        self.assertFalse(self.js("millpose.views.scene.groups.stock.visible"))
        self.assertFalse(self.js("document.querySelector('#show-stock').checked"))
        before = self.colours_of("#view")
        self.tick()
        self.browser.settle()
        self.assertTrue(self.js("millpose.views.scene.groups.stock.visible"))
        self.assertNotEqual(self.colours_of("#view"), before)
        self.assertGreater(self.js("document.querySelector('#stock-scale').getBoundingClientRect().height"), 20)

    def test_it_falls_to_what_the_summary_says(self):
        self.tick()
        total = self.js("millpose.data.timeline.seconds")
        self.seek(0)
        blank = self.js(DRAWN)
        drawn = [blank]
        for k in range(1, 11):
            self.seek(total * k / 10)
            drawn.append(self.js(DRAWN))
        self.assertEqual(drawn, sorted(drawn, reverse=True))
        self.assertGreater(len(set(drawn)), 6)
        removed = self.stock["removed_cm3"]
        self.assertAlmostEqual(blank - drawn[-1], removed, delta=0.01 * removed)
        self.assertRegex(self.text("#removed"), r"^(\d+\.\d) of \1 cm³ milled off$")
        self.keep("stock_end.png", self.browser.screenshot("#scene"))

    def test_back_and_forth_it_is_the_same(self):
        self.tick()
        total = self.js("millpose.data.timeline.seconds")
        steps = "Array.from(millpose.views.scene.stock.steps).join()"
        self.seek(0.4 * total)
        at = self.js(steps)
        self.keep("stock_middle.png", self.browser.screenshot("#scene"))
        self.seek(total)
        self.assertNotEqual(self.js(steps), at)
        self.seek(0.4 * total)
        self.assertEqual(self.js(steps), at)

    def test_nothing_is_gouged_and_little_is_left(self):
        self.tick()
        self.seek(self.js("millpose.data.timeline.seconds"))
        over = self.js("""(() => { const s = millpose.views.scene.stock, all = [];
            for (let i = 0; i < s.count; ++i) { const o = s.over(i); if (o.length) all.push(...o); } return all; })()""")
        self.assertGreater(len(over), 1000)
        self.assertGreater(min(over), -0.05)

    def test_the_first_play_shows_it(self):
        self.js("document.querySelector('#speed').value = '1'")
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", key=" ")
        self.assertTrue(self.js("document.querySelector('#show-stock').checked"))
        self.browser.key(" ")
        self.tick()  # off again, and so it stays
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", key=" ")
        self.assertFalse(self.js("document.querySelector('#show-stock').checked"))
        self.browser.key(" ")


if __name__ == "__main__":
    sys.argv = sys.argv[:1]
    unittest.main()

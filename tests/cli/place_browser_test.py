# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: place_browser_test.py MILLPOSE TOP: placement.html in a headless Chromium at 1400, 800 and 390 pixels, light, dark and paper."""
import pathlib
import subprocess
import sys
import unittest

MILLPOSE, TOP = sys.argv[1], pathlib.Path(sys.argv[2])
sys.path.insert(0, str(TOP / "tests/report"))
from browser_case import BrowserCase  # noqa: E402

PLACEMENT = """placement:
  x_mm: {from: 1700, to: 2300}
  z_mm: {from: 700, to: 1500}
  points: 5
  places: 30
  plans: 2
  map_points: 3
"""


class Placement(BrowserCase):
    @classmethod
    def write_pages(cls):
        sample = TOP / "toolpaths/support_pad"
        text = (sample / "job.yaml").read_text().replace("../../cells", str(TOP / "cells")).replace("mesh: support_pad", f"mesh: {sample}/support_pad")
        (cls.folder / "job.yaml").write_text(text + PLACEMENT)
        for language in ("en", "de", "zh"):
            subprocess.run([MILLPOSE, "place", cls.folder / "job.yaml", "-o", cls.folder / language, "-q", "--set", "toolpath.stepover_mm=40",
                            "--set", "toolpath.spacing_mm=40", "--lang", language], stdout=subprocess.DEVNULL, check=True)
        cls.page = cls.folder / "en/placement.html"

    def test_fits_every_window_in_light_and_dark_and_on_paper(self):
        for look in ("light", "dark", "paper"):
            self.assert_fits("placement", looks=(look,))

    def test_fits_narrow_windows_in_every_language(self):
        for language in ("en", "de", "zh"):
            for width in (901, 390, 320):
                self.browser.size(width, 900)
                self.browser.open((self.folder / language / "placement.html").as_uri())
                self.assertLessEqual(self.js("document.documentElement.scrollWidth"), width, language)

    def test_every_figure_is_seen_with_its_head(self):
        heads = self.columns()
        self.assertGreater(len(heads), 8)
        for width in (1400, 901, 900, 800, 390, 320):
            self.browser.size(width, 900)
            self.open()
            hidden = self.js("[...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth + 1).length")
            self.assertEqual(hidden, 0, f"a table is scrolled sideways at {width}")
            narrow = self.js("getComputedStyle(document.querySelector('.plans thead')).display") == "none"
            self.assertEqual(narrow, width <= 900)
            shown = self.js("[...document.querySelector('.plans tbody tr').cells].slice(1).map(c => getComputedStyle(c, '::before').content)")
            self.assertEqual(shown, [f'"{head}"' for head in heads[1:]] if narrow else ["none"] * (len(heads) - 1))

    def columns(self):
        self.open()
        return self.js("[...document.querySelectorAll('.plans thead th')].slice(0, document.querySelector('.plans tbody tr').cells.length)"
                       ".map(c => c.textContent)")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

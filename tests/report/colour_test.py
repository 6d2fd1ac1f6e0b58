# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: colour_test.py lib/report/web: the colours of report.html are distinguished by people who do not tell red from
green, and are seen against their ground, in light and in dark."""
import pathlib
import re
import sys
import unittest

from colour_sight import KINDS, contrast, difference, least_difference

WEB = pathlib.Path(sys.argv[1])
THEMES = {theme: dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})\b", body)) for theme, body in
          re.findall(r':root\[data-theme="(\w+)"\] \{(.*?)\n\}', (WEB / "style.css").read_text(), re.DOTALL)}
SERIES = ["s1", "s2", "s3", "s4", "s5", "s6"]
STATES = ["reach", "limit", "singular", "admissible"]
LEAST = 15  # ΔE2000; today's page had 2.5 (violet and blue, protanopia)


class Colours(unittest.TestCase):
    def test_the_formula_gives_the_published_values(self):
        for first, second, expected in (((50, 2.6772, -79.7751), (50, 0, -82.7485), 2.0425),
                                        ((50, 2.5, 0), (58, 24, 15), 19.4535),
                                        ((22.7233, 20.0904, -46.6940), (23.0331, 14.9730, -42.5619), 2.0373),
                                        ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082)):
            self.assertAlmostEqual(difference(first, second), expected, places=4)

    def test_the_simulation_makes_red_and_green_alike(self):
        red, green = "#b04020", "#607010"
        self.assertGreater(least_difference([red, green], "normal")[0], 35)
        self.assertLess(least_difference([red, green], "deuteranopia")[0], 10)

    def test_both_themes_have_the_same_colours(self):
        self.assertEqual(set(THEMES), {"light", "dark"})
        self.assertEqual(set(THEMES["light"]), set(THEMES["dark"]))

    def test_what_stands_side_by_side_is_told_apart(self):
        for theme, colours in THEMES.items():
            for names in (SERIES + ["ink"], STATES, ["gap", "lead", "bad"]):
                for kind in ("normal", "protanopia", "deuteranopia"):
                    least, *pair = least_difference([colours[n] for n in names], kind)
                    print(f"{theme} {names[0]}… {kind}: {least:.1f}", *pair)
                    self.assertGreater(least, LEAST, (theme, kind, pair))

    def test_limits_and_singularities_of_the_axis_map_are_told_apart(self):
        text = (WEB / "map_paint.js").read_text()
        limits = re.findall(r'style\("(#\w+)"', re.search(r"LIMITS = \[(.*?)\];", text, re.DOTALL)[1])
        singular = re.search(r'SINGULAR = style\("(#\w+)"', text)[1]
        self.assertEqual(len(limits), 6)
        for kind in KINDS:
            for limit in limits:
                self.assertGreater(least_difference([limit, singular], kind)[0], LEAST, (kind, limit))

    def test_everything_is_seen_against_its_ground(self):
        for theme, colours in THEMES.items():
            for name, least in [(n, 3) for n in SERIES + ["gap", "lead", "near"]] + [(n, 4.5) for n in ("ink", "muted", "bad", "accent")]:
                self.assertGreater(contrast(colours[name], colours["card"]), least, (theme, name))
            self.assertGreater(contrast(colours["accent-ink"], colours["accent"]), 4.5, theme)
            self.assertGreater(contrast(colours["warn-ink"], colours["warn"]), 4.5, theme)

    def test_no_script_has_colours_of_its_own(self):
        """But for what does not change with the theme: viridis, the axis map and the bodies."""
        for script in sorted(WEB.glob("*.js")):
            if script.name in ("colour.js", "map_paint.js", "map_plot.js"):
                continue
            self.assertEqual(re.findall(r'"#[0-9a-fA-F]{3,6}"', script.read_text()), [], script.name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

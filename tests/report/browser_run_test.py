# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: browser_run_test.py WRITE_REPORT_PANEL: plays a report's run, and looks at it in the dark, on paper and by
keys alone."""
import base64
import math
import re
import subprocess
import sys
import unittest

from browser_case import BrowserCase, colours

PASSES, POINTS = 12, 40


class RunInBrowser(BrowserCase):
    @classmethod
    def write_pages(cls):
        cls.page = cls.folder / "report.html"
        subprocess.run([sys.argv[1], str(PASSES), str(POINTS), cls.page], check=True)

    def setUp(self):
        super().setUp()
        self.open("#point=53")

    def seek(self, seconds):
        self.js(f"""(() => {{ const s = document.querySelector('#time'); s.value = {seconds};
            s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); }})()""")
        self.browser.settle()

    # Time

    def test_the_slider_moves_the_arm_along_the_plan(self):
        total = self.js("millpose.data.timeline.seconds")
        self.assertGreater(total, 60)
        self.assertEqual(float(self.js("document.querySelector('#time').max")), total)
        time = self.js("millpose.views.player.line.timeOfRow[100]")
        self.seek(time)
        self.assertEqual(self.js("millpose.selected"), 100)
        self.assertIn("pass 2, cutting", self.text("#doing"))
        # The arm that is drawn stands where the time law has it, half-way to the next point too.
        after = self.js("millpose.views.player.line.timeOfRow[101]")
        drawn = """(() => { const m = millpose, s = m.views.scene; const p = s.skeleton.geometry.attributes.position.array;
            return Array.from(p.slice(-3)); })()"""
        self.seek(0.5 * (time + after))
        tip = self.js(drawn)
        ends = self.js("[millpose.place(millpose.data, 100), millpose.place(millpose.data, 101)]")
        for k in range(3):
            self.assertAlmostEqual(tip[k], 0.5 * (ends[0][k] + ends[1][k]), delta=0.5)
        self.keep("time.png", self.browser.screenshot("#scene"))

    def test_a_selected_point_sets_the_time(self):
        self.open("#point=85")
        self.assertAlmostEqual(float(self.js("document.querySelector('#time').value")),
                               self.js("millpose.views.player.line.timeOfRow[85]"), places=3)
        self.browser.key(".")
        self.assertIn("cutting", self.text("#doing"))
        self.assertGreater(self.js("millpose.selected"), 84)

    def test_play_runs_and_pauses_at_a_point(self):
        self.open("#point=41")
        self.js("document.querySelector('#speed').value = '1'")
        before = self.js("millpose.views.player.seconds")
        # Not key(): while it plays there is always something to draw, and it would wait for the end.
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", key=" ")
        self.assertEqual(self.text("#play"), "❚❚")
        self.browser.wait(f"millpose.views.player.seconds > {before} + 0.5")
        self.browser.key(" ")
        self.assertEqual(self.text("#play"), "▶")
        stood = self.js("millpose.views.player.seconds")
        self.browser.frames()
        self.assertEqual(self.js("millpose.views.player.seconds"), stood)
        self.assertLessEqual(self.js("millpose.views.player.line.timeOfRow[millpose.selected]"), stood + 30)

    def test_gaps_are_drawn_and_can_be_hidden(self):
        names = self.js("millpose.views.scene.groups.gaps.children.map(c => c.name)")
        self.assertEqual(sorted(names), ["bad", "gap", "lead"])
        # Every piece of line ends where the one after begins, from home to home, but for cuts and the leap.
        ends = self.js("""(() => { const line = millpose.views.player.line, n = line.raw.time.length;
            const home = millpose.armFrames(millpose.data, millpose.data.home_deg)[7];
            return [line.tip(0), line.tip(n - 1)].map(p => Math.hypot(p[0] - home[3], p[1] - home[7], p[2] - home[11])); })()""")
        self.assertLess(max(ends), 0.1)
        shown = self.browser.screenshot("#view canvas")
        self.browser.click_on("#show-gaps")
        self.assertNotEqual(self.browser.screenshot("#view canvas"), shown)

    def test_leads_are_rings_and_no_worst_place(self):
        rings = self.js("""(() => { const kinds = [...millpose.data.rows.kind];
            const points = millpose.views.scene.scene.children.find(c => c.isPoints);
            return [kinds.filter(k => k !== 0).length, [...points.geometry.attributes.ring.array].filter((r, i) => r !== (kinds[i] ? 1 : 0)).length]; })()""")
        self.assertEqual(rings, [2 * PASSES, 0])
        kinds = "[...document.querySelectorAll('#worst tbody tr')].map(r => millpose.data.rows.kind[r.dataset.row])"
        for key in ("objective", "clearance", "limit_reserve", "lambda_n"):
            self.js(f"""(() => {{ const s = document.querySelector('#index'); s.value = '{key}'; s.dispatchEvent(new Event('change')); }})()""")
            self.assertEqual(set(self.js(kinds)), {0}, key)
        self.assertIn("cuts alone", self.text("#worst-note"))
        before = self.js("[...document.querySelectorAll('#worst tbody tr')].map(r => r.dataset.row)")
        self.browser.click_on("#with-leads")
        self.assertIn("among them", self.text("#worst-note"))
        self.assertNotEqual(self.js("[...document.querySelectorAll('#worst tbody tr')].map(r => r.dataset.row)"), before)

    # What stands in the view

    def test_the_triad_shows_the_worlds_axes(self):
        def axes():
            return self.js("""['x', 'y', 'z'].map(a => { const e = document.querySelector('#triad .axis-' + a);
                return [e.getAttribute('x2') - 42, e.getAttribute('y2') - 42]; })""")
        def seen():
            return self.js("""(() => { const s = millpose.views.scene, o = s.orbit.target; const at = (p) => s.onScreen(p);
                const c = at([o.x, o.y, o.z]); return [[1,0,0],[0,1,0],[0,0,1]].map(d => { const p = at([o.x + d[0], o.y + d[1], o.z + d[2]]);
                return [p[0] - c[0], p[1] - c[1]]; }); })()""")
        before = axes()
        for _ in range(2):
            for drawn, real in zip(axes(), seen()):
                self.assertGreater(drawn[0] * real[0] + drawn[1] * real[1], 0.97 * (drawn[0] ** 2 + drawn[1] ** 2) ** 0.5 * (real[0] ** 2 + real[1] ** 2) ** 0.5)
            self.browser.key("ArrowRight", modifiers=8)
        self.assertNotEqual(axes(), before)
        self.assertEqual(sorted(self.js("[...document.querySelectorAll('#triad text')].map(e => e.textContent)")), ["x", "y", "z"])

    def test_the_nearest_pair_is_named_and_a_line_shows_its_distance(self):
        hidden = "['.marker.near', '#nearest-line'].map(e => document.querySelector(e).style.display)"
        near = self.js("[...millpose.data.nearest.pair].findIndex(p => p > 1)")
        self.open(f"#point={near}")
        names = self.js(f"millpose.nearestAt(millpose.data, {near}).names")
        self.assertEqual(self.text("#nearest-pair"), " – ".join(names))
        self.assertIn(" – ".join(names), self.text(".marker.near"))
        ends = self.js(f"millpose.nearestAt(millpose.data, {near}).ends")
        distance = self.js(f"millpose.data.column.clearance.values[{near}]")
        self.assertAlmostEqual(math.dist(*ends), distance, delta=0.01)
        self.assertIn(f"{distance:.2f}\u202fmm", self.text(".marker.near"))
        places = self.js(f"{ends}.flatMap(end => millpose.views.scene.onScreen(end).slice(0, 2))")
        self.assertGreater(math.dist(places[:2], places[2:]), 2)
        line = self.js("""['x1', 'y1', 'x2', 'y2'].map(name => Number(document.querySelector('#nearest-line line:not(.under)').getAttribute(name)))""")
        mark = self.js("""(() => { const t = new DOMMatrix(getComputedStyle(document.querySelector('.marker.near')).transform); return [t.e, t.f]; })()""")
        for k in range(4):
            self.assertAlmostEqual(line[k], places[k], delta=0.5)
            self.assertAlmostEqual(mark[k % 2], 0.5 * (places[k % 2] + places[k % 2 + 2]), delta=1)
        for width in (390, 800, 1400):
            self.browser.size(width, 900)
            self.browser.settle()
            view, label = self.js("""['#view', '.marker.near span'].map(e => { const b = document.querySelector(e).getBoundingClientRect(); return [b.left, b.right, b.top, b.bottom]; })""")
            self.assertTrue(view[0] <= label[0] and label[1] <= view[1] and view[2] <= label[2] and label[3] <= view[3], (width, view, label))
        shown = self.browser.screenshot("#view")
        self.keep("nearest.png", shown)
        ink = tuple(int(self.js("millpose.theme.near")[k:k + 2], 16) for k in (1, 3, 5))
        self.browser.click_on("#show-nearest")
        self.assertGreater(colours(shown)[ink], self.colours_of("#view")[ink] + 20)
        self.assertEqual(self.js(hidden), ["none", "none"])
        far = self.js("[...millpose.data.nearest.pair].indexOf(1)")
        self.open(f"#point={far}")
        self.assertIn("none within", self.text("#nearest-pair"))
        self.assertEqual(self.js(hidden), ["none", "none"])

    # Light, dark, paper

    def test_dark_as_the_system_says_until_the_button_is_pressed(self):
        card = "getComputedStyle(document.querySelector('.card')).backgroundColor"
        self.assertEqual(self.js(card), "rgb(255, 255, 255)")
        self.browser.media("dark")
        self.assertEqual(self.js(card), "rgb(27, 33, 39)")
        series = tuple(int(self.js("millpose.SERIES[0]")[k:k + 2], 16) for k in (1, 3, 5))
        self.assertEqual(series, (0x0a, 0xa6, 0xb3))
        self.assertIn(series, self.colours_of(".chart canvas"))
        self.assertNotIn((255, 255, 255), self.colours_of(".chart canvas"))
        self.browser.click_on("#theme")
        self.assertEqual(self.js(card), "rgb(255, 255, 255)")
        self.browser.media("light")
        self.browser.media("dark")
        self.assertEqual(self.js(card), "rgb(255, 255, 255)")

    def test_paper_shows_everything_in_light(self):
        self.browser.media("dark")
        self.browser.media("dark", paper=True)
        self.assertEqual(self.js("getComputedStyle(document.querySelector('.card')).backgroundColor"), "rgb(255, 255, 255)")
        self.browser.size(718, 900)
        self.browser.settle()
        self.assertEqual(self.js("[...document.querySelectorAll('details')].filter(d => !d.open).length"), 0)
        cut = self.js("""[...document.querySelectorAll('main *')].filter(e => { const s = getComputedStyle(e);
            return s.display !== 'none' && s.overflowY !== 'visible' && s.overflowY !== 'clip' && e.id !== 'view' && e.scrollHeight > e.clientHeight + 1; }).map(e => e.id || e.className)""")
        self.assertEqual(cut, [])
        wide = self.js("[...document.querySelectorAll('.card canvas, .card img')].filter(e => e.getBoundingClientRect().right > 719).length")
        self.assertEqual(wide, 0)
        picture = self.js("(() => { const i = document.querySelector('#view img.paper'); return [i.naturalWidth, i.naturalHeight, getComputedStyle(i).display, i.src]; })()")
        self.assertEqual(picture[:3], [1400, 840, "block"])
        self.assertGreater(len(colours(base64.b64decode(picture[3].split(",")[1]))), 500)
        self.keep("paper.png", self.browser.screenshot())
        self.browser.media("dark")
        self.assertIsNone(self.js("document.querySelector('#view img.paper')"))
        self.assertGreater(self.js("[...document.querySelectorAll('details')].filter(d => !d.open).length"), 1)
        self.assertEqual(self.js("getComputedStyle(document.querySelector('.card')).backgroundColor"), "rgb(27, 33, 39)")

    def test_prints_to_pdf(self):
        data = base64.b64decode(self.browser.call("Page.printToPDF", preferCSSPageSize=True)["data"])
        self.keep("report.pdf", data)
        pages = len(re.findall(rb"/Type\s*/Page\b", data))
        self.assertGreaterEqual(pages, 3)
        self.assertLessEqual(pages, 9)
        self.assertGreater(len(re.findall(rb"/Subtype\s*/Image", data)), 12)  # the view and the charts
        self.assertIsNone(self.js("document.querySelector('#view img.paper')"))

    # Keys

    def test_every_key_does_what_the_list_says(self):
        listed = self.js("[...document.querySelectorAll('#keys kbd')].map(e => e.textContent)")
        self.assertEqual(len(self.js("millpose.KEYS")), 20)
        for name in ("w", "f", "a", "d", "?", ",", ".", "+", "-", "space", "Home", "End"):
            self.assertIn(name, listed)
        for key, row in (("Home", 0), ("End", PASSES * POINTS - 1), ("PageUp", (PASSES - 2) * POINTS), ("PageDown", (PASSES - 1) * POINTS)):
            self.browser.key(key)
            self.assertEqual(self.js("millpose.selected"), row, key)
        self.browser.key("w")
        self.assertEqual(self.js("millpose.selected"), self.js("millpose.views.worst.places[0]"))
        distance = self.js("millpose.views.scene.orbit.distance")
        self.browser.key("+")
        self.assertLess(self.js("millpose.views.scene.orbit.distance"), distance)
        self.browser.key("-")
        self.assertAlmostEqual(self.js("millpose.views.scene.orbit.distance"), distance, places=6)
        self.browser.key("a")
        self.assertNotAlmostEqual(self.js("millpose.views.scene.orbit.distance"), distance)
        self.browser.key("f")
        self.assertAlmostEqual(self.js("millpose.views.scene.orbit.distance"), distance)
        self.browser.key("?")
        self.assertTrue(self.js("document.querySelector('#keys').open"))
        self.browser.key("d")
        self.assertEqual(self.js("document.documentElement.dataset.theme"), "dark")

    def test_a_key_redraws_no_curve_and_nothing_off_the_screen_at_once(self):
        """What makes a key slow where there is no graphics card; tests/report/opening_cost.py measures it."""
        self.js("""(() => { millpose.QUIET = 1e6; window.drawn = {base: 0, off: 0};
            for (const c of millpose.views.charts.charts) {
              const base = c.drawBase.bind(c), draw = c.draw.bind(c);
              c.drawBase = () => { ++drawn.base; base(); };
              c.draw = () => { const b = c.box.getBoundingClientRect(); if (b.top > innerHeight + 200) ++drawn.off; draw(); };
            } })()""")
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight")
        self.browser.frames()
        self.assertEqual(self.js("drawn"), {"base": 0, "off": 0})
        self.js("millpose.QUIET = 0")
        self.browser.key("ArrowRight")
        self.assertGreater(self.js("drawn.off"), 8)  # they follow


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: check_browser_test.py MILLPOSE TOP: opens what `millpose check --view` writes for a job, a cell and a part
in a headless Chromium and clicks in it."""
import json
import pathlib
import subprocess
import sys
import unittest

from browser_case import BrowserCase
from browser_language_test import AS_IS, READ

MILLPOSE, TOP = sys.argv[1], pathlib.Path(sys.argv[2])


class CheckInBrowser(BrowserCase):
    @classmethod
    def write_pages(cls):
        cls.pages = {}
        for name, what in (("job", cls.narrow_job(cls.folder)), ("cell", TOP / "cells/ur10e.yaml"), ("part", TOP / "toolpaths/cabin_ring/cabin_ring.stl"),
                           ("step", TOP / "tests/fuzz/seeds/step/patch.step"), ("rough", TOP / "toolpaths/support_rough/job.yaml")):
            cls.pages[name] = cls.folder / f"{name}.html"
            subprocess.run([MILLPOSE, "check", what, "--view", cls.pages[name], "-q"], stdout=subprocess.DEVNULL)

    @classmethod
    def narrow_job(cls, folder):
        """support_pad with a cell whose A5 does not reach every point."""
        cell = (TOP / "cells/kr500_r2830.yaml").read_text()
        of_a5 = "[-120, 120]"
        assert cell.count(of_a5) == 1
        cell = cell.replace(of_a5, "[-45, 45]")
        (folder / "cell.yaml").write_text(cell)
        text = (TOP / "toolpaths/support_pad/job.yaml").read_text()
        (folder / "job.yaml").write_text(text.replace("../../cells/kr500_r2830.yaml", "cell.yaml"))
        (folder / "support_pad.stl").write_bytes((TOP / "toolpaths/support_pad/support_pad.stl").read_bytes())
        return folder / "job.yaml"

    def open(self, name):
        self.page = self.pages[name]
        super().open()

    def picked(self):
        return dict(self.js("[...document.querySelectorAll('#picked tr')].map(r => [r.children[0].textContent, r.children[1].textContent])"))

    def click_at(self, place):
        """A place in P, seen in the 3-D view."""
        x, y = self.js(f"""(() => {{ const s = millpose.views.scene, at = new THREE.Vector3(...{place}).applyMatrix4(new THREE.Matrix4().set(...millpose.data.X_WP));
            const [x, y] = s.onScreen(at.toArray()), b = document.querySelector('#view').getBoundingClientRect(); return [x + b.x, y + b.y]; }})()""")
        self.browser.click(x, y)

    def test_a_click_names_the_face(self):
        self.open("part")
        self.js("document.querySelector('#show-edges').click()")
        # The first face that is turned to the eye and not hidden.
        number, place = self.js("""(() => { const s = millpose.views.scene, p = millpose.views.parts;
            for (const f of millpose.data.part.faces) { const [x, y] = s.onScreen(f.place_mm), hit = p.at(x, y); if (hit && hit.face === f.number - 1) return [f.number, f.place_mm]; } })()""")
        self.click_at(place)
        self.assertEqual(self.js("millpose.picked"), {"face": number - 1})
        face = self.js(f"millpose.data.part.faces[{number - 1}]")
        told = self.picked()
        for text, value in zip(told["normal, P"].split(", "), face["normal"]):
            self.assertAlmostEqual(float(text), value, places=4)
        self.assertIn("mm²", told["area"])
        self.assertIn("selected", self.js(f"document.querySelectorAll('#faces tbody tr')[{number - 1}].className"))
        chosen = sum(n for (r, g, b), n in self.colours_of("#view canvas").items() if r > 150 and g < 0.7 * r and b < 0.35 * r)
        self.assertGreater(chosen, 200)

    def test_a_click_on_an_edge_names_it_and_its_faces(self):
        self.open("part")
        number, place = self.js("""(() => { const s = millpose.views.scene, p = millpose.views.parts;
            for (const e of millpose.data.part.edges) { const [x, y] = s.onScreen(e.place_mm), hit = p.at(x, y); if (hit && hit.edge === e.number - 1) return [e.number, e.place_mm]; } })()""")
        self.click_at(place)
        self.assertEqual(self.js("millpose.picked"), {"edge": number - 1})
        self.assertEqual(self.js("document.querySelector('#picked h2').textContent"), f"Edge {number}")
        self.assertIn("mm", self.picked()["length"])

    def test_a_face_and_an_edge_of_a_step_file_are_told_as_the_file_has_them(self):
        self.open("step")
        face, edge = self.js("""(() => { const s = millpose.views.scene, p = millpose.views.parts, { faces, edges } = millpose.data.part;
            const seen = (key, all) => all.find(one => { const [x, y] = s.onScreen(one.place_mm), hit = p.at(x, y); return hit && hit[key] === one.number - 1; });
            return [seen("face", faces), seen("edge", edges)]; })()""")
        self.click_at(face["place_mm"])
        self.assertEqual(self.js("millpose.picked"), {"face": 0})
        told = " ".join([self.js("document.querySelector('#picked h2').textContent"), *self.picked().values()])
        for word in ("#22", "top", "spline", "106.1"):
            self.assertIn(word, told)
        self.keep("step_face.png", self.browser.screenshot())
        self.click_at(edge["place_mm"])
        self.assertEqual(self.js("millpose.picked"), {"edge": edge["number"] - 1})
        self.assertIn("closed", " ".join([self.js("document.querySelector('#picked').textContent")]))

    def test_the_lists_choose_too(self):
        self.open("part")
        self.browser.click_on("#faces tbody tr:nth-child(2)")
        self.assertEqual(self.js("[millpose.picked.face, millpose.views.parts.face]"), [1, 1])
        self.browser.click_on("#edges tbody tr:nth-child(1)")
        self.assertEqual(self.js("[millpose.picked.edge, millpose.views.parts.face]"), [0, None])
        self.assertTrue(self.js("millpose.views.parts.chosenEdge.visible"))

    def test_points_tell_the_axis_that_limits_them(self):
        self.open("job")
        counts = self.js("[0, 1, 2, 3].map(s => millpose.data.rows.state.filter(v => v === s).length)")
        self.assertGreater(counts[2], 0)
        row = self.js("millpose.data.rows.state.indexOf(2)")
        self.js(f"millpose.select({row})")
        self.browser.settle()
        told = self.picked()
        self.assertEqual(told["reach"], "outside a limit")
        self.assertRegex(told["axis that limits"], r"^A5, \d.*° beyond$")
        # The axis is that of the pose shown, which stands at the point.
        tip, place, a5, upper = self.js(f"""(() => {{ const m = millpose, d = m.data, q = m.jointsOf(d, {row}), f = m.armFrames(d, q)[7];
            return [[f[3], f[7], f[11]], m.place(d, {row}), q[4], d.arm.upper_deg[4]]; }})()""")
        for k in range(3):
            self.assertAlmostEqual(tip[k], place[k], delta=0.02)
        self.assertGreater(abs(a5), upper - 10)
        self.keep("job_point.png", self.browser.screenshot("#scene"))

    def test_a_click_on_a_point_is_no_click_on_the_face_below(self):
        self.open("job")
        row = self.js("""(() => { const s = millpose.views.scene; return Math.floor(millpose.data.count / 2); })()""")
        x, y = self.js(f"""(() => {{ const [x, y] = millpose.views.scene.project({row}), b = document.querySelector('#view').getBoundingClientRect(); return [x + b.x, y + b.y]; }})()""")
        self.browser.click(x, y)
        self.assertIn("point", self.js("millpose.picked"))
        self.js("document.querySelector('#show-path').click()")
        self.browser.settle()
        self.browser.click(x, y)
        self.assertNotIn("point", self.js("millpose.picked"))

    def test_the_region_and_the_normals_are_drawn(self):
        self.open("job")
        self.assertGreater(self.js("millpose.data.part.inRegion.filter(v => v).length"), 0)
        for box in ("#show-region", "#show-normals"):
            before = self.browser.screenshot("#view canvas")
            self.js(f"document.querySelector('{box}').click()")
            self.browser.settle()
            self.assertNotEqual(self.browser.screenshot("#view canvas"), before, box)

    def test_the_material_is_drawn_as_it_comes_and_as_the_path_leaves_it(self):
        self.open("rough")
        volume = "(() => { const s = millpose.views.scene.stock, p = s.position, n = s.count, a = s.raw.along; let sum = 0; for (let i = 0; i < n; ++i) if (s.stands(i)) sum += p[3 * (n + i) + a] - p[3 * i + a]; return sum * s.raw.spacing_mm ** 2 / 1000; })()"
        choose = lambda value: self.js(f"(() => {{ const menu = document.querySelector('#show-stock'); menu.value = '{value}'; menu.dispatchEvent(new Event('change')); }})()") or self.browser.settle()
        raw = self.js("millpose.data.removal.cm3")
        self.assertAlmostEqual(self.js(volume), raw, delta=0.02 * raw)
        self.assertTrue(self.js("millpose.views.scene.groups.stock.visible && millpose.views.scene.stock.mesh.material.opacity < 0.6"))
        pictures = [self.browser.screenshot("#view canvas")]
        self.keep("check_stock.png", self.browser.screenshot("#scene"))
        choose(1)
        left = self.js("millpose.data.removal.left[0]")
        self.assertLess(left, 0.9 * raw)
        self.assertAlmostEqual(self.js(volume), left, delta=0.03 * raw)
        self.assertRegex(self.text("#removed"), r"^(\d+\.\d) of \1 cm³ milled off$")
        pictures.append(self.browser.screenshot("#view canvas"))
        self.keep("check_stock_left.png", self.browser.screenshot("#scene"))
        choose("")
        self.assertFalse(self.js("millpose.views.scene.groups.stock.visible"))
        self.assertTrue(self.js("document.querySelector('#stock-scale').hidden"))
        pictures.append(self.browser.screenshot("#view canvas"))
        self.assertEqual(len(set(pictures)), 3)
        choose(0)
        self.assertAlmostEqual(self.js(volume), raw, delta=0.02 * raw)
        # A job without a raw part has nothing to choose.
        self.open("job")
        self.assertEqual(self.js("document.querySelectorAll('#show-stock, #stock-scale').length"), 0)

    def test_nothing_that_is_read_lacks_its_words(self):
        """But for findings and notes, which stay English where no table has them."""
        for name in self.pages:
            self.open(name)
            self.js("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
            for pick in ("#faces tbody tr", "#edges tbody tr"):
                self.js(f"document.querySelector('{pick}') && document.querySelector('{pick}').click()")
                read = set(self.js(READ)) - set(self.js("[...document.querySelectorAll('#messages li')].map((e) => e.textContent.trim())"))
                self.assertGreater(len(read), 10)
                self.assertEqual([t for t in sorted(read) if not AS_IS.fullmatch(t.removesuffix("²")) and not self.js(f"millpose.canSay({json.dumps(t)})")], [], name)
        self.js("(() => { const menu = document.querySelector('#language'); menu.value = 'de'; menu.dispatchEvent(new Event('change')); })()")
        self.browser.settle()
        self.assertEqual(self.js("[document.documentElement.lang, document.querySelector('#told h2').textContent]"), ["de", "Wie es im Terminal steht"])
        self.keep("check_de.png", self.browser.screenshot())

    def test_keys(self):
        self.open("job")
        self.browser.key("ArrowRight")
        self.browser.key("ArrowRight")
        self.assertEqual(self.js("millpose.selected"), 1)
        self.browser.key("d")
        self.assertEqual(self.js("document.documentElement.dataset.theme"), "dark")

    def test_fits_every_window_in_light_and_dark_and_on_paper(self):
        for name in self.pages:
            self.assert_fits(name, name)
            self.browser.media("light", paper=True)
            self.browser.size(718, 900)
            self.browser.settle()
            self.assertEqual(self.js("document.querySelector('#view img.paper').naturalWidth"), 1400, name)
            self.assertEqual(self.js("[...document.querySelectorAll('.scroll')].filter(e => e.scrollHeight > e.clientHeight + 1).length"), 0)
            self.keep(f"{name}_paper.png", self.browser.screenshot())
            self.browser.media()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

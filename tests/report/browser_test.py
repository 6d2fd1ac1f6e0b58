# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: browser_test.py WRITE_REPORT_PANEL: opens a report from file:// in a headless Chromium without a
network and uses it as a person would."""
import base64
import json
import math
import struct
import subprocess
import sys
import unittest

from browser_case import BrowserCase
from chromium import pixels

PASSES, POINTS = 12, 40


class ReportInBrowser(BrowserCase):
    @classmethod
    def write_pages(cls):
        cls.page = cls.folder / "report.html"
        subprocess.run([sys.argv[1], str(PASSES), str(POINTS), cls.page], check=True)

    def setUp(self):
        super().setUp()
        self.open()

    def selected(self):
        return self.js("millpose.selected")

    def assert_all_show(self, row):
        number = self.js(f"millpose.data.rows.number[{row}]")
        self.assertEqual(self.selected(), row)
        self.assertEqual(self.text("#point-title"), f"Point {number}")
        self.assertEqual(self.js("location.hash"), f"#point={number}")
        self.assertEqual(self.js("millpose.views.charts.group.selected"), row)
        self.assertEqual(self.js("millpose.views.poses.row"), row)
        self.assertEqual(self.js("millpose.views.scene.selected"), row)

    def chart_texts(self):
        return self.js("[...document.querySelectorAll('.chart .legend')].map(e => e.textContent)")

    def test_opens_at_the_worst_point(self):
        worst = self.js("""(() => { const v = millpose.data.column.objective.values;
            const cut = (i) => millpose.data.rows.kind[i] === 0 && !Number.isNaN(v[i]);
            let best = -1; v.forEach((x, i) => { if (cut(i) && (best < 0 || x > v[best])) best = i; }); return best; })()""")
        self.assert_all_show(worst)
        self.assertIn("selected", self.js("document.querySelector('#worst tbody tr').className"))
        self.keep("worst_1400.png", self.browser.screenshot())

    def test_view_is_not_blank(self):
        colours = self.colours_of("#view canvas")
        self.assertGreater(len(colours), 500)
        viridis = sum(n for (r, g, b), n in colours.items() if max(r, g, b) - min(r, g, b) > 60)
        self.assertGreater(viridis, 0.01 * colours.total())

    def test_click_in_the_view_selects_everywhere(self):
        before, panel, plots = self.chart_texts(), self.text("#point-figures"), self.browser.screenshot("#rotation-chart")
        # A point in the middle of a pass near the part's lower rim, clear of the arm.
        row = 2 * POINTS + 10
        x, y = self.js(f"""(() => {{ const [x, y] = millpose.views.scene.project({row});
            const b = document.querySelector('#view').getBoundingClientRect(); return [x + b.x, y + b.y]; }})()""")
        self.browser.click(x, y)
        self.assert_all_show(row)
        self.assertNotEqual(self.chart_texts(), before)
        self.assertNotEqual(self.text("#point-figures"), panel)
        self.assertNotEqual(self.browser.screenshot("#rotation-chart"), plots)

    def test_drag_turns_the_view_and_selects_nothing(self):
        row, view = self.selected(), self.browser.screenshot("#view canvas")
        call = self.browser.call
        call("Input.dispatchMouseEvent", type="mousePressed", x=400, y=400, button="left", clickCount=1)
        call("Input.dispatchMouseEvent", type="mouseMoved", x=480, y=430, button="left", buttons=1)
        call("Input.dispatchMouseEvent", type="mouseReleased", x=480, y=430, button="left", clickCount=1)
        self.browser.settle()
        self.assertEqual(self.selected(), row)
        self.assertNotEqual(self.browser.screenshot("#view canvas"), view)

    def test_click_in_a_chart_selects_everywhere(self):
        self.browser.click_on(".chart:nth-of-type(2) canvas")
        row = self.selected()
        self.assertAlmostEqual(row, PASSES * POINTS / 2, delta=POINTS)
        self.assert_all_show(row)

    def test_drag_in_a_chart_zooms_all_and_double_click_goes_back(self):
        x, y = self.js("""(() => { const e = document.querySelector('.chart canvas');
            e.scrollIntoView({block: "center"}); const b = e.getBoundingClientRect(); return [b.x, b.y + 60]; })()""")
        call = self.browser.call
        call("Input.dispatchMouseEvent", type="mousePressed", x=x + 300, y=y, button="left", clickCount=1)
        call("Input.dispatchMouseEvent", type="mouseMoved", x=x + 500, y=y, button="left", buttons=1)
        call("Input.dispatchMouseEvent", type="mouseReleased", x=x + 500, y=y, button="left", clickCount=1)
        self.browser.settle()
        low, high = self.js("millpose.views.charts.group.range")
        self.assertLess(high - low, 0.2 * 900 * PASSES)
        self.assertGreater(high - low, 0.1 * 900 * PASSES)
        for clicks in (1, 2):
            for kind in ("mousePressed", "mouseReleased"):
                call("Input.dispatchMouseEvent", type=kind, x=x + 400, y=y, button="left", clickCount=clicks)
        self.browser.settle()
        self.assertIsNone(self.js("millpose.views.charts.group.range"))

    def test_click_in_the_table_selects_everywhere(self):
        self.browser.click_on("#worst tbody tr:nth-child(4) td:last-child")
        row = self.js("Number(document.querySelector('#worst tbody tr:nth-child(4)').dataset.row)")
        self.assert_all_show(row)

    def test_link_opens_its_point(self):
        self.open("#point=77")
        self.assert_all_show(77)
        self.js("location.hash = '#point=140'")
        self.browser.settle()
        self.assert_all_show(140)

    def test_arrow_keys_follow_the_path(self):
        self.open("#point=100")
        for key, row in (("ArrowRight", 101), ("ArrowLeft", 100), ("ArrowLeft", 99)):
            self.browser.key(key)
            self.assert_all_show(row)

    def test_skipped_point_says_why(self):
        number = (PASSES - 1) * POINTS + 9
        self.browser.click_on("#skipped tbody a")
        self.assert_all_show(number)
        self.assertEqual(self.text("#point-status"), "skipped, interference: spindle against workpiece </script><b>")
        self.assertFalse(self.js("millpose.views.scene.groups.arm.visible"))

    def test_a_plan_without_any_pose_opens(self):
        begin, end = '<script type="application/json" id="plan-data">', "</script>"
        before, rest = self.page.read_text().split(begin)
        data, after = rest.split(end, 1)
        plan = json.loads(data)
        for column in plan["columns"]:
            count = len(base64.b64decode(column["values"])) // 4
            column["values"] = base64.b64encode(struct.pack(f"<{count}f", *[math.nan] * count)).decode()
        plan["timeline"] = None
        page = self.folder / "no_pose.html"
        page.write_text(before + begin + json.dumps(plan).replace("</", "<\\/") + end + after)
        self.browser.open(page.as_uri())
        self.assertEqual(self.text("#point-title"), "Point 0")

    def test_fit_arm_shows_every_joint(self):
        seen = """millpose.armFrames(millpose.data, millpose.jointsOf(millpose.data, millpose.selected)).map((f) => {
            const p = new THREE.Vector3(f[3], f[7], f[11]).project(millpose.views.scene.camera);
            return Math.max(Math.abs(p.x), Math.abs(p.y)); })"""
        self.assertGreater(max(self.js(seen)), 1)
        self.browser.click_on("#fit-arm")
        self.assertLess(max(self.js(seen)), 1)
        self.keep("arm_1400.png", self.browser.screenshot())
        self.browser.click_on("#fit")
        self.assertGreater(max(self.js(seen)), 1)

    def test_bounded_clearance_is_shown_as_at_least(self):
        row = self.js("millpose.data.column.clearance.values.findIndex((v) => v >= 50)")
        self.assertGreaterEqual(row, 0)
        self.open(f"#point={row}")
        self.assertIn("≥\u202f50.00\u202fmm", self.text("#point-figures"))
        below = self.js("millpose.data.column.clearance.values.findIndex((v) => v < 50)")
        self.open(f"#point={below}")
        self.assertNotIn("≥", self.text("#point-figures"))

    def test_gaps_tell_what_was_given_up(self):
        rows = self.js("[...document.querySelectorAll('#gaps tbody tr')].map((e) => e.textContent)")
        self.assertEqual(len(rows), 2)
        self.assertIn("not planned", rows[0])
        self.assertIn("clearances reduced to 90 %", rows[1])

    def test_deflection_has_section_chart_and_colours(self):
        self.assertEqual(self.js("getComputedStyle(document.querySelector('#deflection')).display"), "block")
        self.assertIn("40", self.text("#deflection"))
        chart = """[...document.querySelectorAll('.chart')].find(
            (e) => e.querySelector('h3').textContent.startsWith('Predicted deflection'))"""
        self.assertEqual(self.js(f"{chart}.querySelectorAll('.legend span').length"), 4)
        row = 3 * POINTS + 5
        self.open(f"#point={row}")
        length = self.js(f"millpose.format(millpose.data.column.deflection.values[{row}])")
        self.assertIn(length, self.js(f"{chart}.querySelector('.legend').textContent"))
        self.assertIn(length, self.text("#point-figures"))
        self.js(f"{chart}.id = 'deflection-chart'")
        colours = self.colours_of("#deflection-chart canvas")
        for wanted in self.js(f"{chart}.querySelectorAll('.legend .swatch').length && millpose.SERIES.slice(0, 4)"):
            self.assertIn(tuple(int(wanted[k:k + 2], 16) for k in (1, 3, 5)), colours)
        view = self.browser.screenshot("#view canvas")
        self.js("""(() => { const s = document.querySelector('#index'); s.value = 'deflection';
            s.dispatchEvent(new Event('change')); })()""")
        self.browser.settle()
        self.assertIn("|d| in µm", self.text("#scale-label"))
        self.assertNotEqual(self.browser.screenshot("#view canvas"), view)

    def test_many_findings_leave_the_views_on_the_first_screen(self):
        self.assertEqual(self.text("#messages summary"), "9 findings")
        self.assertEqual(self.js("document.querySelectorAll('#messages details.finding li.bad').length"), 9)
        self.assertFalse(self.js("document.querySelector('#messages details').open"))
        self.assertLess(self.js("document.querySelector('#view').getBoundingClientRect().top"), 280)
        self.assertLess(self.js("document.querySelector('#time').getBoundingClientRect().bottom"), 900)

    def test_index_recolours_all_views(self):
        view, label = self.browser.screenshot("#view canvas"), self.text("#scale-label")
        self.js("""(() => { const s = document.querySelector('#index'); s.value = 'mu';
            s.dispatchEvent(new Event('change')); })()""")
        self.browser.settle()
        self.assertNotEqual(self.text("#scale-label"), label)
        self.assertIn("bright: low, worse", self.text("#scale-label"))
        self.assertIn("μ", self.text("#worst-title"))
        self.assertIn("μ", self.text(".chart h3"))
        self.assertNotEqual(self.browser.screenshot("#view canvas"), view)

    def test_arm_stands_on_its_point(self):
        worst = self.js("""(() => { const m = millpose, d = m.data; let worst = 0;
            for (let row = 0; row < d.count; ++row) {
              const joints = m.jointsOf(d, row);
              if (!joints) continue;
              const tool = m.armFrames(d, joints)[7], p = m.place(d, row);
              worst = Math.max(worst, Math.hypot(tool[3] - p[0], tool[7] - p[1], tool[11] - p[2]));
            }
            return worst; })()""")
        self.assertLess(worst, 0.02)  # mm: single precision of angles

    def test_the_inverse_gives_back_every_planned_pose(self):
        worst = self.js("""(() => { const m = millpose, d = m.data; let worst = 0;
            for (let row = 0; row < d.count; ++row) {
              const joints = m.jointsOf(d, row);
              if (!joints) continue;
              const found = m.jointsAt(d, row, d.column.rotation.values[row], d.rows.branch[row]);
              joints.forEach((q, i) => { const off = q - found[i]; worst = Math.max(worst, Math.abs(off - 360 * Math.round(off / 360))); });
            }
            return worst; })()""")
        self.assertLess(worst, 1e-3)  # degrees: single precision of angles

    def test_click_in_the_axis_map_shows_that_pose(self):
        self.open("#point=85")
        self.assertEqual(self.text("#map-title"), "Axis map of pass 2")
        self.assertIn("Point 85: ", self.text("#map-why"))
        self.assertIn("link4 / panel", self.text("#map-legend"))
        place = """(() => { const map = millpose.views.map, b = map.canvas.node.getBoundingClientRect();
            for (let c = 1; c < map.cells.length; ++c) for (let j = 0; j < map.steps; ++j) {
              const cell = map.cells[c][map.cellIndex(j)];
              if (WANTED) return {row: map.columns[c].row, branch: cell.branch, rotation: map.rotationOf(j),
                x: b.x + map.plot.axes.x(map.columns[c].way), y: b.y + map.plot.axes.y(map.rotationOf(j))};
            } })()"""
        self.js("document.querySelector('#map-canvas').scrollIntoView({block: 'center'})")
        met = self.js(place.replace("WANTED", "cell.zone === millpose.ZONE.PAIR"))
        view = self.browser.screenshot("#view canvas")
        self.browser.click(met["x"], met["y"])
        self.assert_all_show(met["row"])
        self.assertIn("link4 / panel", self.text("#map-pose"))
        self.assertNotEqual(self.browser.screenshot("#view canvas"), view)
        # The tool stands at the point, turned to the rotation that was clicked.
        tip = self.js(f"""(() => {{ const m = millpose, d = m.data, q = m.jointsAt(d, {met["row"]}, {met["rotation"]}, {met["branch"]});
            const f = m.armFrames(d, q)[7], p = m.place(d, {met["row"]}); return Math.hypot(f[3] - p[0], f[7] - p[1], f[11] - p[2]); }})()""")
        self.assertLess(tip, 0.02)
        self.browser.click_on("#next")
        self.assertNotIn("link4", self.text("#map-pose"))

    def test_the_axis_map_follows_pass_and_branch(self):
        self.open("#point=85")
        self.browser.click_on("#map-next")
        self.assertEqual(self.text("#map-title"), "Axis map of pass 3")
        self.assertEqual(self.js("millpose.data.rows.pass[millpose.selected]"), 3)
        seen = self.browser.screenshot("#map-canvas canvas")
        self.js("""(() => { const s = document.querySelector('#map-branch'); s.value = s.value === 'all' ? s.options[1].value : 'all';
            s.dispatchEvent(new Event('change')); })()""")
        self.browser.settle()
        self.assertNotEqual(self.browser.screenshot("#map-canvas canvas"), seen)

    def test_the_best_poses_are_seen_where_the_path_is_at_them(self):
        self.open("#point=85")
        dark, magenta = self.js("""(() => { const map = millpose.views.map, d = millpose.data, node = map.canvas.node;
            const context = node.getContext('2d'), ratio = node.width / node.getBoundingClientRect().width, found = [0, 0];
            for (const row of map.rows) {
              const rotation = d.column.rotation.values[row];
              if (!(Math.abs(d.map.own[row] - rotation) < 0.2)) continue;
              const x = map.plot.axes.x(map.plot.wayOf(row)), y = map.plot.axes.y(map.shown(rotation));
              const image = context.getImageData((x - 1) * ratio, (y - 4) * ratio, 3 * ratio, 9 * ratio).data;
              let ink = false, own = false;
              for (let i = 0; i < image.length; i += 4) {
                ink ||= image[i] < 60 && image[i + 1] < 60 && image[i + 2] < 60;
                own ||= image[i] > 150 && image[i + 1] < 60 && image[i + 2] > 60;
              }
              found[0] += ink;
              found[1] += own;
            }
            return found; })()""")
        self.assertGreater(magenta, 3)
        self.assertGreater(dark, 3)

    def test_the_axis_map_fits_narrow_windows(self):
        for width in (1400, 800):
            self.browser.size(width, 900)
            self.open("#point=85")
            self.keep(f"map_{width}.png", self.browser.screenshot("#axis-map"))
            card, boxes, hidden, plot = self.js("""(() => {
                const box = (e) => { const b = e.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; };
                const card = document.querySelector('#axis-map'), map = millpose.views.map, a = map.plot.axes;
                const leaves = [...card.querySelectorAll('.bar > *, #map-why, #map-canvas canvas, #map-legend > *, #map-pose')]
                  .filter((e) => e.textContent || e.tagName === 'CANVAS');
                return [box(card), leaves.map(box), leaves.filter((e) => e.scrollWidth > e.clientWidth + 1 && e.clientWidth).length,
                  [a.left, a.right, map.canvas.width]]; })()""")
            self.assertEqual(hidden, 0, width)
            self.assertGreaterEqual(len(boxes), 10, width)
            for i, box in enumerate(boxes):
                self.assertGreater(min(box[2] - box[0], box[3] - box[1]), 5, (width, i))
                self.assertTrue(card[0] <= box[0] and box[2] <= card[2] and card[1] <= box[1] and box[3] <= card[3], (width, i, box))
                for other in boxes[:i]:
                    apart = box[0] >= other[2] - 1 or other[0] >= box[2] - 1 or box[1] >= other[3] - 1 or other[1] >= box[3] - 1
                    self.assertTrue(apart, (width, i, box, other))
            self.assertGreater(plot[1] - plot[0], 0.8 * plot[2], "most of the width is map")

    def test_fits_narrow_windows(self):
        self.assert_fits("point50", "#point=50")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

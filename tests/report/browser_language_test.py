# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: browser_language_test.py WRITE_REPORT_PANEL: report.html in its three languages, and its tips on tap, in a
headless Chromium."""
import json
import re
import subprocess
import sys
import unittest

from browser_case import BrowserCase

# All that people read, with what it is in English: texts, and what is told of things by title and aria-label.
READ = """(() => { const found = [], walk = document.createTreeWalker(document.body, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
    for (let node = walk.nextNode(); node; node = walk.nextNode()) {
      const element = node.nodeType === 1 ? node : node.parentElement;
      if (!element || element.closest('[translate=no], script, style')) continue;
      if (node.nodeType === 3) found.push(node.data.trim().replace(/\\s*\\n\\s*/g, ' '));
      else for (const name of ['title', 'aria-label']) if (node.hasAttribute(name)) found.push(...node.getAttribute(name).split('\\n'));
    }
    return found.filter((text) => text); })()"""
# What no language changes: units, names of axes and bodies, symbols, controllers, details that the test's plan made up.
AS_IS = re.compile(r"[\d.,/×≥–\u202f +\-…−]*(µm/N|µm/arcmin|µm|mm|N|°/s|°|%|s)?|[AVES]\d(/\d)?|S\d|[xyz]|f|D|μ|nᵀcn|λ\w+|f/f\*|v/vmax|\|\w+\||d·\S+|a_[ep]|[wfad,.?]"
                   r"|finding \d|(?:[\d.]+\u202fmm: )?\w+ – \w+|\d+×|e|◐|panel|krl|W|[fDμ], [µm/N1]+|spindle against .*|link3 against platform|clearances reduced to 90 %")


def figures(text):
    return re.findall(r"\d+(?:[.,:]\d+)*", text)


class ReportInLanguages(BrowserCase):
    @classmethod
    def write_pages(cls):
        cls.page = cls.folder / "report.html"
        subprocess.run([sys.argv[1], "6", "30", cls.page], check=True)

    def setUp(self):
        super().setUp()
        self.open()

    def speak(self, language):
        self.js(f"""(() => {{ const menu = document.querySelector('#language'); menu.value = '{language}';
            menu.dispatchEvent(new Event('change')); }})()""")
        self.browser.settle()

    def test_nothing_that_is_read_lacks_its_words(self):
        self.js("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
        missing = [text for text in self.js(READ) if not AS_IS.fullmatch(text) and not self.js(f"millpose.canSay({json.dumps(text)})")]
        self.assertEqual(missing, [])

    def test_page_and_program_say_the_same(self):
        texts = sorted(set(self.js(READ)) | {"Nobody knows. Not sampled for this plan.", "gear error, unheard", "gear error, thermal",
                                             "a; b, pass 7", "pass 1e3: 2 s", "{1}: pass 7", "pass x"})
        for language in ("de", "zh"):
            self.speak(language)
            said = subprocess.run([sys.argv[1], "--say", language], input="\n".join(texts) + "\n", capture_output=True, text=True, check=True).stdout
            self.assertEqual([self.js(f"millpose.say({json.dumps(text)})") for text in texts], said.split("\n")[:-1])

    def test_menu_switches_at_once_and_back(self):
        english = self.js(READ)
        self.assertEqual(self.js("document.documentElement.lang"), "en")
        for language, heading, point in (("de", "Längs des Werkzeugwegs", "Punkt "), ("zh", "沿刀具路径", "点 ")):
            self.speak(language)
            self.assertEqual(self.js("document.documentElement.lang"), language)
            self.assertEqual(self.text("#path h2"), heading)
            self.assertTrue(self.text("#point-title").startswith(point))
            said = self.js(READ)
            self.assertEqual(len(said), len(english))
            for before, after in zip(english, said):
                self.assertEqual(sorted(figures(before)), sorted(figures(after)), (before, after))
            # What scripts write from now on is said too.
            self.browser.key("ArrowRight")
            self.assertTrue(self.text("#point-title").startswith(point))
            self.browser.key("ArrowLeft")
        self.speak("en")
        self.assertEqual(self.js(READ), english)

    def test_canvases_are_drawn_anew(self):
        chart = ".chart canvas"
        before = self.browser.screenshot(chart)
        self.speak("de")
        self.assertNotEqual(self.browser.screenshot(chart), before)
        self.speak("en")
        self.assertEqual(self.browser.screenshot(chart), before)

    def test_names_of_the_job_stay(self):
        name = self.text("#job")
        self.speak("zh")
        self.assertEqual(self.text("#job"), name)
        self.assertIn("job", self.text("#settings-text"))

    def test_every_language_fits_narrow_and_wide(self):
        for language in ("en", "de", "zh"):
            self.speak(language)
            for width in (1400, 390):
                self.browser.size(width, 900)
                self.browser.settle()
                self.assertLessEqual(self.js("document.documentElement.scrollWidth"), width, (language, width))
                self.keep(f"language_{language}_{width}.png", self.browser.screenshot())

    def tap(self, selector):
        x, y = self.js(f"""(() => {{ const e = document.querySelector({selector!r});
            e.scrollIntoView({{block: "center"}}); const b = e.getBoundingClientRect();
            return [b.x + b.width / 2, b.y + b.height / 2]; }})()""")
        self.browser.frames()
        self.browser.call("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        self.browser.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.browser.settle()

    def shown(self):
        return self.js("document.querySelector('#tip').hidden ? null : document.querySelector('#tip').textContent")

    def test_a_tap_on_a_symbol_says_what_it_means(self):
        self.browser.call("Emulation.setTouchEmulationEnabled", enabled=True)
        self.addCleanup(self.browser.call, "Emulation.setTouchEmulationEnabled", enabled=False)
        self.browser.size(390, 844)
        for language, part in (("en", "compliance ellipsoid"), ("de", "Werkzeugmittelpunkt"), ("zh", "刀具中心点")):
            self.speak(language)
            self.tap("#point-figures [data-tip=lambda_t1]")
            self.assertIn(part, self.shown() or "")
            left, right, top, bottom = self.js("""(() => { const b = document.querySelector('#tip').getBoundingClientRect();
                return [b.left, b.right, b.top, b.bottom]; })()""")
            self.assertTrue(left >= 0 and right <= 390 and top >= 0 and bottom <= 844, (left, right, top, bottom))
            self.keep(f"tip_{language}.png", self.browser.screenshot())
            self.tap("#point-title")
            self.assertIsNone(self.shown())

    def test_keys_open_and_close_a_tip(self):
        self.js("document.querySelector('#point-figures [data-tip=mu]').focus({preventScroll: true})")
        for key in ("Enter", " "):
            self.browser.key(key)
            self.assertIn("λτ2 divided by λτ1", self.shown() or "")
            self.assertEqual(self.js("document.activeElement.getAttribute('aria-describedby')"), "tip")
            self.browser.key("Escape")
            self.assertIsNone(self.shown())
        self.assertFalse(self.js("millpose.views.player.playing"))

    def test_every_marked_word_has_a_sentence(self):
        marked = self.js("[...document.querySelectorAll('[data-tip]')].map((e) => e.dataset.tip)")
        self.assertGreater(len(set(marked)), 15)
        self.assertEqual([key for key in marked if not self.js(f"millpose.tips[{key!r}]")], [])


if __name__ == "__main__":
    unittest.main(argv=["browser_language_test.py"])

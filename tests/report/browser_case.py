# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of pages in a browser share: one browser for all tests of a class, a clean start and no errors for each.
Screenshots stay in the folder that MILLPOSE_PICTURES names."""
import collections
import os
import pathlib
import tempfile
import unittest

from chromium import Chromium, pixels

PICTURES = os.environ.get("MILLPOSE_PICTURES")


def colours(png):
    return collections.Counter(colour for row in pixels(png)[2] for colour in row)


class BrowserCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.write_pages()
        cls.browser = Chromium()
        cls.addClassCleanup(cls.browser.close)

    @classmethod
    def write_pages(cls):
        """Into cls.folder; the one page of a class with one is cls.page."""
        raise NotImplementedError

    def setUp(self):
        self.browser.errors.clear()
        self.browser.requests.clear()
        self.browser.size(1400, 900)
        self.browser.media()

    def tearDown(self):
        self.assertEqual(self.browser.errors, [])
        self.assertEqual([u for u in self.browser.requests if not u.startswith(("file:", "about:", "data:"))], [])

    def open(self, fragment=""):
        self.browser.open(self.page.as_uri() + fragment)

    def js(self, expression):
        return self.browser.evaluate(expression)

    def text(self, selector):
        return self.js(f"document.querySelector('{selector}').textContent")

    def colours_of(self, selector):
        """Of an element, with the number of their pixels."""
        return colours(self.browser.screenshot(selector))

    def keep(self, name, data):
        if PICTURES:
            pathlib.Path(PICTURES).mkdir(parents=True, exist_ok=True)
            (pathlib.Path(PICTURES) / name).write_bytes(data)

    def assert_fits(self, name, *page, looks=("light", "dark")):
        """No window, however narrow, needs to be scrolled sideways."""
        for look in looks:
            self.browser.media("dark" if look == "dark" else "light", paper=look == "paper")
            for width in (1400, 800, 390):
                self.browser.size(width, 900)
                self.open(*page)
                self.assertLessEqual(self.js("document.documentElement.scrollWidth"), width, (name, look))
                self.keep(f"{name}_{look}_{width}.png", self.browser.screenshot())

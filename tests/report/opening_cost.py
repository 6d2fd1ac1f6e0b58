# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: opening_cost.py REPORT.html: wall and processor time until a headless Chromium has opened the page, and wall time of
a key until the screen shows what it did (not a test: no clock decides one). A page of 20,000 points: `write_report_panel 100 200 big.html`."""
import os
import pathlib
import sys
import time

from chromium import Chromium


def processor_seconds(root):
    """Of the process and all below it, by kind of Chromium's processes."""
    children, seconds, kind = {}, {}, {}
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            words = (entry / "cmdline").read_text().replace("\0", " ").split()
        except OSError:  # it has ended
            continue
        number = int(entry.name)
        children.setdefault(int(fields[1]), []).append(number)
        seconds[number] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        kind[number] = next((word[len("--type="):] for word in words if word.startswith("--type=")), "browser")
    total, open_numbers = {}, [root]
    while open_numbers:
        number = open_numbers.pop()
        open_numbers += children.get(number, [])
        total[kind[number]] = total.get(kind[number], 0) + seconds[number]
    return total


page = pathlib.Path(sys.argv[1]).resolve()
browser = Chromium()
browser.size(1400, 900)
before, began = processor_seconds(browser.process.pid), time.monotonic()
browser.open(page.as_uri())
wall, after = time.monotonic() - began, processor_seconds(browser.process.pid)
points = browser.evaluate("millpose.data.count")


def key_seconds(key, times=20):
    """Median and largest wall time from a key to the second frame after it."""
    taken = []
    for _ in range(times):
        start = time.monotonic()
        browser.call("Input.dispatchKeyEvent", type="keyDown", key=key)
        browser.frames()
        taken.append(time.monotonic() - start)
    return sorted(taken)[times // 2], max(taken)


keys = {}
browser.evaluate("millpose.select(Math.floor(millpose.data.count / 3))")
browser.settle()
for place, selector in (("at the top", "#scene"), ("at the axis map", "#axis-map"), ("at the charts", "#path")):
    browser.evaluate(f"document.querySelector('{selector}').scrollIntoView()")
    browser.settle()
    keys[place] = key_seconds("ArrowRight")
browser.close()
print(f"{points} points, {page.stat().st_size / 1e6:.1f} MB: wall {wall:.2f} s; processor",
      ", ".join(f"{name} {value - before.get(name, 0):.2f} s" for name, value in sorted(after.items())))
for place, (median, largest) in keys.items():
    print(f"a key {place}: median {1e3 * median:.0f} ms, largest {1e3 * largest:.0f} ms")

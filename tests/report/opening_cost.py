# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: opening_cost.py REPORT.html: wall and processor time until a headless Chromium has opened the page (not a test: no
clock decides one). A page of 20,000 points: `write_report_panel 100 200 big.html`."""
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
browser.close()
print(f"{points} points, {page.stat().st_size / 1e6:.1f} MB: wall {wall:.2f} s; processor",
      ", ".join(f"{name} {value - before.get(name, 0):.2f} s" for name, value in sorted(after.items())))

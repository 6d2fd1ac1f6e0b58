#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the picture of README.md anew: report.html of the sample cabin_panel in a browser (chromium, packages-slow.txt).
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$top/millpose" plan "$top/toolpaths/cabin_panel/job.yaml" -o "$out/panel" --quiet
chromium --headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars \
  --window-size=1400,900 --virtual-time-budget=8000 --screenshot="$top/docs/pictures/cabin_panel.png" \
  "file://$out/panel/report.html"

#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the pictures of README.md and of the pages beside it anew, in a browser (chromium, packages-slow.txt): what
# the tutorial's own commands and three samples show.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# picture NAME PAGE [WIDTH,HEIGHT]
picture() {
  chromium --headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars \
    --window-size="${3:-1400,900}" --virtual-time-budget=8000 --screenshot="$top/docs/pictures/$1.png" "file://$2"
}

cd "$out"
sed -n '/^v -60 -40 -20$/,/^f 4 1 5 8$/p' "$top/docs/tutorial.md" > block.obj
"$top/millpose" init block.obj --arm kr500_r2830 --out first --quiet
"$top/millpose" check first/job.yaml --view "$out/check.html" --quiet
"$top/millpose" plan first/job.yaml --quiet
picture init "$out/check.html" 1200,760
picture tutorial "$out/first/block.out/report.html" 1200,760
for sample in cabin_panel cabin_window irb6640_rail; do
  "$top/millpose" plan "$top/toolpaths/$sample/job.yaml" -o "$out/$sample" --quiet
done
picture cabin_panel "$out/cabin_panel/report.html"
picture operations "$out/cabin_window/report.html" 1200,900
picture external_axes "$out/irb6640_rail/report.html" 1200,760

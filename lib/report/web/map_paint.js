// SPDX-License-Identifier: GPL-3.0-or-later
// How the axis map is painted: a colour or a hatch for every zone, pixel by pixel, and names on large zones.
(function (m) {
  "use strict";

  // Zones as in html.hpp: 0 out of reach, 1 singular, 2…7 limit of an axis, 8 not checked, 9 free, 10 + p a pair.
  const UNCHECKED = 8, FREE = 9, PAIR = 10;
  m.ZONE = { UNCHECKED, FREE, PAIR };

  const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
  const style = (ground, hatch, ink) => ({ ground: hex(ground), hatch, ink: hex(ink) });
  const LIMITS = [
    style("#ead9bd", "down", "#b88d4a"), style("#e3cba3", "up", "#a67d3d"), style("#f0e0b0", "across", "#bf9b30"),
    style("#e8cfb0", "cross", "#b07f50"), style("#f3e3c3", "along", "#b08d55"), style("#dfc8a8", "down", "#8f6a3a"),
  ];
  const PAIRS = [
    style("#4a2530", "up", "#8c5363"), style("#2b3442", "down", "#5d6f88"), style("#43294f", "cross", "#7b588a"),
    style("#1f3d37", "along", "#4d7f74"), style("#55371c", "across", "#94693f"), style("#333333", "dots", "#808080"),
  ];
  const REACH = style("#eceff2", "none", "#eceff2"), SINGULAR = style("#a985d0", "cross", "#5b2f86");

  m.zoneStyle = (zone) => (zone === 0 ? REACH : zone === 1 ? SINGULAR : zone < UNCHECKED ? LIMITS[zone - 2] : PAIRS[(zone - PAIR) % PAIRS.length]);
  // Two bodies' names, between which no language has a word.
  m.pairText = (pair) => pair.replace(" and ", " / ");
  m.zoneName = function (data, zone) {
    if (zone === 0) return "out of reach";
    if (zone === 1) return "singular";
    if (zone < UNCHECKED) return `A${zone - 1} beyond its limit`;
    if (zone === UNCHECKED) return "not checked for interference";
    if (zone === FREE) return "free";
    const pair = data.map.pairs[zone - PAIR];
    return pair ? m.pairText(pair) : "further pairs";
  };

  const HATCH = {
    none: () => false,
    up: (x, y) => (x + y) % 9 < 2,
    down: (x, y) => (x - y + 9000) % 9 < 2,
    across: (x, y) => y % 7 < 1.5,
    along: (x) => x % 7 < 1.5,
    cross: (x, y) => (x + y) % 10 < 1.5 || (x - y + 9000) % 10 < 1.5,
    dots: (x, y) => x % 6 < 2 && y % 6 < 2,
  };

  // Not checked: the colour of its value, much paler.
  const pale = (rgb) => rgb.map((v) => 255 - 0.42 * (255 - v));

  // Colour of a cell {zone, value} at a pixel; `share` maps values to 0…1.
  m.cellColour = function (cell, share) {
    if (cell.zone !== FREE && cell.zone !== UNCHECKED) return null;
    const rgb = m.viridis(share(cell.value)).map((v) => 255 * v);
    return cell.zone === FREE ? rgb : pale(rgb);
  };
  m.hatched = (look, x, y) => (HATCH[look.hatch](x, y) ? look.ink : look.ground);

  // A small picture of a zone for the legend; of values from least to largest.
  m.zoneSwatch = function (zone, width) {
    const node = m.element("canvas", { width, height: 13 }), context = node.getContext("2d"), image = context.createImageData(width, 13);
    for (let y = 0; y < 13; ++y)
      for (let x = 0; x < width; ++x) {
        const rgb = m.cellColour({ zone, value: x / (width - 1) }, (v) => v) || m.hatched(m.zoneStyle(zone), x, y);
        image.data.set([...rgb, 255], 4 * (width * y + x));
      }
    context.putImageData(image, 0, 0);
    return node;
  };

  // The largest stretches of one forbidden zone in a table of columns × rows: {zone, column, row, size, width, height}, a
  // middle cell each.
  m.largeZones = function (zones, columns, rows, least) {
    const seen = new Uint8Array(columns * rows), found = [];
    for (let start = 0; start < columns * rows; ++start) {
      const zone = zones[start];
      if (seen[start] || zone === UNCHECKED || zone === FREE) continue;
      const cells = [start];
      let low = columns, high = 0;
      seen[start] = 1;
      for (let next = 0; next < cells.length; ++next) {
        const c = Math.floor(cells[next] / rows), r = cells[next] % rows;
        low = Math.min(low, c);
        high = Math.max(high, c);
        for (const [dc, dr] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
          const at = (c + dc) * rows + r + dr;
          if (c + dc < 0 || c + dc >= columns || r + dr < 0 || r + dr >= rows || seen[at] || zones[at] !== zone) continue;
          seen[at] = 1;
          cells.push(at);
        }
      }
      if (cells.length < least) continue;
      // In the column nearest to the middle that has the longest run.
      const middle = (low + high) / 2, runs = new Map();
      for (const at of cells) {
        const c = Math.floor(at / rows);
        if (!runs.has(c)) runs.set(c, []);
        runs.get(c).push(at % rows);
      }
      let best = null;
      for (const [c, list] of runs) {
        list.sort((a, b) => a - b);
        for (let i = 0; i < list.length;) {
          let j = i;
          while (j + 1 < list.length && list[j + 1] === list[j] + 1) ++j;
          const height = j - i + 1, score = height - 0.5 * Math.abs(c - middle) * (rows / columns);
          if (!best || score > best.score) best = { score, column: c, row: (list[i] + list[j]) / 2, height };
          i = j + 1;
        }
      }
      found.push({ zone, size: cells.length, width: high - low + 1, ...best });
    }
    return found.sort((a, b) => b.size - a.size);
  };
})((window.millpose = window.millpose || {}));

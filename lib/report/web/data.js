// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the JSON that html_data.cpp wrote: base64 columns become typed arrays, rows get their look-ups.
(function (m) {
  "use strict";

  function bytes(text) {
    const binary = atob(text);
    const array = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) array[i] = binary.charCodeAt(i);
    return array.buffer;
  }
  // Also for check_data.js.
  m.unpack = { floats: (text) => floats(text), uint32: (text) => uint32(text), uint16: (text) => uint16(text) };
  const floats = (text) => new Float32Array(bytes(text));
  const uint32 = (text) => new Uint32Array(bytes(text));
  const uint16 = (text) => new Uint16Array(bytes(text));

  m.SKIP_REASONS = ["", "unreachable", "limit", "singular", "interference", "step", "source", "gouge", "access", "over_missing", "incomplete", "stock"];
  m.KINDS = ["cut", "lead-in", "lead-out"];

  // Least and largest finite value, with the shares of the sorted values in between on request.
  m.spread = function (values) {
    const sorted = Float32Array.from(values.filter((v) => !Number.isNaN(v))).sort();
    const at = (share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
    return { count: sorted.length, low: sorted[0], high: sorted[sorted.length - 1], at };
  };

  function decodeCurves(raw) {
    const curves = Object.assign({}, raw, { number: uint32(raw.number) });
    // Large, and of use only when a point is looked at.
    let parts = null;
    curves.parts = () =>
      parts || (parts = {
        least: floats(raw.least), span: floats(raw.span), values: uint16(raw.values),
        states: uint16(raw.states), best: floats(raw.best), mean: floats(raw.mean),
      });
    return curves;
  }

  m.readData = function (text) {
    const raw = JSON.parse(text);
    const data = Object.assign({}, raw);
    const r = raw.rows;
    data.rows = {
      number: uint32(r.number), pass: uint32(r.pass), piece: uint32(r.piece), status: uint32(r.status),
      branch: uint32(r.branch), kind: uint32(r.kind), way: floats(r.way_mm),
      position: floats(r.position_mm), normal: floats(r.normal),
    };
    data.count = data.rows.number.length;
    data.columns = raw.columns.map((c) => Object.assign({}, c, { values: floats(c.values) }));
    data.column = {};
    for (const column of data.columns) data.column[column.key] = column;
    data.optima = { genetic: floats(raw.optima.genetic), own: floats(raw.optima.own), free: floats(raw.optima.free) };
    data.curves = decodeCurves(raw.curves);
    if (raw.map) data.map = Object.assign({}, raw.map, { runs: new Uint8Array(bytes(raw.map.runs)), start: uint32(raw.map.start),
      own: floats(raw.map.own_deg), free: floats(raw.map.free_deg), branches: uint32(raw.map.branches), barred: uint32(raw.map.barred) });
    if (raw.nearest) {
      const pair = uint32(raw.nearest.pair);
      let named = 0;  // only rows with a pair have ends
      data.nearest = { pairs: raw.nearest.pairs, pair, ends: floats(raw.nearest.ends_mm), at: pair.map((p) => (p > 1 ? named++ : 0)) };
    }
    data.timeline = raw.timeline && { seconds: raw.timeline.seconds, time: floats(raw.timeline.time_s), stretch: uint32(raw.timeline.stretch),
      pass: uint32(raw.timeline.pass), row: uint32(raw.timeline.row), joints: floats(raw.timeline.joints_deg), tip: floats(raw.timeline.tip_mm) };
    if (raw.row_bases) data.rowBases = floats(raw.row_bases);  // external axes move along passes
    if (raw.timeline && raw.timeline.bases) data.timeline.bases = floats(raw.timeline.bases);
    data.removal = raw.removal && m.readRemoval(raw.removal, { floats, uint32, uint16 });
    data.bodies = raw.bodies.map((b) => Object.assign({}, b, { vertices: floats(b.vertices), faces: uint32(b.faces) }));
    return data;
  };

  // The columns of the external axes: e1, e2, …
  m.externalKeys = (data) => [1, 2, 3].map((k) => "e" + k).filter((key) => data.column[key]);

  // The row that shows point `number`, or the one whose number is nearest.
  m.rowOf = function (data, number) {
    const numbers = data.rows.number;
    let low = 0, high = numbers.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (numbers[middle] < number) low = middle + 1;
      else high = middle;
    }
    return low > 0 && number - numbers[low - 1] < Math.abs(numbers[low] - number) ? low - 1 : low;
  };

  m.place = (data, row) => Array.from(data.rows.position.subarray(3 * row, 3 * row + 3));

  // The curves of a row's point, or of the nearest sampled point by number; null when there are none.
  m.curveOf = function (data, row) {
    const numbers = data.curves.number;
    if (numbers.length === 0) return null;
    let best = 0;
    const wanted = data.rows.number[row];
    for (let i = 1; i < numbers.length; ++i)
      if (Math.abs(numbers[i] - wanted) < Math.abs(numbers[best] - wanted)) best = i;
    return { index: best, number: numbers[best], exact: numbers[best] === wanted };
  };

  // The nearest pair of bodies at a row, {names, ends}: their two places that are nearest to each other; null where none is near, undefined where nobody looked.
  m.nearestAt = function (data, row) {
    const { nearest } = data, pair = nearest ? nearest.pair[row] : 0;
    if (pair === 0) return undefined;
    if (pair === 1) return null;
    const from = 6 * nearest.at[row], end = (k) => Array.from(nearest.ends.subarray(from + 3 * k, from + 3 * k + 3));
    return { names: nearest.pairs[pair - 2], ends: [end(0), end(1)] };
  };

  // The worst rows of a column, no two of them nearer than `apart` mm: places rather than neighbours. Lead-ins and
  // -outs count only when asked for: nobody measures them on the part.
  m.worstPlaces = function (data, column, count, apart, leads) {
    const order = [];
    for (let i = 0; i < data.count; ++i) if (!Number.isNaN(column.values[i]) && (leads || data.rows.kind[i] === 0)) order.push(i);
    order.sort((a, b) => column.worse * (column.values[b] - column.values[a]) || a - b);
    const places = [];
    for (const row of order) {
      const p = m.place(data, row);
      if (places.every((q) => Math.hypot(p[0] - q.p[0], p[1] - q.p[1], p[2] - q.p[2]) > apart)) {
        places.push({ row, p });
        if (places.length === count) break;
      }
    }
    return places.map((q) => q.row);
  };
})((window.millpose = window.millpose || {}));

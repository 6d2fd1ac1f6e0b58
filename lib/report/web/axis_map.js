// SPDX-License-Identifier: GPL-3.0-or-later
// The axis map of one pass: way along it × rotation about the tool axis, coloured by the objective, with what bars the
// rest, the points' own optima and the path.
(function (m) {
  "use strict";

  const $ = (id) => document.getElementById(id);

  m.AxisMap = class {
    constructor(data, actions, scene) {
      this.data = data;
      this.actions = actions;
      this.scene = scene;
      this.plot = new m.MapPlot($("map-canvas"), data);
      this.canvas = this.plot.canvas;
      this.stale = true;
      this.schedule = m.atNextFrame(() => this.draw(), $("map-canvas"));
      this.steps = data.curves.count;
      this.shift = 0;
      $("map-branch").addEventListener("change", () => {
        this.compose();
        this.redraw();
      });
      $("map-previous").addEventListener("click", () => this.turnTo(-1));
      $("map-next").addEventListener("click", () => this.turnTo(1));
      const node = this.canvas.node;
      node.addEventListener("pointermove", (e) => this.tell(this.at(e)));
      node.addEventListener("pointerleave", () => this.tell(null));
      node.addEventListener("click", (e) => this.pick(this.at(e)));
    }

    redraw() {
      this.stale = true;
      this.schedule();
    }

    // Another pass, at the worst point of its cut.
    turnTo(by) {
      const { rows, count, passes } = this.data, pass = Math.max(0, Math.min(passes.length - 1, this.pass + by));
      const f = this.data.column.objective.values;
      const cut = (i) => rows.kind[i] === 0 && !Number.isNaN(f[i]);
      const beats = (i, than) => (cut(i) === cut(than) ? f[i] > f[than] : cut(i));
      let best = -1;
      for (let i = 0; i < count; ++i)
        if (rows.pass[i] === pass && (best < 0 || beats(i, best))) best = i;
      if (best >= 0) this.actions.select(best);
    }

    select(row) {
      this.row = row;
      $("map-pose").textContent = "Click in the map: the arm in that pose stands in the 3-D view.";
      if (this.data.rows.pass[row] !== this.pass) {
        this.pass = this.data.rows.pass[row];
        this.collect();
        this.fillBranches();
        this.compose();
        this.stale = true;
      }
      this.explain();
      this.schedule();
    }

    // The sampled points of the pass: a column each, from half-way to the one before to half-way to the next.
    collect() {
      const { data } = this, { rows } = data, begin = data.passes[this.pass].begin_mm;
      const parts = data.curves.parts(), n = this.steps;
      this.rows = [];
      for (let i = 0; i < data.count; ++i) if (rows.pass[i] === this.pass) this.rows.push(i);
      this.columns = [];
      for (let k = 0; k < data.curves.number.length; ++k) {
        const row = m.rowOf(data, data.curves.number[k]);
        if (data.rows.number[row] !== data.curves.number[k] || rows.pass[row] !== this.pass) continue;
        const zones = new Uint8Array(8 * n);
        for (let at = data.map.start[k], cell = 0; at < data.map.start[k + 1]; at += 2) {
          zones.fill(data.map.runs[at], cell, cell + data.map.runs[at + 1]);
          cell += data.map.runs[at + 1];
        }
        const value = (branch, i) => {
          const code = parts.values[4 * n * k + n * (branch & 3) + i];
          return code === 65535 ? NaN : parts.least[k] + (parts.span[k] * code) / 65534;
        };
        this.columns.push({ row, way: rows.way[row] - begin, zones, value });
      }
      this.columns.forEach((c, i) => {
        const before = this.columns[i - 1], after = this.columns[i + 1];
        c.from = before ? (before.way + c.way) / 2 : c.way;
        c.to = after ? (after.way + c.way) / 2 : c.way;
      });
      this.length = this.columns.length ? [this.columns[0].from, this.columns[this.columns.length - 1].to] : [0, 1];
      if (!(this.length[1] > this.length[0])) this.length[1] = this.length[0] + 1;
      this.centre();
    }

    // The path in the middle, unwound along the pass, so that the edge of the map cuts it only where it makes more than
    // a full revolution.
    centre() {
      const { curves, column } = this.data, rotation = column.rotation.values;
      let last = NaN, low = Infinity, high = -Infinity;
      for (const row of this.rows) {
        if (Number.isNaN(rotation[row])) continue;
        last = Number.isNaN(last) ? rotation[row] : rotation[row] - 360 * Math.round((rotation[row] - last) / 360);
        low = Math.min(low, last);
        high = Math.max(high, last);
      }
      const middle = low <= high ? 15 * Math.round((low + high) / 30) : 0;
      this.shift = Math.round((middle - 180 - curves.first_deg) / curves.step_deg);
    }
    // The rotation at which row j of the map, from below, lies; its cell of the sampled grid.
    rotationOf(j) {
      return this.data.curves.first_deg + (j + this.shift) * this.data.curves.step_deg;
    }
    cellIndex(j) {
      return (((j + this.shift) % this.steps) + this.steps) % this.steps;
    }
    // The angle as the map shows it, and as it is reported.
    shown(degrees) {
      const low = this.rotationOf(-0.5);
      return low + ((((degrees - low) % 360) + 360) % 360);
    }
    principal(degrees) {
      return degrees - 360 * Math.ceil(degrees / 360 - 0.5);
    }

    // The branches that are of use somewhere in the pass; those of the path are named.
    fillBranches() {
      const used = new Map(), planned = new Set(), { rows } = this.data, n = this.steps;
      for (const { zones } of this.columns)
        zones.forEach((zone, i) => { if (zone >= m.ZONE.UNCHECKED) used.set(Math.floor(i / n), true); });
      for (const row of this.rows) if (rows.status[row] === 0) planned.add(rows.branch[row]);
      const list = [...used.keys()].sort((a, b) => a - b);
      $("map-branch").replaceChildren(m.element("option", { value: "all" }, "best of all"),
        ...list.map((b) => m.element("option", { value: b }, `S${b}${planned.has(b) ? " (the path's)" : ""}`)));
      if (planned.size === 1) $("map-branch").value = String([...planned][0]);
    }

    // What each cell shows: of one branch, or the best that is not known to interfere, else what bars the best.
    compose() {
      const choice = $("map-branch").value, n = this.steps;
      const branches = choice === "all" ? [0, 1, 2, 3, 4, 5, 6, 7] : [Number(choice)];
      this.cells = this.columns.map(({ zones, value }) => Array.from({ length: n }, (_, i) => {
        let best = null;
        for (const branch of branches) {
          const zone = zones[branch * n + i], v = value(branch, i);
          const open = zone === m.ZONE.FREE || zone === m.ZONE.UNCHECKED;
          const rank = open ? 0 : zone >= m.ZONE.PAIR ? 1 : zone >= 2 ? 2 : zone === 1 ? 3 : 4;
          const cell = { zone, branch, rank, value: v };
          const better = !best || rank < best.rank || (rank === best.rank && (v < best.value || (v === best.value && zone === m.ZONE.FREE)));
          if (better) best = cell;
        }
        return best;
      }));
      this.scale = this.valueRange();
    }

    // From the least value to the worst of path and optima, with a little room.
    valueRange() {
      const f = this.data.column.objective.values;
      let low = Infinity, high = -Infinity, most = -Infinity;
      for (const column of this.cells)
        for (const { rank, value } of column)
          if (rank === 0 && value === value) [low, most] = [Math.min(low, value), Math.max(most, value)];
      for (const row of this.rows) if (f[row] === f[row]) [low, high] = [Math.min(low, f[row]), Math.max(high, f[row])];
      if (!(low < Infinity)) return { low: 0, high: 1 };
      high = Math.max(1.15 * high, low + 0.25 * (high - low), 1.5 * low);
      return { low, high: Math.min(high, Math.max(most, low * 1.01)) };
    }

    share(value) {
      return (value - this.scale.low) / (this.scale.high - this.scale.low || 1);
    }

    draw() {
      if (this.pass === undefined) return;
      if (!this.stale) {
        this.plot.moveCursor(this);
        return;
      }
      this.stale = false;
      $("map-title").textContent = `Axis map of pass ${this.data.passes[this.pass].pass}`;
      this.plot.draw(this);
      this.drawLegend();
    }

    drawLegend() {
      const seen = new Set(), { low, high } = this.scale, unit = this.data.objective.unit;
      for (const column of this.cells) for (const { zone } of column) seen.add(zone);
      const line = (colour, words) => m.element("span", {}, m.element("i", { style: `background:${colour};width:22px;height:4px;vertical-align:3px` }), words);
      const values = (zone, words) => m.element("span", {}, m.zoneSwatch(zone, 40), words);
      $("map-legend").replaceChildren(
        line(m.MAP_INK, "path"), line(m.MAP_OWN, "each point's own best pose, interference left aside"),
        m.element("span", {}, `${m.format(low, 3)} `, m.zoneSwatch(m.ZONE.FREE, 90), `${m.format(high, 3)} ${unit} and more (bright: soft), free`),
        ...(seen.has(m.ZONE.UNCHECKED) ? [values(m.ZONE.UNCHECKED, "paler: not checked for interference")] : []),
        ...[...seen].filter((z) => z < m.ZONE.UNCHECKED || z >= m.ZONE.PAIR).sort((a, b) => b - a).map((z) => m.element("span", {}, m.zoneSwatch(z, 26), `${z >= m.ZONE.PAIR ? "interference: " : ""}${m.zoneName(this.data, z)}`)));
    }

    // The place under the pointer: row, rotation in degrees, cell.
    at(event) {
      const [px, py] = this.canvas.place(event), a = this.plot.axes;
      if (!a || this.columns.length === 0 || px < a.left || px > a.right || py < a.top || py > a.bottom) return null;
      const way = a.valueAt(px), column = this.columns.findIndex((c) => way <= c.to);
      const k = column < 0 ? this.columns.length - 1 : column, share = (a.bottom - py) / (a.bottom - a.top);
      const j = Math.max(0, Math.min(this.steps - 1, Math.floor(share * this.steps)));
      return { row: this.columns[k].row, rotation: this.principal(this.rotationOf(j)), cell: this.cells[k][this.cellIndex(j)] };
    }

    words({ row, rotation, cell }) {
      const unit = this.data.objective.unit, value = Number.isNaN(cell.value) ? "" : `, ${m.withUnit(cell.value, unit)}`;
      return `point ${this.data.rows.number[row]}, ${m.format(rotation)}°, S${cell.branch}${value}: ${m.zoneName(this.data, cell.zone)}`;
    }
    tell(place) {
      $("map-value").textContent = place ? this.words(place) : "";
    }
    pick(place) {
      if (!place) return;
      this.actions.select(place.row);
      const joints = place.cell.zone === 0 ? null : m.jointsAt(this.data, place.row, place.rotation, place.cell.branch);
      $("map-pose").textContent = joints ? `The 3-D view shows ${this.words(place)}. ← and → go back to the path.` : `No pose to show: ${this.words(place)}.`;
      if (joints && this.scene) this.scene.pose(joints, place.cell.zone >= m.ZONE.PAIR ? this.data.map.pairs[place.cell.zone - m.ZONE.PAIR] || "" : "", m.baseAt(this.data, place.row));
    }

    // What the worst point of the pass, and the selected one, give up and why.
    explain() {
      const { data } = this, f = data.column.objective.values, unit = data.objective.unit, row = this.row;
      const value = (v) => m.withUnit(v, unit), own = data.optima.own[row], free = data.optima.free[row];
      const words = [];
      if (data.rows.status[row] === 0 && own > 0) {
        const branch = (b) => `S${(data.map.branches[row] >> b) & 15}`, pair = data.map.pairs[data.map.barred[row] - 1];
        words.push(`Point ${data.rows.number[row]}: ${value(f[row])} on the path at ${m.format(data.column.rotation.values[row])}°, S${data.rows.branch[row]};`,
          `its best pose would give ${value(own)} at ${m.format(data.map.own[row])}°, ${branch(4)}${pair ? `, but there ${m.pairText(pair)} interfere` : ""}${pair || free > 1.001 * own ? `; its best free one ${value(free)} at ${m.format(data.map.free[row])}°, ${branch(0)}` : `, free of interference${f[row] > 1.01 * own ? ": what keeps the path from it is that the joints may not jump on the way there or back" : ""}`}.`);
      }
      const worst = (values) => this.rows.reduce((most, r) => (data.rows.status[r] === 0 && data.rows.kind[r] === 0 && values[r] > most ? values[r] : most), 0);
      const [b, s, p] = [worst(data.optima.own), worst(data.optima.free), worst(f)];
      if (b > 0) words.push(`Worst of this pass: ${value(p)} on the path, ${value(s)} with every point in its best free pose, ${value(b)} with interference left aside.`);
      $("map-why").textContent = words.join(" ");
    }
  };
})((window.millpose = window.millpose || {}));

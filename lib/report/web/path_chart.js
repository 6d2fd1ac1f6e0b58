// SPDX-License-Identifier: GPL-3.0-or-later
// One chart along the path; all of them share zoom, cursor and the marks of passes.
(function (m) {
  "use strict";

  // Along-the-path chart. `group`: {x, broken, bands, range, selected, hovered, pick, hover, zoom} shared by all.
  m.PathChart = class {
    constructor(parent, group, title, unit, series, height) {
      this.group = group;
      this.unit = unit;
      this.series = series;
      this.box = m.element("section", { class: "chart" });
      this.legend = m.element("div", { class: "legend" });
      this.title = m.element("h3", {}, title);
      this.box.append(m.element("div", { class: "chart-head" }, this.title, this.legend));
      parent.append(this.box);
      this.canvas = new m.Canvas(this.box, height, `${title} along the path`);
      this.drag = null;
      this.stale = true;
      this.schedule = m.atNextFrame(() => this.draw(), this.box);
      this.listen();
    }
    listen() {
      const node = this.canvas.node;
      node.addEventListener("pointerdown", (e) => {
        this.drag = { from: this.canvas.place(e)[0], to: this.canvas.place(e)[0] };
        node.setPointerCapture(e.pointerId);
      });
      node.addEventListener("pointermove", (e) => {
        const [x] = this.canvas.place(e);
        if (this.drag) this.drag.to = x;
        this.group.hover(this.rowAt(x));
      });
      node.addEventListener("pointerleave", () => this.group.hover(-1));
      node.addEventListener("pointerup", () => {
        if (!this.drag) return;
        const ends = [this.drag.from, this.drag.to].sort((a, b) => a - b);
        this.drag = null;
        if (ends[1] - ends[0] > 6) this.group.zoom(ends.map((p) => this.axes.valueAt(p)));
        else this.group.pick(this.rowAt(ends[0]));
      });
      node.addEventListener("dblclick", () => this.group.zoom(null));
    }
    rowAt(pixel) {
      const x = this.group.x, wanted = this.axes.valueAt(pixel);
      let low = 0, high = x.length - 1;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (x[middle] < wanted) low = middle + 1;
        else high = middle;
      }
      return low > 0 && wanted - x[low - 1] < x[low] - wanted ? low - 1 : low;
    }
    showValues() {
      const row = this.group.hovered >= 0 ? this.group.hovered : this.group.selected;
      this.legend.replaceChildren(
        ...this.series.map((s) =>
          m.element("span", {}, m.swatch(s.number), `${s.symbol} `,
            m.element("b", {}, m.withUnit(s.values[row], this.unit, s.bound)))));
    }
    // Everything but the cursor, which moves with every key.
    redraw() {
      this.stale = true;
      this.schedule();
    }
    draw() {
      if (this.stale) this.drawBase();
      this.stale = false;
      const context = this.canvas.restore(), g = this.group;
      this.axes.clip(context, () => {
        this.drawCursor(context, g.hovered, m.theme.hint, 3);
        this.drawCursor(context, g.selected, m.theme.ink, 4);
        if (this.drag && Math.abs(this.drag.to - this.drag.from) > 6) {
          context.globalAlpha = 0.18;
          context.fillStyle = m.theme.accent;
          context.fillRect(this.drag.from, this.axes.top, this.drag.to - this.drag.from, this.axes.bottom - this.axes.top);
          context.globalAlpha = 1;
        }
      });
      this.showValues();
    }
    drawBase() {
      const context = this.canvas.begin(), g = this.group;
      const range = g.range || [g.x[0], g.x[g.x.length - 1]];
      this.axes = new m.Axes(this.canvas, range, [0, 1]);
      let first = this.rowAt(this.axes.left), last = this.rowAt(this.axes.right);
      first = Math.max(0, first - 1);
      last = Math.min(g.x.length - 1, last + 1);
      while (first > 0 && g.x[first - 1] >= range[0]) --first;
      while (last < g.x.length - 1 && g.x[last + 1] <= range[1]) ++last;
      this.axes.yRange = m.valueRange(this.series.map((s) => s.values), first, last);
      this.drawBands(context);
      this.axes.draw(context, "mm along the path", this.unit);
      this.axes.clip(context, () => {
        context.lineWidth = 1.6;
        context.lineJoin = "round";
        for (const s of this.series) {
          context.strokeStyle = m.SERIES[s.number];
          context.setLineDash(m.DASHES[s.number]);
          m.drawSeries(context, this.axes, g.x, s.values, first, last, g.broken);
        }
        context.setLineDash([]);
        this.drawSkipped(context, first, last);
      });
      this.canvas.keep();
    }
    drawBands(context) {
      this.group.bands.forEach((band, i) => {
        const from = Math.max(this.axes.left, this.axes.x(band.begin_mm));
        const to = Math.min(this.axes.right, this.axes.x(band.begin_mm + band.length_mm));
        if (to <= from) return;
        if (i % 2 === 1) {
          context.fillStyle = m.theme.band;
          context.fillRect(from, this.axes.top, to - from, this.axes.bottom - this.axes.top);
        }
        if (to - from > 26) {
          context.fillStyle = m.theme.hint;
          context.textAlign = "center";
          context.textBaseline = "top";
          context.fillText(to - from > 60 ? m.say(`pass ${band.pass}`) : band.pass, (from + to) / 2, this.axes.top + 1);
        }
      });
    }
    drawSkipped(context, first, last) {
      context.strokeStyle = m.RED;
      context.lineWidth = 1.5;
      for (let i = first; i <= last; ++i) {
        if (!this.group.skipped(i)) continue;
        const x = this.axes.x(this.group.x[i]);
        m.line(context, x, this.axes.bottom - 6, x, this.axes.bottom);
      }
    }
    drawCursor(context, row, colour, radius) {
      if (row < 0) return;
      const x = Math.round(this.axes.x(this.group.x[row])) + 0.5;
      context.strokeStyle = colour;
      context.lineWidth = 1;
      m.line(context, x, this.axes.top, x, this.axes.bottom);
      for (const s of this.series)
        if (!Number.isNaN(s.values[row])) m.dot(context, x, this.axes.y(s.values[row]), radius, m.SERIES[s.number]);
    }
  };
})((window.millpose = window.millpose || {}));

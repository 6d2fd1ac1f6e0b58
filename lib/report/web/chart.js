// SPDX-License-Identifier: GPL-3.0-or-later
// Line charts on a canvas: axes with round ticks, series thinned to the pixels, a cursor that all charts share.
(function (m) {
  "use strict";

  const INK = "#27313b", FAINT = "#e3e7eb", MUTED = "#6a7683";
  const MARGIN = { left: 58, right: 12, top: 10, bottom: 24 };

  // Round tick values that cover low..high in about `count` steps.
  m.ticks = function (low, high, count) {
    const span = high - low;
    if (!(span > 0)) return [low];
    const raw = span / Math.max(1, count), power = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= raw * 0.999);
    const list = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * span; ++i) list.push(i * step);
    return list;
  };
  m.tickText = function (value, list) {
    const step = list.length > 1 ? list[1] - list[0] : Math.abs(value) || 1;
    return value.toFixed(Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9))));
  };

  // A canvas that fills its parent's width, drawn in CSS pixels.
  m.Canvas = class {
    constructor(parent, height, label) {
      this.height = height;
      this.node = m.element("canvas", { role: "img", "aria-label": label });
      this.node.style.height = height + "px";
      parent.append(this.node);
      // Long lines are drawn faster by the processor than by a graphics card that is emulated, and as fast as by a real one.
      this.context = this.node.getContext("2d", { willReadFrequently: true });
    }
    begin() {
      const ratio = window.devicePixelRatio || 1;
      this.width = this.node.parentNode.clientWidth || 300;
      this.node.style.width = this.width + "px";
      this.node.width = Math.round(this.width * ratio);
      this.node.height = Math.round(this.height * ratio);
      this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.context.font = "11px system-ui, sans-serif";
      return this.context;
    }
    place(event) {
      const box = this.node.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    }
  };

  // Axes of one plot. x and y map values to pixels, inverse of x maps back.
  m.Axes = class {
    constructor(canvas, xRange, yRange) {
      this.left = MARGIN.left;
      this.top = MARGIN.top;
      this.right = canvas.width - MARGIN.right;
      this.bottom = canvas.height - MARGIN.bottom;
      this.xRange = xRange;
      this.yRange = yRange;
    }
    x(value) {
      const [a, b] = this.xRange;
      return this.left + ((value - a) / (b - a || 1)) * (this.right - this.left);
    }
    y(value) {
      const [a, b] = this.yRange;
      return this.bottom - ((value - a) / (b - a || 1)) * (this.bottom - this.top);
    }
    valueAt(pixel) {
      const [a, b] = this.xRange;
      return a + ((pixel - this.left) / (this.right - this.left || 1)) * (b - a);
    }
    inside(pixel) {
      return pixel >= this.left - 4 && pixel <= this.right + 4;
    }
    draw(context, xLabel, yLabel, xTicks) {
      const xs = xTicks || m.ticks(...this.xRange, (this.right - this.left) / 90);
      const ys = m.ticks(...this.yRange, (this.bottom - this.top) / 34);
      context.lineWidth = 1;
      context.strokeStyle = FAINT;
      context.fillStyle = MUTED;
      context.textAlign = "right";
      context.textBaseline = "middle";
      for (const value of ys) {
        const y = Math.round(this.y(value)) + 0.5;
        m.line(context, this.left, y, this.right, y);
        context.fillText(m.tickText(value, ys), this.left - 6, y);
      }
      context.textAlign = "center";
      context.textBaseline = "top";
      const free = this.right - (xLabel ? context.measureText(xLabel).width + 22 : -30);
      for (const value of xs) {
        const x = Math.round(this.x(value)) + 0.5;
        if (x < free) context.fillText(m.tickText(value, xs), x, this.bottom + 6);
      }
      context.textAlign = "right";
      if (xLabel) context.fillText(xLabel, this.right, this.bottom + 6);
      context.save();
      context.translate(11, (this.top + this.bottom) / 2);
      context.rotate(-Math.PI / 2);
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.fillText(yLabel, 0, 0);
      context.restore();
      context.strokeStyle = "#b4bdc6";
      m.line(context, this.left, this.bottom + 0.5, this.right, this.bottom + 0.5);
    }
    clip(context, draw) {
      context.save();
      context.beginPath();
      context.rect(this.left, this.top - 4, this.right - this.left, this.bottom - this.top + 5);
      context.clip();
      draw();
      context.restore();
    }
  };

  m.line = function (context, x0, y0, x1, y1) {
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    context.stroke();
  };

  m.dot = function (context, x, y, radius, fill) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = fill;
    context.fill();
    context.lineWidth = 1.5;
    context.strokeStyle = "#fff";
    context.stroke();
  };

  // Least to largest value of several series between two rows, with a little air; 0 is shown when it is near.
  m.valueRange = function (series, first, last) {
    let low = Infinity, high = -Infinity;
    for (const values of series) {
      for (let i = first; i <= last; ++i) {
        const v = values[i];
        if (v < low) low = v;
        if (v > high) high = v;
      }
    }
    if (!(low <= high)) return [0, 1];
    const span = high - low || Math.abs(high) || 1;
    const start = low >= 0 && low < 0.35 * high ? 0 : low - 0.06 * span;
    return [start, high + 0.08 * span];
  };

  // Draws y(x) through the rows first..last, at most four points a pixel; `broken(i)` parts row i from i − 1.
  m.drawSeries = function (context, axes, x, values, first, last, broken) {
    context.beginPath();
    let pen = false, pixel = NaN, low = 0, high = 0, end = 0;
    const flush = () => {
      if (low !== high || high !== end) {
        context.lineTo(pixel, low);
        context.lineTo(pixel, high);
        context.lineTo(pixel, end);
      }
    };
    for (let i = first; i <= last; ++i) {
      const gone = Number.isNaN(values[i]);
      if (gone || broken(i)) {
        if (pen) flush();
        pen = false;
        if (gone) continue;
      }
      const px = Math.round(axes.x(x[i])), py = axes.y(values[i]);
      if (pen && px === pixel) {
        low = Math.min(low, py);
        high = Math.max(high, py);
        end = py;
        continue;
      }
      if (pen) {
        flush();
        context.lineTo(px, py);
      } else {
        context.moveTo(px, py);
        context.lineTo(px + 0.01, py);
      }
      pen = true;
      pixel = px;
      low = high = end = py;
    }
    if (pen) flush();
    context.stroke();
  };

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
          m.element("span", {}, m.element("i", { style: `background:${s.colour}` }), `${s.symbol} `,
            m.element("b", {}, m.withUnit(s.values[row], this.unit, s.bound)))));
    }
    draw() {
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
        context.lineWidth = 1.4;
        context.lineJoin = "round";
        for (const s of this.series) {
          context.strokeStyle = s.colour;
          m.drawSeries(context, this.axes, g.x, s.values, first, last, g.broken);
        }
        this.drawSkipped(context, first, last);
        this.drawCursor(context, g.hovered, "#9aa5b0", 3);
        this.drawCursor(context, g.selected, INK, 4);
        if (this.drag && Math.abs(this.drag.to - this.drag.from) > 6) {
          context.fillStyle = "rgba(43,95,168,.15)";
          context.fillRect(this.drag.from, this.axes.top, this.drag.to - this.drag.from, this.axes.bottom - this.axes.top);
        }
      });
      this.showValues();
    }
    drawBands(context) {
      this.group.bands.forEach((band, i) => {
        const from = Math.max(this.axes.left, this.axes.x(band.begin_mm));
        const to = Math.min(this.axes.right, this.axes.x(band.begin_mm + band.length_mm));
        if (to <= from) return;
        if (i % 2 === 1) {
          context.fillStyle = "#f3f5f8";
          context.fillRect(from, this.axes.top, to - from, this.axes.bottom - this.axes.top);
        }
        if (to - from > 26) {
          context.fillStyle = "#9aa5b0";
          context.textAlign = "center";
          context.textBaseline = "top";
          context.fillText(to - from > 60 ? `pass ${band.pass}` : band.pass, (from + to) / 2, this.axes.top + 1);
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
        if (!Number.isNaN(s.values[row])) m.dot(context, x, this.axes.y(s.values[row]), radius, s.colour);
    }
  };
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// Line charts on a canvas: axes with round ticks, series thinned to the pixels.
(function (m) {
  "use strict";

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

  // How series are distinguished beside their colours.
  m.DASHES = [[], [7, 3], [2, 2.5], [10, 3, 2, 3], [4, 4], [12, 3, 2, 3, 2, 3]];
  // A line of a series for its legend.
  m.swatch = (number) => m.markup(`<svg class="swatch" width="24" height="10" aria-hidden="true"><line x1="0" x2="24" y1="5" y2="5" stroke-width="3" stroke-dasharray="${m.DASHES[number].join(" ")}" style="stroke: var(--s${number + 1})"/></svg>`);

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
      const ratio = m.pixelRatio();
      this.width = m.paperWidth || this.node.parentNode.clientWidth || 300;
      this.node.style.width = this.width + "px";
      this.node.width = Math.round(this.width * ratio);
      this.node.height = Math.round(this.height * ratio);
      this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.context.font = "11px system-ui, sans-serif";
      return this.context;
    }
    // What is drawn so far comes back with restore(), for what moves above it.
    keep() {
      this.kept = this.context.getImageData(0, 0, this.node.width, this.node.height);
    }
    restore() {
      this.context.putImageData(this.kept, 0, 0);
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
      context.strokeStyle = m.theme.faint;
      context.fillStyle = m.theme.muted;
      context.textAlign = "right";
      context.textBaseline = "middle";
      for (const value of ys) {
        const y = Math.round(this.y(value)) + 0.5;
        m.line(context, this.left, y, this.right, y);
        context.fillText(m.tickText(value, ys), this.left - 6, y);
      }
      context.textAlign = "center";
      context.textBaseline = "top";
      [xLabel, yLabel] = [m.say(xLabel), m.say(yLabel)];
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
      context.strokeStyle = m.theme.axis;
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
    context.strokeStyle = m.theme.card;
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
})((window.millpose = window.millpose || {}));

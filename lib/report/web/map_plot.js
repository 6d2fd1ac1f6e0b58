// SPDX-License-Identifier: GPL-3.0-or-later
// Draws an axis map: the cells, names on large zones, the points' own best poses, the path, the selected point.
(function (m) {
  "use strict";

  const HEIGHT = 380, LEAP = 20;
  m.MAP_OWN = "#e6007e";
  m.MAP_INK = "#11181f";

  m.MapPlot = class {
    constructor(parent, data) {
      this.data = data;
      this.canvas = new m.Canvas(parent, HEIGHT, "Axis map of the pass");
    }

    // `map`: columns {row, way, to}, cells [column][rotation], length, shown, rotationOf, cellIndex, share, steps, pass, rows, row.
    draw(map) {
      const context = this.canvas.begin(), { rows } = this.data;
      this.map = map;
      this.axes = new m.Axes(this.canvas, map.length, [map.rotationOf(-0.5), map.rotationOf(map.steps - 0.5)]);
      if (map.columns.length === 0) {
        context.fillText(m.say("No point of this pass was sampled."), this.axes.left, this.axes.top + 12);
        return;
      }
      this.drawAxes(context);
      this.paint(context);
      this.axes.clip(context, () => {
        const own = this.lines(this.data.map.own, () => true);
        this.stroke(context, own, m.MAP_OWN, 2, 2);
        this.stroke(context, this.lines(this.data.column.rotation.values, (row) => rows.status[row] === 0), m.MAP_INK, 4, 3);
        this.stroke(context, own, m.MAP_OWN, 1.5, 0);  // seen within the path where that is at the best pose
        this.drawNames(context);
      });
      this.canvas.keep();
      this.drawCursor();
    }

    // The cursor alone, above what was drawn last.
    moveCursor(map) {
      this.map = map;
      if (map.columns.length === 0) return;
      this.canvas.restore();
      this.drawCursor();
    }

    wayOf(row) {
      return this.data.rows.way[row] - this.data.passes[this.map.pass].begin_mm;
    }

    drawAxes(context) {
      const a = this.axes;
      a.draw(context, "mm along the pass", "");
      context.fillStyle = m.theme.card;
      context.fillRect(0, 0, a.left - 1, a.bottom + 4);
      context.fillStyle = m.theme.muted;
      context.textAlign = "right";
      context.textBaseline = "middle";
      for (let t = 45 * Math.ceil(a.yRange[0] / 45); t <= a.yRange[1]; t += 45)
        context.fillText(String(this.map.principal(t)), a.left - 6, Math.max(a.top + 5, Math.min(a.bottom - 4, a.y(t))));
      context.save();
      context.translate(11, (a.top + a.bottom) / 2);
      context.rotate(-Math.PI / 2);
      context.textAlign = "center";
      context.fillText(m.say("° rotation about the tool axis"), 0, 0);
      context.restore();
    }

    // Every pixel of the plot: its column, its rotation, its colour.
    paint(context) {
      const { map } = this, ratio = this.canvas.node.width / this.canvas.width, a = this.axes, n = map.steps;
      const left = Math.round(a.left * ratio), top = Math.round(a.top * ratio);
      const width = Math.round(a.right * ratio) - left, height = Math.round(a.bottom * ratio) - top;
      const image = context.createImageData(width, height), bytes = image.data;
      const share = (v) => map.share(v);
      const looks = map.cells.map((column) => column.map((cell) => m.cellColour(cell, share) || m.zoneStyle(cell.zone)));
      let at = 0;
      for (let x = 0; x < width; ++x) {
        const way = map.length[0] + ((x + 0.5) / width) * (map.length[1] - map.length[0]);
        while (at + 1 < map.columns.length && way > map.columns[at].to) ++at;
        for (let y = 0; y < height; ++y) {
          const look = looks[at][map.cellIndex(Math.min(n - 1, Math.floor((1 - (y + 0.5) / height) * n)))];
          const rgb = look.ground ? m.hatched(look, Math.floor(x / ratio), Math.floor(y / ratio)) : look, to = 4 * (width * y + x);
          bytes[to] = rgb[0];
          bytes[to + 1] = rgb[1];
          bytes[to + 2] = rgb[2];
          bytes[to + 3] = 255;
        }
      }
      context.putImageData(image, left, top);
    }

    text(context, words, x, y) {
      context.font = "600 11px system-ui, sans-serif";
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.lineJoin = "round";
      context.lineWidth = 4;
      context.strokeStyle = "rgba(255,255,255,.94)";
      context.strokeText(words, x, y);
      context.fillStyle = m.MAP_INK;
      context.fillText(words, x, y);
      context.font = "11px system-ui, sans-serif";
    }

    drawNames(context) {
      const { map } = this, n = map.steps, count = map.cells.length, zones = new Uint8Array(count * n), a = this.axes;
      for (let c = 0; c < count; ++c) for (let j = 0; j < n; ++j) zones[c * n + j] = map.cells[c][map.cellIndex(j)].zone;
      const taken = [];
      for (const large of m.largeZones(zones, count, n, 0.003 * count * n).slice(0, 16)) {
        const words = m.say(m.zoneName(this.data, large.zone)), width = 1.12 * context.measureText(words).width + 10;
        const high = (large.height / n) * (a.bottom - a.top);
        if (high < 12 || (large.width / count) * (a.right - a.left) < 0.4 * width) continue;
        const x = Math.max(a.left + width / 2, Math.min(a.right - width / 2, a.x(map.columns[large.column].way)));
        const y = a.bottom - ((large.row + 0.5) / n) * (a.bottom - a.top);
        if (taken.some((t) => Math.abs(t.x - x) < (t.width + width) / 2 && Math.abs(t.y - y) < 15)) continue;
        taken.push({ x, y, width });
        this.text(context, words, x, y);
      }
    }

    // Runs of rows with values, broken where the line would leap.
    lines(values, use) {
      const list = [], { piece } = this.data.rows;
      let last = null, before = 0;
      for (const row of this.map.rows) {
        if (!use(row) || Number.isNaN(values[row])) {
          last = null;
          continue;
        }
        const value = this.map.shown(values[row]), place = [this.axes.x(this.wayOf(row)), this.axes.y(value)];
        if (last !== null && Math.abs(value - before) < LEAP && piece[row] === piece[last]) list[list.length - 1].push(place);
        else list.push([place]);
        last = row;
        before = value;
      }
      return list;
    }

    stroke(context, lines, colour, width, halo) {
      for (const [ink, w] of [["rgba(255,255,255,.95)", width + halo], [colour, width]]) {
        context.strokeStyle = context.fillStyle = ink;
        context.lineWidth = w;
        context.lineJoin = context.lineCap = "round";
        for (const line of lines) {
          context.beginPath();
          if (line.length === 1) {
            context.arc(line[0][0], line[0][1], w / 2 + 0.3, 0, 2 * Math.PI);
            context.fill();
            continue;
          }
          line.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
          context.stroke();
        }
      }
    }

    drawCursor() {
      const { context } = this.canvas;
      const at = Math.round(this.axes.x(this.wayOf(this.map.row)));  // whole at either end of the map, too
      const x = Math.max(this.axes.left + 1, Math.min(this.axes.right - 1, at)) + 0.5;
      context.lineWidth = 1.5;
      context.setLineDash([5, 5]);
      for (const [colour, offset] of [["#fff", 0], [m.MAP_INK, 5]]) {
        context.strokeStyle = colour;
        context.lineDashOffset = offset;
        m.line(context, x, this.axes.top, x, this.axes.bottom);
      }
      context.setLineDash([]);
      context.lineDashOffset = 0;
    }
  };
})((window.millpose = window.millpose || {}));

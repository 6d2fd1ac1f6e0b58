// SPDX-License-Identifier: GPL-3.0-or-later
// The material while it is milled off: on each line of a lattice from its lowest to its highest place, drawn as two
// faces with walls around; coloured by what stands over the finished part.
(function (m) {
  "use strict";

  const NONE = 65535, DONE = 0.05;  // mm: as good as nothing left, or as good as no gouge
  const SOON = 1e-3;  // s: times are floats
  const SCRAP = [0.62, 0.6, 0.56], FINISHED = [0.79, 0.82, 0.84], GOUGE = [0.85, 0.15, 0.1];

  m.readRemoval = function (raw, { floats, uint32, uint16 }) {
    return Object.assign({}, raw, { blank: uint16(raw.blank), part: uint16(raw.part), time: floats(raw.time_s), left: floats(raw.left_cm3),
      changed: uint32(raw.changed), lines: uint32(raw.lines), ends: uint16(raw.ends) });
  };

  m.Stock = class {
    constructor(removal, X_WP) {
      const { rows, columns, range_mm } = (this.raw = removal);
      const count = (this.count = rows * columns);
      this.step = (range_mm[1] - range_mm[0]) / 65534;
      this.steps = removal.blank.slice();
      this.position = new Float32Array(6 * count);  // all lower ends, then all upper ends
      this.colours = new Float32Array(6 * count);
      this.corners = new Uint32Array(36 * (rows - 1) * (columns - 1));
      const a = removal.along, b = (a + 1) % 3, c = (a + 2) % 3;
      for (let line = 0; line < count; ++line)
        for (const at of [3 * line, 3 * (count + line)]) {
          this.position[at + b] = removal.origin_mm[b] + (line % columns) * removal.spacing_mm;
          this.position[at + c] = removal.origin_mm[c] + Math.floor(line / columns) * removal.spacing_mm;
        }
      this.most = DONE * 2;
      for (let line = 0; line < count; ++line) this.most = Math.max(this.most, ...this.over(line));
      const geometry = (this.geometry = new THREE.BufferGeometry());
      geometry.setAttribute("position", new THREE.BufferAttribute(this.position, 3));
      geometry.setAttribute("color", new THREE.BufferAttribute(this.colours, 3));
      geometry.setIndex(new THREE.BufferAttribute(this.corners, 1));
      // Behind what it coincides with: the finished part, the path on it.
      this.mesh = new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({ vertexColors: THREE.VertexColors, flatShading: true, shininess: 0, side: THREE.DoubleSide,
        polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4 }));
      this.mesh.matrixAutoUpdate = false;
      this.mesh.matrix = new THREE.Matrix4().set(...X_WP);
      this.mesh.frustumCulled = false;
      this.frame = this.next = 0;
      for (let line = 0; line < count; ++line) this.put(line);
      this.join();
    }

    stands(line) {
      return this.steps[2 * line + 1] > 0 || this.steps[2 * line] !== NONE;
    }
    // What stands over the part below and above, mm; less than 0: a gouge. Nothing where the line misses the part.
    over(line) {
      const { part, blank } = this.raw, at = 2 * line;
      if (part[at] === NONE || !this.stands(line)) return [];
      // Where the raw part never was, nothing is missing.
      const low = Math.max(part[at], blank[at]), high = Math.min(part[at + 1], blank[at + 1]);
      return [(low - this.steps[at]) * this.step, (this.steps[at + 1] - high) * this.step];
    }
    colourOf(over) {
      if (over === undefined) return SCRAP;
      if (over < -DONE) return GOUGE;
      return over <= DONE ? FINISHED : m.viridis(this.share(over));
    }
    // 0 to 1 by its logarithm: a finishing allowance can be told from nothing beside a deep pocket.
    share(over) {
      return Math.log(over / DONE) / Math.log(this.most / DONE);
    }
    mm(share) {
      return DONE * (this.most / DONE) ** share;
    }

    put(line) {
      if (!this.stands(line)) return;
      const over = this.over(line);
      for (const k of [0, 1]) {
        const at = 3 * (k * this.count + line);
        this.position[at + this.raw.along] = this.raw.range_mm[0] + this.steps[2 * line + k] * this.step;
        this.colours.set(this.colourOf(over[k]), at);
      }
    }

    // The faces between lines that stand.
    join() {
      const { rows, columns } = this.raw, { count, corners } = this;
      const whole = (i, j) => {
        if (i < 0 || j < 0 || i + 1 >= rows || j + 1 >= columns) return false;
        const a = i * columns + j;
        return this.stands(a) && this.stands(a + 1) && this.stands(a + columns) && this.stands(a + columns + 1);
      };
      let to = 0;
      const face = (a, b, c, d) => {
        for (const corner of [a, b, c, a, c, d]) corners[to++] = corner;
      };
      const wall = (a, b) => face(a, b, b + count, a + count);
      for (let i = 0; i + 1 < rows; ++i)
        for (let j = 0; j + 1 < columns; ++j) {
          if (!whole(i, j)) continue;
          const a = i * columns + j, b = a + 1, d = a + columns, c = d + 1;
          face(a, d, c, b);
          face(a + count, b + count, c + count, d + count);
          if (!whole(i - 1, j)) wall(a, b);
          if (!whole(i + 1, j)) wall(c, d);
          if (!whole(i, j - 1)) wall(d, a);
          if (!whole(i, j + 1)) wall(b, c);
        }
      this.geometry.setDrawRange(0, to);
      const { index } = this.geometry;
      index.updateRange = { offset: 0, count: to };
      index.needsUpdate = true;
    }

    // As it stands at a time of the run, s.
    seek(seconds) {
      const { time, changed, lines, ends, blank } = this.raw;
      let parted = false;
      if (this.frame > 0 && time[this.frame - 1] > seconds + SOON) {
        this.steps.set(blank);
        this.frame = this.next = 0;
        for (let line = 0; line < this.count; ++line) this.put(line);
        parted = true;
      }
      const first = this.next;
      while (this.frame < time.length && time[this.frame] <= seconds + SOON) {
        for (let k = 0; k < changed[this.frame]; ++k, ++this.next) {
          const line = lines[this.next], stood = this.stands(line);
          this.steps[2 * line] = ends[2 * this.next];
          this.steps[2 * line + 1] = ends[2 * this.next + 1];
          parted = parted || stood !== this.stands(line);
        }
        ++this.frame;
      }
      if (this.next === first && !parted) return;
      for (let k = first; k < this.next; ++k) this.put(lines[k]);
      if (parted) this.join();
      for (const name of ["position", "color"]) this.geometry.attributes[name].needsUpdate = true;
    }

  };

  m.removedText = function ({ time, left, cm3 }, seconds) {
    let low = 0, high = time.length;  // how many frames have ended
    while (low < high) {
      const middle = (low + high) >> 1;
      if (time[middle] <= seconds + SOON) low = middle + 1;
      else high = middle;
    }
    const off = cm3 - (low === 0 ? cm3 : left[low - 1]);
    return `${off.toFixed(1)} of ${(cm3 - left[left.length - 1]).toFixed(1)} cm³ milled off`;
  };

  m.drawStockScale = function (stock) {
    const stops = Array.from({ length: 15 }, (_, i) => m.css(m.viridis(i / 14)));
    document.getElementById("stock-bar").style.background = `linear-gradient(to right, ${stops.join(",")})`;
    document.getElementById("stock-ticks").replaceChildren(...[0, 0.5, 1].map((t) => m.element("span", {}, m.format(stock.mm(t), 2))));
  };

  // The scale of its colours, and the box that shows it: ticked by the first Play, unless somebody has been there before.
  m.StockView = class {
    constructor(scene) {
      this.box = document.getElementById("show-stock");
      this.scale = document.getElementById("stock-scale");
      this.scene = scene;
      if (!scene || !scene.stock) {
        this.box.parentNode.remove();
        this.scale.remove();
        return;
      }
      m.drawStockScale(scene.stock);
      this.box.addEventListener("change", () => this.show(this.box.checked));
      this.show(false);
    }
    show(on) {
      this.asked = this.asked || on;
      this.box.checked = on;
      this.scale.hidden = !on;
      this.scene.show("stock", on);
    }
    showOnce() {
      if (this.scene && this.scene.stock && !this.asked) this.show(true);
    }
  };
})((window.millpose = window.millpose || {}));

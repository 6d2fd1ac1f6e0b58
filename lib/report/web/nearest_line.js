// SPDX-License-Identifier: GPL-3.0-or-later
// The distance of the nearest pair over the 3-D view: a line between the two nearest places, seen through all bodies, and what it is.
(function (m) {
  "use strict";

  m.NearestLine = class {
    constructor(parent) {
      this.lines = m.markup(`<svg id="nearest-line" aria-hidden="true"><line class="under"/><line/><circle r="3.5"/><circle r="3.5"/></svg>`);
      this.label = m.element("div", { class: "marker near" }, m.element("span"));
      parent.append(this.lines, this.label);
    }
    say(text) {
      this.label.firstChild.textContent = text;
    }
    // Between two places in W; null: nothing.
    draw(scene, ends) {
      const seen = ends ? ends.map((end) => scene.onScreen(end)) : [];
      const shown = seen.length === 2 && seen.every(([x, , depth]) => depth < 1 && Number.isFinite(x));  // a view of no size has no places
      this.lines.style.display = shown ? "block" : "none";
      scene.put(this.label, shown ? [0, 1, 2].map((k) => 0.5 * (ends[0][k] + ends[1][k])) : null, scene.width / 2);
      if (!shown) return;
      const set = (node, values) => Object.entries(values).forEach(([name, value]) => node.setAttribute(name, value.toFixed(1)));
      const [[x1, y1], [x2, y2]] = seen, [under, line, ...circles] = this.lines.children;
      for (const node of [under, line]) set(node, { x1, y1, x2, y2 });
      circles.forEach((node, i) => set(node, { cx: seen[i][0], cy: seen[i][1] }));
    }
  };
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// The axes of the world W in a corner of the 3-D view, as they stand on the screen; names, not colours, tell them apart.
(function (m) {
  "use strict";

  const SIZE = 84, LENGTH = 28;

  m.Triad = class {
    constructor(parent) {
      this.node = m.markup(`<svg id="triad" width="${SIZE}" height="${SIZE}" role="img" aria-label="Axes of the world W"></svg>`);
      parent.append(this.node);
    }
    draw(camera) {
      const view = new THREE.Matrix3().setFromMatrix4(camera.matrixWorldInverse).elements, middle = SIZE / 2;
      const axes = ["x", "y", "z"].map((name, k) => ({ name, x: view[3 * k], y: -view[3 * k + 1], depth: view[3 * k + 2] }));
      axes.sort((a, b) => a.depth - b.depth);  // what is nearer comes last
      const at = (value, length) => (middle + length * value).toFixed(1);
      this.node.innerHTML = axes.map(({ name, x, y }) =>
        `<line class="axis-${name}" x1="${middle}" y1="${middle}" x2="${at(x, LENGTH)}" y2="${at(y, LENGTH)}"/>` +
        `<text x="${at(x, LENGTH + 9)}" y="${at(y, LENGTH + 9)}">${name}</text>`).join("");
    }
  };
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// The face as the tool is expected to leave it, beside that of the best fixed rotation on the same scale.
(function (m) {
  "use strict";

  // Least and greatest value of several maps.
  function ends(maps) {
    let low = Infinity, high = -Infinity;
    for (const map of maps)
      for (const value of map) {
        if (Number.isNaN(value)) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    return low <= high ? { low, high } : { low: 0, high: 0 };
  }

  // One canvas pixel a place, the map's y upwards.
  function paint(face, map, scale) {
    const canvas = m.element("canvas", { width: face.nx, height: face.ny });
    const context = canvas.getContext("2d"), image = context.createImageData(face.nx, face.ny);
    const span = scale.high - scale.low;
    map.forEach((value, k) => {
      if (Number.isNaN(value)) return;
      const x = k % face.nx, y = face.ny - 1 - Math.floor(k / face.nx), at = 4 * (y * face.nx + x);
      m.viridis(span > 0 ? (value - scale.low) / span : 0.5).forEach((c, i) => (image.data[at + i] = Math.round(255 * c)));
      image.data[at + 3] = 255;
    });
    context.putImageData(image, 0, 0);
    canvas.style.aspectRatio = `${face.nx} / ${face.ny}`;
    return canvas;
  }

  m.fillFace = function (data) {
    const section = document.getElementById("face"), face = data.face;
    if (!face) {
      section.remove();
      return;
    }
    const shown = [{ name: "plan", of: face.plan }];
    if (face.fixed) shown.push({ name: `fixed rotation of ${m.format(face.fixed_deg)}°`, of: face.fixed });
    for (const one of shown) one.map = m.unpack.floats(one.of.added_um);
    const scale = ends(shown.map((one) => one.map));
    section.querySelector(".maps").append(...shown.map((one) =>
      m.element("figure", {}, paint(face, one.map, scale), m.element("figcaption", {}, `${one.name}, mean ${m.format(one.of.level_um)} µm`))));
    section.querySelector("p").textContent =
      `What the tool's errors add along the normal, less its mean, ${m.format(scale.low)} µm (dark) to ${m.format(scale.high)} µm (bright: material left); ` +
      `${face.across} to the right, ${face.up} upwards in the part's frame, a place every ${m.format(face.spacing_mm)} mm.`;
    // A table in columns, so it comes in each language as a whole.
    const write = () => { section.querySelector("pre").textContent = face.text[document.documentElement.lang]; };
    write();
    m.whenToldAnew(write);
  };
})((window.millpose = window.millpose || {}));

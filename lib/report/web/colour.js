// SPDX-License-Identifier: GPL-3.0-or-later
// Viridis: even to the eye, legible in grey and to the colour-blind. The bright end is always the worse one.
(function (m) {
  "use strict";

  const VIRIDIS = [
    [68, 1, 84], [71, 26, 108], [70, 49, 126], [64, 69, 136], [55, 89, 140], [46, 108, 142], [39, 126, 142],
    [33, 144, 141], [32, 162, 134], [53, 183, 121], [92, 200, 99], [143, 215, 68], [200, 224, 32], [253, 231, 37],
  ];

  // Colour of a share 0..1 as [r, g, b], each 0..1.
  m.viridis = function (share) {
    const at = Math.max(0, Math.min(1, share)) * (VIRIDIS.length - 1);
    const i = Math.min(VIRIDIS.length - 2, Math.floor(at)), t = at - i;
    return [0, 1, 2].map((k) => (VIRIDIS[i][k] * (1 - t) + VIRIDIS[i + 1][k] * t) / 255);
  };
  m.css = (rgb) => `rgb(${rgb.map((v) => Math.round(255 * v)).join(",")})`;

  // From a column's values to shares: low and high are the ends of the scale, `share` runs towards worse.
  m.scale = function (column, robust) {
    const spread = m.spread(column.values);
    let low = spread.low, high = spread.high;
    if (spread.count === 0) low = high = 0;
    else if (robust) [low, high] = [spread.at(0.02), spread.at(0.98)];
    const span = high - low, flip = column.worse < 0;
    return {
      low, high, flip,
      share(value) {
        const t = span > 0 ? (value - low) / span : 0.5;
        return flip ? 1 - t : t;
      },
    };
  };
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// What printing needs that a style sheet cannot say: the 3-D view as a picture, canvases as wide as the paper and finer,
// and everything that is folded on the screen.
(function (m) {
  "use strict";

  const WIDTH = 700, HEIGHT = 420, RATIO = 2;  // CSS pixels of an A4 page less its margins; pixels for each

  m.paperWidth = 0;

  m.onPaper = function (scene, redraw) {
    let opened = [];
    m.aroundPrint(
      () => {
        [m.paperWidth, m.paperRatio] = [WIDTH, RATIO];
        opened = [...document.querySelectorAll("details:not([open])")];
        for (const node of opened) node.open = true;
        redraw();
        m.drawAll();
        if (scene) scene.picture([WIDTH, HEIGHT]);
      },
      () => {
        [m.paperWidth, m.paperRatio] = [0, 0];
        for (const node of opened) node.open = false;
        if (scene) scene.picture(null);
        redraw();
      });
  };
})((window.millpose = window.millpose || {}));

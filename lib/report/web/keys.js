// SPDX-License-Identifier: GPL-3.0-or-later
// What the keys do; page.html lists them for people.
(function (m) {
  "use strict";

  const $ = (id) => document.getElementById(id);
  const TURN = 40, ZOOM = 0.15;  // pixels of a drag that a key stands for; share of the distance

  m.listenToKeys = function (data, actions, { scene, player, worst }) {
    const pass = (by) => {
      const { rows } = data, now = rows.pass[m.selected];
      for (let row = m.selected; row >= 0 && row < data.count; row += by)
        if (rows.pass[row] !== now) return actions.select(by > 0 ? row : rows.pass.indexOf(rows.pass[row]));
    };
    const turn = (dx, dy) => scene && scene.orbit.turn(dx, dy);
    const keys = {
      ArrowRight: () => actions.step(1),
      ArrowLeft: () => actions.step(-1),
      PageDown: () => pass(1),
      PageUp: () => pass(-1),
      Home: () => actions.select(0),
      End: () => actions.select(data.count - 1),
      " ": () => player && player.toggle(),
      ",": () => player && player.step(-1),
      ".": () => player && player.step(1),
      w: () => worst.places.length && actions.select(worst.places[0]),
      f: () => scene && scene.fit(false),
      a: () => scene && scene.fit(true),
      "+": () => scene && scene.orbit.zoom(-ZOOM),
      "-": () => scene && scene.orbit.zoom(ZOOM),
      d: m.toggleTheme,
      "?": () => { $("keys").open = !$("keys").open; },
      "shift ArrowRight": () => turn(TURN, 0),
      "shift ArrowLeft": () => turn(-TURN, 0),
      "shift ArrowUp": () => turn(0, -TURN),
      "shift ArrowDown": () => turn(0, TURN),
    };
    m.KEYS = Object.keys(keys);
    document.addEventListener("keydown", (e) => {
      const { tagName, type } = e.target;
      if (tagName === "SELECT" || (tagName === "INPUT" && type !== "checkbox") || e.altKey || e.ctrlKey || e.metaKey) return;
      if (e.key === " " && ["BUTTON", "A", "SUMMARY", "INPUT"].includes(tagName)) return;  // it presses what has the focus
      const work = keys[(e.shiftKey && e.key.startsWith("Arrow") ? "shift " : "") + e.key];
      if (!work) return;
      work();
      e.preventDefault();
    });
  };
})((window.millpose = window.millpose || {}));

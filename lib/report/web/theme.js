// SPDX-License-Identifier: GPL-3.0-or-later
// Light or dark: as the system says until the button is pressed; paper is always light. The colours stand in style.css;
// canvases and the 3-D view read them from here.
(function (m) {
  "use strict";

  const NAMES = ["ink", "muted", "faint", "line", "axis", "card", "band", "accent", "bad", "hint", "gap", "lead", "near",
    "reach", "limit", "singular", "admissible"];
  const system = matchMedia("(prefers-color-scheme: dark)"), paper = matchMedia("print");
  const listeners = [];
  let wanted = null, printing = false;

  m.theme = {};

  function apply() {
    const root = document.documentElement;
    root.dataset.theme = !printing && (wanted === null ? system.matches : wanted === "dark") ? "dark" : "light";
    const style = getComputedStyle(root), colour = (name) => style.getPropertyValue("--" + name).trim();
    for (const name of NAMES) m.theme[name] = colour(name);
    m.SERIES = [1, 2, 3, 4, 5, 6].map((i) => colour("s" + i));
    m.RED = m.theme.bad;
    const button = document.querySelector("#theme span");
    if (button) button.textContent = root.dataset.theme === "dark" ? "light" : "dark";
    for (const listener of listeners) listener();
  }

  // Has `redraw` called whenever the colours have changed.
  m.whenRecoloured = (redraw) => listeners.push(redraw);
  m.toggleTheme = function () {
    wanted = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    apply();
  };

  // `before` and `after` are called around printing, with the colours of paper between.
  m.aroundPrint = function (before, after) {
    const change = function (on) {
      if (on === printing) return;
      printing = on;
      apply();
      (on ? before : after)();
    };
    window.addEventListener("beforeprint", () => change(true));
    window.addEventListener("afterprint", () => change(false));
    paper.addEventListener("change", (e) => change(e.matches));
  };

  system.addEventListener("change", apply);
  apply();
})((window.millpose = window.millpose || {}));

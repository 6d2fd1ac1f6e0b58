// SPDX-License-Identifier: GPL-3.0-or-later
// What all views use: elements, numbers as text, drawing at the next frame.
(function (m) {
  "use strict";

  // A text in the language of the page; language.js has more than English.
  m.say = (english) => english;

  const LEAST = 1e-9;  // in any unit that pages have: less is what rounding leaves

  // About four significant digits, without an exponent where that stays short.
  m.format = function (value, digits = 4) {
    if (value === null || value === undefined || Number.isNaN(value)) return "–";
    if (Math.abs(value) < LEAST) value = 0;
    const size = Math.abs(value);
    if (size !== 0 && (size >= 1e6 || size < 1e-4)) return value.toExponential(digits - 1);
    const whole = size >= 1 ? Math.floor(Math.log10(size)) + 1 : 0;
    return value.toFixed(Math.max(0, Math.min(6, size >= 1 || size === 0 ? digits - whole : digits - 1 - Math.floor(Math.log10(size)) - 1)));
  };
  // `bound`: a value from which on "at least" is all that is known.
  const atLeast = (value, bound) => (bound !== null && bound !== undefined && value >= bound ? "≥\u202f" : "");
  m.withUnit = (value, unit, bound) => atLeast(value, bound) + (unit && value === value ? `${m.format(value)}${unit === "°" ? "" : "\u202f"}${unit}` : m.format(value));

  m.element = function (tag, attributes, ...children) {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes || {})) {
      if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
      else node.setAttribute(key, value);
    }
    node.append(...children);
    return node;
  };

  // Pixels of a canvas per CSS pixel; more on paper.
  m.paperRatio = 0;
  m.pixelRatio = () => Math.max(m.paperRatio, window.devicePixelRatio || 1);

  // An element from a text of ours, never of the data's.
  m.markup = function (text) {
    const template = document.createElement("template");
    template.innerHTML = text;
    return template.content.firstElementChild;
  };

  // A function that has `draw` called once at the next frame, however often it is called before. What `node` shows is
  // drawn later while it is off the screen: a key must not wait for what nobody sees.
  m.QUIET = 250;  // ms
  const unseen = new Set(), late = new Set();
  const observer = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (isIntersecting) unseen.delete(target);
      else unseen.add(target);
    }
    for (const job of [...late]) if (!unseen.has(job.node)) job.run();
  }, { rootMargin: "120px" });
  let timer = 0;

  m.drawAll = function () {
    for (const job of [...late]) job.run();
  };
  m.isDrawn = () => late.size === 0;

  m.atNextFrame = function (draw, node) {
    let waiting = false;
    const job = { node, run() {
      late.delete(job);
      draw();
    } };
    if (node) observer.observe(node);
    return function () {
      if (waiting) return;
      late.add(job);
      if (unseen.has(node)) {
        clearTimeout(timer);
        timer = setTimeout(m.drawAll, m.QUIET);
        return;
      }
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        if (late.has(job)) job.run();
      });
    };
  };
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// What a word or symbol means, in one sentence, when it is tapped, clicked or pressed: elements that data-tip names one
// of the table's sentences for (lib/report/words/tips.txt).
(function (m) {
  "use strict";

  const MARGIN = 8;  // px from the window's edge
  const box = m.element("div", { id: "tip", role: "tooltip", hidden: "" });
  document.body.append(box);
  let shown = null;

  // The attributes of an element that has a tip; none where the table has no such sentence.
  m.tipOf = (key) => (m.tips[key] ? { "data-tip": key, tabindex: 0, role: "button", "aria-expanded": "false" } : {});

  function hide() {
    if (!shown) return;
    shown.removeAttribute("aria-describedby");
    shown.setAttribute("aria-expanded", "false");
    shown = null;
    box.hidden = true;
  }

  // Below its word, or above where there is no room; never beyond the window.
  function show(node) {
    hide();
    shown = node;
    box.textContent = m.tips[node.dataset.tip];
    box.hidden = false;
    box.style.left = box.style.top = "0";
    node.setAttribute("aria-describedby", "tip");
    node.setAttribute("aria-expanded", "true");
    // The sentence is in its language from the next task on.
    requestAnimationFrame(() => {
      if (shown !== node) return;
      const word = node.getBoundingClientRect(), own = box.getBoundingClientRect();
      const left = Math.max(MARGIN, Math.min(word.left, innerWidth - own.width - MARGIN));
      const below = word.bottom + MARGIN / 2, above = word.top - own.height - MARGIN / 2;
      box.style.left = `${left}px`;
      box.style.top = `${below + own.height > innerHeight - MARGIN && above > 0 ? above : below}px`;
    });
  }

  for (const node of document.querySelectorAll("[data-tip]"))
    for (const [name, value] of Object.entries(m.tipOf(node.dataset.tip))) node.setAttribute(name, value);

  document.addEventListener("click", (e) => {
    const node = e.target.closest("[data-tip]");
    if (node && node !== shown) show(node);
    else hide();
  });
  document.addEventListener("keydown", (e) => {
    if (e.key === "Escape") hide();
    const node = e.target.closest && e.target.closest("[data-tip]");
    if (!node || (e.key !== "Enter" && e.key !== " ")) return;
    if (node === shown) hide();
    else show(node);
    e.preventDefault();
    e.stopImmediatePropagation();  // the space would play the run
  });
  window.addEventListener("scroll", hide, { passive: true, capture: true });
  window.addEventListener("resize", hide);
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// The page in another language: finished English texts are looked up in the tables of lib/report/words, as words.cpp
// does it. The scripts write English; what they have written is said in the chosen language before it is painted.
(function (m) {
  "use strict";

  const LIST = { "; ": "；", ", ": "，" };  // and how Chinese parts the same
  const KEPT = 20000;  // texts remembered
  const SAID = ["title", "aria-label"];  // attributes
  const root = document.documentElement;

  // "a {#} b {}" as the texts before its places and what these take.
  function piecesOf(english) {
    const parts = english.split(/\{(#|say|any|)\}/), pieces = [];
    for (let i = 0; i < parts.length; i += 2) pieces.push({ before: parts[i], place: i + 1 < parts.length ? parts[i + 1] : null });
    return pieces;
  }

  m.parseWords = function (text) {
    const exact = new Map(), patterns = [], tips = {};
    let tip = null, entry = null;
    for (const line of text.split("\n")) {
      const key = line.slice(0, line.indexOf(" ")), said = line.slice(key.length + 1);
      if (key === "tip") tip = said;
      if (key === "de" || key === "zh") entry[key] = said;
      if (key !== "en") continue;
      entry = { en: said, pieces: piecesOf(said) };
      if (entry.pieces.length === 1) exact.set(said, entry);
      else patterns.push(entry);
      if (tip) tips[tip] = said;
      tip = null;
    }
    const own = (e) => e.pieces.reduce((size, piece) => size + new TextEncoder().encode(piece.before).length, 0);
    for (const one of patterns) one.own = own(one);
    patterns.sort((a, b) => b.own - a.own);
    return { exact, patterns, tips };
  };

  const words = m.parseWords(document.getElementById("words").textContent);
  m.tips = words.tips;

  const hasLetters = (text) => /[A-Za-z]/.test(text);
  const isFigure = (text) => (/\d/.test(text) || text === "-" || text === "–") && !/[^\d\-+.,/: %\u0080-\uffff]/.test(text.replace(/(\d)e/g, "$1"));

  const known = new Map();  // of the language: what was found

  // The same text in `language`; null where a part of it is missing.
  function find(english, language) {
    if (!hasLetters(english)) return english;
    if (!known.has(english)) known.set(english, findAnew(english, language));
    return known.get(english);
  }

  function findAnew(english, language) {
    const entry = words.exact.get(english);
    if (entry) return entry[language];
    for (const pattern of words.patterns) {
      const captures = [];
      if (match(pattern, 0, english, language, captures)) return fill(pattern, captures, language);
    }
    const separator = Object.keys(LIST).find((s) => english.includes(s));
    if (!separator) return null;
    const parts = english.split(separator).map((part) => find(part, language));
    return parts.includes(null) ? null : parts.join(language === "zh" ? LIST[separator] : separator);
  }

  function match(pattern, k, text, language, captures) {
    const { before, place } = pattern.pieces[k];
    if (!text.startsWith(before)) return false;
    const rest = text.slice(before.length);
    if (place === null) return rest === "";
    const next = pattern.pieces[k + 1].before, last = next === "";  // no two places touch
    for (let end = last ? rest.length : rest.indexOf(next, 1); end > 0; end = last ? 0 : rest.indexOf(next, end + 1)) {
      captures.push(rest.slice(0, end));
      if (fits(place, rest.slice(0, end), language) && match(pattern, k + 1, rest.slice(end), language, captures)) return true;
      captures.pop();
    }
    return false;
  }

  function fits(place, capture, language) {
    if (place === "#") return isFigure(capture);
    if (capture.includes(". ")) return false;  // no place takes several sentences, a name not even a list
    return place === "say" ? find(capture, language) !== null : place === "any" || !/[;,] /.test(capture);
  }

  function fill(pattern, captures, language) {
    return pattern[language].replace(/\{(\d+)\}/g, (_, number) => {
      const capture = captures[number - 1], { place } = pattern.pieces[number - 1];
      return place === "say" || place === "any" ? find(capture, language) || capture : capture;
    });
  }

  const sentences = (text) => text.split(/(?<=\.) /);

  // A text of the page in the chosen language, as Say() in words.hpp.
  m.say = function (english) {
    const language = root.lang;
    if (language === "en") return english;
    if (known.size > KEPT) known.clear();
    const said = find(english, language);
    return said !== null ? said : sentences(english).map((one) => find(one, language) || one).join(" ").replaceAll("。 ", "。");
  };
  // Whether all of it can be said, in any language.
  m.canSay = (english) => find(english, root.lang) !== null || sentences(english).every((one) => find(one, root.lang) !== null);

  // What was English before it was said otherwise: of text nodes the text, of elements their attributes.
  const english = new WeakMap();

  // In the source of the page a text may go on in the next line.
  function sayPadded(text) {
    const [, left, middle, right] = /^(\s*)([\s\S]*?)(\s*)$/.exec(text);
    return left + m.say(middle.replace(/[ \t]*\n\s*/g, " ")) + right;
  }

  function tell(node, key, now, write) {
    const texts = english.get(node) || english.set(node, {}).get(node), before = texts[key];
    const original = before && before.said === now ? before.original : now;
    const said = key === "text" ? sayPadded(original) : original.split("\n").map(m.say).join("\n");
    texts[key] = { original, said: root.lang === "en" ? original : said };
    if (texts[key].said !== now) write(texts[key].said);
  }

  const asIs = (element) => element && element.closest("[translate=no], script, style");

  function tellElement(element) {
    for (const name of SAID)
      if (element.hasAttribute(name)) tell(element, name, element.getAttribute(name), (text) => element.setAttribute(name, text));
  }

  function tellAll(node) {
    if (node.nodeType === Node.TEXT_NODE) {
      if (!asIs(node.parentElement)) tell(node, "text", node.data, (text) => { node.data = text; });
      return;
    }
    if (node.nodeType !== Node.ELEMENT_NODE || asIs(node)) return;
    tellElement(node);
    for (const child of node.childNodes) tellAll(child);
  }

  const observer = new MutationObserver((changes) => {
    for (const { type, target, addedNodes } of changes) {
      if (type === "attributes") tellElement(target);
      else if (type === "characterData") tellAll(target);
      else for (const node of addedNodes) tellAll(node);
    }
    observer.takeRecords();  // what was said just now
  });

  const listeners = [], menu = document.getElementById("language");
  // Has `redraw` called whenever the language has changed: canvases hold texts too.
  m.whenToldAnew = (redraw) => listeners.push(redraw);

  m.setLanguage = function (language) {
    root.lang = menu.value = language;
    known.clear();
    observer.disconnect();
    tellAll(document.body);
    if (language !== "en") observer.observe(document.body, { subtree: true, childList: true, characterData: true, attributes: true, attributeFilter: SAID });
    for (const listener of listeners) listener();
  };

  menu.value = root.lang;
  menu.addEventListener("change", () => m.setLanguage(menu.value));
  if (root.lang !== "en") m.setLanguage(root.lang);
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// Ties the views together: one selected point, one index that colours, both shown everywhere.
(function (m) {
  "use strict";

  const $ = (id) => document.getElementById(id);

  function drawScale(column, scale) {
    const stops = Array.from({ length: 15 }, (_, i) => m.css(m.viridis(scale.flip ? 1 - i / 14 : i / 14)));
    $("scale-bar").style.background = `linear-gradient(to right, ${stops.join(",")})`;
    const values = [0, 0.25, 0.5, 0.75, 1].map((t) => scale.low + t * (scale.high - scale.low));
    // As many digits as tell the ticks apart.
    const digits = (d) => values.map((v) => m.format(v, d));
    const texts = [3, 4, 5, 6].map(digits).find((t) => new Set(t).size === t.length) || digits(3);
    $("scale-ticks").replaceChildren(...texts.map((t) => m.element("span", {}, t)));
    const worse = column.worse === 0 ? "" : scale.flip ? "; bright: low, worse" : "; bright: high, worse";
    $("scale-label").textContent = `${column.symbol}${column.unit ? " in " + column.unit : ""}${worse}`;
  }

  function fillChoice(data) {
    for (const column of data.columns) {
      if (column.values.every((v) => Number.isNaN(v))) continue;
      const unit = column.unit ? `, ${column.unit}` : "";
      $("index").append(m.element("option", { value: column.key }, `${column.symbol}: ${column.label}${unit}`));
    }
  }

  function numberOfHash() {
    const match = /^#point=(\d+)$/.exec(location.hash);
    return match ? Number(match[1]) : null;
  }

  function start() {
    const data = m.readData($("plan-data").textContent);
    m.data = data;
    m.fillHeader(data);
    m.fillSkipped(data);
    m.fillGaps(data);
    m.fillDeflection(data);
    m.fillBudget(data);
    m.fillReversals(data);
    m.fillFixed(data);
    m.fillFace(data);
    m.fillPrice(data);
    m.fillPaper(data);
    $("settings-text").textContent = data.settings;
    if (data.count === 0) return;

    const views = [], actions = {};
    actions.select = function (row) {
      m.selected = row;
      for (const view of views) view.select(row);
      const hash = `#point=${data.rows.number[row]}`;
      if (location.hash !== hash) history.replaceState(null, "", hash);
    };
    actions.step = (by) => actions.select(Math.max(0, Math.min(data.count - 1, m.selected + by)));
    m.select = actions.select;

    let scene = null;
    try {
      scene = new m.Scene($("view"), data, actions);
    } catch (error) {
      $("view").append(m.element("p", { class: "note no-view" }, "This browser has no WebGL: the 3-D view is left out. " + error.message));
    }
    const player = data.timeline ? new m.Player(data, actions, scene) : null;
    if (!player) $("player").remove();
    const stock = new m.StockView(scene);
    if (player) player.onPlay = () => stock.showOnce();
    const charts = new m.PathCharts($("path-charts"), data, actions), worst = new m.WorstTable(data, actions);
    const poses = new m.PoseCharts($("rotation-chart"), $("genetic-chart"), data);
    if (scene) views.push(scene);
    const map = data.map && data.curves.number.length > 0 ? new m.AxisMap(data, actions, scene) : null;
    if (!map) $("axis-map").remove();
    views.push(new m.PointPanel(data, actions), worst, charts, poses, ...(map ? [map] : []), ...(player ? [player] : []));
    m.views = { scene, charts, worst, poses, map, player };

    fillChoice(data);
    const recolour = function () {
      const column = data.column[$("index").value] || data.columns[0];
      const scale = m.scale(column, $("robust").checked);
      drawScale(column, scale);
      charts.show(column);
      const row = worst.show(column);
      if (m.selected !== undefined) worst.select(m.selected);
      if (scene) {
        scene.colour(column, scale);
        if (row !== undefined) scene.markWorst(row, `worst ${column.symbol}: ${m.withUnit(column.values[row], column.unit, column.bound)}`);
        else scene.markWorst(-1, "");
      }
      return row;
    };
    $("index").addEventListener("change", recolour);
    $("robust").addEventListener("change", recolour);
    $("with-leads").addEventListener("change", recolour);
    $("to-worst").addEventListener("click", () => worst.places.length && actions.select(worst.places[0]));
    if (scene) {
      $("fit").addEventListener("click", () => scene.fit(false));
      $("fit-arm").addEventListener("click", () => scene.fit(true));
      for (const name of ["part", "cell", "arm", "gaps", "marks", "nearest"]) $("show-" + name).addEventListener("change", (e) => scene.show(name, e.target.checked));
    }

    const firstWorst = recolour();
    const open = function () {
      const number = numberOfHash();
      if (number === null) return false;
      const row = m.rowOf(data, number);
      $("link-note").textContent = data.rows.number[row] === number ? "" : `Point ${number} is not shown here; the nearest that is: ${data.rows.number[row]}.`;
      actions.select(row);
      return true;
    };
    if (!open()) actions.select(firstWorst === undefined ? 0 : firstWorst);
    window.addEventListener("hashchange", open);
    const redraw = function () {
      charts.redraw();
      poses.schedule();
      if (map) map.redraw();
      if (scene) scene.recolour();
    };
    window.addEventListener("resize", redraw);
    m.whenToldAnew(() => {
      recolour();
      redraw();
    });
    m.whenRecoloured(() => {
      recolour();
      redraw();
    });
    m.onPaper(scene, redraw);
    $("theme").addEventListener("click", m.toggleTheme);
    m.listenToKeys(data, actions, m.views);
    document.body.classList.add("ready");
  }

  start();
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// check.html: what a job, a cell or a part is, before anything is planned.
(function (m) {
  "use strict";

  const $ = (id) => document.getElementById(id);
  const vector = (v, digits) => v.map((x) => x.toFixed(digits)).join(", ");
  const cell = (text, numeric) => m.element("td", numeric ? { class: "number" } : {}, text);

  const solid = (text, as_is) => m.element("td", as_is ? { class: "solid", translate: "no" } : { class: "solid" }, text);

  function fillHeader(data) {
    $("job").textContent = data.title;
    $("about").textContent = [data.cell ? `${data.cell.arm.name} in cell ${data.cell.name}` : "", data.measured ? `arm ${data.measured}` : "", "checked, nothing planned"].filter((t) => t).join("; ");
    const fact = (value, label, bad) => m.element("div", { class: bad ? "fact bad" : "fact" }, m.element("b", {}, value), label);
    const facts = [];
    if (data.path) {
      const out = [0, 1, 2, 3].map((state) => data.rows.state.filter((s) => s === state).length), missed = out[1] + out[2] + out[3];
      facts.push(fact(data.path.total.toLocaleString("en"), data.path.total === 1 ? "point" : "points"), fact(String(data.path.passes), data.path.passes === 1 ? "pass" : "passes"), fact(missed.toLocaleString("en"), "out of reach", missed > 0));
    }
    if (data.part) facts.push(fact(data.part.faces.length.toLocaleString("en"), data.part.solid_model ? "STEP faces" : "faces between creases"));
    facts.push(fact(String(data.findings.length), "findings", data.findings.length > 0));
    $("facts").append(...facts);
    $("messages").append(...data.findings.map((t) => m.element("li", { class: "bad" }, t)), ...data.notes.map((t) => m.element("li", { class: "note" }, t)));
    $("told").querySelector("pre").textContent = data.text;
    $("settings-text").textContent = data.settings;
    if (!data.settings) $("settings").remove();
  }

  function fillTables(data, choose) {
    const rows = (id, title, list, columns) => {
      const section = $(id);
      if (!list || list.length === 0) return section.remove();
      section.querySelector("h2").textContent = title;
      section.querySelector("tbody").append(...list.slice(0, 3000).map((entry, i) => {
        const line = m.element("tr", { "data-index": i, tabindex: 0, onclick: () => choose(id, i), onkeydown: (e) => e.key === "Enter" && choose(id, i) });
        line.append(...columns(entry));
        return line;
      }));
    };
    const part = data.part;
    const counted = (all, one) => `${all.length} ${one}${all.length === 1 ? "" : "s"}`;
    rows("faces", part && `${counted(part.faces, "face")} ${part.solid_model ? "of the STEP file" : "between edges that bend by more than 30°"}`, part && part.faces, (f) => [
      cell(String(f.number), true), solid(f.id, true), solid(f.kind), solid(f.name, true), cell(m.format(f.area_mm2, 6), true), cell(vector(f.place_mm, 2), true), cell(vector(f.normal, 3), true)]);
    rows("edges", part && counted(part.edges, "edge"), part && part.edges, (e) => [
      cell(String(e.number), true), cell(e.faces[1] > 0 ? `${e.faces[0]}, ${e.faces[1]}` : `${e.faces[0]}, open border`), cell(e.closed ? "closed" : ""), cell(m.format(e.length_mm, 6), true),
      cell(vector(e.place_mm, 2), true), cell(vector(e.normal, 3), true)]);
  }

  const AS_IS = ["STEP id", "name"], SEEN_THROUGH = 0.4;
  // Names and values of what was picked.
  function describe(data, title, lines) {
    $("picked").querySelector("h2").textContent = title;
    $("picked").querySelector("tbody").replaceChildren(...lines.filter((l) => l[1] !== "").map(([name, value]) => m.element("tr", {}, m.element("th", {}, name), m.element("td", AS_IS.includes(name) ? { class: "number", translate: "no" } : { class: "number" }, value))));
  }
  const faceLines = (f) => [["STEP id", f.id], ["name", f.name], ["kind", f.kind], ["area", `${m.format(f.area_mm2, 6)} mm²`], ["place, P", `${vector(f.place_mm, 3)} mm`], ["normal, P", vector(f.normal, 4)],
    ["triangles", String(f.triangles)]];
  const edgeLines = (e) => [["faces", e.faces[1] > 0 ? e.faces.join(", ") : `${e.faces[0]}, open border`], ["length", `${m.format(e.length_mm, 6)} mm`], ["closed", e.closed ? "yes" : "no"],
    ["place, P", `${vector(e.place_mm, 3)} mm`], ["normal, P", vector(e.normal, 4)]];
  function pointLines(data, row) {
    const { rows } = data, state = rows.state[row], axis = rows.axis[row], reserve = data.column.reserve.values[row];
    const three = (array) => Array.from(array.subarray(3 * row, 3 * row + 3));
    return [["reach", m.REACH[state]], ["axis that limits", axis ? `A${axis}, ${reserve < 0 ? `${m.format(-reserve, 3)}° beyond` : `${m.format(reserve, 3)}° to spare`}` : ""],
      ["pass", `${rows.pass[row]}, ${m.KINDS[rows.kind[row]]}`], ["place, W", `${vector(three(rows.position), 2)} mm`], ["normal, W", vector(three(rows.normal), 4)], ["tool axis, W", vector(three(rows.toolAxis), 4)]];
  }

  function drawScale(column, scale) {
    const stops = Array.from({ length: 15 }, (_, i) => m.css(m.viridis(scale.flip ? 1 - i / 14 : i / 14)));
    $("scale-bar").style.background = `linear-gradient(to right, ${stops.join(",")})`;
    $("scale-ticks").replaceChildren(...[0, 0.5, 1].map((t) => m.element("span", {}, m.format(scale.low + t * (scale.high - scale.low), 3))));
    $("scale-label").textContent = `${column.symbol}${column.unit ? " in " + column.unit : ""}; red: out of reach`;
  }

  // The raw part as it comes to the path, or as the points that are reached leave it.
  function showStock(data, scene) {
    const menu = $("show-stock"), { stock } = scene || {};
    if (!stock) {
      menu.parentNode.remove();
      return $("stock-scale").remove();
    }
    Object.assign(stock.mesh.material, { transparent: true, opacity: SEEN_THROUGH, depthWrite: false });
    m.drawStockScale(stock);
    const show = () => {
      $("stock-scale").hidden = menu.value === "";
      $("removed").textContent = m.removedText(data.removal, Number(menu.value));
      scene.show("stock", menu.value !== "");
      scene.millUntil(Number(menu.value));
    };
    menu.addEventListener("change", show);
    show();
  }

  function start() {
    const data = m.readCheck($("check-data").textContent);
    m.data = data;
    fillHeader(data);
    const view = { scene: null, parts: null };
    m.views = view;
    const mark = (id, index) => {
      for (const line of document.querySelectorAll("#faces tbody tr, #edges tbody tr")) line.classList.toggle("selected", line.closest("section").id === id && Number(line.dataset.index) === index);
    };
    const choose = (id, index) => {
      m.picked = { [id === "faces" ? "face" : "edge"]: index };
      if (view.parts) view.parts.choose(id === "faces" ? index : null, id === "edges" ? index : null);
      mark(id, index);
      if (id === "faces") describe(data, `Face ${data.part.faces[index].number}`, faceLines(data.part.faces[index]));
      else describe(data, `Edge ${data.part.edges[index].number}`, edgeLines(data.part.edges[index]));
    };
    const select = (row) => {
      m.selected = row;
      m.picked = { point: row };
      if (view.parts && view.parts.part) view.parts.choose(null, null);
      mark("", -1);
      if (view.scene) view.scene.select(row);
      describe(data, `Point ${data.rows.number[row]}`, pointLines(data, row));
    };
    m.select = select;
    fillTables(data, choose);
    try {
      view.scene = new m.Scene($("view"), data, { select });
    } catch (error) {
      $("view").append(m.element("p", { class: "note no-view" }, "This browser has no WebGL: the 3-D view is left out. " + error.message));
    }
    const { scene } = view;
    showStock(data, scene);
    if (scene) {
      const parts = (view.parts = new m.CheckParts(scene, data)), pickPoint = scene.pick.bind(scene);
      if (data.cell) scene.pose(data.cell.home_deg, "");
      // A point of the path is nearer to the hand than the face below it.
      scene.pick = (x, y) => {
        const before = m.picked;
        m.picked = null;
        if (scene.path.shown !== false) pickPoint(x, y);
        if (m.picked) return;
        const found = parts.at(x, y);
        m.picked = before;
        if (found) choose(found.edge !== null ? "edges" : "faces", found.edge !== null ? found.edge : found.face);
      };
      const show = { part: (on) => (scene.groups.part.visible = on), cell: (on) => (scene.groups.cell.visible = on), arm: (on) => (scene.groups.arm.visible = on),
        path: (on) => scene.path.show(on), normals: (on) => (parts.normals.visible = on), region: (on) => { parts.showRegion = on; parts.recolour(); },
        edges: (on) => { if (parts.edges) parts.edges.visible = on; } };
      for (const [name, work] of Object.entries(show)) $("show-" + name).addEventListener("change", (e) => { work(e.target.checked); scene.schedule(); });
      const fit = (arm) => scene.fitTo(m.boxOf(data, arm), m.meanNormal(data));
      $("fit").addEventListener("click", () => fit(false));
      $("fit-arm").addEventListener("click", () => fit(true));
      fit(!data.part && data.count === 0);
      m.whenRecoloured(() => { scene.recolour(); parts.recolour(); if (data.count > 0) recolour(); });
      m.onPaper(scene, () => scene.schedule());
    }
    const recolour = () => {
      const column = data.column[$("index").value], scale = m.scale(column, false);
      drawScale(column, scale);
      if (scene) scene.colour(column, scale);
    };
    if (data.count > 0) {
      for (const column of data.columns) $("index").append(m.element("option", { value: column.key }, `${column.symbol}: ${column.label}`));
      $("index").addEventListener("change", recolour);
      recolour();
    } else for (const id of ["colour", "scale"]) $(id).remove();
    // What there is none of has no box to tick.
    const absent = [...(data.part ? [] : ["part", "region", "edges"]), ...(data.count > 0 ? [] : ["path", "normals"]), ...(data.cell ? [] : ["arm", "cell"])];
    for (const name of absent) $("show-" + name).parentNode.remove();
    if (!data.cell) $("fit-arm").remove();
    if (!data.part && data.count === 0) $("fit").remove();
    if (!data.part) $("picked").hidden = data.count === 0;
    if (data.part && !data.part.solid_model) document.body.classList.add("mesh");
    $("theme").addEventListener("click", m.toggleTheme);
    window.addEventListener("resize", () => scene && scene.schedule());
    document.addEventListener("keydown", (e) => {
      if (/INPUT|SELECT/.test(e.target.tagName) || e.altKey || e.ctrlKey || e.metaKey) return;
      const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
      if (step && data.count > 0) select(m.selected === undefined ? 0 : Math.max(0, Math.min(data.count - 1, m.selected + step)));
      else if ($({ f: "fit", a: "fit-arm" }[e.key])) $({ f: "fit", a: "fit-arm" }[e.key]).click();
      else if (e.key === "d") m.toggleTheme();
      else return;
      e.preventDefault();
    });
    document.body.classList.add("ready");
  }

  // What is to be seen: the part and the path, with the arm or else the cell where there is neither.
  m.boxOf = function (data, withArm) {
    const box = new THREE.Box3(), add = (array, place) => {
      const at = new THREE.Box3().setFromBufferAttribute(new THREE.BufferAttribute(array, 3));
      if (array.length > 0) box.union(place ? at.applyMatrix4(new THREE.Matrix4().set(...place)) : at);
    };
    if (data.part) add(data.part.vertices, data.X_WP);
    add(data.rows.position);
    // Of a cell alone all that stands in it: its rail is longer than the arm.
    if (!data.part && data.count === 0) for (const body of data.bodies) if (!["link", "tool"].includes(body.mount)) add(body.vertices, body.X_MG);
    if (data.cell && (withArm || box.isEmpty())) {
      const joints = (m.selected !== undefined && m.jointsOf(data, m.selected)) || data.cell.home_deg;
      for (const f of m.armFrames(data, joints)) box.expandByPoint(new THREE.Vector3(f[3], f[7], f[11]));
    }
    return box;
  };
  m.meanNormal = function (data) {
    const { normal } = data.rows, sum = [0, 0, 0];
    normal.forEach((v, i) => (sum[i % 3] += v));
    return sum.map((v) => v / Math.max(1, data.count));
  };

  start();
})((window.millpose = window.millpose || {}));

// SPDX-License-Identifier: GPL-3.0-or-later
// Header, the selected point's figures, worst places, skipped points, gaps and settings.
(function (m) {
  "use strict";

  const MESSAGES_OPEN = 4;  // findings that stand open

  const cell = (text, numeric) => m.element("td", numeric ? { class: "number" } : {}, text);

  m.fillHeader = function (data) {
    const c = data.counts, gaps = data.gaps;
    document.getElementById("job").textContent = data.job;
    document.getElementById("about").textContent =
      `${data.arm.name} in cell ${data.cell}; objective ${data.objective.name} (${data.objective.unit || "no unit"}), stiffness at the ${data.stiffness_origin.replace("_", " ")}; seed ${data.seed}`;
    const fact = (value, label, bad) => m.element("div", bad ? { class: "fact bad" } : { class: "fact" }, m.element("b", {}, value), label);
    document.getElementById("facts").append(
      fact(c.planned.toLocaleString("en"), `of ${c.total.toLocaleString("en")} points planned`, c.planned < c.total),
      fact(c.skipped.toLocaleString("en"), "skipped", c.skipped > 0),
      fact(String(data.passes.length), m.element("span", m.tipOf("pass"), data.passes.length === 1 ? "pass" : "passes")),
      fact(`${gaps.planned}/${gaps.total}`, m.element("span", m.tipOf("gap"), "gaps planned"), gaps.planned < gaps.total));
    for (const time of data.times) {
      const [total, ...parts] = time.text.split(" ");
      const node = fact(total, time.controller);
      node.title = `h:min:s on ${time.controller} ${parts.join(" ")}\n` + time.passes_s.map((s, pass) => `pass ${pass}: ${s} s`).slice(0, 40).join("\n");
      document.getElementById("facts").append(node);
      document.getElementById("times").append(m.element("p", {}, `${time.controller}: h:min:s ${time.text}`));
    }
    if (data.air) document.getElementById("times").append(m.element("p", {}, data.air));
    const thinned = [];
    if (c.shown < c.total) thinned.push(`${c.shown.toLocaleString("en")} of ${c.total.toLocaleString("en")} points are shown; the ends of all pieces and the worst points of every index are among them. All points stand in points.csv.`);
    for (const body of data.bodies)
      if (body.triangles_shown < body.triangles) thinned.push(`${body.name} is drawn with ${body.triangles_shown.toLocaleString("en")} of ${body.triangles.toLocaleString("en")} triangles.`);
    document.getElementById("thinned").textContent = thinned.join(" ");
    document.getElementById("messages").append(...foldedMessages("finding", "bad", data.findings), ...foldedMessages("warning", "note", data.warnings));
  };

  // One line of a kind of message, with the rest behind it: the views must stay on the first screen, however much there is
  // to tell. A single message stands by itself.
  function foldedMessages(kind, style, texts) {
    const list = texts.map((text) => m.element("li", { class: style }, text));
    if (list.length < 2) return list;
    const summary = m.element("summary", { class: style }, `${texts.length} ${kind}s`);
    const folded = m.element("details", { class: kind }, summary, m.element("ul", {}, ...list));
    folded.open = kind === "finding" && list.length <= MESSAGES_OPEN;
    return [m.element("li", {}, folded)];
  }

  m.PointPanel = class {
    constructor(data, actions) {
      this.data = data;
      this.title = document.getElementById("point-title");
      this.status = document.getElementById("point-status");
      this.figures = document.getElementById("point-figures");
      this.link = document.getElementById("point-link");
      document.getElementById("previous").addEventListener("click", () => actions.step(-1));
      document.getElementById("next").addEventListener("click", () => actions.step(1));
    }
    select(row) {
      const { data } = this, rows = data.rows, number = rows.number[row], reason = m.SKIP_REASONS[rows.status[row]];
      const pass = data.passes[rows.pass[row]];
      this.title.textContent = `Point ${number}`;
      this.link.href = `#point=${number}`;
      this.status.className = reason ? "bad" : "";
      const skipped = reason && data.skipped.rows.find((s) => s.point === number);
      this.status.textContent = reason ? `skipped, ${reason}${skipped ? ": " + skipped.detail : ""}` : `pass ${pass.pass}, piece ${rows.piece[row]}, ${m.KINDS[rows.kind[row]]}`;
      const p = m.place(data, row);
      const value = (key) => m.withUnit(data.column[key].values[row], data.column[key].unit, data.column[key].bound);
      const line = (name, ...text) => m.element("tr", {}, m.element("th", {}, name), ...text.map((t) => cell(t, true)));
      const simple = (key) => {
        const node = line(m.element("span", m.tipOf(key), data.column[key].symbol), value(key));
        node.title = data.column[key].label;
        return node;
      };
      const joints = [1, 2, 3, 4, 5, 6].map((j) =>
        line("A" + j, value("a" + j), `${m.format(data.arm.lower_deg[j - 1])}…${m.format(data.arm.upper_deg[j - 1])}°`, value("v" + j)));
      const external = m.externalKeys(data).map((key) => line(data.column[key].symbol, value(key), "", ""));
      const table = (caption, head, ...lines) => m.element("table", {}, m.element("caption", {}, caption), ...head, ...lines);
      this.figures.replaceChildren(
        table("Stiffness", [], ...["objective", "lambda_t1", "lambda_t2", "lambda_n", "normal_compliance", "mu", "dexterity", "price", "deflection", "deflection_normal", "before", "after", "worst_before", "worst_after", "shift", "arm_shift", "gear_shift"].filter((key) => data.column[key]).map(simple)),
        table("Place and pose", [], line("x, W", `${p[0].toFixed(2)} mm`), line("y, W", `${p[1].toFixed(2)} mm`), line("z, W", `${p[2].toFixed(2)} mm`),
          simple("rotation"), line(m.element("span", m.tipOf("branch"), "branch"), reason ? "–" : "S" + rows.branch[row]), simple("clearance"), ...this.nearest(row), simple("limit_reserve"), simple("speed_share")),
        table("Joints", [m.element("tr", {}, m.element("th"), ...["angle", "limits", "speed"].map((t) => m.element("th", { class: "number" }, t)))], ...joints, ...external));
    }
  };

  m.PointPanel.prototype.nearest = function (row) {
    const nearest = m.nearestAt(this.data, row);
    if (nearest === undefined) return [];
    const words = nearest ? nearest.names.join(" – ") : "none within 50 mm";
    return [m.element("tr", { id: "nearest-pair" }, m.element("td", { colspan: 2, class: "note" }, words))];
  };

  m.WorstTable = class {
    constructor(data, actions) {
      this.data = data;
      this.actions = actions;
      this.body = document.querySelector("#worst tbody");
      const p = data.rows.position, low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      p.forEach((v, i) => {
        low[i % 3] = Math.min(low[i % 3], v);
        high[i % 3] = Math.max(high[i % 3], v);
      });
      this.hasLeads = data.rows.kind.some((kind) => kind !== 0);
      document.getElementById("with-leads").parentNode.hidden = !this.hasLeads;
      this.apart = 0.07 * Math.hypot(...[0, 1, 2].map((k) => high[k] - low[k]));
    }
    show(column) {
      const { data } = this;
      const word = column.worse < 0 ? "lowest" : "highest";
      document.getElementById("worst-title").textContent = `Worst places: ${word} ${column.symbol}`;
      const leads = document.getElementById("with-leads").checked;
      document.getElementById("worst-note").textContent = `${column.label}. At least ${m.format(this.apart, 2)} mm apart${this.hasLeads ? leads ? "; lead-ins and -outs among them" : "; cuts alone, no lead-in or -out" : ""}.`;
      document.getElementById("worst-value").textContent = column.unit ? `${column.symbol}, ${column.unit}` : column.symbol;
      this.places = m.worstPlaces(data, { values: column.values, worse: column.worse || 1 }, 8, this.apart, leads);
      this.body.replaceChildren(
        ...this.places.map((row, i) => {
          const p = m.place(data, row).map((v) => v.toFixed(0));
          const number = data.rows.number[row];
          const link = m.element("a", { href: `#point=${number}` }, String(number));
          return m.element("tr", { "data-row": row, onclick: () => this.actions.select(row) },
            cell(String(i + 1), true), m.element("td", { class: "number" }, link), cell(data.passes[data.rows.pass[row]].pass, true),
            cell(m.withUnit(column.values[row], "", column.bound), true), cell(p.join(", "), true));
        }));
      return this.places[0];
    }
    select(row) {
      for (const line of this.body.children) line.classList.toggle("selected", Number(line.dataset.row) === row);
    }
  };

  m.fillPaper = function (data) {
    const section = document.getElementById("paper"), p = data.paper;
    if (!p) {
      section.remove();
      return;
    }
    const above = p.above_percent ? p.above_percent.map((v) => m.format(v, 3)) : null;
    section.querySelector("p").textContent =
      `${p.within_tolerance} of ${p.searched} points meet its tolerance of 0.1 mm and 0.1°; errors at worst ${m.format(p.position_error_mm)} mm and ${m.format(p.angle_error_deg)}°. ` +
      (above ? `Where it is met, f lies ${above[0]} % to ${above[2]} % above the point's own optimum (median ${above[1]} %). ` : "") +
      `${p.usable} answers are admissible once put on the exact pose, ${p.on_path} of them are on the path; answers beyond the tolerance are never milled.`;
  };

  // The finished face: an offset of depth (level) and what is not flat (variation) are different things.
  m.fillDeflection = function (data) {
    const section = document.getElementById("deflection"), d = data.deflection;
    if (!d) {
      section.remove();
      return;
    }
    const force = d.mean_force_N.map((f) => m.format(f)).join(", ");
    const face = d.face
      ? `Over the finished face, along the normal: level ${m.format(d.face.level_um)} µm (mean, an offset of depth; positive away from the part), ` +
        `variation ${m.format(d.face.variation_um)} µm (largest less smallest distance from its own best plane, equation 37), ` +
        `largest step to a neighbouring pass ${m.format(d.face.largest_step_um)} µm.`
      : "Fewer than three planned cut points: no figures of a face.";
    section.querySelector("p").textContent = `Heaviest mean force on the tool (feed, across, axis): ${force} N. ${face} What it is: ${d.model}.`;
  };

  // What is known of the error of the face, source by source.
  m.fillBudget = function (data) {
    const section = document.getElementById("budget");
    if (!data.budget) section.remove();
    else section.querySelector("tbody").append(...data.budget.map(([name, value, basis]) => m.element("tr", {}, cell(name), cell(value, true), cell(basis))));
  };

  // Where joints turn back, and what that leaves.
  m.fillReversals = function (data) {
    const section = document.getElementById("reversals");
    if (!data.reversals) section.remove();
    else section.querySelector("p").textContent = `Reversals: ${data.reversals}.`;
  };

  // What the best rotations that stay the same would have given.
  m.fillFixed = function (data) {
    const section = document.getElementById("fixed");
    if (!data.fixed) {
      section.remove();
      return;
    }
    section.querySelector("ul").append(...data.fixed.map((line) => m.element("li", {}, line)));
  };

  // The price of the path against each point's own best pose, and how near the search came to its bound.
  m.fillPrice = function (data) {
    const section = document.getElementById("price");
    if (data.price.length === 0) section.remove();
    else section.append(...data.price.map((line) => m.element("p", {}, line.replaceAll(" um", " µm").replaceAll(" x ", " × "))));
  };

  m.fillSkipped = function (data) {
    const section = document.getElementById("skipped"), { reasons, rows } = data.skipped;
    const summary = section.querySelector("p");
    if (data.counts.skipped === 0) {
      summary.textContent = "None: every point is planned.";
      section.querySelector("table").remove();
      return;
    }
    summary.textContent = Object.entries(reasons).map(([reason, count]) => `${reason}: ${count}`).join(", ") +
      (rows.length < data.counts.skipped ? `. The first ${rows.length} are listed; all stand in summary.json.` : ".");
    section.querySelector("tbody").append(...rows.map((s) =>
      m.element("tr", {}, m.element("td", { class: "number" }, m.element("a", { href: `#point=${s.point}` }, String(s.point))), cell(s.pass, true), cell(s.reason), cell(s.detail))));
  };

  m.fillGaps = function (data) {
    const section = document.getElementById("gaps"), end = (pass, piece) => (pass < 0 ? "home" : `pass ${pass}, piece ${piece}`);
    if (data.gaps.told.length === 0) {
      section.remove();
      return;
    }
    section.querySelector("tbody").append(...data.gaps.told.map((g) =>
      m.element("tr", {}, cell(end(g.from_pass, g.from_piece)), cell(end(g.to_pass, g.to_piece)), cell(g.planned ? "planned" : "not planned"), cell(g.detail))));
  };
})((window.millpose = window.millpose || {}));

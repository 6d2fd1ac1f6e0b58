// SPDX-License-Identifier: GPL-3.0-or-later
// How the selected point's pose was chosen: the objective over the rotation about the tool axis with branches and
// limits, and the genetic algorithm's generations.
(function (m) {
  "use strict";

  // Arm branches by the low two bits of the status S; the wrist's bit changes neither arm nor compliance.
  const BRANCHES = ["S0/4", "S1/5: overhead", "S2/6: elbow", "S3/7: overhead, elbow"];
  const STATES = [
    { name: "out of reach", colour: "reach" }, { name: "beyond a limit", colour: "limit" },
    { name: "near a singularity", colour: "singular" }, { name: "admissible", colour: "admissible" },
  ];
  const STRIP = 9;

  m.PoseCharts = class {
    constructor(rotation, genetic, data) {
      this.data = data;
      this.rotationNote = m.element("p", { class: "note" });
      this.geneticNote = m.element("p", { class: "note" });
      rotation.append(this.rotationNote);
      genetic.append(this.geneticNote);
      this.schedule = m.atNextFrame(() => this.draw(), rotation);
      const plot = (parent, label) => {
        const box = m.element("div");
        parent.append(box);
        return new m.Canvas(box, 330, label);
      };
      this.rotation = plot(rotation, "Objective over the rotation about the tool axis");
      this.genetic = plot(genetic, "Convergence of the genetic algorithm");
      rotation.append(this.key());
      genetic.append(m.element("div", { class: "legend" }, line(0, "best"), line(1, "mean of the admissible"), line(2, "after refinement"), patch("ink", "own optimum")));
    }
    key() {
      const node = m.element("div", { class: "legend" });
      BRANCHES.forEach((name, i) => node.append(line(i, name)));
      node.append(m.element("span", {}, "thin: not admissible"));
      STATES.forEach((state) => node.append(patch(state.colour, state.name)));
      return node;
    }
    select(row) {
      this.row = row;
      this.schedule();
    }
    // What is known of the selected row: curves of this point or of the nearest sampled one.
    sample() {
      const found = m.curveOf(this.data, this.row);
      if (!found) return null;
      const c = this.data.curves, p = c.parts(), n = c.count, k = found.index;
      const value = (arm, i) => {
        const code = p.values[4 * n * k + n * arm + i];
        return code === 65535 ? NaN : p.least[k] + (p.span[k] * code) / 65534;
      };
      return {
        exact: found.exact, number: found.number, value,
        state: (branch, i) => (p.states[n * k + i] >> (2 * branch)) & 3,
        best: p.best.subarray(c.generations * k, c.generations * (k + 1)),
        mean: p.mean.subarray(c.generations * k, c.generations * (k + 1)),
        top: p.least[k] + p.span[k],
      };
    }
    draw() {
      if (this.row === undefined) return;
      const sample = this.sample(), number = this.data.rows.number[this.row];
      const note = !sample ? "Not sampled for this plan." : sample.exact ? "" : `Point ${number} was not sampled; shown is point ${sample.number}.`;
      this.rotationNote.textContent = note;
      this.geneticNote.textContent = note;
      this.drawRotation(sample);
      this.drawGenetic(sample);
    }
    drawRotation(sample) {
      const context = this.rotation.begin();
      if (!sample) return;
      const c = this.data.curves, degrees = Float32Array.from({ length: c.count }, (_, i) => c.first_deg + i * c.step_deg);
      const range = [c.first_deg, c.first_deg + c.count * c.step_deg];
      const strips = 8 * STRIP + 22;
      const axes = new m.Axes(this.rotation, range, this.valueRange(sample));
      axes.bottom -= strips;
      const ticks = [];
      for (let t = Math.ceil(range[0] / 45) * 45; t <= range[1]; t += 45) ticks.push(t);
      axes.draw(context, "° rotation", this.data.objective.unit, ticks);
      axes.clip(context, () => {
        for (const dashed of [true, false]) for (let arm = 0; arm < 4; ++arm) this.drawBranch(context, axes, sample, degrees, arm, dashed);
      });
      this.drawChosen(context, axes, sample.exact);
      this.drawStrips(context, axes, sample, degrees);
    }
    // Room for all admissible values, up to four times the least, and for what lies below them out of bounds.
    valueRange(sample) {
      let low = Infinity, least = Infinity, most = -Infinity;
      for (let arm = 0; arm < 4; ++arm)
        for (let i = 0; i < this.data.curves.count; ++i) {
          const v = sample.value(arm, i);
          if (Number.isNaN(v)) continue;
          low = Math.min(low, v);
          if (sample.state(arm, i) !== 3 && sample.state(arm + 4, i) !== 3) continue;
          least = Math.min(least, v);
          most = Math.max(most, v);
        }
      if (!(low < Infinity)) return [0, 1];
      let high = least < Infinity ? Math.min(most, 4 * least) : sample.top;
      const own = this.data.column.objective.values[this.row];
      if (sample.exact && own === own) [low, high] = [Math.min(low, own), Math.max(high, own)];
      if (!(high > low)) high = 1.2 * low;
      return [low - 0.08 * (high - low), high + 0.18 * (high - low)];
    }
    drawBranch(context, axes, sample, degrees, arm, dashed) {
      const admissible = (i) => sample.state(arm, i) === 3 || sample.state(arm + 4, i) === 3;
      const values = degrees.map((_, i) => {
        const near = admissible(i) || (dashed && (admissible(Math.max(0, i - 1)) || admissible(Math.min(degrees.length - 1, i + 1))));
        return dashed || near ? sample.value(arm, i) : NaN;
      });
      context.strokeStyle = m.SERIES[arm];
      context.globalAlpha = dashed ? 0.6 : 1;
      context.lineWidth = dashed ? 1 : 2.6;
      context.setLineDash(m.DASHES[arm]);
      m.drawSeries(context, axes, degrees, values, 0, degrees.length - 1, (i) => i === 0);
      context.setLineDash([]);
      context.globalAlpha = 1;
    }
    drawChosen(context, axes, exact) {
      const rotation = this.data.column.rotation.values[this.row], value = this.data.column.objective.values[this.row];
      if (!exact || Number.isNaN(rotation) || Number.isNaN(value)) return;
      const [low, high] = axes.xRange;
      const x = axes.x(low + ((((rotation - low) % (high - low)) + (high - low)) % (high - low))), y = axes.y(value);
      context.strokeStyle = m.theme.ink;
      context.lineWidth = 1;
      m.line(context, x, axes.top, x, axes.bottom + 8 * STRIP + 22);
      m.dot(context, x, y, 5, m.theme.ink);
      context.fillStyle = m.theme.ink;
      context.textBaseline = "top";
      const right = x > axes.right - 190;
      context.textAlign = right ? "right" : "left";
      const text = m.say(`chosen ${m.format(value)} at ${m.format(rotation)}°, S${this.data.rows.branch[this.row]}`);
      context.strokeStyle = m.theme.card;
      context.lineWidth = 4;
      context.lineJoin = "round";
      context.strokeText(text, x + (right ? -6 : 6), axes.top + 2);
      context.fillText(text, x + (right ? -6 : 6), axes.top + 2);
    }
    drawStrips(context, axes, sample, degrees) {
      const width = (axes.right - axes.left) / degrees.length, top = axes.bottom + 22;
      context.textAlign = "right";
      context.textBaseline = "middle";
      for (let branch = 0; branch < 8; ++branch) {
        const y = top + branch * STRIP;
        for (let i = 0; i < degrees.length; ++i) {
          context.fillStyle = m.theme[STATES[sample.state(branch, i)].colour];
          context.fillRect(axes.left + i * width, y, width + 0.5, STRIP - 2);
        }
        context.fillStyle = this.data.rows.branch[this.row] === branch && sample.exact ? m.theme.ink : m.theme.hint;
        context.font = "9px system-ui, sans-serif";
        context.fillText("S" + branch, axes.left - 6, y + STRIP / 2 - 1);
      }
      context.font = "11px system-ui, sans-serif";
    }
    drawGenetic(sample) {
      const context = this.genetic.begin();
      if (!sample) return;
      let count = sample.best.length;
      while (count > 0 && Number.isNaN(sample.best[count - 1])) --count;
      const found = this.data.optima.genetic[this.row], optimum = this.data.optima.own[this.row];
      const levels = sample.exact ? [found, optimum].filter((v) => v === v) : [];
      const finite = [...sample.best, ...sample.mean, ...levels].filter((v) => v === v);
      if (count === 0 || finite.length === 0) {
        this.geneticNote.textContent ||= this.data.paper
          ? "The paper's formulation searched the six joint angles: it has no generations over the rotation."
          : "No admissible individual in any generation.";
        return;
      }
      const low = Math.min(...finite), high = Math.max(...finite), span = high - low || low || 1;
      const axes = new m.Axes(this.genetic, [0, Math.max(1, count - 1)], [low - 0.1 * span, high + 0.08 * span]);
      axes.draw(context, "generation", this.data.objective.unit);
      const x = Float32Array.from({ length: count }, (_, i) => i);
      axes.clip(context, () => {
        context.lineWidth = 1.2;
        [[optimum, m.theme.ink, [5, 4]], [found, m.SERIES[2], m.DASHES[2]]].forEach(([level, colour, dash]) => {
          if (!sample.exact || level !== level) return;
          context.strokeStyle = colour;
          context.setLineDash(dash);
          m.line(context, axes.left, axes.y(level), axes.right, axes.y(level));
        });
        context.setLineDash([]);
        context.lineWidth = 2;
        [[sample.mean, 1], [sample.best, 0]].forEach(([values, number]) => {
          context.strokeStyle = m.SERIES[number];
          context.setLineDash(m.DASHES[number]);
          m.drawSeries(context, axes, x, values, 0, count - 1, (i) => i === 0);
        });
      });
    }
  };

  const patch = (colour, text) => m.element("span", {}, m.element("i", { style: `background: var(--${colour})` }), text);
  const line = (number, text) => m.element("span", {}, m.swatch(number), text);
})((window.millpose = window.millpose || {}));

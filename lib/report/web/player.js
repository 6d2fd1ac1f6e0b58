// SPDX-License-Identifier: GPL-3.0-or-later
// The run of the plan over time. Times are those of the plan's own clock (lib/program/make_timeline.hpp); between two
// instants the joints turn evenly.
(function (m) {
  "use strict";

  const $ = (id) => document.getElementById(id);
  const NO_ROW = 0xffffffff;
  const STRETCHES = ["cutting", "lead-in or -out", "approach", "retract", "gap", "gap that could not be planned", "external axes move"];
  m.STRETCH = { CUT: 0, LEAD: 1, APPROACH: 2, RETRACT: 3, GAP: 4, MISSING: 5, EXTERNAL: 6 };

  m.clock = function (seconds) {
    const whole = Math.floor(seconds + 1e-6), two = (v) => String(v).padStart(2, "0");
    return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
  };

  m.Timeline = class {
    constructor(data) {
      this.data = data;
      const t = (this.raw = data.timeline);
      // Where the joints of instants that are no point's begin.
      this.own = new Uint32Array(t.time.length);
      for (let i = 0, own = 0; i < t.time.length; ++i) {
        this.own[i] = own;
        if (t.row[i] === NO_ROW) ++own;
      }
      this.timeOfRow = new Float32Array(data.count).fill(NaN);
      for (let i = t.time.length - 1; i >= 0; --i) if (t.row[i] !== NO_ROW) this.timeOfRow[t.row[i]] = t.time[i];
    }
    joints(i) {
      const { row, joints } = this.raw;
      return row[i] === NO_ROW ? Array.from(joints.subarray(6 * this.own[i], 6 * this.own[i] + 6)) : m.jointsOf(this.data, row[i]);
    }
    tip(i) {
      const { row, tip } = this.raw;
      return row[i] === NO_ROW ? Array.from(tip.subarray(3 * this.own[i], 3 * this.own[i] + 3)) : m.place(this.data, row[i]);
    }
    // Where the base stands at an instant; only where external axes move along passes.
    base(i) {
      const { row, bases } = this.raw;
      return row[i] === NO_ROW ? m.baseOf(bases, this.own[i]) : m.baseAt(this.data, row[i]);
    }
    // At a time: the joints, what the arm does there, the pass (−1: the way home), the row reached last (−1: none) and
    // where the base stands, as evenly as eyes can tell.
    at(seconds) {
      const { time, stretch, pass, row } = this.raw;
      let low = 0, high = time.length - 1;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (time[middle] < seconds) low = middle + 1;
        else high = middle;
      }
      const from = Math.max(0, low - 1), span = time[low] - time[from], share = span > 0 ? Math.max(0, Math.min(1, (seconds - time[from]) / span)) : 1;
      const a = this.joints(from), b = this.joints(low);
      const near = share < 0.5 ? from : low;
      const between = (a, b) => b.map((q, k) => a[k] + share * (q - a[k]));
      const inPass = pass[low] === NO_ROW ? -1 : pass[low], { bases, X_WB } = this.data;
      return { joints: between(a, b), stretch: stretch[low], pass: inPass, row: row[near] === NO_ROW ? -1 : row[near],
        base: this.raw.bases ? between(this.base(from), this.base(low)) : bases && inPass >= 0 ? bases[inPass] : X_WB };
    }
  };

  m.Player = class {
    constructor(data, actions, scene) {
      this.data = data;
      this.actions = actions;
      this.scene = scene;
      this.line = new m.Timeline(data);
      this.seconds = 0;
      this.playing = false;
      this.slider = $("time");
      this.slider.max = data.timeline.seconds;
      this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
      this.slider.addEventListener("change", () => this.settle());
      // As fast as shows all of it within two minutes.
      const speeds = [...$("speed").options].map((o) => o.value);
      $("speed").value = speeds.find((s) => data.timeline.seconds <= 120 * s) || speeds[speeds.length - 1];
      $("play").addEventListener("click", () => this.toggle());
      this.tell({ stretch: m.STRETCH.GAP, pass: -1 });
    }
    toggle() {
      this.playing = !this.playing;
      if (this.playing && this.seconds >= this.data.timeline.seconds) this.seconds = 0;
      this.button();
      if (!this.playing) return this.settle();
      if (this.onPlay) this.onPlay();
      let before = performance.now();
      const frame = (now) => {
        if (!this.playing) return;
        const step = (Math.max(0, now - before) / 1000) * Number($("speed").value);
        before = now;
        this.seek(this.seconds + step);
        if (this.seconds >= this.data.timeline.seconds) this.toggle();
        else requestAnimationFrame(frame);
      };
      requestAnimationFrame(frame);
    }
    button() {
      $("play").textContent = this.playing ? "❚❚" : "▶";
      $("play").setAttribute("aria-label", this.playing ? "pause" : "play");
    }
    // The arm at a time, the selection left as it is: all other views follow when the arm stands still.
    seek(seconds) {
      this.seconds = Math.max(0, Math.min(this.data.timeline.seconds, seconds));
      const at = (this.now = this.line.at(this.seconds));
      this.slider.value = this.seconds;
      this.tell(at);
      if (this.scene) {
        this.scene.pose(at.joints, "", at.base);
        this.scene.millUntil(this.seconds);
      }
    }
    step(seconds) {
      this.seek(this.seconds + seconds);
      this.settle();
    }
    settle() {
      if (!this.now || this.now.row < 0) return;
      this.settling = true;
      this.actions.select(this.now.row);
      this.settling = false;
      this.seek(this.seconds);
    }
    tell(at) {
      const where = at.pass < 0 ? (this.seconds > 0 ? "way home" : "home") : `pass ${this.data.passes[at.pass].pass}, ${STRETCHES[at.stretch]}`;
      $("clock").textContent = `${m.clock(this.seconds)} / ${m.clock(this.data.timeline.seconds)}`;
      $("doing").textContent = where;
      const { removal } = this.data;
      if (removal) $("removed").textContent = m.removedText(removal, this.seconds);
      this.slider.setAttribute("aria-valuetext", `${m.clock(this.seconds)}, ${where}`);
    }
    // Another view selected a point: the time goes there.
    select(row) {
      if (this.settling) return;
      if (this.playing) {
        this.playing = false;
        this.button();
      }
      const time = this.line.timeOfRow[row];
      if (Number.isNaN(time)) return;
      this.seconds = time;
      this.now = null;
      this.slider.value = time;
      this.tell(this.line.at(time));
      if (this.scene) this.scene.millUntil(time);
    }
  };
})((window.millpose = window.millpose || {}));

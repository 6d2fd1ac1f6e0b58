// SPDX-License-Identifier: GPL-3.0-or-later
// The charts along the path: which there are, and the cursor and zoom that they share.
(function (m) {
  "use strict";

  m.PathCharts = class {
    constructor(parent, data, actions) {
      this.data = data;
      const rows = data.rows;
      const group = {
        x: rows.way,
        bands: data.passes,
        range: null,
        selected: 0,
        hovered: -1,
        skipped: (i) => rows.status[i] !== 0,
        broken: (i) => i === 0 || rows.pass[i] !== rows.pass[i - 1] || rows.piece[i] !== rows.piece[i - 1],
        pick: actions.select,
        hover: (row) => {
          group.hovered = row;
          this.schedule();
        },
        zoom: (range) => {
          group.range = range;
          this.redraw();
        },
      };
      this.group = group;
      const chart = (title, keys, height, unit) => {
        const columns = keys.map((key) => data.column[key]).filter((c) => c && c.values.some((v) => !Number.isNaN(v)));
        if (columns.length === 0) return null;
        const series = columns.map((c, i) => ({ symbol: c.symbol, values: c.values, number: i, bound: c.bound }));
        return new m.PathChart(parent, group, title, unit === undefined ? columns[0].unit : unit, series, height);
      };
      this.chosen = chart("Objective", ["objective"], 150);
      const six = (letter) => [1, 2, 3, 4, 5, 6].map((j) => letter + j);
      this.charts = [
        this.chosen,
        chart("Compliance indices", ["lambda_t1", "lambda_t2", "lambda_n", "normal_compliance"], 160),
        chart("Predicted deflection under the mean cutting force", ["deflection", "deflection_normal", "deflection_feed", "deflection_across"], 160),
        chart("Error along the normal, before and after compensation", ["before", "after", "worst_before", "worst_after"], 160),
        chart("Shift of the commanded tip", ["shift"], 110),
        chart("Commanded tip from the planned one, for the arm", ["arm_shift", "gear_shift"], 110),
        chart("Marks of joints that turn back", ["reversal"], 130),
        chart("Displacement along the normal by lost motion", ["lost_motion"], 130),
        chart("What is cut", ["cut_width", "cut_depth"], 130),
        chart("Mean cutting force", ["cut_force"], 110),
        chart("Isotropy and dexterity", ["mu", "dexterity"], 120),
        chart("Clearance", ["clearance"], 110),
        chart("Joint angles", six("a"), 170),
        chart("Joint speeds", six("v"), 150),
        ...m.externalKeys(data).map((key) => chart(data.column[key].label, [key], 110)),
        chart("Distance of the nearest joint from its limit", ["limit_reserve"], 110),
      ].filter((c) => c);
    }
    // The first chart shows what the 3-D view is coloured by.
    show(column) {
      if (!this.chosen) return;  // no point is planned
      this.chosen.title.textContent = `${column.symbol}: ${column.label}`;
      this.chosen.unit = column.unit;
      this.chosen.series = [{ symbol: column.symbol, values: column.values, number: 0, bound: column.bound }];
      this.chosen.redraw();
    }
    select(row) {
      const group = this.group, x = group.x[row];
      group.selected = row;
      if (group.range && (x < group.range[0] || x > group.range[1])) {
        group.range = null;
        this.redraw();
      }
      this.schedule();
    }
    // The cursors alone; redraw() draws all anew.
    schedule() {
      for (const chart of this.charts) chart.schedule();
    }
    redraw() {
      for (const chart of this.charts) chart.redraw();
    }
  };
})((window.millpose = window.millpose || {}));

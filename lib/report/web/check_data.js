// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the JSON that check_html.cpp wrote, into the shape that the 3-D view of report.html draws.
(function (m) {
  "use strict";

  const { floats, uint32, uint16 } = m.unpack;
  const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

  m.REACH = ["within reach", "too far or too near", "outside a limit", "near a singularity"];

  function readPath(raw, data) {
    const count = raw ? uint32(raw.number).length : 0, none = () => new Uint32Array(count);
    const path = raw || {}, words = (text) => (text ? uint32(text) : none()), values = (text) => (text ? floats(text) : new Float32Array(0));
    data.count = count;
    data.rows = {
      number: words(path.number), pass: words(path.pass), piece: none(), kind: words(path.kind), state: words(path.state), axis: words(path.axis),
      status: none(), way: values(path.way_mm), position: values(path.position_mm), normal: values(path.normal), toolAxis: values(path.tool_axis),
    };
    // Red where no pose is admissible.
    data.rows.status.set(data.rows.state.map((s) => (s === 0 ? 0 : 1)));
    const joints = values(path.joints_deg), reserve = values(path.reserve_deg);
    const column = (key, symbol, label, unit, worse, all) => ({ key, symbol, label, unit, worse, bound: null, values: all });
    data.columns = [column("reserve", "to limit", "what the best pose keeps from the limit of its nearest axis", "°", -1, reserve),
      column("pass", "pass", "pass", "", 0, Float32Array.from(data.rows.pass))];
    data.column = { reserve: data.columns[0], pass: data.columns[1], clearance: null };
    for (let j = 0; j < 6; ++j) data.column["a" + (j + 1)] = { values: joints.filter((_, i) => i % 6 === j) };
  }

  m.readCheck = function (text) {
    const raw = JSON.parse(text), data = Object.assign({}, raw), cell = raw.cell;
    data.X_WP = cell ? cell.X_WP : IDENTITY;
    data.X_WB = cell ? cell.X_WB : IDENTITY;
    data.X_FT = cell ? cell.X_FT : IDENTITY;
    data.arm = cell && cell.arm;
    data.bodies = (cell ? cell.bodies : []).map((b) => Object.assign({}, b, { vertices: floats(b.vertices), faces: uint32(b.faces) }));
    readPath(raw.path, data);
    if (raw.part)
      data.part = Object.assign({}, raw.part, { vertices: floats(raw.part.vertices), triangles: uint32(raw.part.triangles),
        faceOf: uint32(raw.part.face_of), inRegion: uint32(raw.part.in_region),
        edges: raw.part.edges.map((e) => Object.assign({}, e, { sides: floats(e.sides_mm) })) });
    data.removal = raw.removal && m.readRemoval(raw.removal, { floats, uint32, uint16 });
    return data;
  };
})((window.millpose = window.millpose || {}));

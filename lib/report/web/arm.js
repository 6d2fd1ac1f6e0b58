// SPDX-License-Identifier: GPL-3.0-or-later
// Forward kinematics as in lib/machine/robot: frames of the links in W for joint angles in degrees.
(function (m) {
  "use strict";

  const DEG = Math.PI / 180;

  // Row-major 4×4.
  m.multiply = function (a, b) {
    const c = new Array(16).fill(0);
    for (let i = 0; i < 4; ++i)
      for (let j = 0; j < 4; ++j)
        for (let k = 0; k < 4; ++k) c[4 * i + j] += a[4 * i + k] * b[4 * k + j];
    return c;
  };
  const shift = (x, y, z) => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1];
  const turnX = (a) => [1, 0, 0, 0, 0, Math.cos(a), -Math.sin(a), 0, 0, Math.sin(a), Math.cos(a), 0, 0, 0, 0, 1];
  const turnY = (a) => [Math.cos(a), 0, Math.sin(a), 0, 0, 1, 0, 0, -Math.sin(a), 0, Math.cos(a), 0, 0, 0, 0, 1];
  const turnZ = (a) => [Math.cos(a), -Math.sin(a), 0, 0, Math.sin(a), Math.cos(a), 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

  // Where the robot's base stands at a row: where the external axes have put it, as seen from the part.
  m.baseAt = (data, row) => (data.rowBases ? m.baseOf(data.rowBases, row) : data.bases ? data.bases[data.rows.pass[row]] : data.X_WB);
  // The pose number `i` of packed ones, 4x4.
  m.baseOf = (packed, i) => [...packed.subarray(12 * i, 12 * i + 12), 0, 0, 0, 1];

  // Frames 0 (base) … 6 (flange) in W, and the tool last.
  m.armFrames = function (data, degrees, base = data.X_WB) {
    const a = data.arm;
    const q = degrees.map((angle, i) => (a.sign[i] * angle + a.offset_deg[i]) * DEG);
    const steps = [
      [shift(0, 0, a.d1), turnZ(q[0])],
      [shift(a.a1, a.dy, 0), turnY(q[1])],
      [shift(a.a2, 0, 0), turnY(q[2])],
      [shift(a.d4, 0, a.dz), turnZ(a.parallel ? Math.PI / 2 : 0), turnX(q[3])],
      [shift(0, -a.d5, 0), turnY(q[4])],
      [turnX(q[5]), shift(a.d6, 0, 0), turnY(Math.PI / 2)],
    ];
    const frames = [base];
    for (const step of steps) frames.push(step.reduce(m.multiply, frames[frames.length - 1]));
    frames.push(m.multiply(frames[6], data.X_FT));
    return frames;
  };

  // Joint angles of a row in degrees; null for a skipped point.
  m.jointsOf = function (data, row) {
    const angles = [1, 2, 3, 4, 5, 6].map((j) => data.column["a" + j].values[row]);
    return angles.some(Number.isNaN) ? null : angles;
  };
})((window.millpose = window.millpose || {}));

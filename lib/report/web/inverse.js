// SPDX-License-Identifier: GPL-3.0-or-later
// The closed-form inverse as in lib/machine/robot/closed_form.hpp: joint angles in degrees for a pose of the tool in W.
(function (m) {
  "use strict";

  const DEG = Math.PI / 180;
  const clamp = (v) => Math.max(-1, Math.min(1, v));

  // Inverse of a rigid row-major 4×4.
  m.rigidInverse = function (X) {
    const R = (i, j) => X[4 * i + j], p = [X[3], X[7], X[11]];
    const row = (i) => [R(0, i), R(1, i), R(2, i), -(R(0, i) * p[0] + R(1, i) * p[1] + R(2, i) * p[2])];
    return [...row(0), ...row(1), ...row(2), 0, 0, 0, 1];
  };

  // q2 and q3 for the forearm's end at x forward and y down of axis 2; null out of reach.
  function elbowAngles(a, x, y, elbow) {
    const forearm = Math.hypot(a.d4, a.dz), raw = (x * x + y * y - a.a2 * a.a2 - forearm * forearm) / (2 * a.a2 * forearm);
    if (Math.abs(raw) > 1 + 1e-12) return null;
    const cosine = clamp(raw), bend = elbow * Math.acos(cosine);
    return [Math.atan2(y, x) - Math.atan2(forearm * Math.sin(bend), a.a2 + forearm * cosine), bend + Math.atan2(a.dz, a.d4)];
  }

  // a, q5, q6 of M = Rx(a)·Ry(q5)·Rx(q6), flipped or not.
  function wristAngles(m00, m10, m20, m11, m21, m12, m22, flip) {
    const sine = Math.hypot(m10, m20), first = sine < 1e-10 ? 0 : Math.atan2(m10, -m20);
    const c = Math.cos(first), s = Math.sin(first);
    const sixth = Math.atan2(-(c * m12 + s * m22), c * m11 + s * m21), turn = flip < 0 && sine >= 1e-10 ? Math.PI : 0;
    return [first + turn, Math.atan2(flip * sine, m00), sixth + turn];
  }

  function inner(a, X, branch) {
    const side = branch & 1 ? -1 : 1, elbow = branch & 2 ? 1 : -1, flip = branch & 4 ? -1 : 1;
    const x = [X[0], X[4], X[8]], y = [X[1], X[5], X[9]], z = [X[2], X[6], X[10]];
    const w = [X[3] - a.d6 * z[0], X[7] - a.d6 * z[1], X[11] - a.d6 * z[2]];
    const length = Math.hypot(w[0], w[1]);
    if (Math.abs(a.dy) > length * (1 + 1e-12)) return null;
    const along = Math.sqrt(Math.max(0, length * length - a.dy * a.dy));
    const q1 = Math.atan2(w[1], w[0]) - Math.atan2(a.dy, side * along), c1 = Math.cos(q1), s1 = Math.sin(q1);
    const forward = side * along - a.a1, down = a.d1 - w[2];
    if (a.parallel) {
      const wrist = wristAngles(c1 * z[1] - s1 * z[0], -(c1 * z[0] + s1 * z[1]), z[2], -(c1 * y[0] + s1 * y[1]), y[2], c1 * x[0] + s1 * x[1], -x[2], flip);
      const bend = elbowAngles(a, forward - a.d5 * Math.cos(wrist[0]), down - a.d5 * Math.sin(wrist[0]), elbow);
      return bend && [q1, bend[0], bend[1], wrist[0] - bend[0] - bend[1], wrist[1], wrist[2]];
    }
    const bend = elbowAngles(a, forward, down, elbow);
    if (!bend) return null;
    const s23 = Math.sin(bend[0] + bend[1]), c23 = Math.cos(bend[0] + bend[1]);
    const x3 = [c1 * c23, s1 * c23, -s23], z3 = [c1 * s23, s1 * s23, c23];
    const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    return [q1, ...bend, ...wristAngles(dot(x3, z), c1 * z[1] - s1 * z[0], dot(z3, z), c1 * y[1] - s1 * y[0], dot(z3, y), s1 * x[0] - c1 * x[1], -dot(z3, x), flip)];
  }

  // Joint angles in degrees with which the tool stands at X_WT on a branch; null out of reach.
  m.armInverse = function (data, X_WT, branch, base = data.X_WB) {
    const X_BF = m.multiply(m.multiply(m.rigidInverse(base), X_WT), m.rigidInverse(data.X_FT));
    const q = inner(data.arm, X_BF, branch), a = data.arm;
    return q && q.map((angle, i) => {
      const outer = a.sign[i] * (angle / DEG - a.offset_deg[i]);
      return outer - 360 * Math.floor(outer / 360 + 0.5);
    });
  };

  // Joint angles at a row's point, the tool turned to `rotation` (°); from the nearest planned point of its pass where
  // the row itself is skipped. Null where the arm does not reach.
  m.jointsAt = function (data, row, rotation, branch) {
    const { pass } = data.rows;
    const planned = (r) => pass[r] === pass[row] && m.jointsOf(data, r) !== null;
    let from = -1;
    for (let away = 0; from < 0 && (pass[row - away] === pass[row] || pass[row + away] === pass[row]); ++away)
      from = planned(row - away) ? row - away : planned(row + away) ? row + away : -1;
    if (from < 0) return null;
    const X_WT = m.armFrames(data, m.jointsOf(data, from), m.baseAt(data, row))[7];
    const turn = (rotation - data.column.rotation.values[from]) * DEG, c = Math.cos(turn), s = Math.sin(turn);
    const turned = m.multiply(X_WT, [c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    m.place(data, row).forEach((p, k) => { turned[4 * k + 3] = p; });
    return m.armInverse(data, turned, branch, m.baseAt(data, row));
  };
})((window.millpose = window.millpose || {}));

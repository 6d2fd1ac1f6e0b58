// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles for the 3-D view.
(function (m) {
  "use strict";

  const CREASE = Math.cos((35 * Math.PI) / 180);

  // Unit normals of the faces, x y z in turn. Plain loops here and below: they run over every corner while the page opens.
  function faceNormals(vertices, faces) {
    const normals = new Float32Array(faces.length);
    for (let f = 0; f < faces.length; f += 3) {
      const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
      const ux = vertices[b] - vertices[a], uy = vertices[b + 1] - vertices[a + 1], uz = vertices[b + 2] - vertices[a + 2];
      const vx = vertices[c] - vertices[a], vy = vertices[c + 1] - vertices[a + 1], vz = vertices[c + 2] - vertices[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      const length = Math.sqrt(x * x + y * y + z * z) || 1;
      normals[f] = x / length;
      normals[f + 1] = y / length;
      normals[f + 2] = z / length;
    }
    return normals;
  }

  // The faces around every vertex v: around[start[v]] … around[start[v + 1] - 1].
  function facesAround(vertexCount, faces) {
    const start = new Uint32Array(vertexCount + 1);
    for (let i = 0; i < faces.length; ++i) ++start[faces[i] + 1];
    for (let v = 1; v < start.length; ++v) start[v] += start[v - 1];
    const around = new Uint32Array(faces.length), fill = start.slice();
    for (let i = 0; i < faces.length; ++i) around[fill[faces[i]]++] = Math.floor(i / 3);
    return { start, around };
  }

  // Triangles with a normal per corner: the mean of its neighbours' that lie within the crease angle.
  m.geometryOf = function (vertices, faces) {
    const position = new Float32Array(3 * faces.length), normal = new Float32Array(3 * faces.length);
    const flat = faceNormals(vertices, faces), { start, around } = facesAround(vertices.length / 3, faces);
    for (let i = 0; i < faces.length; ++i) {
      const v = faces[i], own = i - (i % 3);
      let x = 0, y = 0, z = 0;
      for (let a = start[v]; a < start[v + 1]; ++a) {
        const n = 3 * around[a];
        if (flat[n] * flat[own] + flat[n + 1] * flat[own + 1] + flat[n + 2] * flat[own + 2] <= CREASE) continue;
        x += flat[n];
        y += flat[n + 1];
        z += flat[n + 2];
      }
      const length = Math.sqrt(x * x + y * y + z * z) || 1;
      normal[3 * i] = x / length;
      normal[3 * i + 1] = y / length;
      normal[3 * i + 2] = z / length;
      for (let k = 0; k < 3; ++k) position[3 * i + k] = vertices[3 * v + k];
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normal, 3));
    return geometry;
  };
})((window.millpose = window.millpose || {}));

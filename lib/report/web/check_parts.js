// SPDX-License-Identifier: GPL-3.0-or-later
// The part of check.html: its faces, edges and region, to be picked by clicking; and the normals of the path.
(function (m) {
  "use strict";

  const NEAR = 7;  // pixels beside an edge that still pick it

  const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
  const mix = (a, b, share) => a.map((v, k) => v * (1 - share) + b[k] * share);

  m.CheckParts = class {
    constructor(scene, data) {
      this.scene = scene;
      this.data = data;
      this.part = data.part;
      this.showRegion = true;
      this.group = scene.groups.part;
      this.normals = new THREE.Group();
      this.normals.visible = false;
      scene.scene.add(this.normals);
      if (data.count > 0) this.addNormals();
      if (!this.part) return;
      this.place = new THREE.Matrix4().set(...data.X_WP);
      this.addMesh();
      this.addEdges();
      this.recolour();
    }

    addMesh() {
      const geometry = m.geometryOf(this.part.vertices, this.part.triangles);
      this.colours = new THREE.BufferAttribute(new Float32Array(3 * this.part.triangles.length), 3);
      geometry.setAttribute("color", this.colours);
      this.mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 }));
      this.add(this.mesh);
    }
    add(object) {
      object.matrixAutoUpdate = false;
      object.matrix.copy(this.place);
      object.frustumCulled = false;
      this.group.add(object);
      object.updateMatrixWorld(true);
    }

    addEdges() {
      const places = [];
      for (const edge of this.part.edges) for (const value of edge.sides) places.push(value);
      this.edges = this.lines(places, "ink");
      this.chosenEdge = this.lines([], "near");
      this.chosenEdge.renderOrder = 2;
    }
    lines(places, colour) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
      const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ linewidth: 2 }));
      lines.name = colour;
      this.add(lines);
      return lines;
    }

    // A line along every point's normal; where the tool's axis is another, one along that too.
    addNormals() {
      const { position, normal, toolAxis } = this.data.rows, count = this.data.count;
      const box = new THREE.Box3().setFromBufferAttribute(new THREE.BufferAttribute(position, 3)), length = Math.max(8, 0.03 * box.getSize(new THREE.Vector3()).length());
      const along = (directions, wanted) => {
        const places = [];
        for (let i = 0; i < count; ++i) {
          if (!wanted(i)) continue;
          for (const far of [0, length]) for (let k = 0; k < 3; ++k) places.push(position[3 * i + k] + far * directions[3 * i + k]);
        }
        return places;
      };
      const tilted = (i) => Math.hypot(...[0, 1, 2].map((k) => normal[3 * i + k] - toolAxis[3 * i + k])) > 1e-3;
      for (const [places, colour] of [[along(normal, () => true), "gap"], [along(toolAxis, tilted), "near"]]) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
        const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial());
        lines.name = colour;
        lines.frustumCulled = false;
        this.normals.add(lines);
      }
    }

    // What is chosen, what lies in the region, the rest.
    recolour() {
      for (const lines of this.normals.children) lines.material.color.set(m.theme[lines.name]);
      if (!this.part) return this.scene.schedule();
      const plain = [0.79, 0.82, 0.84], region = mix(plain, hex(m.SERIES[0]), 0.45), chosen = hex(m.theme.near);
      this.part.faceOf.forEach((face, triangle) => {
        const colour = face === this.face ? chosen : this.showRegion && this.part.inRegion[triangle] ? region : plain;
        for (let corner = 0; corner < 3; ++corner) this.colours.array.set(colour, 9 * triangle + 3 * corner);
      });
      this.colours.needsUpdate = true;
      for (const lines of [this.edges, this.chosenEdge]) lines.material.color.set(m.theme[lines.name === "near" ? "near" : "lead"]);
      this.scene.schedule();
    }
    choose(face, edge) {
      this.face = face;
      this.edge = edge;
      const sides = edge === null ? new Float32Array(0) : this.part.edges[edge].sides;
      this.chosenEdge.geometry.setAttribute("position", new THREE.BufferAttribute(sides, 3));
      this.chosenEdge.visible = edge !== null;
      this.recolour();
    }

    // What stands at a place of the view: {edge}, {face}, or null. An edge only where nothing hides it.
    at(x, y) {
      if (!this.part || !this.group.visible) return null;
      const { camera, width, height } = this.scene;
      const ray = new THREE.Raycaster();
      ray.setFromCamera(new THREE.Vector2((2 * x) / width - 1, 1 - (2 * y) / height), camera);
      const hit = ray.intersectObject(this.mesh)[0], edge = this.edgeAt(x, y, hit ? hit.distance : Infinity);
      if (edge !== null) return { face: null, edge };
      return hit ? { face: this.part.faceOf[hit.faceIndex !== undefined ? hit.faceIndex : Math.floor(hit.face.a / 3)], edge: null } : null;
    }
    edgeAt(x, y, depth) {
      if (!this.edges.visible) return null;
      const eye = this.scene.camera.position, seen = (p) => {
        const at = new THREE.Vector3(...p).applyMatrix4(this.place), far = at.distanceTo(eye), [px, py, z] = this.scene.onScreen(at.toArray());
        return { x: px, y: py, z, far };
      };
      let best = null, least = NEAR;
      this.part.edges.forEach((edge, number) => {
        for (let i = 0; i < edge.sides.length; i += 6) {
          const a = seen(edge.sides.subarray(i, i + 3)), b = seen(edge.sides.subarray(i + 3, i + 6));
          if (a.z >= 1 || b.z >= 1) continue;
          const dx = b.x - a.x, dy = b.y - a.y, t = Math.max(0, Math.min(1, ((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy || 1)));
          const away = Math.hypot(x - a.x - t * dx, y - a.y - t * dy), far = a.far + t * (b.far - a.far);
          if (away < least && far < 1.01 * depth) [best, least] = [number, away];
        }
      });
      return best;
    }
  };
})((window.millpose = window.millpose || {}));

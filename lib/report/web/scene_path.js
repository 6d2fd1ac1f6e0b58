// SPDX-License-Identifier: GPL-3.0-or-later
// The path in the 3-D view: discs and lines coloured by an index, leads as rings, and the ways between pieces.
(function (m) {
  "use strict";

  // Round, lit-free discs of a size in mm that never get smaller or larger than a few pixels; rings where `ring` is 1.
  function pointMaterial(size) {
    return new THREE.ShaderMaterial({
      uniforms: { size: { value: size }, height: { value: 600 }, ratio: { value: 1 } },
      vertexColors: true,
      vertexShader: `
        uniform float size, height, ratio; attribute float ring; varying vec3 tint; varying float hollow;
        void main() {
          tint = color;
          hollow = ring;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
          float pixels = size * height * projectionMatrix[1][1] / gl_Position.w * 0.5;
          gl_PointSize = ratio * clamp(pixels, 3.0 + 3.0 * ring, 14.0);
          gl_Position.z -= 0.0015 * gl_Position.w;
        }`,
      fragmentShader: `
        varying vec3 tint; varying float hollow;
        void main() {
          float away = length(gl_PointCoord - 0.5);
          if (away > 0.5 || (hollow > 0.5 && away < 0.27)) discard;
          gl_FragColor = vec4(tint, 1.0);
        }`,
    });
  }

  // A disc's size: the middle distance of neighbours on the path, mm.
  function spacing(data) {
    const steps = [];
    for (let i = 1; i < data.count; ++i) {
      const step = data.rows.way[i] - data.rows.way[i - 1];
      if (step > 0) steps.push(step);
    }
    steps.sort((a, b) => a - b);
    return Math.max(1, 1.4 * (steps[steps.length >> 1] || 10));
  }

  const rgbOf = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);

  m.ScenePath = class {
    constructor(scene, data) {
      const { rows, count } = data;
      this.data = data;
      this.colours = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
      const position = new THREE.BufferAttribute(rows.position, 3);
      const geometry = (more) => {
        const made = new THREE.BufferGeometry();
        for (const [name, attribute] of Object.entries({ position, color: this.colours, ...more })) made.setAttribute(name, attribute);
        return made;
      };
      this.material = pointMaterial(spacing(data));
      const ring = new THREE.BufferAttribute(Float32Array.from(rows.kind, (kind) => (kind === 0 ? 0 : 1)), 1);
      const points = new THREE.Points(geometry({ ring }), this.material);
      const pairs = [];
      for (let i = 1; i < count; ++i)
        if (rows.pass[i] === rows.pass[i - 1] && rows.piece[i] === rows.piece[i - 1] && !rows.status[i] && !rows.status[i - 1]) pairs.push(i - 1, i);
      const lines = new THREE.LineSegments(geometry({}).setIndex(pairs), new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors }));
      // After the arm, which is seen through: the colours of the path stay true behind it.
      for (const path of [lines, points]) {
        path.frustumCulled = false;
        path.material.transparent = true;
        path.renderOrder = 1;
      }
      this.ways = new THREE.Group();
      if (data.timeline) this.addWays();
      this.drawn = [lines, points];
      this.marks = this.marksOf(data);
      scene.add(lines, points, this.ways, this.marks);
    }
    // Rings around the points at which a joint turns back.
    marksOf(data) {
      const column = data.column.reversal, at = [];
      for (let i = 0; column && i < data.count; ++i) if (column.values[i] > 0) at.push(...data.rows.position.subarray(3 * i, 3 * i + 3));
      const count = at.length / 3, red = rgbOf(m.RED), geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(at), 3));
      geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * count).map((_, i) => red[i % 3]), 3));
      geometry.setAttribute("ring", new THREE.BufferAttribute(new Float32Array(count).fill(1), 1));
      const marks = new THREE.Points(geometry, pointMaterial(2.2 * spacing(data)));
      marks.frustumCulled = false;
      marks.material.transparent = true;
      marks.renderOrder = 2;
      this.markMaterial = marks.material;
      return marks;
    }
    show(on) {
      this.shown = on;
      for (const path of this.drawn) path.visible = on;
    }

    // From piece to piece as the tip goes: dashed between retract and approach; what could not be planned straight.
    addWays() {
      const line = new m.Timeline(this.data), { stretch } = line.raw, S = m.STRETCH;
      const of = { [S.APPROACH]: "lead", [S.RETRACT]: "lead", [S.GAP]: "gap", [S.EXTERNAL]: "gap", [S.MISSING]: "bad" };
      const corners = { lead: [], gap: [], bad: [] };
      for (let i = 1; i < stretch.length; ++i) if (of[stretch[i]]) corners[of[stretch[i]]].push(...line.tip(i - 1), ...line.tip(i));
      for (const [name, places] of Object.entries(corners)) {
        if (places.length === 0) continue;
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
        const material = name === "lead" ? new THREE.LineBasicMaterial() : new THREE.LineDashedMaterial({ dashSize: 24, gapSize: 14 });
        const way = new THREE.LineSegments(geometry, material);
        if (name !== "lead") way.computeLineDistances();
        way.name = name;
        way.frustumCulled = false;
        way.renderOrder = 1;
        way.material.transparent = true;
        way.material.opacity = name === "gap" ? 0.4 : 1;
        this.ways.add(way);
      }
      this.recolour();
    }
    recolour() {
      for (const way of this.ways.children) way.material.color.set(m.theme[way.name]);
    }

    // Colours every point by `scale`; skipped points are red, points without a value grey.
    colour(column, scale) {
      const { rows, count } = this.data, bad = rgbOf(m.RED);
      for (let i = 0; i < count; ++i) {
        const v = column.values[i];
        this.colours.array.set(rows.status[i] ? bad : Number.isNaN(v) ? [0.6, 0.6, 0.6] : m.viridis(scale.share(v)), 3 * i);
      }
      this.colours.needsUpdate = true;
    }
  };
})((window.millpose = window.millpose || {}));

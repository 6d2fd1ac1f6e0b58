// SPDX-License-Identifier: GPL-3.0-or-later
// The 3-D view: workpiece, path, cell and arm with three.js; drawn when something changed, not all the time.
(function (m) {
  "use strict";

  const COLOURS = { workpiece: 0xc9d0d6, link: 0x7f8b96, spindle: 0x4f6d8f, holder: 0x4f6d8f, cutter: 0xb03a2e, fixture: 0x8fa1ae, platform: 0xa9b4bc };
  const CREASE = Math.cos((35 * Math.PI) / 180);

  // Triangles with a normal per corner: the mean of its neighbours' that lie within the crease angle.
  function geometryOf(vertices, faces) {
    const count = faces.length / 3;
    const position = new Float32Array(9 * count), faceNormal = new Float32Array(3 * count);
    for (let f = 0; f < count; ++f) {
      const p = [0, 1, 2].map((k) => vertices.subarray(3 * faces[3 * f + k], 3 * faces[3 * f + k] + 3));
      p.forEach((q, k) => position.set(q, 9 * f + 3 * k));
      const u = [0, 1, 2].map((k) => p[1][k] - p[0][k]), v = [0, 1, 2].map((k) => p[2][k] - p[0][k]);
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const length = Math.hypot(...n) || 1;
      faceNormal.set(n.map((x) => x / length), 3 * f);
    }
    const start = new Uint32Array(vertices.length / 3 + 1);
    for (const v of faces) ++start[v + 1];
    for (let v = 1; v < start.length; ++v) start[v] += start[v - 1];
    const around = new Uint32Array(faces.length), fill = start.slice();
    faces.forEach((v, corner) => (around[fill[v]++] = Math.floor(corner / 3)));
    const normal = new Float32Array(9 * count);
    for (let corner = 0; corner < faces.length; ++corner) {
      const own = faceNormal.subarray(3 * Math.floor(corner / 3), 3 * Math.floor(corner / 3) + 3);
      let sum = [0, 0, 0];
      for (let a = start[faces[corner]]; a < start[faces[corner] + 1]; ++a) {
        const n = faceNormal.subarray(3 * around[a], 3 * around[a] + 3);
        if (n[0] * own[0] + n[1] * own[1] + n[2] * own[2] > CREASE) sum = sum.map((x, k) => x + n[k]);
      }
      const length = Math.hypot(...sum) || 1;
      normal.set(sum.map((x) => x / length), 3 * corner);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normal, 3));
    return geometry;
  }

  const matrix = (rows) => new THREE.Matrix4().set(...rows);

  // Round, lit-free discs of a size in mm that never get smaller or larger than a few pixels.
  function pointMaterial(size) {
    return new THREE.ShaderMaterial({
      uniforms: { size: { value: size }, height: { value: 600 }, ratio: { value: 1 } },
      vertexColors: true,
      vertexShader: `
        uniform float size, height, ratio; varying vec3 tint;
        void main() {
          tint = color;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
          float pixels = size * height * projectionMatrix[1][1] / gl_Position.w * 0.5;
          gl_PointSize = ratio * clamp(pixels, 3.0, 14.0);
          gl_Position.z -= 0.0015 * gl_Position.w;
        }`,
      fragmentShader: `
        varying vec3 tint;
        void main() {
          if (length(gl_PointCoord - 0.5) > 0.5) discard;
          gl_FragColor = vec4(tint, 1.0);
        }`,
    });
  }

  m.Scene = class {
    constructor(parent, data, actions) {
      this.parent = parent;
      this.data = data;
      this.actions = actions;
      this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
      parent.prepend(this.renderer.domElement);
      this.renderer.domElement.setAttribute("aria-label", "3-D view of the part, the path and the arm");
      this.scene = new THREE.Scene();
      this.camera = new THREE.PerspectiveCamera(35, 1, 1, 1e6);
      this.camera.up.set(0, 0, 1);
      const sky = new THREE.HemisphereLight(0xffffff, 0x8a8f96, 0.75);
      sky.position.set(0, 0, 1);
      this.lamp = new THREE.DirectionalLight(0xffffff, 0.5);
      this.scene.add(sky, this.lamp, this.lamp.target);
      this.addPath();
      this.addBodies();
      this.marker = m.element("div", { class: "marker" }, m.element("span"));
      this.worst = m.element("div", { class: "marker worst" }, m.element("span"));
      parent.append(this.worst, this.marker);
      this.orbit = new m.Orbit(this.renderer.domElement, () => this.schedule(), (x, y) => this.pick(x, y));
      this.fit(false);
    }

    addPath() {
      const { rows, count } = this.data;
      const colours = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
      const position = new THREE.BufferAttribute(rows.position, 3);
      const points = new THREE.BufferGeometry();
      points.setAttribute("position", position);
      points.setAttribute("color", colours);
      this.pathColours = colours;
      this.pointMaterial = pointMaterial(this.spacing());
      this.pathPoints = new THREE.Points(points, this.pointMaterial);
      this.pathPoints.frustumCulled = false;
      const pairs = [];
      for (let i = 1; i < count; ++i)
        if (rows.pass[i] === rows.pass[i - 1] && rows.piece[i] === rows.piece[i - 1] && !rows.status[i] && !rows.status[i - 1]) pairs.push(i - 1, i);
      const lines = new THREE.BufferGeometry();
      lines.setAttribute("position", position);
      lines.setAttribute("color", colours);
      lines.setIndex(pairs);
      this.pathLines = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors }));
      this.pathLines.frustumCulled = false;
      // After the arm, which is seen through: the colours of the path stay true behind it.
      for (const path of [this.pathLines, this.pathPoints]) {
        path.material.transparent = true;
        path.renderOrder = 1;
      }
      this.scene.add(this.pathLines, this.pathPoints);
    }

    // A disc's size: the middle distance of neighbours on the path, mm.
    spacing() {
      const steps = [];
      for (let i = 1; i < this.data.count; ++i) {
        const step = this.data.rows.way[i] - this.data.rows.way[i - 1];
        if (step > 0) steps.push(step);
      }
      steps.sort((a, b) => a - b);
      return Math.max(1, 1.4 * (steps[steps.length >> 1] || 10));
    }

    addBodies() {
      this.moving = [];
      this.groups = { part: new THREE.Group(), cell: new THREE.Group(), arm: new THREE.Group() };
      this.scene.add(...Object.values(this.groups));
      for (const body of this.data.bodies) {
        const workpiece = body.class === "workpiece";
        const moves = (body.mount === "link" && body.link > 0) || body.mount === "tool";
        const material = new THREE.MeshLambertMaterial({
          color: COLOURS[body.class] || 0x999999, side: THREE.DoubleSide,
          // Seen through, so that the arm never hides the path.
          transparent: moves, opacity: moves ? 0.28 : 1, depthWrite: !moves,
          polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2,
        });
        const mesh = new THREE.Mesh(geometryOf(body.vertices, body.faces), material);
        mesh.matrixAutoUpdate = false;
        this.groups[workpiece ? "part" : moves || body.mount === "link" ? "arm" : "cell"].add(mesh);
        if (moves) {
          this.moving.push({ mesh, body, frame: body.mount === "tool" ? 7 : body.link });
        } else {
          const mount = { world: null, link: this.data.X_WB, workpiece: this.data.X_WP }[body.mount];
          mesh.matrix = mount ? matrix(mount).multiply(matrix(body.X_MG)) : matrix(body.X_MG);
        }
      }
      // The skeleton shows the arm also where the cell gives it no shapes.
      this.skeleton = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x39424c }));
      this.skeleton.frustumCulled = false;
      this.skeletonJoints = new THREE.Points(this.skeleton.geometry, new THREE.PointsMaterial({ color: 0x39424c, size: 6, sizeAttenuation: false }));
      this.skeletonJoints.frustumCulled = false;
      this.groups.arm.add(this.skeleton, this.skeletonJoints);
    }

    // Colours every point by `scale`; skipped points are red, points without a value grey.
    colour(column, scale) {
      const { rows, count } = this.data;
      for (let i = 0; i < count; ++i) {
        const v = column.values[i];
        const rgb = rows.status[i] ? [0.76, 0.15, 0.18] : Number.isNaN(v) ? [0.6, 0.6, 0.6] : m.viridis(scale.share(v));
        this.pathColours.array.set(rgb, 3 * i);
      }
      this.pathColours.needsUpdate = true;
      this.schedule();
    }

    select(row) {
      this.selected = row;
      const joints = m.jointsOf(this.data, row);
      this.groups.arm.visible = joints !== null && this.showArm !== false;
      if (joints) {
        const frames = m.armFrames(this.data, joints);
        for (const { mesh, body, frame } of this.moving) mesh.matrix = matrix(frames[frame]).multiply(matrix(body.X_MG));
        const at = (f) => [frames[f][3], frames[f][7], frames[f][11]];
        const way = new Float32Array([0, 1, 2, 3, 5, 6, 7].flatMap(at));
        this.skeleton.geometry.setAttribute("position", new THREE.BufferAttribute(way, 3));
      }
      this.schedule();
    }

    markWorst(row, text) {
      this.worstRow = row;
      this.worst.firstChild.textContent = text;
      this.schedule();
    }

    show(name, on) {
      if (name === "arm") {
        this.showArm = on;
        this.select(this.selected);
      } else this.groups[name].visible = on;
      this.schedule();
    }

    // Looks at the part from the side its points face, from a little above and aside, so that the arm does not hide it.
    // Shows the path, or the path and the arm as it stands.
    fit(withArm) {
      const { rows, count } = this.data;
      const box = new THREE.Box3().setFromBufferAttribute(new THREE.BufferAttribute(rows.position, 3));
      const joints = withArm ? m.jointsOf(this.data, this.selected) : null;
      if (joints) for (const frame of m.armFrames(this.data, joints)) box.expandByPoint(new THREE.Vector3(frame[3], frame[7], frame[11]));
      const n = [0, 1, 2].map((k) => {
        let sum = 0;
        for (let i = 0; i < count; ++i) sum += rows.normal[3 * i + k];
        return sum / Math.max(1, count);
      });
      let azimuth = Math.atan2(n[1], n[0]) + 0.95, height = 0.4;
      if (Math.hypot(...n) < 0.2) azimuth = -0.8;
      else if (Math.hypot(n[0], n[1]) < 0.3) [azimuth, height] = [-0.9, 0.9];
      const sphere = box.getBoundingSphere(new THREE.Sphere());
      this.orbit.set(sphere.center, Math.max(sphere.radius, 20) * 4, azimuth, height);
      this.schedule();
    }

    schedule() {
      if (this.waiting) return;
      this.waiting = true;
      requestAnimationFrame(() => {
        this.waiting = false;
        this.draw();
      });
    }

    draw() {
      const width = this.parent.clientWidth, height = this.parent.clientHeight;
      const ratio = window.devicePixelRatio || 1;
      if (width !== this.width || height !== this.height || ratio !== this.ratio) {
        [this.width, this.height, this.ratio] = [width, height, ratio];
        this.renderer.setPixelRatio(ratio);
        this.renderer.setSize(width, height);
        this.camera.aspect = width / height;
      }
      this.orbit.aim(this.camera);
      this.lamp.position.copy(this.camera.position);
      this.lamp.target.position.copy(this.orbit.target);
      this.pointMaterial.uniforms.height.value = height;
      this.pointMaterial.uniforms.ratio.value = ratio;
      this.renderer.render(this.scene, this.camera);
      this.put(this.marker, this.selected);
      this.put(this.worst, this.worstRow);
    }

    // Where a row stands on the screen in CSS pixels, with its depth.
    project(row) {
      const p = new THREE.Vector3(...m.place(this.data, row)).project(this.camera);
      return [((p.x + 1) / 2) * this.width, ((1 - p.y) / 2) * this.height, p.z];
    }

    put(node, row) {
      if (row === undefined || row < 0) {
        node.style.display = "none";
        return;
      }
      const [x, y, z] = this.project(row);
      node.style.display = z < 1 && x >= 0 && x <= this.width && y >= 0 && y <= this.height ? "block" : "none";
      node.style.transform = `translate(${x}px, ${y}px)`;
      node.classList.toggle("left", x > this.width - 170);
    }

    // The point nearest to a place of the screen within 14 pixels; of several, the one in front.
    pick(x, y) {
      let best = -1, bestScore = Infinity;
      const view = new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse).elements;
      const p = this.data.rows.position;
      for (let i = 0; i < this.data.count; ++i) {
        const [a, b, c] = [p[3 * i], p[3 * i + 1], p[3 * i + 2]];
        const w = view[3] * a + view[7] * b + view[11] * c + view[15];
        if (w <= 0) continue;
        const sx = ((view[0] * a + view[4] * b + view[8] * c + view[12]) / w + 1) / 2 * this.width;
        const sy = (1 - (view[1] * a + view[5] * b + view[9] * c + view[13]) / w) / 2 * this.height;
        const off = Math.hypot(sx - x, sy - y);
        if (off > 14) continue;
        const score = Math.floor(off / 4) + w / (1e3 * this.orbit.distance);
        if (score < bestScore) [best, bestScore] = [i, score];
      }
      if (best >= 0) this.actions.select(best);
    }
  };

  // Turn (drag), shift (right button or shift-drag), near and far (wheel) about a target, z up.
  m.Orbit = class {
    constructor(node, changed, clicked) {
      this.target = new THREE.Vector3();
      this.changed = changed;
      let drag = null;
      node.style.touchAction = "none";
      node.addEventListener("contextmenu", (e) => e.preventDefault());
      node.addEventListener("pointerdown", (e) => {
        drag = { x: e.clientX, y: e.clientY, moved: 0, pan: e.button === 2 || e.shiftKey };
        node.setPointerCapture(e.pointerId);
      });
      node.addEventListener("pointermove", (e) => {
        if (!drag) return;
        const dx = e.clientX - drag.x, dy = e.clientY - drag.y;
        drag.moved += Math.abs(dx) + Math.abs(dy);
        [drag.x, drag.y] = [e.clientX, e.clientY];
        if (drag.pan) this.pan(dx, dy, node.clientHeight);
        else this.turn(dx, dy);
      });
      node.addEventListener("pointerup", (e) => {
        if (drag && drag.moved < 5) {
          const box = node.getBoundingClientRect();
          clicked(e.clientX - box.left, e.clientY - box.top);
        }
        drag = null;
      });
      node.addEventListener("wheel", (e) => {
        e.preventDefault();
        this.distance *= Math.exp(0.0012 * Math.max(-200, Math.min(200, e.deltaY)));
        changed();
      }, { passive: false });
    }
    set(target, distance, azimuth, height) {
      this.target.copy(target);
      Object.assign(this, { distance, azimuth, height });
    }
    turn(dx, dy) {
      this.azimuth -= 0.006 * dx;
      this.height = Math.max(-1.5, Math.min(1.5, this.height + 0.006 * dy));
      this.changed();
    }
    pan(dx, dy, pixels) {
      const scale = (this.distance * 0.63) / pixels;
      const right = new THREE.Vector3(-Math.sin(this.azimuth), Math.cos(this.azimuth), 0);
      const up = new THREE.Vector3().crossVectors(this.direction(), right);
      this.target.addScaledVector(right, -dx * scale).addScaledVector(up, dy * scale);
      this.changed();
    }
    direction() {
      const c = Math.cos(this.height);
      return new THREE.Vector3(c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.height));
    }
    aim(camera) {
      camera.near = this.distance / 100;
      camera.far = this.distance * 100;
      camera.position.copy(this.target).addScaledVector(this.direction(), this.distance);
      camera.lookAt(this.target);
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
    }
  };
})((window.millpose = window.millpose || {}));

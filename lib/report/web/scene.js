// SPDX-License-Identifier: GPL-3.0-or-later
// The 3-D view: workpiece, path, cell and arm with three.js; drawn when something changed, not all the time.
(function (m) {
  "use strict";

  const COLOURS = { workpiece: 0xc9d0d6, link: 0x7f8b96, spindle: 0x4f6d8f, holder: 0x4f6d8f, cutter: 0xb03a2e, fixture: 0x8fa1ae, platform: 0xa9b4bc };

  const LIGHT = 0.1;       // opacity of the arm
  const LARGEST_PART = 2;  // of what is shown with its path, in the path's own size: a larger one leaves little of it to see

  const matrix = (rows) => new THREE.Matrix4().set(...rows);

  // How far the nearest part of the arm is from the line from `centre` towards who looks, as a share of the distance
  // from him: what stands near him hides most.
  function roomBeside(arm, centre, direction, distance) {
    let least = Infinity;
    for (let i = 1; i < arm.length; ++i)
      for (let t = 0; t <= 1; t += 0.125) {
        const off = arm[i - 1].clone().lerp(arm[i], t).sub(centre), along = off.dot(direction);
        if (along <= 0) continue;  // behind the part
        const left = Math.max(distance - along, 0.05 * distance);
        least = Math.min(least, off.addScaledVector(direction, -along).length() / left);
      }
    return least;
  }

  m.Scene = class {
    constructor(parent, data, actions) {
      this.parent = parent;
      this.data = data;
      this.actions = actions;
      this.schedule = m.atNextFrame(() => this.draw(), parent);
      this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
      parent.prepend(this.renderer.domElement);
      this.renderer.domElement.setAttribute("aria-label", "3-D view of the part, the path and the arm");
      this.scene = new THREE.Scene();
      this.camera = new THREE.PerspectiveCamera(m.FIELD_OF_VIEW, 1, 1, 1e6);
      this.camera.up.set(0, 0, 1);
      const sky = new THREE.HemisphereLight(0xffffff, 0x8a8f96, 0.75);
      sky.position.set(0, 0, 1);
      this.lamp = new THREE.DirectionalLight(0xffffff, 0.5);
      this.scene.add(sky, this.lamp, this.lamp.target);
      this.path = new m.ScenePath(this.scene, data);
      this.addBodies();
      this.addStock();
      this.groups.gaps = this.path.ways;
      this.groups.marks = this.path.marks;
      this.triad = new m.Triad(parent);
      this.marker = m.element("div", { class: "marker" }, m.element("span"));
      this.worst = m.element("div", { class: "marker worst" }, m.element("span"));
      this.near = new m.NearestLine(parent);
      parent.append(this.worst, this.marker);
      this.orbit = new m.Orbit(this.renderer.domElement, this.schedule, (x, y) => this.pick(x, y));
      this.fit(false);
    }

    addBodies() {
      this.moving = [];
      this.bodies = [];
      this.groups = { part: new THREE.Group(), cell: new THREE.Group(), arm: new THREE.Group() };
      this.scene.add(...Object.values(this.groups));
      for (const body of this.data.bodies) {
        const workpiece = body.class === "workpiece";
        const moves = (body.mount === "link" && body.link > 0) || body.mount === "tool";
        const material = new THREE.MeshLambertMaterial({
          color: COLOURS[body.class] || 0x999999, side: moves ? THREE.FrontSide : THREE.DoubleSide,
          // Seen through, so that the arm never hides the path, and from outside alone: no walls around who stands in it.
          transparent: moves, opacity: moves ? LIGHT : 1, depthWrite: !moves,
          polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2,
        });
        const mesh = new THREE.Mesh(m.geometryOf(body.vertices, body.faces), material);
        mesh.matrixAutoUpdate = false;
        this.bodies.push({ mesh, body, colour: material.color.getHex() });
        this.groups[workpiece ? "part" : moves || body.mount === "link" ? "arm" : "cell"].add(mesh);
        if (moves) {
          this.moving.push({ mesh, body, frame: body.mount === "tool" ? 7 : body.link });
        } else {
          const mount = { world: null, link: this.data.X_WB, workpiece: this.data.X_WP }[body.mount];
          mesh.matrix = mount ? matrix(mount).multiply(matrix(body.X_MG)) : matrix(body.X_MG);
        }
      }
      // The skeleton shows the arm also where the cell gives it no shapes.
      this.skeleton = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
      this.skeleton.frustumCulled = false;
      this.skeletonJoints = new THREE.Points(this.skeleton.geometry, new THREE.PointsMaterial({ size: 6, sizeAttenuation: false }));
      this.skeletonJoints.frustumCulled = false;
      this.groups.arm.add(this.skeleton, this.skeletonJoints);
      this.recolour();
    }

    // The material is drawn on request: it hides the path that still lies in it.
    addStock() {
      this.groups.stock = new THREE.Group();
      this.groups.stock.visible = false;
      this.scene.add(this.groups.stock);
      this.stock = this.data.removal ? new m.Stock(this.data.removal, this.data.X_WP) : null;
      if (this.stock) this.groups.stock.add(this.stock.mesh);
      this.seconds = 0;
    }
    // The material as it stands at a time of the run.
    millUntil(seconds) {
      this.seconds = seconds;
      if (!this.stock || !this.groups.stock.visible) return;
      this.stock.seek(seconds);
      this.schedule();
    }

    // The colours of the theme.
    recolour() {
      for (const part of [this.skeleton, this.skeletonJoints]) part.material.color.set(m.theme.ink);
      this.path.recolour();
      this.schedule();
    }
    colour(column, scale) {
      this.path.colour(column, scale);
      this.schedule();
    }

    select(row) {
      this.selected = row;
      this.pose(m.jointsOf(this.data, row), "", m.baseAt(this.data, row));
      this.pointAtNearest(row);
    }

    // The pair that is nearest at a row: its bodies tinted, their distance drawn.
    pointAtNearest(row) {
      const nearest = m.nearestAt(this.data, row) || null, clearance = this.data.column.clearance;
      this.nearest = nearest && nearest.ends;
      if (nearest) this.near.say(`${m.withUnit(clearance.values[row], clearance.unit, clearance.bound)}: ${nearest.names.join(" – ")}`);
      if (!nearest || this.showNearest === false) return;
      for (const { mesh, body } of this.bodies)
        if (nearest.names.some((name) => name === body.name || name.startsWith(body.name + " above "))) {
          mesh.material.color.lerp(new THREE.Color(m.theme.near), 0.55);
          if (mesh.material.transparent) mesh.material.opacity = 0.5;
        }
    }

    // The arm at joint angles (degrees; null: none), with the bodies of a pair that interferes in red.
    // `base`: where the robot's stands then.
    pose(joints, pair, base = this.data.X_WB) {
      this.nearest = null;
      if (this.data.bases)
        for (const { mesh, body } of this.bodies)
          if (body.mount === "link" && body.link === 0) mesh.matrix = matrix(base).multiply(matrix(body.X_MG));
      for (const { mesh, body, colour } of this.bodies) {
        const red = pair.split(" and ").includes(body.name);
        mesh.material.color.setHex(red ? parseInt(m.RED.slice(1), 16) : colour);
        if (mesh.material.transparent) mesh.material.opacity = red ? 0.8 : LIGHT;
      }
      this.groups.arm.visible = joints !== null && this.showArm !== false;
      if (joints) {
        const frames = m.armFrames(this.data, joints, base);
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
      } else if (name === "nearest") {
        this.showNearest = on;
        this.select(this.selected);
      } else this.groups[name].visible = on;
      if (name === "stock") this.millUntil(this.seconds);
      this.schedule();
    }

    // The box of the part as it stands.
    partBox() {
      const box = new THREE.Box3();
      for (const { mesh, body } of this.bodies) if (body.class === "workpiece") box.expandByObject(mesh);
      return box;
    }
    // Looks at the part from the side its points face, past the arm as it stands. Shows path and part, or path and arm.
    fit(withArm) {
      const { rows, count } = this.data;
      const box = new THREE.Box3().setFromBufferAttribute(new THREE.BufferAttribute(rows.position, 3));
      const row = this.selected === undefined ? 0 : this.selected, joints = this.data.arm ? m.jointsOf(this.data, row) : null;
      const arm = joints ? m.armFrames(this.data, joints, m.baseAt(this.data, row)).map((frame) => new THREE.Vector3(frame[3], frame[7], frame[11])) : [];
      const size = (of) => of.getBoundingSphere(new THREE.Sphere()).radius, part = this.partBox().union(box);
      if (size(part) < LARGEST_PART * size(box)) box.copy(part);
      if (withArm) for (const place of arm) box.expandByPoint(place);
      const n = [0, 1, 2].map((k) => {
        let sum = 0;
        for (let i = 0; i < count; ++i) sum += rows.normal[3 * i + k];
        return sum / Math.max(1, count);
      });
      this.fitTo(box, n, withArm ? [] : arm);
    }
    // `n`: the mean of the normals; `arm`: places along the arm that had better not stand in the way.
    fitTo(box, n, arm = []) {
      let azimuth = Math.atan2(n[1], n[0]), height = 0.4, turns = [0.95];
      if (Math.hypot(...n) < 0.2) [azimuth, turns] = [-0.8, [0]];
      else if (Math.hypot(n[0], n[1]) < 0.3) [azimuth, height, turns] = [-0.9, 0.9, [0]];
      else if (arm.length > 0) turns = [0.95, -0.95, 0.7, -0.7, 0.45, -0.45];
      const sphere = box.getBoundingSphere(new THREE.Sphere()), distance = Math.max(sphere.radius, 20) * m.DISTANCE;
      // Of the views that show the face that from which the arm stands farthest beside the line of sight and the face is
      // seen well; the first of equal ones.
      let best = turns[0], most = -Infinity;
      for (const turn of turns) {
        this.orbit.set(sphere.center, distance, azimuth + turn, height);
        const room = roomBeside(arm, sphere.center, this.orbit.direction(), distance) * Math.cos(turn);
        if (room > most * 1.05 || most === -Infinity) [best, most] = [turn, room];
      }
      this.orbit.set(sphere.center, distance, azimuth + best, height);
      this.schedule();
    }

    draw() {
      const [width, height] = this.paper || [this.parent.clientWidth, this.parent.clientHeight];
      const ratio = m.pixelRatio();
      if (width !== this.width || height !== this.height || ratio !== this.ratio) {
        [this.width, this.height, this.ratio] = [width, height, ratio];
        this.renderer.setPixelRatio(ratio);
        this.renderer.setSize(width, height);
        this.camera.aspect = width / height;
      }
      this.orbit.aim(this.camera);
      this.lamp.position.copy(this.camera.position);
      this.lamp.target.position.copy(this.orbit.target);
      for (const material of [this.path.material, this.path.markMaterial]) material.uniforms.height.value = height;
      for (const material of [this.path.material, this.path.markMaterial]) material.uniforms.ratio.value = ratio;
      this.renderer.render(this.scene, this.camera);
      this.triad.draw(this.camera);
      const place = (row) => (row === undefined || row < 0 ? null : m.place(this.data, row));
      this.put(this.marker, place(this.selected));
      this.put(this.worst, place(this.worstRow));
      this.near.draw(this, this.showNearest === false ? null : this.nearest);
    }

    // The view as a picture for paper, of a size in CSS pixels; null: back to the screen.
    picture(size) {
      if (this.image) this.image.remove();
      this.image = null;
      this.paper = size;
      this.draw();
      if (!size) return;
      this.image = m.element("img", { class: "paper", alt: "3-D view", src: this.renderer.domElement.toDataURL() });
      this.parent.prepend(this.image);
    }

    // Where a row stands on the screen in CSS pixels, with its depth.
    project(row) {
      return this.onScreen(m.place(this.data, row));
    }
    onScreen(place) {
      const p = new THREE.Vector3(...place).project(this.camera);
      return [((p.x + 1) / 2) * this.width, ((1 - p.y) / 2) * this.height, p.z];
    }

    // A marker at a place; `room`: px to the right of it that its words need.
    put(node, place, room = 170) {
      if (!place) {
        node.style.display = "none";
        return;
      }
      const [x, y, z] = this.onScreen(place);
      node.style.display = z < 1 && x >= 0 && x <= this.width && y >= 0 && y <= this.height ? "block" : "none";
      node.style.transform = `translate(${x}px, ${y}px)`;
      node.classList.toggle("left", x > this.width - room);
      node.classList.toggle("above", y > this.height - 80);
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
})((window.millpose = window.millpose || {}));

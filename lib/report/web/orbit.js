// SPDX-License-Identifier: GPL-3.0-or-later
// The camera of the 3-D view.
(function (m) {
  "use strict";

  // A long lens: who looks stands outside of most arms, and distances keep their proportions.
  m.FIELD_OF_VIEW = 18;  // degrees, of the height
  m.DISTANCE = 7.4;      // from a sphere that shall be seen whole, in its radii

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
        this.zoom(0.0012 * Math.max(-200, Math.min(200, e.deltaY)));
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
    zoom(by) {
      this.distance *= Math.exp(by);
      this.changed();
    }
    pan(dx, dy, pixels) {
      const scale = (this.distance * 2 * Math.tan((m.FIELD_OF_VIEW * Math.PI) / 360)) / pixels;
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

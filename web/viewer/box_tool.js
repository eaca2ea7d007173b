// A box around a part of the model. Each of its faces has a handle that can be dragged.
import * as THREE from '../three.js';

const BLUE = 0x2f6bff; // the colour of the veil

export class BoxTool {
  /** @param {import('./stage.js').Stage} stage @param {(box: THREE.Box3) => void} change called when the box has changed */
  constructor(stage, change) {
    this.stage = stage;
    this.change = change;
    this.box = new THREE.Box3();
    this.group = new THREE.Group();
    this.lines = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(1, 1, 1)), new THREE.LineBasicMaterial({ color: 0xffffff, depthTest: false, transparent: true }));
    this.group.add(this.lines);
    this.handles = [0, 1, 2, 3, 4, 5].map((face) => {
      const handle = new THREE.Mesh(new THREE.SphereGeometry(1, 16, 12), new THREE.MeshBasicMaterial({ color: BLUE, depthTest: false, transparent: true }));
      handle.userData.face = face;
      this.group.add(handle);
      return handle;
    });
    /** @type {number} */
    this.dragged = -1;
    this.begin = new THREE.Vector3();
  }

  /** @param {THREE.Box3} box */
  show(box) {
    this.box.copy(box);
    this.stage.overlay.add(this.group);
    this.place();
    this.change(this.box);
  }

  hide() {
    this.group.removeFromParent();
    this.stage.invalidate();
  }

  place() {
    const centre = this.box.getCenter(new THREE.Vector3()), size = this.box.getSize(new THREE.Vector3());
    this.lines.position.copy(centre);
    this.lines.scale.copy(size).max(new THREE.Vector3().setScalar(1e-6));
    const radius = 0.016 * Math.max(size.length(), this.stage.camera.position.distanceTo(centre) * 0.4);
    for (const handle of this.handles) {
      const axis = handle.userData.face >> 1, upper = handle.userData.face & 1;
      handle.position.copy(centre).setComponent(axis, (upper ? this.box.max : this.box.min).getComponent(axis));
      handle.scale.setScalar(radius);
    }
    this.stage.invalidate();
  }

  /** @param {PointerEvent} event @returns {boolean} true if a handle was hit */
  down(event) {
    const ray = this.stage.rayAt(event.clientX, event.clientY);
    const hit = ray?.caster.intersectObjects(this.handles)[0];
    this.dragged = hit ? hit.object.userData.face : -1;
    return this.dragged >= 0;
  }

  /** @param {PointerEvent} event */
  move(event) {
    const ray = this.stage.rayAt(event.clientX, event.clientY);
    if (this.dragged < 0 || !ray) return;
    const axis = this.dragged >> 1, end = this.dragged & 1 ? this.box.max : this.box.min;
    const along = new THREE.Vector3().setComponent(axis, 1);
    const through = this.handles[this.dragged].position;
    // The face moves to the point of its axis that is nearest to the ray.
    const { origin, direction } = ray.caster.ray;
    const slope = along.dot(direction), between = through.clone().sub(origin);
    const denominator = 1 - slope * slope;
    if (denominator < 1e-4) return;
    const t = (slope * between.dot(direction) - between.dot(along)) / denominator;
    const other = this.dragged & 1 ? this.box.min.getComponent(axis) : this.box.max.getComponent(axis);
    const value = through.getComponent(axis) + t;
    end.setComponent(axis, this.dragged & 1 ? Math.max(value, other) : Math.min(value, other));
    this.place();
    this.change(this.box);
  }

  up() {
    this.dragged = -1;
  }
}

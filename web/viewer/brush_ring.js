// Outline of the brush: a circle on the surface under the pointer. It is drawn by SVG, so that no new frame of the model is needed.
import * as THREE from '../three.js';

const POINTS = 48;
const SVG = 'http://www.w3.org/2000/svg';

export class BrushRing {
  /** @param {import('./stage.js').Stage} stage */
  constructor(stage) {
    this.stage = stage;
    this.element = document.createElementNS(SVG, 'svg');
    this.element.classList.add('brush-ring');
    this.element.setAttribute('aria-hidden', 'true');
    this.paths = [document.createElementNS(SVG, 'path'), document.createElementNS(SVG, 'path')]; // a dark line below a bright line
    this.element.append(...this.paths);
    stage.host.append(this.element);
    stage.controls.addEventListener('change', () => this.hide());
    stage.canvas.addEventListener('pointerleave', () => this.hide());
    this.hide();
  }

  /**
   * @param {THREE.Vector3} centre @param {THREE.Vector3} normal the surface's normal, of length 1 @param {number} radius in world space
   * @param {{x: number, y: number, width: number, height: number}} pane @param {boolean} erases
   */
  show(centre, normal, radius, pane, erases) {
    const across = new THREE.Vector3(1, 0, 0);
    if (Math.abs(normal.x) > 0.9) across.set(0, 1, 0);
    across.cross(normal).normalize();
    const up = normal.clone().cross(across);
    const points = Array.from({ length: POINTS }, (_, i) => {
      const angle = 2 * Math.PI * i / POINTS;
      const { x, y } = centre.clone().addScaledVector(across, radius * Math.cos(angle)).addScaledVector(up, radius * Math.sin(angle)).project(this.stage.camera);
      return `${(pane.x + (x + 1) / 2 * pane.width).toFixed(1)} ${(pane.y + (1 - y) / 2 * pane.height).toFixed(1)}`;
    });
    for (const path of this.paths) path.setAttribute('d', `M${points.join('L')}Z`);
    this.element.classList.toggle('erases', erases);
    this.element.style.display = 'block';
  }

  hide() {
    this.element.style.display = 'none';
  }
}

// The stage has a renderer, a camera and a light, and shows looks in panes, which are rectangles of the canvas. In a wipe,
// two panes cover the whole canvas and are cut at the bar. Side by side, each has its own rectangle. The stage draws only
// when something has changed.
import * as THREE from '../three.js';
import { frame, pointsOf, setAspect, boundsOf } from './camera.js';
import { StageLight } from './light.js';
import { STRIPE, sharedUniforms } from './shading.js';
import { VIEWS } from './views.js';

/**
 * @typedef {import('./look.js').Look} Look
 * @typedef {{look: Look, label: string, labelled?: boolean}} Shown  labelled: true if the label is shown even in a single pane
 * @typedef {'single'|'wipe'|'side'} Layout
 */

const SLOW_FRAME = 40; // ms; if moving frames take longer, they are drawn with fewer pixels
const AFTER_SCROLL = 200; // ms to wait after scrolling

export class Stage extends EventTarget {
  /** @param {HTMLElement} host */
  constructor(host) {
    super();
    this.host = host;
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, powerPreference: 'high-performance' });
    this.renderer.toneMapping = THREE.NoToneMapping;
    this.renderer.outputColorSpace = THREE.SRGBColorSpace;
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0, 0);
    this.software = isSoftware(this.renderer.getContext());
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    host.prepend(this.canvas);

    this.scene = new THREE.Scene();
    this.overlay = new THREE.Scene(); // the box and its handles, drawn over all panes
    this.camera = new THREE.PerspectiveCamera();
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.invalidate(true));
    this.light = new StageLight();
    this.scene.add(this.light.backdrop);
    this.shared = sharedUniforms(this.light.uniforms, this.software ? 1 : 8);

    /** @type {Shown[]} */
    this.shown = [];
    /** @type {Layout} */
    this.layout = 'single';
    this.wipe = 0.5;
    this.points = new Float32Array();
    this.turning = false;
    this.wires = false;
    this.scale = 1;
    this.frames = { count: 0, milliseconds: this.software ? 2 * SLOW_FRAME : 16, last: -Infinity };
    this.pending = false;
    this.moving = false;
    this.settle = 0;
    this.scrolled = -Infinity;
    this.later = 0;
    // A frame that the CPU draws would delay scrolling, so frames wait until scrolling has ended.
    if (this.software) document.addEventListener('scroll', () => { this.scrolled = performance.now(); }, { capture: true, passive: true });
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  /** Shows looks. @param {Shown[]} shown one look, or several for a wipe or side by side @param {Layout} layout */
  show(shown, layout = 'single') {
    for (const { look } of this.shown) if (!shown.some((other) => other.look === look)) look.root.removeFromParent();
    this.shown = shown;
    this.layout = shown.length > 1 ? layout : 'single';
    for (const { look } of shown) {
      this.scene.add(look.root);
      this.wire(look);
    }
    this.dispatchEvent(new Event('panes'));
    this.updateAspect();
    this.invalidate();
  }

  /** Frames the shown model as `item3d render` does. @param {number} [azimuth] degrees @param {number} [elevation] degrees */
  frame(azimuth, elevation) {
    if (!this.shown.length) return;
    this.points = pointsOf(this.shown[0].look.root);
    this.updateAspect();
    this.controls.target.copy(frame(this.camera, this.points, azimuth, elevation));
    const size = boundsOf(this.points).getSize(new THREE.Vector3()).length();
    this.controls.minDistance = size / 50;
    this.controls.maxDistance = size * 20;
    this.controls.update();
    this.invalidate();
  }

  /** Sets the view. @param {string} name one of VIEWS */
  setView(name) {
    this.shared.view.value = Math.max(VIEWS.indexOf(name), 0);
    this.invalidate();
  }

  /** @param {boolean} shown */
  setWires(shown) {
    this.wires = shown;
    for (const { look } of this.shown) this.wire(look);
    this.invalidate();
  }

  /** @param {Look} look */
  wire(look) {
    look.root.traverse((object) => {
      if (object.userData.wire) object.visible = this.wires;
    });
    if (!this.wires || look.root.userData.wired) return;
    look.root.userData.wired = true;
    const material = new THREE.MeshBasicMaterial({ color: 0x4da3ff, wireframe: true, transparent: true, opacity: 0.3, polygonOffset: true, polygonOffsetFactor: -1 });
    for (const entry of look.materials)
      for (const mesh of entry.meshes) {
        const wire = new THREE.Mesh(mesh.geometry, material);
        wire.userData.wire = true;
        wire.raycast = () => {};
        mesh.add(wire);
      }
  }

  /** Starts or stops the turntable, whose turn takes twelve seconds. @param {boolean} turning */
  setTurning(turning) {
    this.turning = turning;
    this.controls.autoRotate = turning;
    this.controls.autoRotateSpeed = 5;
    this.invalidate(true);
  }

  /** Moves the wipe's bar. @param {number} share its place as a fraction of the width, from the left */
  setWipe(share) {
    this.wipe = Math.min(Math.max(share, 0), 1);
    this.dispatchEvent(new Event('panes'));
    this.invalidate(true);
  }

  /** Returns the panes' rectangles in CSS pixels: x and y from the top left, and the range from left to right that is drawn. */
  panes() {
    const width = this.host.clientWidth, height = this.host.clientHeight;
    if (this.layout === 'side') {
      const columns = this.shown.length <= 3 ? (width >= height ? this.shown.length : 1) : 2;
      const rows = Math.ceil(this.shown.length / columns);
      return this.shown.map((shown, i) => ({ shown, x: (i % columns) * width / columns, y: Math.floor(i / columns) * height / rows,
        width: width / columns, height: height / rows, left: 0, right: width / columns }));
    }
    if (this.layout === 'wipe') {
      const cut = Math.round(this.wipe * width);
      return this.shown.slice(0, 2).map((shown, i) => ({ shown, x: 0, y: 0, width, height, left: i ? cut : 0, right: i ? width : cut }));
    }
    return this.shown.slice(0, 1).map((shown) => ({ shown, x: 0, y: 0, width, height, left: 0, right: width }));
  }

  resize() {
    const width = Math.max(this.host.clientWidth, 1), height = Math.max(this.host.clientHeight, 1);
    this.setPixelRatio();
    this.renderer.setSize(width, height);
    this.updateAspect();
    this.dispatchEvent(new Event('panes'));
    this.draw();
  }

  updateAspect() {
    const pane = this.panes()[0];
    if (pane && pane.height > 0) setAspect(this.camera, pane.width / pane.height);
  }

  /** Requests a new frame. @param {boolean} [moving] true if it is one of many, which may be coarser */
  invalidate(moving = false) {
    const wait = this.scrolled + AFTER_SCROLL - performance.now();
    if (wait > 0 && !moving) {
      clearTimeout(this.later);
      this.later = window.setTimeout(() => this.invalidate(), wait);
      return;
    }
    this.moving = this.moving || moving;
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.tick();
    });
  }

  tick() {
    if (this.turning) this.controls.update();
    const moving = this.moving, now = performance.now(), { frames } = this;
    this.moving = false;
    // The interval between two moving frames is the time that a frame takes, on a GPU or a CPU.
    if (moving && now - frames.last < 1000) frames.milliseconds += 0.3 * (now - frames.last - frames.milliseconds);
    frames.last = moving ? now : -Infinity;
    if (moving) {
      this.setScale(frames.milliseconds > 2 * SLOW_FRAME ? 0.35 : frames.milliseconds > SLOW_FRAME ? 0.5 : frames.milliseconds < SLOW_FRAME / 2 ? 1 : this.scale);
      clearTimeout(this.settle);
      this.settle = window.setTimeout(() => this.setScale(1) && this.invalidate(), 180);
    }
    this.draw();
    if (this.turning) this.invalidate(true);
  }

  /** @param {number} scale @returns {boolean} true if it changed */
  setScale(scale) {
    if (scale === this.scale) return false;
    this.scale = scale;
    this.setPixelRatio();
    return true;
  }

  setPixelRatio() {
    const ratio = Math.min(devicePixelRatio, 2) * this.scale;
    this.renderer.setPixelRatio(ratio);
    this.shared.maskStripe.value = STRIPE * ratio;
  }

  draw() {
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    const height = this.host.clientHeight;
    for (const pane of this.panes()) {
      if (pane.right - pane.left < 1) continue;
      for (const { look } of this.shown) look.root.visible = look === pane.shown.look;
      this.renderer.setViewport(pane.x, height - pane.y - pane.height, pane.width, pane.height);
      this.renderer.setScissor(pane.x + pane.left, height - pane.y - pane.height, pane.right - pane.left, pane.height);
      this.renderer.render(this.scene, this.camera);
      if (this.overlay.children.length) this.renderer.render(this.overlay, this.camera);
    }
    for (const { look } of this.shown) look.root.visible = true;
    ++this.frames.count;
    this.dispatchEvent(new Event('drawn'));
  }

  /**
   * Returns the ray through a point of the page, and the pane there.
   * @param {number} clientX @param {number} clientY
   */
  rayAt(clientX, clientY) {
    const area = this.host.getBoundingClientRect();
    const x = clientX - area.left, y = clientY - area.top;
    const pane = this.panes().find((p) => x >= p.x + p.left && x <= p.x + p.right && y >= p.y && y <= p.y + p.height);
    if (!pane) return null;
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(2 * (x - pane.x) / pane.width - 1, 1 - 2 * (y - pane.y) / pane.height), this.camera);
    return { caster, pane, look: pane.shown.look };
  }

  /** Returns the nearest point of the surface under a point of the page. @param {number} clientX @param {number} clientY */
  pick(clientX, clientY) {
    const ray = this.rayAt(clientX, clientY);
    if (!ray) return null;
    return ray.caster.intersectObject(ray.look.root, true)[0] ?? null;
  }

  /** Returns a PNG of the stage with a transparent background. */
  async picture() {
    this.setScale(1);
    this.draw();
    return new Promise((resolve) => this.canvas.toBlob(resolve));
  }

  dispose() {
    this.light.dispose();
    this.controls.dispose();
    this.renderer.dispose();
    this.canvas.remove();
  }
}

/** Returns true if the CPU draws, for which anisotropic filtering is expensive. @param {WebGLRenderingContext|WebGL2RenderingContext} gl */
function isSoftware(gl) {
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  return info !== null && /swiftshader|llvmpipe|softpipe|basic render/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
}

/** Returns true if the browser has WebGL 2. */
export function hasWebGL() {
  try {
    return document.createElement('canvas').getContext('webgl2') !== null;
  } catch {
    return false;
  }
}

// Tools that choose regions in the viewer: a click, a brush and a box; and the veil, which marks the selected surface.
import * as THREE from '../three.js';
import { Brush } from '../viewer/brush.js';
import { BrushRing } from '../viewer/brush_ring.js';
import { BoxTool } from '../viewer/box_tool.js';
import { boundsOf, pointsOf } from '../viewer/camera.js';
import { api } from '../core/api.js';
import { text } from '../text.js';
import { startOf } from '../core/results.js';
import { pointMenu } from './point_menu.js';

export class RegionTools {
  /**
   * @param {import('../core/store.js').Store} store @param {import('../viewer/stage.js').Stage} stage
   * @param {import('./region_measure.js').RegionMeasure} measure @param {(error: any) => void} failed
   */
  constructor(store, stage, measure, failed) {
    this.store = store;
    this.stage = stage;
    this.failed = failed;
    this.measure = measure;
    this.radius = 0.06; // relative to the model's size
    this.erases = false;
    /** @type {(selector: string, out?: boolean) => void} */
    this.add = () => {};
    /** @type {(said?: string) => void} called when a stroke or the shown model has changed, with what hinders painting */
    this.changed = () => {};
    /** @type {Brush|null} */
    this.brush = null;
    this.ring = new BrushRing(stage);
    /** @type {(values: number[]) => void} called with the smallest x, y, z, then the largest */
    this.boxChanged = () => {};
    this.box = new BoxTool(stage, () => this.boxChanged(this.boxValues()));
    /** @type {Map<number, THREE.Texture>} */
    this.veil = new Map();
    /** @type {() => void} frees the veil's textures */
    this.freeVeil = () => {};
    this.hovered = false;
    this.menu = pointMenu(stage.host, (selector, out) => this.add(selector, out));
    this.region = store.state.region;
    this.shownKey = '';
    /** @type {{x: number, y: number}|null} where the mouse button was pressed */
    this.pressed = null;
    /** @type {THREE.Vector3|null} last point of the stroke */
    this.last = null;

    const canvas = stage.canvas;
    canvas.addEventListener('pointerdown', (event) => this.down(event), { capture: true });
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.up(event));
    stage.addEventListener('panes', () => this.followLook());
    measure.addEventListener('masks', () => this.loadVeil());
    store.on(['tool'], ({ tool }) => this.choose(tool));
    store.on(['region', 'project', 'selected', 'results'], (state) => this.highlight(state));
    store.on(['highlight', 'tab'], () => this.showVeil());
  }

  get size() {
    return boundsOf(this.stage.points).getSize(new THREE.Vector3()).length() || 1;
  }

  /** Switches the highlight on when the region changes, and off when another model is shown or will be edited. @param {import('../core/types.js').State} state */
  highlight(state) {
    const key = `${state.project?.id} ${state.selected} ${startOf(state.results, state.selected)?.id}`;
    const { include, exclude } = state.region;
    if (state.region !== this.region) this.store.set({ highlight: include.length + exclude.length > 0 });
    else if (key !== this.shownKey && state.highlight) this.store.set({ highlight: false });
    [this.region, this.shownKey] = [state.region, key];
  }

  /** Returns the look of the model that the next edit will begin with, or undefined if it is not shown. */
  editedLook() {
    const { state } = this.store;
    const id = startOf(state.results, state.selected)?.id ?? '';
    if (state.layout === 'side') return this.stage.shown[state.side.indexOf(id)]?.look;
    return state.selected === id ? this.stage.shown.at(-1)?.look : undefined;
  }

  /** Returns true if the shown model has a UV map to paint in. */
  paintable() {
    return this.stage.shown[0]?.look.materials.some(({ meshes }) => meshes.some((mesh) => mesh.geometry.getAttribute('uv'))) ?? false;
  }

  /** @param {string} tool */
  choose(tool) {
    if (this.stage.host.dataset.tool === 'brush' && tool !== 'brush') this.useBrush().catch(this.failed);
    this.stage.host.dataset.tool = tool;
    this.menu.hidden = true;
    this.ring.hide();
    this.stage.controls.mouseButtons.LEFT = tool === 'brush' ? /** @type {any} */ (null) : THREE.MOUSE.ROTATE;
    if (tool === 'box' && this.stage.shown[0]) {
      const box = boundsOf(pointsOf(this.stage.shown[0].look.root));
      const size = box.getSize(new THREE.Vector3());
      box.max.y -= size.y / 2;
      this.box.show(box.expandByScalar(0.01 * size.length()));
    } else this.box.hide();
    if (tool === 'brush') this.followLook();
    this.showVeil();
  }

  /** Gives the brush the shown look. Strokes stay if they fit the look's UV map. */
  followLook() {
    const look = this.stage.shown[0]?.look;
    if (this.brush && look !== this.brush.look) {
      if (look && !this.brush.look.disposed && this.brush.look.sharesSurface(look)) this.brush.look = look;
      else this.dropBrush();
    }
    if (this.store.state.tool === 'brush' && look && this.paintable()) this.brush ??= new Brush(this.stage.renderer, look);
    this.changed();
    this.showVeil();
  }

  dropBrush() {
    this.brush?.dispose();
    this.brush = null;
  }

  /** @param {PointerEvent} event */
  down(event) {
    this.pressed = { x: event.clientX, y: event.clientY };
    this.menu.hidden = true;
    const { tool } = this.store.state;
    if (event.button !== 0) return;
    if (tool === 'box' && this.box.down(event)) this.hold(event);
    if (tool === 'brush') {
      this.stage.canvas.focus({ preventScroll: true }); // so that Ctrl+Z undoes the stroke
      const hit = this.stage.pick(event.clientX, event.clientY);
      if (!hit) {
        this.stage.controls.mouseButtons.LEFT = THREE.MOUSE.ROTATE; // beside the model, dragging turns the view
        return;
      }
      this.stage.controls.mouseButtons.LEFT = /** @type {any} */ (null);
      this.hold(event);
      this.last = hit.point;
      this.brush?.begin();
      this.paint(hit, event.altKey);
    }
  }

  /** @param {PointerEvent} event */
  hold(event) {
    this.stage.controls.enabled = false;
    this.stage.canvas.setPointerCapture(event.pointerId);
  }

  /** @param {PointerEvent} event */
  move(event) {
    if (this.store.state.tool === 'box') this.box.move(event);
    if (this.store.state.tool !== 'brush' || event.buttons && !this.last) return;
    const hit = this.stage.pick(event.clientX, event.clientY);
    if (hit && this.last) this.paint(hit, event.altKey);
    this.outline(hit, event);
  }

  /** Shows the brush's outline at a point of the surface. @param {THREE.Intersection|null} hit @param {PointerEvent} event */
  outline(hit, event) {
    const pane = this.stage.rayAt(event.clientX, event.clientY)?.pane;
    if (!hit?.face || !pane || !this.brush) return this.ring.hide();
    this.ring.show(hit.point, normalAt(hit), this.radius * this.size, pane, this.erases || event.altKey);
  }

  /** @param {PointerEvent} event */
  up(event) {
    this.last = null;
    this.stage.controls.enabled = true;
    this.box.up();
    const still = this.pressed && Math.hypot(event.clientX - this.pressed.x, event.clientY - this.pressed.y) < 4;
    if (this.store.state.tool === 'part' && still && event.button === 0) this.offer(event);
  }

  /** @param {THREE.Intersection} hit @param {boolean} alt */
  paint(hit, alt) {
    if (!this.brush || !hit.face) return;
    if (!/** @type {THREE.Mesh} */ (hit.object).geometry.getAttribute('uv')) return this.changed(text.region.partWithoutUv);
    this.brush.add({ begin: (this.last ?? hit.point).clone(), end: hit.point.clone(), normal: normalAt(hit), radius: this.radius * this.size, erases: this.erases || alt });
    this.last = hit.point;
    this.changed();
    this.showVeil();
  }

  clearBrush() {
    this.dropBrush();
    this.followLook();
  }

  /** Undoes or redoes a stroke. @param {'undo'|'redo'} what @returns {boolean} false if there is none */
  stepStroke(what) {
    if (this.store.state.tool !== 'brush' || !this.brush?.[what]()) return false;
    this.changed();
    this.showVeil();
    return true;
  }

  /** Sends the painted masks to the server, and adds the answered selectors to the region. */
  async useBrush() {
    const { brush } = this, { project } = this.store.state;
    this.brush = null;
    try {
      for (const { name, blob } of brush?.painted ? await brush.pictures() : []) {
        const { selector } = await api(`projects/${project?.id}/masks?name=painted_${Date.now().toString(36)}.png&material=${encodeURIComponent(name)}`, { body: blob });
        this.add(selector);
      }
    } catch (error) {
      this.brush ??= brush; // the strokes stay
      throw error;
    }
    if (brush) this.setVeil(brush.masks(), () => brush.dispose()); // until the region is measured
    if (this.store.state.tool === 'brush') this.store.set({ tool: 'orbit' });
  }

  boxValues() {
    const { min, max } = this.box.box;
    return [...min.toArray(), ...max.toArray()].map((v) => Number(v.toPrecision(4)));
  }

  /** Sets the box. @param {number[]} values two opposite corners, in any order */
  setBox(values) {
    const a = new THREE.Vector3(...values.slice(0, 3)), b = new THREE.Vector3(...values.slice(3));
    this.box.show(new THREE.Box3(a.clone().min(b), a.max(b)));
  }

  useBox() {
    this.add(`box=${this.boxValues().join(',')}`);
    this.store.set({ tool: 'orbit' });
  }

  /** Opens the menu of the selectors for the point that was clicked. @param {PointerEvent} event */
  offer(event) {
    const hit = this.stage.pick(event.clientX, event.clientY);
    if (hit) this.menu.offer(hit, this.size, event);
  }

  /** Loads the masks of the measured region as the veil. */
  async loadVeil() {
    const { masks } = this.measure;
    try {
      const loader = new THREE.TextureLoader();
      const veil = new Map(await Promise.all(masks.map(async ({ material, url }) => {
        const texture = await loader.loadAsync(url);
        texture.flipY = false;
        texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
        texture.needsUpdate = true;
        return /** @type {[number, THREE.Texture]} */ ([material, texture]);
      })));
      const free = () => veil.forEach((texture) => texture.dispose());
      if (masks === this.measure.masks) this.setVeil(veil, free);
      else free();
    } catch (error) {
      if (masks === this.measure.masks) this.failed(error);
    }
  }

  /** @param {Map<number, THREE.Texture>} masks @param {() => void} free */
  setVeil(masks, free) {
    this.freeVeil();
    [this.veil, this.freeVeil] = [masks, free];
    this.showVeil();
  }

  /** @param {boolean} hovered true while the pointer is over the region in the form */
  hover(hovered) {
    this.hovered = hovered;
    this.showVeil();
  }

  /** Shows the veil over the model that is to be edited: strokes while the user paints, otherwise the region while it is highlighted. */
  showVeil() {
    const { tool, tab, highlight } = this.store.state;
    const painted = tool === 'brush' && this.brush?.painted ? this.brush.masks() : null;
    const masks = painted ?? (tab === 'edit' && (highlight || this.hovered) ? this.veil : new Map());
    const edited = this.editedLook();
    for (const { look } of this.stage.shown) look.showMask(look === edited ? masks : new Map());
    this.stage.invalidate(true);
  }
}

/** Returns the surface's normal in world space. @param {THREE.Intersection} hit */
function normalAt(hit) {
  return /** @type {THREE.Face} */ (hit.face).normal.clone().transformDirection(hit.object.matrixWorld);
}

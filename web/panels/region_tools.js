// Tools that choose regions in the viewer: a click, a brush and a box; and the veil, a colour over the selected surface.
import * as THREE from '../three.js';
import { Brush } from '../viewer/brush.js';
import { BoxTool } from '../viewer/box_tool.js';
import { boundsOf, pointsOf } from '../viewer/camera.js';
import { api, asNumber } from '../core/api.js';
import { h, fill, icon } from '../core/dom.js';
import { text } from '../text.js';

export class RegionTools {
  /**
   * @param {import('../core/store.js').Store} store @param {import('../viewer/stage.js').Stage} stage
   * @param {(error: any) => void} failed
   */
  constructor(store, stage, failed) {
    this.store = store;
    this.stage = stage;
    this.failed = failed;
    this.radius = 0.06; // relative to the model's size
    this.erases = false;
    /** @type {(selector: string, out?: boolean) => void} */
    this.add = () => {};
    /** @type {(said: string) => void} */
    this.tell = () => {};
    /** @type {Brush|null} */
    this.brush = null;
    /** @type {(values: number[]) => void} called with the smallest x, y, z, then the largest */
    this.boxChanged = () => {};
    this.box = new BoxTool(stage, () => this.boxChanged(this.boxValues()));
    /** @type {Map<number, THREE.Texture>} */
    this.veil = new Map();
    this.menu = h('div.popover.point', { hidden: true, role: 'menu' });
    stage.host.append(this.menu);
    this.asked = 0;
    this.timer = 0;
    /** @type {{x: number, y: number}|null} where the mouse button was pressed */
    this.pressed = null;
    /** @type {THREE.Vector3|null} last point of the stroke */
    this.last = null;

    const canvas = stage.canvas;
    canvas.addEventListener('pointerdown', (event) => this.down(event), { capture: true });
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.up(event));
    stage.addEventListener('panes', () => this.showVeil());
    store.on(['tool'], ({ tool }) => this.choose(tool));
    store.on(['region', 'project', 'selected'], () => this.measure());
  }

  get size() {
    return boundsOf(this.stage.points).getSize(new THREE.Vector3()).length() || 1;
  }

  /** @param {string} tool */
  choose(tool) {
    this.stage.host.dataset.tool = tool;
    this.menu.hidden = true;
    this.stage.controls.mouseButtons.LEFT = tool === 'brush' ? /** @type {any} */ (null) : THREE.MOUSE.ROTATE;
    if (tool === 'box' && this.stage.shown[0]) {
      const box = boundsOf(pointsOf(this.stage.shown[0].look.root));
      const size = box.getSize(new THREE.Vector3());
      box.max.y -= size.y / 2;
      this.box.show(box.expandByScalar(0.01 * size.length()));
    } else this.box.hide();
    if (tool === 'brush' && this.stage.shown[0]) this.brush ??= new Brush(this.stage.renderer, this.stage.shown[0].look);
    this.showVeil();
  }

  /** Removes all that was painted, because another model is shown. */
  reset() {
    this.brush?.dispose();
    this.brush = null;
    this.setVeil(new Map());
  }

  /** @param {PointerEvent} event */
  down(event) {
    this.pressed = { x: event.clientX, y: event.clientY };
    this.menu.hidden = true;
    const { tool } = this.store.state;
    if (event.button !== 0) return;
    if (tool === 'box' && this.box.down(event)) this.hold(event);
    if (tool === 'brush') {
      const hit = this.stage.pick(event.clientX, event.clientY);
      if (!hit) {
        this.stage.controls.mouseButtons.LEFT = THREE.MOUSE.ROTATE; // beside the model, dragging turns the view
        return;
      }
      this.stage.controls.mouseButtons.LEFT = /** @type {any} */ (null);
      this.hold(event);
      this.last = hit.point;
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
    if (!this.last) return;
    const hit = this.stage.pick(event.clientX, event.clientY);
    if (hit) this.paint(hit, event.altKey);
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
    const normal = hit.face.normal.clone().transformDirection(hit.object.matrixWorld);
    this.brush.stroke(this.last ?? hit.point, hit.point, normal, this.radius * this.size, this.erases || alt);
    this.last = hit.point;
    this.showVeil();
  }

  clearBrush() {
    this.brush?.dispose();
    this.brush = this.stage.shown[0] ? new Brush(this.stage.renderer, this.stage.shown[0].look) : null;
    this.showVeil();
  }

  /** Sends the painted masks to the server, and adds the answered selectors to the region. */
  async useBrush() {
    const { project } = this.store.state;
    try {
      for (const { name, blob } of await this.brush?.pictures() ?? []) {
        const { selector } = await api(`projects/${project?.id}/masks?name=painted_${Date.now().toString(36)}.png&material=${encodeURIComponent(name)}`, { body: blob });
        this.add(selector);
      }
      this.clearBrush();
      this.store.set({ tool: 'orbit' });
    } catch (error) {
      this.failed(error);
    }
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

  /** Opens a menu of selectors for the point that was clicked. @param {PointerEvent} event */
  offer(event) {
    const hit = this.stage.pick(event.clientX, event.clientY);
    if (!hit) return;
    const choices = this.choicesAt(hit);
    const area = this.stage.host.getBoundingClientRect();
    fill(this.menu, h('h3', {}, text.region.atPoint), ...choices.map(({ label, selector, color }) => h('div.row', {},
      color ? h('i.swatch', { style: `--c:${color}` }) : null,
      h('span', {}, h('small', {}, label), h('code', {}, selector)),
      h('button.icon', { type: 'button', role: 'menuitem', title: text.region.add, 'aria-label': `${text.region.add}: ${selector}`, onclick: () => this.take(selector, false) }, icon('plus')),
      h('button.icon', { type: 'button', role: 'menuitem', title: text.region.subtract, 'aria-label': `${text.region.subtract}: ${selector}`, onclick: () => this.take(selector, true) }, icon('minus')))));
    this.menu.hidden = false;
    const width = this.menu.offsetWidth, height = this.menu.offsetHeight;
    this.menu.style.left = `${Math.max(8, Math.min(event.clientX - area.left + 12, area.width - width - 8))}px`;
    this.menu.style.top = `${Math.max(8, Math.min(event.clientY - area.top + 12, area.height - height - 8))}px`;
    this.menu.querySelector('button')?.focus();
  }

  /** @param {string} selector @param {boolean} out */
  take(selector, out) {
    this.menu.hidden = true;
    this.add(selector, out);
  }

  /** @param {THREE.Intersection} hit */
  choicesAt(hit) {
    const { userData } = hit.object;
    const choices = [{ label: text.region.material, selector: `material=${userData.materialName}`, color: '' }];
    /** @type {THREE.Object3D|null} */
    let node = hit.object;
    while (node && !node.userData.node) node = node.parent;
    if (node) choices.push({ label: text.region.node, selector: `node=${node.userData.node}`, color: '' });
    const color = colorAt(hit);
    if (color) choices.push({ label: text.region.colorHere, selector: `color=${color}`, color });
    const place = [...hit.point.toArray(), 0.12 * this.size].map((v) => Number(v.toPrecision(3))).join(',');
    choices.push({ label: text.region.sphere, selector: `sphere=${place}`, color: '' });
    return choices;
  }

  /** Asks the server which surface the region selects, and shows it. */
  measure() {
    clearTimeout(this.timer);
    const asked = ++this.asked;
    const { region, project } = this.store.state;
    if (!project || region.include.length + region.exclude.length === 0) {
      this.setVeil(new Map());
      return;
    }
    this.tell(text.region.measuring);
    this.timer = window.setTimeout(async () => {
      const { state } = this.store;
      const parent = state.results.find(({ id }) => id === state.selected);
      try {
        const answer = await api(`projects/${project.id}/region`, { json: {
          region: region.include, exclude: region.exclude, feather: region.feather, from: state.from, to: state.to,
          parent: asNumber(parent?.state === 'done' ? parent.id : null) } });
        const loader = new THREE.TextureLoader();
        const masks = await Promise.all(answer.masks.map(async (/** @type {{material: number, url: string}} */ { material, url }) => {
          const texture = await loader.loadAsync(url);
          texture.flipY = false;
          texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
          texture.needsUpdate = true;
          return [material, texture];
        }));
        if (asked !== this.asked) return masks.forEach(([, texture]) => texture.dispose());
        this.tell(text.region.share(answer.share));
        this.setVeil(new Map(masks));
      } catch (error) {
        if (asked !== this.asked) return;
        this.setVeil(new Map());
        this.tell(/** @type {any} */ (error).message);
      }
    }, 250);
  }

  /** @param {Map<number, THREE.Texture>} masks */
  setVeil(masks) {
    for (const texture of this.veil.values()) texture.dispose();
    this.veil = masks;
    this.showVeil();
  }

  /** Shows the veil over the model: painted masks while the brush is used, the region while the edit's tab is open. */
  showVeil() {
    const { tool, tab } = this.store.state;
    const painting = tool === 'brush' && this.brush;
    const masks = painting ? this.brush?.masks() ?? new Map() : tab === 'edit' ? this.veil : new Map();
    for (const { look } of this.stage.shown) look.showMask(masks);
    this.stage.invalidate(true);
  }
}

/** Returns the base colour of the texel that was hit, as #rrggbb. @param {THREE.Intersection} hit */
function colorAt(hit) {
  const { map, color } = /** @type {any} */ (hit.object).material;
  if (!map?.image || !hit.uv) return map ? '' : `#${color.getHexString()}`;
  const canvas = new OffscreenCanvas(1, 1), context = canvas.getContext('2d');
  const { width, height } = map.image;
  const at = (/** @type {number} */ v, /** @type {number} */ n) => Math.min(Math.floor((v - Math.floor(v)) * n), n - 1);
  try {
    context?.drawImage(map.image, at(hit.uv.x, width), at(hit.uv.y, height), 1, 1, 0, 0, 1, 1);
  } catch {
    return ''; // a blend of layers has no image to read
  }
  const pixel = context?.getImageData(0, 0, 1, 1).data ?? [0, 0, 0];
  return `#${[...pixel].slice(0, 3).map((v) => v.toString(16).padStart(2, '0')).join('')}`;
}

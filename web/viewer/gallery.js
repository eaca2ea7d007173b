// Cache of the results' looks (look.js). A look is loaded when it is shown, kept while it may be shown again, and then
// disposed of. A running edit has its own look, whose textures show the edit's previews.
import { Look } from './look.js';
import { fileUrl } from '../core/api.js';

const KEPT = 6;

/** @typedef {import('../core/types.js').Result} Result */

export class Gallery {
  /** @param {import('./stage.js').Stage} stage */
  constructor(stage) {
    this.stage = stage;
    /** @type {Map<string, Promise<Look>>} looks by result; the most recently used is last */
    this.looks = new Map();
    /** @type {Map<string, {look: Look, revision: number}>} */
    this.live = new Map();
    this.modelUrl = '';
    /** @type {Set<string>} results that layers need, and whose looks therefore stay */
    this.pinned = new Set();
  }

  /** Disposes of all looks and opens another model. @param {string} modelUrl */
  open(modelUrl) {
    this.stage.show([]);
    for (const promise of this.looks.values()) promise.then((look) => look.dispose(), () => {});
    for (const { look } of this.live.values()) look.dispose();
    this.looks.clear();
    this.live.clear();
    this.modelUrl = modelUrl;
  }

  /** Returns the look of a result. @param {string} id '': the source @returns {Promise<Look>} */
  get(id) {
    let promise = this.looks.get(id);
    if (promise) this.looks.delete(id);
    else {
      promise = Look.load(id ? fileUrl(id, 'model.glb') : this.modelUrl, this.stage.shared);
      promise.catch(() => this.looks.delete(id));
    }
    this.looks.set(id, promise);
    this.trim();
    return promise;
  }

  /** Disposes of the least recently used looks, except those that are shown or pinned. */
  async trim() {
    for (const [id, promise] of [...this.looks]) {
      if (this.looks.size <= KEPT) return;
      if (id === '') continue;
      const look = await promise.catch(() => null);
      if (!look || this.stage.shown.some((shown) => shown.look === look) || this.pinned.has(id)) continue;
      this.looks.delete(id);
      look.dispose();
    }
  }

  /** Returns the look of a running edit. Until the first preview arrives, it equals the look that the edit began with. @param {Result} result */
  async running(result) {
    const known = this.live.get(result.id);
    if (known) return known.look;
    const before = await this.get(result.parent ?? '');
    const again = this.live.get(result.id);
    if (again) return again.look;
    const look = before.copy(this.stage.shared);
    this.live.set(result.id, { look, revision: -1 });
    return look;
  }

  /**
   * Puts the textures of a preview into the look of the running edit.
   * @param {Result} result
   * @param {{revision: number, textures: {material: number, slot: 'base_color'|'orm'|'normal', url: string}[]}} preview
   */
  async preview(result, preview) {
    await this.running(result);
    const live = this.live.get(result.id);
    if (!live || preview.revision <= live.revision) return;
    live.revision = preview.revision;
    const images = await Promise.all(preview.textures.map(async ({ url }) => {
      const response = await fetch(url);
      if (!response.ok) return null; // a newer preview has replaced this one
      return createImageBitmap(await response.blob(), { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
    }));
    if (live.revision !== preview.revision || live.look.disposed) {
      for (const image of images) image?.close();
      return;
    }
    preview.textures.forEach(({ material, slot }, i) => {
      const image = images[i];
      if (image) live.look.setImage(material, slot, image);
    });
    this.stage.invalidate();
  }

  /** Removes and returns the look of an edit that has ended. Its model is loaded when it is shown. @param {string} id */
  ended(id) {
    const live = this.live.get(id);
    this.live.delete(id);
    return live?.look ?? null;
  }
}

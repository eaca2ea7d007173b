// Looks by result: loaded when they are shown, kept while they are likely to be shown again, disposed of
// after that. A running edit has a look of its own, into whose textures its previews are put.
import { Look } from './look.js';
import { fileUrl } from '../core/api.js';

const KEPT = 6;

/** @typedef {import('../core/types.js').Result} Result */

export class Gallery {
  /** @param {import('./stage.js').Stage} stage */
  constructor(stage) {
    this.stage = stage;
    /** @type {Map<string, Promise<Look>>} the most recently used last */
    this.looks = new Map();
    /** @type {Map<string, {look: Look, revision: number}>} */
    this.live = new Map();
    this.modelUrl = '';
    /** @type {Set<string>} results whose textures layers are blended from */
    this.pinned = new Set();
  }

  /** Another model: nothing of the old one stays. @param {string} modelUrl */
  open(modelUrl) {
    this.stage.show([]);
    for (const promise of this.looks.values()) promise.then((look) => look.dispose(), () => {});
    for (const { look } of this.live.values()) look.dispose();
    this.looks.clear();
    this.live.clear();
    this.modelUrl = modelUrl;
  }

  /** @param {string} id '': the source @returns {Promise<Look>} */
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

  /** Disposes of looks that were not used for the longest time and are not shown. */
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

  /** The look of an edit that runs: what it began with, until previews come. @param {Result} result */
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
   * Puts a preview's pictures into the look of the edit that runs.
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
      if (!response.ok) return null; // a newer one has replaced it
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

  /** An edit has ended: its own model is loaded when it is shown. @param {string} id */
  ended(id) {
    const live = this.live.get(id);
    this.live.delete(id);
    return live?.look ?? null;
  }
}

// Makes the stage follow the page's state: the looks and their layout, layers, the light, and the view.
import { Stage } from './stage.js';
import { Gallery } from './gallery.js';
import { LayerMix } from './layer_mix.js';
import { lightUrl, viewerTurn } from '../panels/light_panel.js';
import { lostParent, nameOf } from '../core/results.js';
import { text } from '../text.js';

/** @typedef {import('../core/types.js').State} State */
/** @typedef {import('../core/types.js').Result} Result */

export class Viewer {
  /**
   * @param {HTMLElement} host @param {import('../core/store.js').Store} store
   * @param {(error: any) => (() => void)} failed shows a message, and returns a function that removes it
   */
  constructor(host, store, failed) {
    this.store = store;
    this.failed = failed;
    this.stage = new Stage(host);
    this.stage.canvas.setAttribute('aria-label', text.viewer.label);
    this.gallery = new Gallery(this.stage);
    /** @type {LayerMix|null} */
    this.mix = null;
    /** @type {string} id of the project that is shown */
    this.project = '';
    this.turn = 0;
    this.light = '';
    this.lighting = false;
    this.closeProblem = () => {}; // removes the message of the last light that failed
    this.sharpen = 0;
    this.shownKey = '';
    /** @type {Set<string>} results whose UV map differs from the source's */
    this.apart = new Set();

    store.on(['project', 'results', 'selected', 'layout', 'side', 'layers', 'blended', 'tab'], () => this.follow());
    store.on(['view'], ({ view }) => this.stage.setView(view));
    store.on(['wires'], ({ wires }) => this.stage.setWires(wires));
    store.on(['turning'], ({ turning }) => this.stage.setTurning(turning));
    store.on(['light'], ({ light }) => {
      this.stage.light.setRotation(viewerTurn(light));
      this.stage.light.setExposure(light.exposure);
      this.stage.light.backdrop.visible = light.backdrop;
      this.stage.invalidate(true);
      this.showLight();
    });
  }

  /** Fetches the light if it has changed. While a light is being fetched, only the last change waits. */
  async showLight() {
    const wanted = lightUrl(this.store.state.light, 256);
    if (this.lighting || wanted === this.light) return;
    this.lighting = true;
    this.closeProblem();
    try {
      this.light = wanted;
      await this.stage.light.show(wanted);
      this.store.set({ lightSun: this.stage.light.sun });
      this.stage.invalidate(true);
      clearTimeout(this.sharpen);
      this.sharpen = window.setTimeout(() => this.sharpenLight(wanted), 700);
    } catch (error) {
      this.closeProblem = this.failed(error);
    } finally {
      this.lighting = false;
      if (lightUrl(this.store.state.light, 256) !== this.light) this.showLight();
    }
  }

  /** Fetches a light at twice the size if it is still shown. @param {string} shown */
  async sharpenLight(shown) {
    if (shown !== this.light) return;
    await this.stage.light.show(lightUrl(this.store.state.light, 512)).catch(() => {});
    this.stage.invalidate();
  }

  /** Shows what the state names. If a later call is made while looks load, the earlier one has no effect. */
  async follow() {
    const { state } = this.store;
    if (!state.project) return;
    if (!state.project.model) { // the project has photographs that are not reconstructed yet
      this.project = '';
      this.shownKey = '';
      this.gallery.open('');
      return;
    }
    const fresh = state.project.id !== this.project;
    if (fresh) {
      this.project = state.project.id;
      this.mix?.dispose();
      this.mix = null;
      this.apart.clear();
      this.gallery.open(state.project.model.url);
    }
    const key = `${state.selected} ${state.layout} ${state.side} ${showsBlend(state) ? JSON.stringify(state.layers) : ''} ${stateOf(state, state.selected)}`;
    if (!fresh && key === this.shownKey) return; // what is loading continues
    this.shownKey = key;
    const turn = ++this.turn;
    try {
      const { shown, layout } = await this.choose(state);
      if (turn !== this.turn) return;
      const first = !this.stage.points.length || fresh;
      this.stage.show(shown, layout);
      if (first) this.stage.frame();
      this.dropEnded();
      this.stage.host.dataset.shown = this.shownKey;
    } catch (error) {
      if (turn === this.turn) this.failed(new Error(`${text.viewer.failed}: ${/** @type {any} */ (error).message}`));
    }
  }

  /** @param {State} state */
  async choose(state) {
    const result = state.results.find(({ id }) => id === state.selected);
    if (showsBlend(state)) {
      const look = await this.mixed(state);
      /** @type {import('./stage.js').Shown[]} */
      const shown = [{ look, label: text.layers.blend(state.layers.filter(({ on }) => on).length), labelled: true }];
      if (state.layout === 'wipe') shown.unshift({ look: await this.gallery.get(''), label: text.viewer.before });
      return { shown, layout: state.layout };
    }
    if (state.layout === 'side' && state.side.length > 1) {
      const looks = await Promise.all(state.side.map((id) => this.lookOf(state, id)));
      return { shown: looks.map((look, i) => ({ look, label: labelOf(state, state.side[i]) })), layout: state.layout };
    }
    const after = { look: await this.lookOf(state, state.selected), label: text.viewer.after };
    if (state.layout === 'wipe' && result) {
      const before = { look: await this.gallery.get(result.parent ?? ''), label: lostParent(result) ? text.history.source : text.viewer.before };
      return { shown: [before, after], layout: state.layout };
    }
    return { shown: [after], layout: /** @type {'single'} */ ('single') };
  }

  /** @param {State} state @param {string} id @returns {Promise<import('./look.js').Look>} */
  async lookOf(state, id) {
    const result = state.results.find((other) => other.id === id);
    if (!result) return this.gallery.get('');
    if (result.state === 'done') return result.files.includes('model.glb') ? this.gallery.get(id) : this.gallery.get(result.parent ?? '');
    return this.gallery.running(result);
  }

  /** @param {State} state */
  async mixed(state) {
    const source = await this.gallery.get('');
    this.mix ??= new LayerMix(this.stage.renderer, source, this.stage.shared);
    const layers = [];
    this.gallery.pinned = new Set(state.layers.filter(({ on }) => on).flatMap(({ id }) => [id, state.results.find((other) => other.id === id)?.parent ?? '']));
    for (const { id, on, strength, channels } of state.layers) {
      const result = state.results.find((other) => other.id === id);
      if (!on || !result || lostParent(result)) continue;
      const [before, after] = await Promise.all([this.gallery.get(result.parent ?? ''), this.gallery.get(id)]);
      if (source.sharesSurface(after)) layers.push({ before, after, strength, channels: new Set(channels) });
      else this.apart.add(id);
    }
    this.mix.set(layers);
    return this.mix.look;
  }

  /** Disposes of looks of edits that have ended, once something else is shown. */
  dropEnded() {
    for (const id of [...this.gallery.live.keys()]) {
      const ended = stateOf(this.store.state, id) === 'done';
      const live = this.gallery.live.get(id);
      if (!ended || !live || this.stage.shown.some(({ look }) => look === live.look)) continue;
      this.gallery.ended(id)?.dispose();
    }
  }

  /** Shows a preview of a running edit. @param {any} preview */
  preview(preview) {
    const result = this.store.state.results.find(({ id }) => id === preview.id);
    if (result && result.state !== 'done') this.gallery.preview(result, preview).catch(this.failed);
  }
}

/** @param {State} state @param {string} id */
function stateOf(state, id) {
  const result = state.results.find((other) => other.id === id);
  return result?.state === 'done' ? 'done' : result ? 'open' : '';
}

/** Returns true if the viewer shows the blend of the layers, not the selected result. @param {State} state */
function showsBlend({ tab, blended, layers }) {
  return tab === 'layers' && blended && layers.some(({ on }) => on);
}

/** @param {State} state @param {string} id */
function labelOf(state, id) {
  const result = state.results.find((other) => other.id === id);
  return result ? nameOf(result) : text.history.source;
}

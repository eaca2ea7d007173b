// Panel of layers: each shows an edit's changes at any strength, in any channels. The viewer blends them at once.
import { h, fill, slider } from '../core/dom.js';
import { lostParent, nameOf } from '../core/results.js';
import { text } from '../text.js';
import { thumbnail } from './thumbnail.js';
import { CHANNELS } from '../viewer/channels.js';

/** @typedef {import('../core/types.js').Layer} Layer */

/**
 * @param {import('../core/store.js').Store} store
 * @param {{remember: () => void, save: () => Promise<void>, blends: (id: string) => boolean}} actions
 */
export function layersPanel(store, { remember, save, blends }) {
  const list = h('div.layers');
  const saved = h('button', { type: 'button', id: 'save-layers', onclick: () => save() }, text.layers.save);
  const reset = h('button', { type: 'button', onclick: () => { remember(); store.set({ layers: [] }); } }, text.layers.reset);
  const unseen = h('div.unseen', { role: 'status', hidden: true }, h('p.hint', {}, text.layers.hidden),
    h('button', { type: 'button', onclick: () => store.set({ blended: true }) }, text.layers.show));
  const footer = h('footer.sticky', {}, h('div.row', {}, reset, h('span.spring'), saved));
  /** @type {Map<string, any>} */
  let cards = new Map();

  const layerOf = (/** @type {string} */ id) => store.state.layers.find((layer) => layer.id === id)
    ?? { id, on: false, strength: 1, channels: [...CHANNELS] };
  const change = (/** @type {string} */ id, /** @type {Partial<Layer>} */ patch) => {
    const layer = { ...layerOf(id), ...patch };
    const others = store.state.layers.filter((other) => other.id !== id);
    store.set({ layers: [...others, layer], blended: true });
  };

  const makeCard = (/** @type {import('../core/types.js').Result} */ result) => {
    const { id } = result;
    const check = h('input', { type: 'checkbox', 'aria-label': `${text.layers.on}: ${nameOf(result)}`, onchange: () => { remember(); change(id, { on: check.checked }); } });
    const strength = slider({ label: text.layers.strength, minimum: -1, maximum: 2, step: 0.01, value: 1, shown: (v) => `${Math.round(100 * v)} %`,
      change: (v) => change(id, { strength: v, on: true }), settled: remember });
    const channels = CHANNELS.map((name) => h('button', { type: 'button', 'data-channel': name, onclick: () => {
      remember();
      const now = layerOf(id).channels;
      change(id, { on: true, channels: now.includes(name) ? now.filter((other) => other !== name) : [...now, name] });
    } }, text.layers.channels[/** @type {keyof typeof text.layers.channels} */ (name)]));
    const element = h('article.layer', { 'data-id': id },
      h('header', {}, h('label.check', {}, check, thumbnail(result), h('b', {}, nameOf(result)))),
      strength, h('div.channels', { role: 'group' }, ...channels), lostParent(result) ? h('p.hint', {}, text.layers.orphan) : !blends(id) && h('p.hint', {}, text.layers.other));
    element.orphan = lostParent(result);
    element.show = (/** @type {Layer} */ layer) => {
      check.checked = layer.on;
      element.classList.toggle('on', layer.on);
      strength.set(layer.strength);
      for (const button of channels) button.setAttribute('aria-pressed', String(layer.channels.includes(button.dataset.channel)));
    };
    return element;
  };

  store.on(['results', 'layers', 'blended', 'project', 'tab'], ({ results, tab, blended }) => {
    if (tab !== 'layers') return;
    const done = results.filter(({ state, kind, files }) => state === 'done' && kind === 'edit' && files.includes('layer.safetensors')).reverse().slice(0, 60);
    const kept = cards;
    cards = new Map(done.map((result) => {
      const card = kept.get(result.id);
      return [result.id, card?.orphan === lostParent(result) ? card : makeCard(result)];
    }));
    for (const [id, card] of cards) card.show(layerOf(id));
    const now = [...list.children], wanted = [...cards.values()];
    if (!now.length || now.length !== wanted.length || wanted.some((card, i) => card !== now[i]))
      fill(list, ...wanted, !wanted.length && h('p.hint', {}, text.layers.none));
    const any = store.state.layers.some(({ on }) => on);
    saved.disabled = reset.disabled = !any;
    unseen.hidden = !any || blended;
  });
  return h('div.panel', {}, h('section', {}, h('h2', {}, text.layers.title), unseen, list), footer);
}

// Measurement of the region. The server answers with the region's share of the surface and its masks, or with what is wrong
// with the region. Unknown words are found without the server.
import { api, asNumber } from '../core/api.js';
import { text } from '../text.js';
import { startOf } from '../core/results.js';
import { regionProblem } from './selector_names.js';
import { Vocabulary } from './sentence.js';

const DELAY = 400; // ms

/** @typedef {import('../core/types.js').State} State */

/** Dispatches "change" when what it says has changed, and "masks" when the masks have. */
export class RegionMeasure extends EventTarget {
  /** @param {import('../core/store.js').Store} store */
  constructor(store) {
    super();
    this.store = store;
    this.said = '';
    /** @type {string} what is wrong with the region, or '' */
    this.problem = '';
    /** @type {string} the selector that is wrong, or '' */
    this.wrong = '';
    /** @type {{word: string, known: string}|null} an unknown word, and the known word with the most similar spelling */
    this.correction = null;
    /** @type {{material: number, url: string}[]} */
    this.masks = [];
    this.key = '';
    this.timer = 0;
    /** @type {Vocabulary|null} */
    this.vocabulary = null;
    store.on(['about'], ({ about }) => { this.vocabulary = about && new Vocabulary(about.words); });
    store.on(['about', 'region', 'project', 'selected', 'results', 'from', 'to'], (state) => this.follow(state));
  }

  /** Measures the region if it has changed, or the model that is to be edited. @param {State} state */
  follow(state) {
    const { region, project, from, to } = state;
    const selectors = [...region.include, ...region.exclude];
    const sentences = selectors.includes('auto') ? [from, to] : [];
    const key = project && selectors.length ? JSON.stringify([project.id, region, startOf(state.results, state.selected)?.id, sentences, this.vocabulary !== null]) : '';
    if (key === this.key) return;
    this.key = key;
    clearTimeout(this.timer);
    if (!key) {
      this.tell('');
      this.setMasks([]);
      return;
    }
    for (const selector of selectors) {
      const word = this.unknownWord(selector);
      if (!word) continue;
      const known = this.vocabulary?.nearest(word) ?? '';
      this.tell('', { problem: text.region.unknown(word), wrong: selector, correction: known ? { word, known } : null });
      this.setMasks([]);
      return;
    }
    this.tell(text.region.measuring);
    this.timer = window.setTimeout(() => this.ask(key, state), DELAY);
  }

  /** Returns the noun of a selector by words if the prior does not know it, or ''. @param {string} selector */
  unknownWord(selector) {
    const phrase = selector.match(/^words=(.*)$/)?.[1].split(/\b(?:at|by|from|in|made|of|on|to|that|under|with)\b/i)[0].trim();
    const noun = phrase?.match(/[\p{L}\p{N}']+$/u)?.[0].toLowerCase() ?? '';
    if (!this.vocabulary || !noun || /^parts?$/.test(noun)) return '';
    return this.vocabulary.unknown(noun).length && this.vocabulary.unknown(`${noun}s`).length ? noun : '';
  }

  /** @param {string} key @param {State} state */
  async ask(key, state) {
    const { region, project, from, to } = state;
    try {
      const { share, masks } = await api(`projects/${project?.id}/region`, { json: {
        region: region.include, exclude: region.exclude, feather: region.feather, from, to, parent: asNumber(startOf(state.results, state.selected)?.id ?? null) } });
      if (key !== this.key) return;
      this.tell(text.region.share(share));
      this.setMasks(masks);
    } catch (error) {
      if (key !== this.key) return;
      const { message, status } = /** @type {any} */ (error);
      const { wrong, said } = regionProblem(message, [...region.include, ...region.exclude]);
      if (status !== 400 || !wrong) return this.tell(text.region.notMeasured(said)); // a busy server does not make the region wrong
      this.tell('', { problem: said, wrong });
      this.setMasks([]);
    }
  }

  /** @param {string} said @param {{problem?: string, wrong?: string, correction?: {word: string, known: string}|null}} [problem] */
  tell(said, { problem = '', wrong = '', correction = null } = {}) {
    Object.assign(this, { said, problem, wrong, correction });
    this.dispatchEvent(new Event('change'));
  }

  /** @param {{material: number, url: string}[]} masks */
  setMasks(masks) {
    this.masks = masks;
    this.dispatchEvent(new Event('masks'));
  }
}

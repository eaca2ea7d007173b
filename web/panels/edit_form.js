// Form of an edit: its sentences, region and settings, and the estimated time.
import { h, fill, icon, oneStop, segments } from '../core/dom.js';
import { api, asNumber } from '../core/api.js';
import { nameOf as resultName, sentenceOf, startOf } from '../core/results.js';
import { text } from '../text.js';
import { Vocabulary, sentenceField } from './sentence.js';
import { labelOf, settingsForm } from './settings_form.js';
import { regionForm } from './region_form.js';

/** @typedef {import('../core/store.js').Store} Store */
/** @typedef {import('../core/types.js').State} State */

/**
 * @param {Store} store
 * @param {{start: () => Promise<void>, remember: () => void, tools: import('./region_tools.js').RegionTools|null, measure: import('./region_measure.js').RegionMeasure}} actions
 */
export function editForm(store, { start, remember, tools, measure }) {
  /** @type {Vocabulary|null} */
  let vocabulary = null;
  const set = (/** @type {'from'|'to'} */ key) => (/** @type {string} */ value) => {
    remember();
    store.set({ [key]: value });
  };
  const options = { vocabulary: () => vocabulary, submit: () => begin() };
  const from = sentenceField({ label: text.edit.from, placeholder: text.edit.fromHint, change: set('from'), ...options });
  const to = sentenceField({ label: text.edit.to, placeholder: text.edit.toHint, change: set('to'), ...options });
  from.input.id = 'from';
  from.querySelector('label').htmlFor = 'from';
  to.input.id = 'to';
  to.querySelector('label').htmlFor = 'to';
  const looks = h('div.chips.looks', { role: 'group', 'aria-label': text.edit.looks });
  const basis = h('p.basis');

  const quality = segments(text.edit.quality, Object.entries(text.edit.presets).map(([value, label]) => ({ value, label })), 'standard', (value) => {
    remember();
    store.set({ settings: { ...withoutPreset(store.state.settings), ...presetSettings(value, store.state) }, invalid: {} });
  });
  for (const button of quality.children) button.title = text.edit.presetHints[/** @type {keyof typeof text.edit.presetHints} */ (button.dataset.value)];
  const settings = settingsForm(store, remember);
  const estimate = h('span.estimate', { 'aria-live': 'polite' });
  const region = regionForm(store, tools, measure, remember);
  const button = h('button.primary', { type: 'button', id: 'start', onclick: () => begin() }, icon('play'), text.edit.start);
  const problem = h('p.problem', { role: 'alert' });

  const begin = async () => {
    if (button.ariaDisabled === 'true') return;
    const wrong = problemOf(store.state);
    fill(problem, wrong);
    if (wrong) return;
    button.ariaDisabled = 'true'; // if the button were disabled, it would lose the focus
    try {
      const problemOfRegion = await region.settle();
      if (problemOfRegion) return fill(problem, problemOfRegion, h('small', {}, text.region.mend));
      await start();
    } catch (error) {
      const { message, hint } = /** @type {any} */ (error);
      fill(problem, message, hint && h('small', {}, hint));
    } finally {
      button.ariaDisabled = null;
    }
  };

  store.on(['about'], ({ about }) => {
    if (!about) return;
    vocabulary = new Vocabulary(about.words);
    fill(looks, ...[...about.words.materials, ...about.words.patterns].map((word) => h('button', { type: 'button', title: withLook(word, store.state.from || text.edit.fromHint, about.words), onclick: () => {
      remember();
      store.set({ to: withLook(word, store.state.from || store.state.to, about.words) });
    } }, word.base_color && h('i.swatch', { style: `--c:color(srgb-linear ${word.base_color.join(' ')})` }), nameOf(word))));
    oneStop(looks);
    from.set(store.state.from);
    to.set(store.state.to);
  });
  store.on(['from', 'to'], (state) => {
    from.set(state.from);
    to.set(state.to);
  });
  store.on(['from', 'to', 'invalid', 'project', 'region'], () => fill(problem));
  store.on(['selected', 'results', 'project'], ({ results, selected, project }) => {
    const start = startOf(results, selected);
    fill(basis, !project?.model ? text.edit.startNone : start ? text.edit.startFrom(resultName(start)) : text.edit.startSource);
    button.disabled = !project?.model;
  });
  followModel(store);
  store.on(['settings', 'about'], (state) => quality.set(presetOf(state)));

  let timer = 0;
  store.on(['from', 'to', 'settings', 'invalid', 'region', 'selected', 'project'], (state) => {
    clearTimeout(timer);
    if (!state.project || problemOf(state)) return fill(estimate);
    timer = window.setTimeout(async () => {
      try {
        const { seconds, memory_bytes } = await api(`projects/${state.project?.id}/estimate`, { json: editBody(store.state) });
        fill(estimate, text.edit.estimate(seconds, memory_bytes));
      } catch {
        fill(estimate);
      }
    }, 350);
  });

  return h('div.panel.edit', {},
    h('section', {}, h('h2', {}, text.edit.what), from, to, looks),
    region,
    h('section', {}, h('div.heading', {}, h('h2', {}, text.edit.how), quality), settings),
    h('footer.sticky', {}, problem, h('div.row', {}, h('div.facts', {}, basis, estimate), button)));
}

/** Returns the body of the request that starts an edit. @param {State} state */
export function editBody(state) {
  return {
    from: state.from.trim(), to: state.to.trim(), settings: state.settings,
    region: state.region.include, exclude: state.region.exclude, feather: state.region.include.length + state.region.exclude.length ? state.region.feather : 0,
    parent: asNumber(startOf(state.results, state.selected)?.id ?? null),
  };
}

/**
 * Makes the source sentence follow the model that an edit begins with. Each model keeps the sentence that the user gave it, otherwise it has that of its edit.
 * @param {Store} store
 */
function followModel(store) {
  /** @type {Map<string, string>} sentences that the user gave, by result; '': the source */
  const sentences = new Map();
  let project = '', shown = '', last = '';
  store.on(['selected', 'results', 'project', 'from'], (state) => {
    const id = startOf(state.results, state.selected)?.id ?? '', owner = state.project?.id ?? '';
    if (owner !== project) sentences.clear();
    const follows = owner === project && id !== shown && state.from === last; // otherwise the sentence was set together with the model
    [project, shown] = [owner, id];
    const own = sentenceOf(state.results, id);
    last = follows ? sentences.get(id) || own : state.from;
    if (last === own) sentences.delete(id);
    else sentences.set(id, last);
    if (follows) store.set({ from: last });
  });
}

/** Returns a message if an edit cannot begin, or ''. @param {State} state */
function problemOf(state) {
  if (!state.project?.model) return text.edit.noModel;
  const [wrong] = Object.keys(state.invalid);
  if (wrong) return text.edit.invalid(labelOf(wrong));
  if (!state.from.trim() || !state.to.trim()) return text.edit.missing;
  return state.from.trim() === state.to.trim() ? text.edit.same : '';
}

const PRESET_KEYS = ['iterations', 'detail'];

/** @param {string} preset @param {State} state @returns {Record<string, any>} */
function presetSettings(preset, state) {
  const usual = Number(state.about?.settings.find(({ name }) => name === 'iterations')?.default ?? 600);
  if (preset === 'draft') return { iterations: Math.max(1, Math.round(usual / 3)), detail: 'off' };
  if (preset === 'fine') return { iterations: Math.round(usual * 1.5), detail: 'always' };
  return {};
}

/** @param {Record<string, any>} settings */
function withoutPreset(settings) {
  return Object.fromEntries(Object.entries(settings).filter(([name]) => !PRESET_KEYS.includes(name)));
}

/** @param {State} state */
function presetOf(state) {
  const now = JSON.stringify(PRESET_KEYS.map((key) => state.settings[key]));
  return ['draft', 'standard', 'fine'].find((name) => JSON.stringify(PRESET_KEYS.map((key) => presetSettings(name, state)[key])) === now) ?? '';
}

/** Returns the words of a look in captions, such as "golden", "leopard print" or "covered in sprinkles". @param {import('../core/types.js').Word} word */
function nameOf({ caption, word }) {
  return caption.replace('{o}', '').replace('{c}', '').replace(/^an?\s+/, '').replace(/\s+/g, ' ').trim() || word;
}

/**
 * Returns the sentence for the same object with another look.
 * @param {import('../core/types.js').Word} word @param {string} from the sentence for the present look @param {import('../core/types.js').About['words']} words
 */
export function withLook({ caption }, from, words) {
  const said = from.toLowerCase().match(/[\p{L}\p{N}'-]+/gu) ?? [];
  const known = words.objects.flatMap(({ spellings }) => spellings);
  const thing = said.findLast((one) => known.includes(one)) ?? said.at(-1) ?? 'object';
  return caption.replace('{o}', thing).replace('{c} ', '').replace(/^an?\s+(?=(\w))/, (_, letter) => /[aeiou]/.test(letter) ? 'an ' : 'a ');
}

// Form of all settings of an edit. Each has a readable name, and its flag and help on the command line.
import { h, fill, iconButton } from '../core/dom.js';
import { text } from '../text.js';

/** Settings that other parts of the page contain. */
const ELSEWHERE = new Set(['from', 'to', 'region', 'exclude', 'feather']);

/** @param {import('../core/store.js').Store} store @param {() => void} remember */
export function settingsForm(store, remember) {
  const search = h('input', { type: 'search', placeholder: text.edit.search, 'aria-label': text.edit.search, oninput: () => filter() });
  const list = h('div.settings');
  const count = h('small.count');
  const none = h('p.hint', { hidden: true }, text.edit.none);
  const details = h('details.advanced', {}, h('summary', {}, text.edit.advanced, count), search, list, none);
  /** @type {{row: HTMLElement, input: HTMLElement, problem: HTMLElement, group: string, words: string, show: (value: any) => void, name: string, fallback: any}[]} */
  let rows = [];

  const filter = () => {
    const wanted = search.value.toLowerCase();
    let shown = 0;
    for (const { row, words } of rows) {
      row.hidden = !words.includes(wanted);
      if (!row.hidden) ++shown;
    }
    none.hidden = shown > 0;
    for (const heading of list.querySelectorAll('h3')) heading.hidden = !rows.some(({ row, group }) => group === heading.dataset.group && !row.hidden);
  };
  const change = (/** @type {string} */ name, /** @type {any} */ value, /** @type {any} */ fallback) => {
    remember();
    const settings = { ...store.state.settings }, invalid = { ...store.state.invalid };
    delete invalid[name];
    if (value === undefined || JSON.stringify(value) === JSON.stringify(fallback)) delete settings[name];
    else settings[name] = value;
    store.set({ settings, invalid });
  };
  const refuse = (/** @type {import('../core/types.js').Setting} */ { name, type, values }) => {
    const number = type === 'integer' ? text.edit.integer : type === 'number' ? text.edit.number : '';
    store.set({ invalid: { ...store.state.invalid, [name]: text.edit.allowed([number, values].filter(Boolean).join(', ')) } });
  };

  const showAll = () => {
    const { settings, invalid } = store.state;
    for (const { row, input, problem, name, show, fallback } of rows) {
      if (!(name in invalid)) show(settings[name] ?? fallback); // an invalid value stays as it was typed
      row.classList.toggle('changed', name in settings || name in invalid);
      input.ariaInvalid = String(name in invalid);
      fill(problem, invalid[name]);
    }
    const n = new Set([...Object.keys(settings), ...Object.keys(invalid)].filter((name) => !ELSEWHERE.has(name))).size;
    count.textContent = n ? text.edit.changed(n) : '';
  };
  store.on(['about'], ({ about }) => {
    rows = (about?.settings ?? []).filter(({ name, path }) => !ELSEWHERE.has(name) && !path).map((setting) => {
      const { input, show } = control(setting, (value) => change(setting.name, value, setting.default), () => refuse(setting));
      const problem = h('span.problem', { id: `${input.id}-problem`, role: 'alert' });
      input.setAttribute('aria-describedby', problem.id);
      const row = h('div.setting', {},
        h('label', { htmlFor: input.id }, labelOf(setting.name), ' ', h('code', {}, setting.flag || setting.name)),
        input,
        iconButton('undo', text.edit.reset, () => change(setting.name, undefined, setting.default), { className: 'icon reset' }),
        problem, h('p', {}, helpOf(setting)));
      return { row, input, problem, group: setting.group ?? '', name: setting.name, show, fallback: setting.default, words: `${labelOf(setting.name)} ${setting.name} ${setting.flag} ${helpOf(setting)}`.toLowerCase() };
    });
    /** @type {(HTMLElement|null)[]} */
    const shown = [];
    rows.forEach(({ row, group }, i) => shown.push(group && group !== rows[i - 1]?.group ? h('h3', { 'data-group': group }, group) : null, row));
    fill(list, ...shown);
    showAll();
  });
  store.on(['settings', 'invalid'], showAll);
  return details;
}

/** Returns the readable name of a setting. @param {string} name */
export function labelOf(name) {
  return text.edit.settings[name] ?? name[0].toUpperCase() + name.slice(1).replaceAll('_', ' ');
}

/** Returns the help with readable names of other settings, and without references to commands. @param {import('../core/types.js').Setting} setting */
function helpOf({ help }) {
  return help.replace(/; `[^`]*` explains them/, '').replace(/ \(as `[^`]*` does\)/, '').replace(/--([a-z][a-z-]*)/g, (_, flag) => `“${labelOf(flag.replaceAll('-', '_'))}”`);
}

/**
 * @param {import('../core/types.js').Setting} setting @param {(value: any) => void} change @param {() => void} refuse called instead if the value is invalid
 * @returns {{input: HTMLElement, show: (value: any) => void}}
 */
function control(setting, change, refuse) {
  const id = `setting-${setting.name}`;
  if (setting.choices) {
    const input = h('select', { id, onchange: () => change(input.value) }, ...setting.choices.map((value) => h('option', { value }, value)));
    return { input, show: (value) => { input.value = String(value ?? ''); } };
  }
  if (setting.type === 'integer' || setting.type === 'number') {
    const input = h('input', { id, type: 'number', min: setting.minimum, max: setting.maximum, title: setting.values, step: setting.type === 'integer' ? 1 : 'any',
      onchange: () => input.validity.valid ? change(input.value === '' ? undefined : Number(input.value)) : refuse() });
    return { input, show: (value) => { input.value = String(value ?? ''); } };
  }
  if (setting.type === 'repeated_texts') {
    const input = h('textarea', { id, rows: 2, spellcheck: false, title: setting.values, onchange: () => change(input.value.split('\n').map((/** @type {string} */ line) => line.trim()).filter(Boolean)) });
    return { input, show: (value) => { input.value = (value ?? []).join('\n'); } };
  }
  const several = setting.type === 'texts' || setting.type === 'numbers';
  const parse = (/** @type {string} */ value) => {
    if (!several) return value;
    const items = value.split(',').map((item) => item.trim()).filter(Boolean);
    return setting.type === 'numbers' ? items.map(Number) : items;
  };
  const isWrong = (/** @type {any} */ value) => setting.type === 'numbers' && value.some(Number.isNaN);
  const input = h('input', { id, type: 'text', spellcheck: false, title: setting.values, onchange: () => isWrong(parse(input.value)) ? refuse() : change(parse(input.value)) });
  return { input, show: (value) => { input.value = Array.isArray(value) ? value.join(', ') : String(value ?? ''); } };
}

// The history: results as a tree, edits of an edit below it. Rows are made once and changed in place;
// what is out of sight is neither laid out nor drawn, so that thousands scroll smoothly.
import { h, fill, icon, iconButton } from '../core/dom.js';
import { when, duration } from '../core/format.js';
import { text } from '../text.js';
import { thumbnail } from './thumbnail.js';
import { shareOf } from './job_bar.js';

/** @typedef {import('../core/types.js').Result} Result */

/**
 * @param {import('../core/store.js').Store} store
 * @param {{select: (id: string) => void, compare: (id: string) => void, favourite: (result: Result) => void}} actions
 */
export function historyPanel(store, { select, compare, favourite }) {
  const filter = h('input', { type: 'search', placeholder: text.history.filter, 'aria-label': text.history.filter, oninput: () => build() });
  const only = h('button.icon', { type: 'button', title: text.history.favourites, 'aria-label': text.history.favourites, 'aria-pressed': 'false',
    onclick: () => { only.setAttribute('aria-pressed', String(only.getAttribute('aria-pressed') !== 'true')); build(); } }, icon('star'));
  const list = h('div.tree', { role: 'tree', 'aria-label': text.history.title, onkeydown: (/** @type {KeyboardEvent} */ event) => move(event) });
  const count = h('small');
  /** @type {Map<string, {row: HTMLElement, result: Result|null}>} */
  let rows = new Map();
  let structure = '', owner = '';

  const build = () => {
    const { results } = store.state;
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const fits = (/** @type {Result} */ result) =>
      (only.getAttribute('aria-pressed') !== 'true' || result.favourite) &&
      words.every((/** @type {string} */ word) => `${result.to} ${result.name ?? ''} ${result.note}`.toLowerCase().includes(word));
    const shown = results.filter(fits);
    const ordered = asTree(shown);
    const kept = rows;
    rows = new Map();
    const source = kept.get('') ?? { row: sourceRow(), result: null };
    rows.set('', source);
    for (const { result, depth } of ordered) {
      const entry = kept.get(result.id) ?? { row: makeRow(result.id), result: null };
      entry.row.style.setProperty('--depth', String(Math.min(depth, 8)));
      entry.row.setAttribute('aria-level', String(depth + 2));
      rows.set(result.id, entry);
      update(entry, result);
    }
    fill(list, ...[...rows.values()].map(({ row }) => row), !ordered.length && h('p.hint', {}, results.length ? text.history.noMatch : text.history.none));
    count.textContent = results.length ? text.history.count(results.length) : '';
    mark();
  };

  /** With a key held, it is put beside what is shown. */
  const choose = (/** @type {string} */ id) => (/** @type {MouseEvent} */ event) => event.ctrlKey || event.metaKey || event.shiftKey ? compare(id) : select(id);
  const sourceRow = () => h('div.node.source', { role: 'treeitem', 'aria-level': 1, tabIndex: -1, 'data-id': '', onclick: choose('') },
    h('span.thumb', {}, icon('box')), h('span.words', {}, h('b', {}, text.history.source), h('small', {}, store.state.project?.name ?? '')));

  const makeRow = (/** @type {string} */ id) => h('div.node', { role: 'treeitem', tabIndex: -1, 'data-id': id, onclick: choose(id) });

  const update = (/** @type {{row: HTMLElement, result: Result|null}} */ entry, /** @type {Result} */ result) => {
    if (entry.result === result) return;
    const old = entry.result;
    entry.result = result;
    const busy = result.state === 'running' || result.state === 'paused';
    const part = busy ? shareOf(result.progress) : 0;
    entry.row.style.setProperty('--part', String(part));
    if (old && busy && old.state === result.state && old.thumbnail === result.thumbnail && old.favourite === result.favourite) return;
    entry.row.dataset.state = result.state;
    const said = result.state === 'done' ? `${when(result.created)} · ${duration(result.seconds)}` : text.states[result.state];
    fill(entry.row,
      thumbnail(result),
      h('span.words', {}, h('b', {}, result.name || result.to || text.kinds[result.kind]), h('small', {}, h('i.dot'), said)),
      result.state === 'done' && iconButton('side', text.history.compare, () => compare(result.id), { className: 'icon compare', tabIndex: -1, onclick: stop(() => compare(result.id)) }),
      iconButton('star', text.history.favourite, () => {}, { className: `icon favourite${result.favourite ? ' on' : ''}`, tabIndex: -1, 'aria-pressed': String(result.favourite), onclick: stop(() => favourite(result)) }));
  };

  const mark = () => {
    const { selected, side, layout } = store.state;
    for (const [id, { row }] of rows) {
      row.setAttribute('aria-selected', String(id === selected));
      row.tabIndex = id === selected ? 0 : -1;
      row.classList.toggle('beside', layout === 'side' && side.includes(id));
    }
    if (!rows.has(selected)) rows.get('')?.row.setAttribute('tabindex', '0');
  };

  const move = (/** @type {KeyboardEvent} */ event) => {
    const items = [...rows.keys()];
    const at = items.indexOf(/** @type {HTMLElement} */ (document.activeElement)?.dataset?.id ?? store.state.selected);
    /** @type {Record<string, number>} */
    const steps = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: items.length - 1, PageDown: at + 10, PageUp: at - 10 };
    if (event.key in steps) {
      const id = items[Math.min(Math.max(steps[event.key], 0), items.length - 1)];
      rows.get(id)?.row.focus();
      select(id);
    } else if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) compare(items[at]);
    else if (event.key === 'Enter' || event.key === ' ') select(items[at]);
    else return;
    event.preventDefault();
  };

  store.on(['results', 'project'], ({ results, project }) => {
    const now = `${project?.id} ${results.map(({ id }) => id).join()}`;
    if (now !== structure || filter.value || only.getAttribute('aria-pressed') === 'true') {
      if (owner !== project?.id) rows = new Map();
      [structure, owner] = [now, project?.id ?? ''];
      build();
    } else for (const result of results) {
      const entry = rows.get(result.id);
      if (entry) update(entry, result);
    }
  });
  store.on(['selected', 'side', 'layout'], mark);
  return h('nav.history', { 'aria-label': text.history.title }, h('div.heading', {}, h('h2', {}, text.history.title), count, only), filter, list);
}

/** @param {() => void} action */
function stop(action) {
  return (/** @type {Event} */ event) => {
    event.stopPropagation();
    action();
  };
}

/** Results in the order of their tree, the newest first among siblings. @param {Result[]} results */
export function asTree(results) {
  const ids = new Set(results.map(({ id }) => id));
  /** @type {Map<string, Result[]>} */
  const children = new Map();
  for (const result of results) {
    const parent = result.parent && ids.has(result.parent) ? result.parent : '';
    if (!children.has(parent)) children.set(parent, []);
    children.get(parent)?.unshift(result);
  }
  /** @type {{result: Result, depth: number}[]} */
  const ordered = [];
  const stack = (children.get('') ?? []).map((result) => ({ result, depth: 0 })).reverse();
  while (stack.length) {
    const next = /** @type {{result: Result, depth: number}} */ (stack.pop());
    ordered.push(next);
    for (const child of [...(children.get(next.result.id) ?? [])].reverse()) stack.push({ result: child, depth: next.depth + 1 });
  }
  return ordered;
}

// The history: a tree of results, in which edits of a result are below it. The page contains only the
// visible rows and some rows above and below them, so that thousands of rows scroll as fast as a dozen.
import { h, fill, icon, iconButton } from '../core/dom.js';
import { when, duration } from '../core/format.js';
import { nameOf } from '../core/results.js';
import { text } from '../text.js';
import { showsSource, sourceThumbnail, thumbnail } from './thumbnail.js';
import { shareOf } from './job_bar.js';

/** @typedef {import('../core/types.js').Result} Result */
/** @typedef {{result: Result, depth: number, place: number, siblings: number}} Branch */
/** @typedef {{row: HTMLElement, result: Result|null}} Entry */

const ROW = 52; // height in pixels, as in layout.css
const BEYOND = 12; // number of extra rows above and below the visible ones

/**
 * @param {import('../core/store.js').Store} store
 * @param {{select: (id: string) => void, compare: (id: string) => void, favourite: (result: Result) => void}} actions
 */
export function historyPanel(store, { select, compare, favourite }) {
  const filter = h('input', { type: 'search', placeholder: text.history.filter, 'aria-label': text.history.filter, oninput: () => build() });
  const only = h('button.icon', { type: 'button', title: text.history.favourites, 'aria-label': text.history.favourites, 'aria-pressed': 'false',
    onclick: () => { only.setAttribute('aria-pressed', String(only.getAttribute('aria-pressed') !== 'true')); build(); } }, icon('star'));
  const inner = h('div.rows');
  const hint = h('p.hint');
  const list = h('div.tree', { role: 'tree', 'aria-label': text.history.title, onscroll: () => attach(), onkeydown: (/** @type {KeyboardEvent} */ event) => move(event) }, inner, hint);
  const count = h('small');
  /** @type {Map<string, Entry>} all rows that were created, whether the page contains them or not */
  let rows = new Map();
  /** @type {string[]} ids of the listed results, from the top; '': the source */
  let order = [''];
  /** @type {Map<string, Branch & {at: number}>} */
  let branches = new Map();
  let structure = '', owner = '';

  const build = () => {
    const { results, project } = store.state;
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const fits = (/** @type {Result} */ result) =>
      (only.getAttribute('aria-pressed') !== 'true' || result.favourite) &&
      words.every((/** @type {string} */ word) => `${result.to} ${nameOf(result)} ${result.note}`.toLowerCase().includes(word));
    const ordered = asTree(results.filter(fits));
    const above = project?.model ? [''] : []; // photographs that are not reconstructed have no source
    order = [...above, ...ordered.map(({ result }) => result.id)];
    branches = new Map(ordered.map((branch, i) => [branch.result.id, { ...branch, at: i + above.length }]));
    for (const id of rows.keys()) if (id && !branches.has(id)) rows.delete(id);
    inner.style.height = `${order.length * ROW}px`;
    fill(hint, ordered.length ? '' : results.length ? text.history.noMatch : text.history.none);
    count.textContent = !results.length ? '' : ordered.length < results.length ? text.history.countOf(ordered.length, results.length) : text.history.count(results.length);
    attach();
  };

  /** Puts the visible rows into the page. The source's row, the selected row (which the Tab key reaches) and the row with the focus stay too. */
  const attach = () => {
    const first = Math.floor(list.scrollTop / ROW) - BEYOND, last = Math.ceil((list.scrollTop + list.clientHeight) / ROW) + BEYOND;
    const focused = /** @type {HTMLElement|null|undefined} */ (document.activeElement?.closest('.node'));
    const kept = new Set(['', store.state.selected, focused?.dataset.id]);
    const wanted = order.filter((id, at) => (at >= first && at < last) || kept.has(id)).map(rowOf);
    const staying = new Set(wanted);
    for (const row of [...inner.children]) if (!staying.has(row)) row.remove();
    wanted.forEach((row, i) => { if (inner.children[i] !== row) inner.insertBefore(row, inner.children[i] ?? null); });
    mark();
  };

  const rowOf = (/** @type {string} */ id) => {
    const entry = rows.get(id) ?? { row: id ? makeRow(id) : source, result: null };
    rows.set(id, entry);
    const branch = branches.get(id);
    if (!branch) return entry.row;
    entry.row.style.setProperty('--depth', String(Math.min(branch.depth, 6)));
    entry.row.style.top = `${branch.at * ROW}px`;
    entry.row.ariaLevel = String(branch.depth + 2);
    entry.row.ariaPosInSet = String(branch.place);
    entry.row.ariaSetSize = String(branch.siblings);
    update(entry, branch.result);
    return entry.row;
  };

  /** Selects a result, or compares it if Ctrl, Cmd or Shift is held. */
  const choose = (/** @type {string} */ id) => (/** @type {MouseEvent} */ event) => event.ctrlKey || event.metaKey || event.shiftKey ? compare(id) : select(id);
  const sourceName = h('small'), sourceImage = h('div.image');
  const source = h('div.node.source', { role: 'treeitem', 'aria-level': 1, tabIndex: -1, 'data-id': '', onclick: choose('') },
    sourceImage, h('span.words', {}, h('b', {}, text.history.source), sourceName));

  const makeRow = (/** @type {string} */ id) => h('div.node', { role: 'treeitem', tabIndex: -1, 'data-id': id, onclick: choose(id) });

  const update = (/** @type {Entry} */ entry, /** @type {Result} */ result) => {
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
      h('span.words', {}, h('b', {}, nameOf(result)), h('small', {}, h('i.dot'), said)),
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
    if (!rows.has(selected)) rows.get(order[0])?.row.setAttribute('tabindex', '0');
  };

  const move = (/** @type {KeyboardEvent} */ event) => {
    const at = order.indexOf(/** @type {HTMLElement} */ (document.activeElement)?.dataset?.id ?? store.state.selected);
    /** @type {Record<string, number>} */
    const steps = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: order.length - 1, PageDown: at + 10, PageUp: at - 10 };
    if (event.key in steps) {
      const next = Math.min(Math.max(steps[event.key], 0), order.length - 1);
      list.scrollTop = Math.min(Math.max(list.scrollTop, (next + 1) * ROW - list.clientHeight), next * ROW);
      attach();
      rows.get(order[next])?.row.focus();
      select(order[next]);
    } else if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) compare(order[at]);
    else if (event.key === 'Enter' || event.key === ' ') select(order[at]);
    else return;
    event.preventDefault();
  };

  let pictured = '';
  store.on(['results', 'project', 'portrait'], ({ results, project, portrait }) => {
    sourceName.textContent = project?.name ?? '';
    const edit = results.find(showsSource), image = portrait?.project === project?.id ? portrait?.image : undefined;
    const now = `${project?.id} ${edit ? edit.id : image}`;
    if (pictured !== now) fill(sourceImage, sourceThumbnail(edit, image));
    pictured = now;
  });
  store.on(['results', 'project'], ({ results, project }) => {
    const now = `${project?.id} ${Boolean(project?.model)} ${results.map(({ id, parent }) => `${id}<${parent}`).join()}`;
    if (now !== structure || filter.value || only.getAttribute('aria-pressed') === 'true') {
      if (owner !== project?.id) rows = new Map();
      [structure, owner] = [now, project?.id ?? ''];
      build();
    } else for (const result of results) {
      const entry = rows.get(result.id), branch = branches.get(result.id);
      if (branch) branch.result = result;
      if (entry) update(entry, result);
    }
  });
  store.on(['selected'], attach);
  store.on(['side', 'layout'], mark);
  new ResizeObserver(attach).observe(list);
  return h('nav.history', { 'aria-label': text.history.title }, h('div.heading', {}, h('h2', {}, text.history.title), count, only), filter, list);
}

/** @param {() => void} action */
function stop(action) {
  return (/** @type {Event} */ event) => {
    event.stopPropagation();
    action();
  };
}

/** Returns the results in the order of their tree. Among siblings, the newest comes first. @param {Result[]} results */
export function asTree(results) {
  const ids = new Set(results.map(({ id }) => id));
  /** @type {Map<string, Result[]>} */
  const children = new Map();
  for (const result of results) {
    const parent = result.parent && ids.has(result.parent) ? result.parent : '';
    if (!children.has(parent)) children.set(parent, []);
    children.get(parent)?.unshift(result);
  }
  const below = (/** @type {string} */ id, /** @type {number} */ depth) =>
    (children.get(id) ?? []).map((result, i, all) => ({ result, depth, place: i + 1, siblings: all.length })).reverse();
  /** @type {Branch[]} */
  const ordered = [];
  const stack = below('', 0);
  while (stack.length) {
    const next = /** @type {Branch} */ (stack.pop());
    ordered.push(next);
    stack.push(...below(next.result.id, next.depth + 1));
  }
  return ordered;
}

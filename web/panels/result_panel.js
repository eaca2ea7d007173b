// Panel of one result: its note, scores, files to download, and the command that reproduces it.
import { h, fill, icon, iconButton, copyText } from '../core/dom.js';
import { fileUrl } from '../core/api.js';
import { duration, when } from '../core/format.js';
import { lostParent, nameOf } from '../core/results.js';
import { text } from '../text.js';

/** @typedef {import('../core/types.js').Result} Result */

/**
 * @param {import('../core/store.js').Store} store
 * @param {{patch: (result: Result, patch: object) => Promise<void>, remove: (result: Result) => void, reuse: (result: Result) => void, variants: () => Promise<void>, toast: (said: string) => void}} actions
 */
export function resultPanel(store, { patch, remove, reuse, variants, toast }) {
  const element = h('div.panel');
  let shown = '';
  store.on(['selected', 'results', 'tab'], ({ results, selected }) => {
    const result = results.find(({ id }) => id === selected);
    const key = result ? `${result.id} ${result.state} ${result.favourite} ${result.files.length} ${result.name} ${lostParent(result)}` : '';
    if (key === shown && element.children.length) return;
    shown = key;
    if (!result) return fill(element, h('section', {}, h('p.hint', {}, text.result.none)));
    fill(element,
      h('section.title', {},
        h('div.heading', {}, h('h1', { contenteditable: 'plaintext-only', spellcheck: false, 'aria-label': text.tabs.result,
          onblur: (/** @type {any} */ event) => event.target.textContent.trim() !== nameOf(result) && patch(result, { name: event.target.textContent.trim() }),
          onkeydown: (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') { event.preventDefault(); /** @type {any} */ (event.target).blur(); } event.stopPropagation(); } }, nameOf(result)),
          iconButton('star', text.history.favourite, () => patch(result, { favourite: !result.favourite }), { className: `icon favourite${result.favourite ? ' on' : ''}`, 'aria-pressed': String(result.favourite) })),
        h('p.meta', {}, [result.from && `${result.from} → ${result.to}`, text.states[result.state], result.seconds > 0 && duration(result.seconds), when(result.created)].filter(Boolean).join(' · ')),
        result.message && h('p.problem', {}, result.message),
        h('label.field', {}, h('span', {}, text.result.note), h('textarea', { rows: 2, placeholder: text.result.notePlaceholder, value: result.note, onchange: (/** @type {any} */ event) => patch(result, { note: event.target.value }) }))),
      result.files.length > 0 && h('section', {}, h('h2', {}, text.result.export), exportsOf(result),
        results.filter(({ favourite, state }) => favourite && state === 'done').length > 1 && h('button', { type: 'button', title: text.result.variantsHint, onclick: variants }, icon('down'), text.result.variants)),
      scoresOf(result),
      h('section', {}, h('div.heading', {}, h('h2', {}, text.result.command), iconButton('copy', text.result.copyCommand, async () => { await copyText(result.command); toast(text.copied); }, { id: 'copy-command' })),
        h('pre.command', { tabIndex: 0 }, result.command)),
      h('footer.sticky', {}, result.kind === 'edit' && lostParent(result) && h('p.hint', {}, text.result.orphan), h('div.row', {}, h('button', { type: 'button', onclick: () => remove(result) }, icon('trash'), text.result.remove), h('span.spring'),
        result.kind === 'edit' && !lostParent(result) && h('button', { type: 'button', onclick: () => reuse(result) }, icon('retry'), text.result.reuse))));
  });
  return element;
}

/** @param {Result} result */
function exportsOf(result) {
  const link = (/** @type {string} */ name, /** @type {string} */ label) =>
    h('li', {}, h('a', { href: fileUrl(result.id, name), download: name.split('/').at(-1), ...(name.endsWith('.html') && { target: '_blank', download: null }) }, icon(name.endsWith('.html') ? 'open' : 'down'), h('span', {}, label), h('small', {}, name.split('/').at(-1))));
  const known = Object.keys(text.result.files).filter((name) => result.files.includes(name));
  const textures = result.files.filter((name) => name.startsWith('textures/'));
  return h('ul.exports', {}, ...known.map((name) => link(name, text.result.files[name])),
    ...textures.map((name) => link(name, text.result.textures)));
}

/** @param {Result} result */
function scoresOf(result) {
  const scores = result.scores ?? {};
  /** @type {[string, string][]} */
  const rows = [];
  if (typeof scores.detail_kept === 'number') rows.push([text.result.detail, `${Math.round(100 * scores.detail_kept)} %`]);
  for (const [key, label] of /** @type {[string, string][]} */ ([['roughness', text.result.roughness], ['metallic', text.result.metallic]]))
    if (scores.before?.[key] !== undefined) rows.push([label, `${scores.before[key].toFixed(2)} → ${scores.after[key].toFixed(2)}`]);
  const color = (/** @type {number[]} */ linear) => h('i.swatch', { style: `--c: color(srgb-linear ${linear.join(' ')})` });
  const colors = scores.before?.base_color_linear;
  if (!rows.length && !colors) return null;
  return h('section', {}, h('h2', {}, text.result.scores), h('dl.scores', {},
    ...(colors ? [h('dt', {}, text.result.baseColor), h('dd', {}, color(colors), '→', color(scores.after.base_color_linear))] : []),
    ...rows.flatMap(([label, value]) => [h('dt', {}, label), h('dd', {}, value)])));
}

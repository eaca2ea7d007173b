// Form of a region: its selectors, which the user makes by clicking, painting, boxes, words and colours. They are shown by name,
// and below as `item3d edit --region` takes them.
import { h, fill, icon, iconButton, slider, copyText } from '../core/dom.js';
import { text } from '../text.js';
import { startOf } from '../core/results.js';
import { selectorColor, selectorName } from './selector_names.js';

const NAMED = { black: '#1c1c1c', white: '#f7f7f5', grey: '#8b8b8b', red: '#c4201c', green: '#2f8a35', yellow: '#e9c522', blue: '#2458b8', brown: '#6d4424', orange: '#e8761b', pink: '#ec8fb0', purple: '#7a3a93' };

/** Returns a region's options of the command line. @param {import('../core/types.js').Region} region */
export function regionCommand({ include, exclude, feather }) {
  const quoted = (/** @type {string} */ value) => /^[\w=.,@~#+:/-]+$/.test(value) ? value : `'${value.replaceAll("'", "'\\''")}'`;
  return [...include.map((one) => `--region ${quoted(one)}`), ...exclude.map((one) => `--exclude ${quoted(one)}`),
    ...(feather > 0 ? [`--feather ${feather}`] : [])].join(' ');
}

/**
 * @param {import('../core/store.js').Store} store
 * @param {import('./region_tools.js').RegionTools|null} tools null without WebGL
 * @param {import('./region_measure.js').RegionMeasure} measure
 * @param {() => void} remember
 */
export function regionForm(store, tools, measure, remember) {
  const change = (/** @type {Partial<import('../core/types.js').Region>} */ patch) => {
    remember();
    const region = { ...store.state.region, ...patch };
    if (region.include.length + region.exclude.length === 0) region.feather = 0; // nothing has an edge
    store.set({ region });
  };
  const add = (/** @type {string} */ selector, out = false) => {
    const { include, exclude } = store.state.region;
    const without = (/** @type {string[]} */ list) => list.filter((one) => one !== selector);
    change(out ? { include: without(include), exclude: [...without(exclude), selector] } : { include: [...without(include), selector], exclude: without(exclude) });
  };
  if (tools) tools.add = add;

  const share = h('span.share', { 'aria-live': 'polite' });
  const eye = tools && iconButton('eye', text.region.highlight, () => store.set({ highlight: !store.state.highlight }), { id: 'highlight' });
  const facts = h('div.row.measured', {}, share, h('span.spring'), eye);
  const chips = h('div.chips.selectors');
  const command = h('code');
  const copy = h('div.command', {}, command, iconButton('copy', text.region.copy, () => copyText(command.textContent ?? '')));
  const feather = slider({ label: text.region.feather, minimum: 0, maximum: 10, step: 0.1, value: 0, shown: (v) => `${v.toFixed(1)} %`, change: () => {}, settled: (v) => change({ feather: v }) });

  const words = h('input', { type: 'text', placeholder: text.region.phrase, 'aria-label': text.region.words, list: 'parts',
    oninput: () => show(), onkeydown: (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') { event.preventDefault(); addWords(); } } });
  const parts = h('datalist', { id: 'parts' });
  const addWords = () => {
    const phrase = words.value.trim();
    if (!phrase) return;
    add(phrase === text.region.auto || phrase === 'auto' ? 'auto' : `words=${phrase}`);
    words.value = '';
    show();
  };
  const wordsRow = h('div.row.extra', { hidden: true }, words, h('button', { type: 'button', onclick: addWords }, text.region.use));
  const colors = h('div.swatches.extra', { hidden: true, role: 'group', 'aria-label': text.region.named },
    ...Object.entries(NAMED).map(([name, value]) => h('button', { type: 'button', title: name, 'aria-label': name, style: `--c:${value}`, onclick: () => add(`named=${name}`) })));
  const hint = h('p.hint');
  const pending = h('p.hint.pending', { 'aria-live': 'polite' });
  const brushRow = tools ? h('div.extra', { hidden: true },
    slider({ label: text.region.radius, minimum: 1, maximum: 30, step: 0.5, value: 6, shown: (v) => `${v} %`, change: (v) => { tools.radius = v / 100; } }),
    h('div.row', {}, h('label.check', {}, h('input', { type: 'checkbox', onchange: (/** @type {any} */ event) => { tools.erases = event.target.checked; } }), text.region.erase),
      h('span.spring'), h('button', { type: 'button', onclick: () => tools.clearBrush() }, text.region.clear),
      h('button', { type: 'button', id: 'use-brush', onclick: () => tools.useBrush().catch(tools.failed) }, text.region.use))) : null;
  const boxRow = tools ? h('div.extra', { hidden: true }, boxFields(tools),
    h('div.row', {}, h('span.spring'), h('button', { type: 'button', id: 'use-box', onclick: () => tools.useBox() }, text.region.use))) : null;

  /** @type {Record<string, HTMLElement|null>} */
  const rows = { words: wordsRow, color: colors, brush: brushRow, box: boxRow };
  let open = '';
  const choose = (/** @type {string} */ name) => {
    open = open === name ? '' : name;
    const pointing = ['part', 'brush', 'box'].includes(open);
    if (pointing && startOf(store.state.results, store.state.selected)?.id !== (store.state.selected || undefined)) store.set({ selected: startOf(store.state.results, store.state.selected)?.id ?? '', layout: 'single', side: [] }); // shows the model that will be edited
    store.set({ tool: /** @type {any} */ (pointing ? open : 'orbit') });
    if (open === 'words') requestAnimationFrame(() => words.focus());
    show();
  };
  const said = { part: text.region.partHint, brush: text.region.brushHint, box: text.region.boxHint };
  const show = (trouble = open === 'brush' && tools && !tools.paintable() ? text.region.noUv : '') => {
    for (const [name, row] of Object.entries(rows)) if (row) row.hidden = name !== open || (name === 'brush' && trouble === text.region.noUv);
    fill(hint, trouble || said[/** @type {keyof typeof said} */ (open)]);
    hint.className = trouble ? 'hint trouble' : 'hint';
    hint.hidden = !hint.textContent;
    if (eye) eye.hidden = !tools?.paintable() || !tools.editedLook(); // there is nothing that can be marked
    for (const button of bar.children) button.setAttribute('aria-pressed', String(button.dataset.value === open));
    const unused = (open === 'brush' && tools?.brush?.painted) || open === 'box' || (open === 'words' && words.value.trim()) ? open : '';
    chips.classList.toggle('open', Boolean(unused)); // then “Everywhere” is not said
    fill(pending, text.region.pending[/** @type {keyof typeof text.region.pending} */ (unused)]);
  };
  const bar = h('div.segments.tools', { role: 'group', 'aria-label': text.edit.where },
    ...(/** @type {const} */ (['part', 'brush', 'box', 'words', 'color'])).filter((name) => tools || name === 'words' || name === 'color').map((name) =>
      h('button', { type: 'button', 'data-value': name, title: text.region[name], 'aria-label': text.region[name], onclick: () => choose(name) }, icon(name))));
  show();
  if (tools) tools.changed = show;

  store.on(['tool'], ({ tool }) => {
    if (tool === 'orbit' && ['part', 'brush', 'box'].includes(open)) {
      open = '';
      show();
    }
  });
  store.on(['about'], ({ about }) => fill(parts, h('option', { value: text.region.auto }), ...(about?.words.parts ?? []).map((part) => h('option', { value: `the ${part}` }))));
  /** Shows what was measured, or what is wrong. */
  const tell = () => {
    const { correction, problem, wrong } = measure;
    share.className = problem ? 'problem' : 'share';
    const correct = () => {
      const corrected = (/** @type {string[]} */ list) => list.map((one) => one === wrong ? one.replace(new RegExp(`${correction?.word}(?=\\s|$)`, 'i'), correction?.known ?? '') : one);
      change({ include: corrected(store.state.region.include), exclude: corrected(store.state.region.exclude) });
    };
    fill(share, problem || measure.said, problem && !correction ? h('small', {}, text.region.tryOther) : null,
      correction && h('button.link', { type: 'button', onclick: correct }, text.edit.nearest(correction.known)));
    for (const one of chips.children) one.classList.toggle('wrong', Boolean(wrong) && one.dataset.selector === wrong);
    facts.hidden = !share.textContent;
  };
  store.on(['region'], ({ region }) => {
    const chip = (/** @type {string} */ selector, /** @type {boolean} */ out) => h('span.selector', { className: `selector${out ? ' out' : ''}`, 'data-selector': selector },
      h('button', { type: 'button', title: text.region.invert, 'aria-label': `${text.region.invert}: ${selectorName(selector)}`, onclick: () => add(selector, !out) }, icon(out ? 'minus' : 'plus')),
      h('span', { title: selector }, selectorName(selector)), selectorColor(selector) ? h('i.swatch', { style: `--c:${selectorColor(selector)}` }) : null,
      h('button', { type: 'button', title: text.region.remove, 'aria-label': `${text.region.remove}: ${selectorName(selector)}`, onclick: () => change({ include: region.include.filter((one) => one !== selector), exclude: region.exclude.filter((one) => one !== selector) }) }, icon('close')));
    const any = region.include.length + region.exclude.length > 0;
    fill(chips, ...(any ? [...region.include.map((one) => chip(one, false)), ...region.exclude.map((one) => chip(one, true))] : [h('span.everything', {}, text.region.everything)]));
    command.textContent = regionCommand(region);
    copy.hidden = !any;
    feather.hidden = !any;
    feather.set(region.feather);
    tell();
  });
  store.on(['highlight'], ({ highlight }) => eye?.setAttribute('aria-pressed', String(highlight)));

  measure.addEventListener('change', tell);

  for (const one of tools ? [chips, facts] : []) {
    one.addEventListener('pointerenter', () => tools?.hover(true));
    one.addEventListener('pointerleave', () => tools?.hover(false));
  }
  const element = h('section.where', {}, h('div.heading', {}, h('h2', {}, text.edit.where), bar), hint, wordsRow, colors, brushRow, boxRow, parts, chips, pending, facts, feather, copy);
  /** Adds what was drawn or typed and not yet used. Returns what is wrong with the region, or ''. */
  element.settle = async () => {
    if (open === 'words') addWords();
    else if (open === 'brush') await tools?.useBrush();
    else if (open === 'box') tools?.useBox();
    await Promise.resolve(); // the measure has followed the region
    return measure.problem;
  };
  return element;
}

/** Creates number fields for the box, which also work with the keyboard. @param {import('./region_tools.js').RegionTools} tools */
function boxFields(tools) {
  const fields = [text.region.boxFrom, text.region.boxTo].flatMap((end) => ['X', 'Y', 'Z'].map((axis) =>
    h('input', { type: 'number', step: 'any', 'aria-label': `${end} ${axis}`, onchange: () => change() })));
  const change = () => {
    const values = fields.map((field) => field.valueAsNumber);
    if (values.every(Number.isFinite)) tools.setBox(values);
  };
  tools.boxChanged = (values) => values.forEach((value, i) => {
    if (fields[i] !== document.activeElement) fields[i].value = String(value);
    fields[i].step = String(Number((tools.size / 100).toPrecision(1)));
  });
  return h('div.box-fields', {}, h('span'), ...['X', 'Y', 'Z'].map((axis) => h('small', { 'aria-hidden': 'true' }, axis)),
    h('span', {}, text.region.boxFrom), ...fields.slice(0, 3), h('span', {}, text.region.boxTo), ...fields.slice(3));
}

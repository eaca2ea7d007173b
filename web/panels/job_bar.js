// Bar below the viewer that shows the running job: its stage, progress, time left and the curve of the edit direction's
// length, with buttons to pause, cancel and resume.
import { h, fill, icon } from '../core/dom.js';
import { duration } from '../core/format.js';
import { lostParent } from '../core/results.js';
import { text } from '../text.js';

/** @typedef {import('../core/types.js').Result} Result */

/**
 * @param {import('../core/store.js').Store} store
 * @param {{act: (result: Result, what: 'pause'|'resume'|'cancel') => void, retry: (result: Result) => void}} actions
 */
export function jobBar(store, { act, retry }) {
  const title = h('b');
  const facts = h('span.facts');
  const bar = h('progress', { max: 1, value: 0, 'aria-label': text.states.running });
  const curve = h('div.curve', { title: text.job.directionHint });
  const buttons = h('div.buttons');
  const message = h('p.message');
  const element = h('div.job', { role: 'status', hidden: true }, h('div.line', {}, title, facts, curve, buttons), bar, message);
  let shown = '';

  const button = (/** @type {string} */ symbol, /** @type {string} */ label, /** @type {() => void} */ action) =>
    h('button', { type: 'button', title: label, onclick: action }, icon(symbol), h('span', {}, label));

  store.on(['selected', 'results'], ({ results, selected }) => {
    const result = results.find(({ id }) => id === selected);
    element.hidden = !result || result.state === 'done';
    if (!result || result.state === 'done') return;
    element.dataset.state = result.state;
    const { progress } = result;
    const part = shareOf(progress);
    const stage = text.job.stages[progress?.stage ?? ''] ?? progress?.stage ?? '';
    const doing = result.kind !== 'relight' ? stage : result.to ? text.job.finding : text.job.rendering;
    const orphan = lostParent(result) && result.state !== 'running';
    fill(title, result.state === 'running' ? doing || capital(text.states.running) : result.state === 'failed' ? text.job.failed[result.kind] : capital(text.states[result.state]));
    const ahead = results.filter((other) => other.state === 'running' || (other.state === 'waiting' && other.created < result.created)).length;
    fill(facts, result.state === 'waiting' ? (result.message ? text.job.blocked : text.job.waiting(ahead)) : progress && result.state !== 'failed'
      ? [progress.total ? text.job.iterations(progress.done, progress.total) : '', result.state === 'running' && leftOf(progress) || duration(progress.seconds)].filter(Boolean).join(' · ') : '');
    bar.hidden = !['running', 'paused', 'waiting'].includes(result.state);
    if (result.state === 'running' && !part) bar.removeAttribute('value');
    else bar.value = part;
    fill(message, result.message, orphan && h('span', {}, text.result.orphanJob));
    const key = `${result.id} ${result.state} ${orphan}`;
    if (key === shown) return;
    if (!shown.startsWith(`${result.id} `)) fill(curve);
    shown = key;
    const { state } = result;
    fill(buttons,
      state === 'running' && button('pause', text.job.pause, () => act(result, 'pause')),
      (state === 'paused' || state === 'cancelled') && !orphan && button('play', text.job.resume, () => act(result, 'resume')),
      ['running', 'paused', 'waiting'].includes(state) && button('stop', text.job.cancel, () => act(result, 'cancel')),
      state === 'failed' && !orphan && button('retry', text.job.retry, () => retry(result)));
  });

  element.direction = (/** @type {number[]} */ values) => fill(curve, ...(values.length > 1 ? [h('small', {}, text.job.direction), sparkline(values, 120, 24)] : []));
  return element;
}

/** Returns the finished share of the job or, if it is unknown, of the job's stage. @param {Result['progress']} progress */
export function shareOf(progress) {
  return progress?.share ?? (progress?.total ? progress.done / progress.total : 0);
}

/** @param {NonNullable<Result['progress']>} progress */
function leftOf({ job_seconds_left: job, seconds_left: stage }) {
  return job ? text.job.left(job) : stage > 0 ? text.job.stageLeft(stage) : '';
}

/** @param {string} word */
function capital(word) {
  return word[0].toUpperCase() + word.slice(1);
}

const SVG = 'http://www.w3.org/2000/svg';
/** Draws a curve and a smoothed version over it. @param {number[]} values @param {number} width @param {number} height */
export function sparkline(values, width, height) {
  const svg = document.createElementNS(SVG, 'svg');
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.setAttribute('width', String(width));
  svg.setAttribute('height', String(height));
  svg.setAttribute('aria-hidden', 'true');
  const most = Math.max(...values, 1e-9);
  const line = (/** @type {number[]} */ list) => list.map((value, i) =>
    `${i ? 'L' : 'M'}${(i * (width - 2) / (list.length - 1) + 1).toFixed(1)} ${(height - 2 - value / most * (height - 4)).toFixed(1)}`).join('');
  let mean = values[0];
  const smooth = values.map((value) => (mean += 0.12 * (value - mean)));
  for (const [name, list] of /** @type {[string, number[]][]} */ ([['raw', values], ['smooth', smooth]])) {
    const path = document.createElementNS(SVG, 'path');
    path.setAttribute('class', name);
    path.setAttribute('d', line(list));
    svg.append(path);
  }
  return svg;
}

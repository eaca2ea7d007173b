// Panel of lights: presets and the user's own lights, their rotation, exposure and tint, a sun that is dragged over the
// sky, the hour, and words. The server changes lights as `item3d light` does, so the viewer shows them as renders do.
import { h, fill, icon, slider } from '../core/dom.js';
import { signed } from '../core/format.js';
import { text } from '../text.js';

/** @typedef {import('../core/types.js').Light} Light */

/** @type {Light} */
export const DEFAULT_LIGHT = { name: 'studio', rotation: 0, exposure: 0, backdrop: false, sun: null, hour: null, lit: '', tint: '' };

/** Returns the rotation that the viewer applies. If a sun was placed, it must stay, so the server turns the other light. @param {Light} light */
export function viewerTurn(light) {
  return light.sun || light.lit ? 0 : light.rotation;
}

/** Returns the light's address. Exposure is left to the viewer. @param {Light} light @param {number} width */
export function lightUrl(light, width) {
  const query = new URLSearchParams({ width: String(width) });
  if (viewerTurn(light) !== light.rotation) query.set('rotate', String(light.rotation));
  if (light.hour !== null) query.set('hour', light.hour.toFixed(2));
  if (light.sun && !light.lit) query.set('sun', light.sun.map((v) => v.toFixed(1)).join(','));
  if (light.lit) query.set('lit', light.lit);
  if (light.tint) query.set('tint', light.tint);
  const name = light.hour !== null ? 'sky' : light.name;
  return `api/lights/${encodeURIComponent(name)}.hdr?${query}`;
}

/** Returns the part of a relight's request that describes a light. @param {Light} light */
export function lightBody(light) {
  const body = { rotate: light.rotation, exposure: light.exposure };
  return { ...body, ...(light.hour !== null ? { hour: light.hour } : { light: light.name }), ...(light.lit ? { lit: light.lit } : light.sun && { sun: light.sun }), ...(light.tint && { tint: light.tint }) };
}

/**
 * @param {import('../core/store.js').Store} store
 * @param {{own: (file: File) => Promise<void>, render: () => Promise<void>, find: (words: string) => Promise<void>}} actions
 */
export function lightPanel(store, { own, render, find }) {
  const change = (/** @type {Partial<Light>} */ patch) => store.set({ light: { ...store.state.light, ...patch } });
  const presets = h('div.chips.lights', { role: 'group', 'aria-label': text.light.presets });
  const wrongFile = h('p.problem', { role: 'alert' }), problem = h('p.problem', { role: 'alert' });
  const guarded = (/** @type {() => Promise<void>} */ action, place = problem) => async () => {
    fill(place);
    try {
      await action();
    } catch (error) {
      const { message, hint } = /** @type {any} */ (error);
      fill(place, message, hint && h('small', {}, hint));
    }
  };
  const file = h('input', { type: 'file', accept: '.hdr,.exr,.png,.jpg,.jpeg', hidden: true, onchange: () => {
    const chosen = file.files[0];
    if (chosen) guarded(() => own(chosen), wrongFile)();
    file.value = ''; // so that the same file can be chosen again
  } });
  const rotation = slider({ label: text.light.rotation, minimum: -180, maximum: 180, step: 1, value: 0, shown: (v) => `${v}°`, change: (v) => change({ rotation: v }) });
  const exposure = slider({ label: text.light.exposure, minimum: -4, maximum: 4, step: 0.05, value: 0, shown: (v) => `${signed(v, 2)} EV`, change: (v) => change({ exposure: v }) });
  const backdrop = h('input', { type: 'checkbox', onchange: () => change({ backdrop: backdrop.checked }) });
  const dome = sunDome((sun) => change({ sun, lit: '' }));
  const hour = slider({ label: text.light.hour, minimum: 0, maximum: 24, step: 0.25, value: 12, shown: (v) => `${String(Math.floor(v)).padStart(2, '0')}:${String(Math.round(v % 1 * 60)).padStart(2, '0')}`, change: (v) => change({ hour: v, sun: null, lit: '' }) });
  const sky = h('input', { type: 'checkbox', onchange: () => change({ hour: sky.checked ? 12 : null, sun: null, lit: '' }) });
  const lit = h('input', { type: 'text', placeholder: text.light.wordsHint, 'aria-label': text.light.words, onchange: () => change({ lit: lit.value.trim(), sun: null }) });
  const tint = h('input', { type: 'color', value: '#ffffff', 'aria-label': text.light.tint, onchange: () => change({ tint: tint.value === '#ffffff' ? '' : tint.value }) });
  const words = h('input', { type: 'text', placeholder: text.light.findHint, 'aria-label': text.light.find,
    onkeydown: (/** @type {KeyboardEvent} */ event) => { if (event.key === 'Enter') guarded(() => find(words.value.trim()))(); } });
  const download = h('a.button', { download: 'light.hdr', title: text.light.download, 'aria-label': text.light.download }, icon('down'), '.hdr');

  let owner = '';
  store.on(['project'], ({ project }) => {
    if (owner !== project?.id) fill(problem);
    owner = project?.id ?? '';
  });
  /** @type {Set<string>} names of the lights that the user opened */
  const opened = new Set();
  store.on(['about', 'light'], ({ about, light }) => {
    const presetNames = about?.lights ?? ['studio'], ofResult = light.name.startsWith('result-');
    if (about && !ofResult && !presetNames.includes(light.name)) opened.add(light.name);
    const names = [...presetNames, ...opened, ...(ofResult && light.hour === null ? [light.name] : [])];
    fill(wrongFile);
    fill(presets, ...names.map((name) => h('button', { type: 'button', 'aria-pressed': String(light.hour === null && light.name === name), onclick: () => change({ name, hour: null, sun: null, lit: '' }) }, shortName(name))),
      h('button', { type: 'button', onclick: () => file.click() }, text.light.own), file);
    rotation.set(light.rotation);
    exposure.set(light.exposure);
    backdrop.checked = light.backdrop;
    sky.checked = light.hour !== null;
    hour.hidden = light.hour === null;
    if (light.hour !== null) hour.set(light.hour);
    lit.value = light.lit;
    tint.value = light.tint || '#ffffff';
    const address = lightUrl({ ...light, rotation: 0 }, 1024);
    download.href = address + (address.includes('?') ? `&rotate=${light.rotation}&exposure=${light.exposure}` : '');
  });
  store.on(['light', 'lightSun'], ({ light, lightSun }) => dome.show(light, lightSun && [(lightSun[0] + viewerTurn(light) + 360) % 360, lightSun[1]]));

  return h('div.panel', {},
    h('section', {}, h('div.heading', {}, h('h2', {}, text.light.presets), h('button.link', { type: 'button', onclick: () => change({ ...DEFAULT_LIGHT, name: store.state.light.name }) }, text.light.reset)),
      presets, wrongFile, rotation, exposure, h('label.check', {}, backdrop, text.light.backdrop)),
    h('section', {}, h('h2', {}, text.light.sun), dome, h('label.check', {}, sky, text.light.sky), hour,
      h('label.field', {}, h('span', {}, text.light.words), lit), h('label.field.inline', {}, h('span', {}, text.light.tint), tint)),
    h('section', {}, h('h2', {}, text.light.find), h('div.row', {}, words, h('button', { type: 'button', onclick: guarded(() => find(words.value.trim())) }, text.light.findStart)), problem),
    h('footer.sticky', {}, h('div.row', {}, download, h('span.spring'), h('button.primary', { type: 'button', onclick: guarded(render) }, text.light.render))));
}

/** Azimuth and elevation in degrees where the user finds the sun in a light without one. @type {[number, number]} */
const START = [145, 45];

/** @param {string} name */
function shortName(name) {
  return name.startsWith('result-') ? text.light.ofResult : text.light.ownName(name);
}

/**
 * Draws the sky from above, with a sun that can be dragged. Until it is dragged, it shows the sun of the light. The middle is overhead,
 * the rim is the horizon, and north is at the top.
 * @param {(sun: [number, number]) => void} change azimuth and elevation in degrees
 */
function sunDome(change) {
  const sun = h('button.sun', { type: 'button', 'aria-label': text.light.sun, title: text.light.sunHint });
  const said = h('span'), source = h('small');
  const sky = h('div.sky', { title: text.light.sunHint }, ...text.light.compass.map((name, i) => h(`span.compass.c${i}`, {}, name)), h('i.ring'), sun);
  const element = h('div.dome', {}, sky, h('output', {}, said, source));
  let [azimuth, elevation] = START, held = false;
  const place = () => {
    const radius = (90 - elevation) / 90 * 50, angle = azimuth * Math.PI / 180;
    sun.style.left = `${50 + radius * Math.sin(angle)}%`;
    sun.style.top = `${50 - radius * Math.cos(angle)}%`;
  };
  const drag = (/** @type {PointerEvent} */ event) => {
    const area = sky.getBoundingClientRect();
    const x = (event.clientX - area.left) / area.width * 2 - 1, y = (event.clientY - area.top) / area.height * 2 - 1;
    azimuth = Math.round((Math.atan2(x, -y) * 180 / Math.PI + 360) % 360);
    elevation = Math.round(Math.max(0, 90 * (1 - Math.min(Math.hypot(x, y), 1))));
    place();
    change([azimuth, elevation]);
  };
  sky.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => {
    held = true;
    sky.setPointerCapture(event.pointerId);
    drag(event);
  });
  sky.addEventListener('pointermove', (/** @type {PointerEvent} */ event) => held && drag(event));
  sky.addEventListener('pointerup', () => { held = false; });
  sun.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
    /** @type {Record<string, [number, number]>} */
    const steps = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] };
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    azimuth = (azimuth + step[0] + 360) % 360;
    elevation = Math.min(Math.max(elevation + step[1], 0), 90);
    place();
    change([azimuth, elevation]);
  });
  element.show = (/** @type {Light} */ light, /** @type {[number, number]|null|undefined} */ found) => {
    const at = light.sun ?? found;
    [azimuth, elevation] = at ?? START;
    element.classList.toggle('none', !at);
    said.textContent = at ? text.light.sunAt(Math.round(azimuth) % 360, Math.round(elevation)) : found === undefined ? text.light.ofLight : text.light.noSun; // undefined: the viewer has no light yet, or no WebGL
    source.textContent = !at || light.sun || light.lit || light.hour !== null ? '' : text.light.ofLight;
    place();
  };
  return element;
}

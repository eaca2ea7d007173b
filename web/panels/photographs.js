// A model from photographs: choose a folder, look at what is in it, start.
import { h, fill, icon } from '../core/dom.js';
import { api } from '../core/api.js';
import { size } from '../core/format.js';
import { text } from '../text.js';

const MOST_BYTES = 1e9;
const PICTURE = /\.(jpe?g|png|webp|tiff?|exr)$/i;

/** @param {(answer: any) => void} started */
export function photographsDialog(started) {
  /** @type {File[]} */
  let files = [];
  const input = h('input', { type: 'file', multiple: true, hidden: true, webkitdirectory: true, onchange: () => choose([...input.files]) });
  const facts = h('p.hint');
  const cameras = h('figure.cameras', { hidden: true });
  const grid = h('div.photos');
  const problem = h('p.problem', { role: 'alert' });
  const start = h('button.primary', { type: 'button', disabled: true, onclick: () => send() }, text.photos.start);

  const choose = async (/** @type {File[]} */ chosen) => {
    for (const image of grid.querySelectorAll('img')) URL.revokeObjectURL(image.src);
    files = chosen.filter(({ name }) => PICTURE.test(name) || /^transforms.*\.json$/.test(name));
    const inMasks = (/** @type {File} */ file) => /(^|\/)masks?\//.test(file.webkitRelativePath);
    const pictures = files.filter((file) => PICTURE.test(file.name) && !inMasks(file));
    const masks = files.filter(inMasks);
    const bytes = files.reduce((sum, file) => sum + file.size, 0);
    fill(problem, !pictures.length ? text.photos.none : bytes > MOST_BYTES ? text.photos.tooMany : '');
    fill(facts, [text.photos.count(pictures.length, bytes), masks.length ? text.photos.masks(masks.length) : ''].filter(Boolean).join(' · '));
    fill(grid, ...pictures.slice(0, 48).map((file) => h('img', { src: URL.createObjectURL(file), alt: file.name, title: file.name, loading: 'lazy', decoding: 'async' })));
    start.disabled = !pictures.length || bytes > MOST_BYTES;
    const transforms = files.find(({ name }) => /^transforms.*\.json$/.test(name));
    const places = transforms ? camerasOf(await transforms.text()) : [];
    cameras.hidden = false;
    fill(cameras, places.length ? cameraMap(places) : null, h('figcaption', {}, places.length ? text.photos.cameras(places.length) : text.photos.noCameras));
  };
  const send = async () => {
    start.disabled = true;
    const form = new FormData();
    for (const file of files) form.append(PICTURE.test(file.name) ? 'photographs' : 'cameras', file, (file.webkitRelativePath || file.name).split('/').slice(-2).join('/'));
    try {
      started(await api('photographs', { body: form }));
      dialog.close();
    } catch (error) {
      fill(problem, /** @type {any} */ (error).message);
      start.disabled = false;
    }
  };
  const dialog = h('dialog.photographs', { 'aria-label': text.photos.title, onclose: () => dialog.remove() },
    h('header', {}, h('h1', {}, text.photos.title), h('button.icon', { type: 'button', 'aria-label': text.close, title: text.close, onclick: () => dialog.close() }, icon('close'))),
    h('p', {}, text.photos.lede), input, h('div.row', {}, h('button', { type: 'button', onclick: () => input.click() }, icon('folder'), text.photos.choose), facts),
    problem, cameras, grid, h('footer', {}, h('span.spring'), h('button', { type: 'button', onclick: () => dialog.close() }, text.cancel), start));
  document.body.append(dialog);
  dialog.showModal();
}

/** Places and view directions of NeRF-synthetic cameras. @param {string} content */
function camerasOf(content) {
  try {
    const { frames } = JSON.parse(content);
    return frames.map((/** @type {any} */ { transform_matrix: m }) => ({ x: m[0][3], z: m[2][3], toX: -m[0][2], toZ: -m[2][2] }));
  } catch {
    return [];
  }
}

const SVG = 'http://www.w3.org/2000/svg';
/** @param {{x: number, z: number, toX: number, toZ: number}[]} places */
function cameraMap(places) {
  const reach = 1.15 * Math.max(...places.map(({ x, z }) => Math.hypot(x, z)), 1e-6);
  const svg = document.createElementNS(SVG, 'svg');
  svg.setAttribute('viewBox', `${-reach} ${-reach} ${2 * reach} ${2 * reach}`);
  const path = document.createElementNS(SVG, 'path');
  const s = reach * 0.07;
  path.setAttribute('d', places.map(({ x, z, toX, toZ }) => {
    const length = Math.hypot(toX, toZ) || 1, dx = toX / length * s, dz = toZ / length * s;
    return `M${x} ${z}L${x + dx - dz / 2} ${z + dz + dx / 2}L${x + dx + dz / 2} ${z + dz - dx / 2}Z`;
  }).join(''));
  svg.append(path);
  return svg;
}

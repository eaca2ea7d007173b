// Dialog for a model from photographs: the user chooses a folder, sees what it contains, and starts.
import { h, fill, icon } from '../core/dom.js';
import { api } from '../core/api.js';
import { text } from '../text.js';

const MOST_BYTES = 1e9;
const PICTURE = /\.(jpe?g|png|webp|tiff?)$/i;
const CAMERAS = /(^|\/)(transforms[^/]*\.json|poses_bounds\.npy|(cameras|images|points3D|frames|rigs)\.(bin|txt))$/;

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
    const transforms = chosen.filter(({ name }) => /^transforms.*\.json$/.test(name));
    const frames = (await Promise.all(transforms.map((file) => file.text()))).map(framesOf);
    const named = new Set(frames.flat().flatMap(({ file_path, mask_path }) => [file_path, mask_path]).filter(Boolean).map(plain));
    const isPicture = (/** @type {File} */ file) => PICTURE.test(file.name);
    const inMasks = (/** @type {File} */ file) => isPicture(file) && /(^|\/)masks?\//.test(placeOf(file));
    // If the dataset names its images, other files such as depths and ground truth are left out.
    const isSeen = (/** @type {File} */ file) => !named.size || named.has(plain(placeOf(file))) || named.has(plain(placeOf(file)).replace(PICTURE, ''));
    const pictures = chosen.filter((file) => isPicture(file) && !inMasks(file) && isSeen(file));
    const masks = chosen.filter(inMasks);
    files = [...pictures, ...masks, ...chosen.filter((file) => CAMERAS.test(placeOf(file)))];
    const bytes = files.reduce((sum, file) => sum + file.size, 0);
    fill(problem, !pictures.length ? text.photos.none : bytes > MOST_BYTES ? text.photos.tooMany : '');
    fill(facts, [text.photos.count(pictures.length, bytes), masks.length ? text.photos.masks(masks.length) : ''].filter(Boolean).join(' · '));
    fill(grid, ...pictures.slice(0, 48).map((file) => h('img', { src: URL.createObjectURL(file), alt: file.name, title: placeOf(file), loading: 'lazy', decoding: 'async' })));
    start.disabled = !pictures.length || bytes > MOST_BYTES;
    const places = placesOf(frames.flat());
    cameras.hidden = false;
    fill(cameras, places.length ? cameraMap(places) : null, h('figcaption', {}, places.length ? text.photos.cameras(places.length)
      : files.some((file) => !isPicture(file)) ? text.photos.otherCameras : text.photos.noCameras));
  };
  const send = async () => {
    start.disabled = true;
    const folder = files[0].webkitRelativePath.split('/')[0]; // the project has its name
    const form = new FormData();
    for (const file of files) form.append('photographs', file, placeOf(file));
    try {
      started(await api(`photographs?name=${encodeURIComponent(folder)}`, { body: form }));
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

/** Returns a file's path inside of the chosen folder. @param {File} file */
function placeOf(file) {
  return file.webkitRelativePath.split('/').slice(1).join('/') || file.name;
}

/** Returns a path with slashes and without a leading "./". @param {string} path */
function plain(path) {
  return path.replaceAll('\\', '/').replace(/^(\.?\/)+/, '');
}

/** Returns the frames of a transforms.json. @param {string} content @returns {any[]} */
function framesOf(content) {
  try {
    const { frames } = JSON.parse(content);
    return Array.isArray(frames) ? frames : [];
  } catch {
    return [];
  }
}

/** Returns places and view directions of cameras, as seen along the axis that is closest to the cameras' up direction. @param {any[]} frames */
function placesOf(frames) {
  const poses = frames.map(({ transform_matrix: m }) => m).filter((m) => Array.isArray(m) && m.length > 2);
  const up = [0, 1, 2].map((axis) => Math.abs(poses.reduce((sum, m) => sum + m[axis][1], 0)));
  const [across, along] = [0, 1, 2].filter((axis) => axis !== up.indexOf(Math.max(...up)));
  return poses.map((m) => ({ x: m[across][3], z: m[along][3], toX: -m[across][2], toZ: -m[along][2] }));
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

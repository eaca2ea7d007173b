// Menu of the selectors for a point of the model that was clicked. A click on a row adds its selector to the region.
import * as THREE from '../three.js';
import { h, fill, icon } from '../core/dom.js';
import { text } from '../text.js';
import { selectorColor, selectorName } from './selector_names.js';

/**
 * @param {HTMLElement} host
 * @param {(selector: string, out: boolean) => void} add called with true to exclude the selector
 */
export function pointMenu(host, add) {
  const menu = h('div.popover.point', { hidden: true, role: 'menu', 'aria-label': text.region.atPoint });
  host.append(menu);
  const take = (/** @type {string} */ selector, /** @type {boolean} */ out) => {
    menu.hidden = true;
    add(selector, out);
  };
  /** Shows the menu. @param {THREE.Intersection} hit @param {number} size the model's size @param {{clientX: number, clientY: number}} at */
  menu.offer = (hit, size, { clientX, clientY }) => {
    const area = host.getBoundingClientRect();
    fill(menu, h('h3', {}, text.region.atPoint), ...selectorsAt(hit, size).map((selector) => {
      const name = selectorName(selector), color = selectorColor(selector);
      return h('div.row', {},
        h('button.item', { type: 'button', role: 'menuitem', title: selector, 'aria-label': `${text.region.add}: ${name}`, onclick: () => take(selector, false) },
          icon('plus'), h('span', {}, name), color ? h('i.swatch', { style: `--c:${color}` }) : null),
        h('button.icon', { type: 'button', role: 'menuitem', title: text.region.subtract, 'aria-label': `${text.region.subtract}: ${name}`, onclick: () => take(selector, true) }, icon('minus')));
    }));
    menu.hidden = false;
    const width = menu.offsetWidth, height = menu.offsetHeight;
    menu.style.left = `${Math.max(8, Math.min(clientX - area.left + 12, area.width - width - 8))}px`;
    menu.style.top = `${Math.max(8, Math.min(clientY - area.top + 12, area.height - height - 8))}px`;
    menu.querySelector('button')?.focus();
  };
  return menu;
}

/** @param {THREE.Intersection} hit @param {number} size */
function selectorsAt(hit, size) {
  const { userData } = hit.object;
  const selectors = userData.materialName ? [`material=${userData.materialName}`] : [];
  /** @type {THREE.Object3D|null} */
  let node = hit.object;
  while (node && !node.userData.node) node = node.parent;
  if (node) selectors.push(`node=${node.userData.node}`);
  const color = colorAt(hit);
  if (color) selectors.push(`color=${color}`);
  selectors.push(`sphere=${[...hit.point.toArray(), 0.12 * size].map((v) => Number(v.toPrecision(3))).join(',')}`);
  return selectors;
}

/** Returns the base colour of the texel that was hit, as #rrggbb. @param {THREE.Intersection} hit */
function colorAt(hit) {
  const { map, color } = /** @type {any} */ (hit.object).material;
  if (!map?.image || !hit.uv) return map ? '' : `#${color.getHexString()}`;
  const canvas = new OffscreenCanvas(1, 1), context = canvas.getContext('2d');
  const { width, height } = map.image;
  const at = (/** @type {number} */ v, /** @type {number} */ n) => Math.min(Math.floor((v - Math.floor(v)) * n), n - 1);
  try {
    context?.drawImage(map.image, at(hit.uv.x, width), at(hit.uv.y, height), 1, 1, 0, 0, 1, 1);
  } catch {
    return ''; // a blend of layers has no image to read
  }
  const pixel = context?.getImageData(0, 0, 1, 1).data ?? [0, 0, 0];
  return `#${[...pixel].slice(0, 3).map((v) => v.toString(16).padStart(2, '0')).join('')}`;
}

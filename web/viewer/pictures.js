// Replacement for the viewer without WebGL: images of the selected result, and a sentence that says why.
import { h, fill } from '../core/dom.js';
import { fileUrl } from '../core/api.js';
import { text } from '../text.js';

/** @param {HTMLElement} host @param {import('../core/store.js').Store} store */
export function showPictures(host, store) {
  const pictures = h('div.pictures');
  host.append(h('p.no-webgl', { role: 'note' }, text.viewer.noWebGL), pictures);
  let shown = '';
  store.on(['selected', 'results', 'layout'], ({ results, selected, layout }) => {
    const result = results.find(({ id }) => id === selected) ?? results.findLast(({ state }) => state === 'done');
    const names = layout === 'wipe' ? ['before.png', 'after.png'] : [selected ? 'after.png' : 'before.png', 'preview.png'];
    const there = result ? names.filter((name) => result.files.includes(name)).slice(0, layout === 'wipe' ? 2 : 1) : [];
    const key = `${result?.id} ${there} ${result?.progress?.done ?? ''}`;
    if (key === shown) return;
    shown = key;
    fill(pictures, ...there.map((name) => h('img', { src: `${fileUrl(/** @type {any} */ (result).id, name)}${name === 'preview.png' ? `?${result?.progress?.done}` : ''}`, alt: name })),
      !there.length && h('p.hint', {}, text.viewer.noPicture));
  });
}

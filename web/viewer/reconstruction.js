// Shows and refreshes the program's own preview while a model is reconstructed from photographs.
import { h } from '../core/dom.js';
import { fileUrl } from '../core/api.js';
import { text } from '../text.js';

const MILLISECONDS = 4000; // refresh interval; the program writes a preview about every ten seconds

/** @param {HTMLElement} host @param {import('../core/store.js').Store} store */
export function showReconstruction(host, store) {
  const image = h('img', { alt: text.photos.preview, hidden: true, onload: () => { image.hidden = false; }, onerror: () => { image.hidden = true; } });
  const caption = h('figcaption', {}, text.photos.preview);
  const figure = h('figure.reconstruction', { hidden: true }, image, caption);
  host.append(figure);
  let shown = '', renewed = 0;
  store.on(['project', 'results', 'selected'], ({ project, results, selected }) => {
    const result = project && !project.model ? results.find(({ id, kind }) => id === selected && kind === 'reconstruct') : undefined;
    figure.hidden = !result;
    caption.hidden = result?.state === 'failed' || result?.state === 'cancelled';
    if (!result || (result.id === shown && Date.now() - renewed < MILLISECONDS)) return;
    [shown, renewed] = [result.id, Date.now()];
    image.src = `${fileUrl(result.id, 'preview.png')}?${renewed}`;
  });
}

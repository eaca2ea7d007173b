// Thumbnail of a result: its own, or the first view of the sheet that an edit writes.
import { h, icon } from '../core/dom.js';
import { fileUrl } from '../core/api.js';

/** @param {import('../core/types.js').Result} result */
export function thumbnail({ id, kind, state, thumbnail: own, files }) {
  const sheet = !own && state === 'done' && files.includes('after.png');
  const src = own || (sheet ? fileUrl(id, 'after.png') : '');
  return h('span.thumb', {}, src ? h('img', { src, alt: '', loading: 'lazy', decoding: 'async', className: sheet ? 'sheet' : '' })
    : icon(kind === 'relight' ? 'sun' : kind === 'reconstruct' ? 'camera' : 'brush'));
}

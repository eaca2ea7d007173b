// Thumbnails: that of a result is its own, or the first view of the sheet that an edit writes. The source has the first
// view of the sheet that its edit writes before, and until then an image of the viewer.
import { h, icon } from '../core/dom.js';
import { fileUrl } from '../core/api.js';
import { lostParent } from '../core/results.js';

/** @param {import('../core/types.js').Result} result */
export function thumbnail({ id, kind, state, thumbnail: own, files }) {
  const sheet = !own && state === 'done' && files.includes('after.png');
  const src = own || (sheet ? fileUrl(id, 'after.png') : '');
  return h('span.thumb', {}, src ? h('img', { src, alt: '', loading: 'lazy', decoding: 'async', className: sheet ? 'sheet' : '' })
    : icon(kind === 'relight' ? 'sun' : kind === 'reconstruct' ? 'camera' : 'brush'));
}

/** Returns true if the result's files contain images of the source. @param {import('../core/types.js').Result} result */
export function showsSource(result) {
  return result.kind === 'edit' && result.state === 'done' && result.parent === null && !lostParent(result) && result.files.includes('before.png');
}

/** @param {import('../core/types.js').Result} [edit] an edit that shows the source @param {string} [image] address of another image of the source */
export function sourceThumbnail(edit, image) {
  return h('span.thumb', {}, edit ? h('img', { src: fileUrl(edit.id, 'before.png'), alt: '', decoding: 'async', className: 'sheet' }) : image ? h('img', { src: image, alt: '' }) : icon('box'));
}

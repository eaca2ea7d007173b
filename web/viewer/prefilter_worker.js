// Prefilters lights beside the page's own thread: {id, pixels, width, size} in, {id, specular, diffuse} out.
import { prefilter } from './prefilter.js';

self.onmessage = ({ data: { id, pixels, width, size } }) => {
  const { specular, diffuse } = prefilter(pixels, width, size);
  const buffers = [...specular, diffuse].flatMap((level) => level.faces.map((face) => face.buffer));
  /** @type {any} */ (self).postMessage({ id, specular, diffuse }, buffers);
};

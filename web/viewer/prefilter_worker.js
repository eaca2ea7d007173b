// Worker that prefilters lights in its own thread. It receives {id, pixels, width, size} and sends {id, specular, diffuse}.
import { prefilter } from './prefilter.js';

self.onmessage = ({ data: { id, pixels, width, size } }) => {
  const { specular, diffuse } = prefilter(pixels, width, size);
  const buffers = [...specular, diffuse].flatMap((level) => level.faces.map((face) => face.buffer));
  /** @type {any} */ (self).postMessage({ id, specular, diffuse }, buffers);
};

// Prefilters an equirectangular light as docs/renderer.md describes. The levels of a cube map hold GGX lobes of increasing
// roughness; a small cube map holds the irradiance divided by pi. Sums run over a pyramid of the light: over fine texels
// near the lobe's centre, and over coarse texels elsewhere. Each texel stores the mean direction of its energy, so that a sun
// keeps its place. The module is pure arithmetic, which a worker runs.

/** Roughness of each level of the specular cube. Each level has half the size of the one before. */
export const ROUGHNESS = [0, 0.1, 0.19, 0.36, 0.65, 1];

/**
 * A level of the pyramid: for each texel radiance times solid angle, the solid angle, and the unit mean direction of the energy.
 * @typedef {{width: number, height: number, light: Float32Array, solid: Float32Array, to: Float32Array}} PyramidLevel
 * @typedef {{size: number, faces: Uint16Array[]}} CubeLevel  RGBA half floats of the faces +X, -X, +Y, -Y, +Z, -Z
 */

/**
 * Prefilters a light.
 * @param {Float32Array} pixels linear RGBA; the image's centre is towards -Z, and +X is a quarter of its width to the right
 * @param {number} width a power of two, twice the height
 * @param {number} size size of the sharpest level, a power of two of at least 32, so that it can be halved for all levels
 * @returns {{specular: CubeLevel[], diffuse: CubeLevel}}
 */
export function prefilter(pixels, width, size) {
  const pyramid = makePyramid(pixels, width);
  const specular = ROUGHNESS.map((roughness, level) => {
    const edge = size >> level;
    return roughness === 0 ? mirror(pixels, width, edge) : convolve(pyramid, edge, ggxKernel(roughness), 1.5);
  });
  return { specular, diffuse: convolve(pyramid.slice(-2), 32, cosineKernel(), 0) };
}

/** @param {Float32Array} pixels @param {number} width @returns {PyramidLevel[]} the levels, the finest first */
function makePyramid(pixels, width) {
  const height = width / 2;
  /** @type {PyramidLevel} */
  let level = { width, height, light: new Float32Array(width * height * 3), solid: new Float32Array(width * height), to: new Float32Array(width * height * 3) };
  for (let y = 0; y < height; ++y) {
    const polar = Math.PI * (y + 0.5) / height;
    const solid = 2 * Math.PI / width * (Math.cos(Math.PI * y / height) - Math.cos(Math.PI * (y + 1) / height));
    for (let x = 0; x < width; ++x) {
      const i = y * width + x, around = 2 * Math.PI * ((x + 0.5) / width - 0.5);
      level.solid[i] = solid;
      for (let c = 0; c < 3; ++c) level.light[3 * i + c] = pixels[4 * i + c] * solid;
      level.to[3 * i] = Math.sin(polar) * Math.sin(around);
      level.to[3 * i + 1] = Math.cos(polar);
      level.to[3 * i + 2] = -Math.sin(polar) * Math.cos(around);
    }
  }
  const pyramid = [level];
  while (level.height > 8) pyramid.push(level = halve(level));
  return pyramid;
}

/** @param {PyramidLevel} fine @returns {PyramidLevel} */
function halve(fine) {
  const width = fine.width / 2, height = fine.height / 2;
  const light = new Float32Array(width * height * 3), solid = new Float32Array(width * height), to = new Float32Array(width * height * 3);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const i = y * width + x;
      for (const j of childrenOf(fine.width, x, y)) {
        const energy = fine.light[3 * j] + fine.light[3 * j + 1] + fine.light[3 * j + 2] + 1e-12 * fine.solid[j];
        solid[i] += fine.solid[j];
        for (let c = 0; c < 3; ++c) {
          light[3 * i + c] += fine.light[3 * j + c];
          to[3 * i + c] += fine.to[3 * j + c] * energy;
        }
      }
      const length = Math.hypot(to[3 * i], to[3 * i + 1], to[3 * i + 2]) || 1;
      for (let c = 0; c < 3; ++c) to[3 * i + c] /= length;
    }
  return { width, height, light, solid, to };
}

/** Returns the indices of a texel's four texels in the finer level. @param {number} width the finer level's width @param {number} x @param {number} y */
function childrenOf(width, x, y) {
  const i = 2 * y * width + 2 * x;
  return [i, i + 1, i + width, i + width + 1];
}

const STEPS = 2048; // of a kernel's table, equally spaced in the sine of half the angle

/** Returns a table of GGX, as seen along the normal, times the cosine (Karis 2013). @param {number} roughness */
function ggxKernel(roughness) {
  const alpha = roughness * roughness, kernel = new Float32Array(STEPS + 1);
  for (let i = 0; i < STEPS; ++i) {
    const half = (i / STEPS) ** 2; // sin^2 of half the angle
    const cosine = 1 - 2 * half, d = alpha / ((1 - half) * (alpha * alpha - 1) + 1);
    kernel[i] = cosine > 0 ? d * d * cosine : 0;
  }
  return kernel;
}

function cosineKernel() {
  const kernel = new Float32Array(STEPS + 1);
  for (let i = 0; i < STEPS; ++i) kernel[i] = Math.max(1 - 2 * (i / STEPS) ** 2, 0);
  return kernel;
}

/**
 * Computes the kernel's weighted mean of the light around each texel's direction of a cube.
 * @param {PyramidLevel[]} pyramid @param {number} size @param {Float32Array} kernel
 * @param {number} near a texel of the pyramid is split if it is nearer than this many times its width
 * @returns {CubeLevel}
 */
function convolve(pyramid, size, kernel, near) {
  const coarsest = pyramid.length - 1, top = pyramid[coarsest];
  const sum = new Float64Array(4);
  let nx = 0, ny = 0, nz = 0;
  // Texels finer than a quarter of an output texel make no visible difference.
  const finest = Math.max(0, pyramid.findIndex(({ height }) => height <= size * 8));
  const widths = pyramid.map(({ height }) => (near * Math.PI / height) ** 2);

  const add = (/** @type {number} */ at, /** @type {number} */ x, /** @type {number} */ y) => {
    const level = pyramid[at], i = y * level.width + x;
    const dot = nx * level.to[3 * i] + ny * level.to[3 * i + 1] + nz * level.to[3 * i + 2];
    const half = Math.max((1 - dot) / 2, 0);
    if (at > finest && 4 * half < widths[at]) { // compares the squared chord with the squared width
      add(at - 1, 2 * x, 2 * y);
      add(at - 1, 2 * x + 1, 2 * y);
      add(at - 1, 2 * x, 2 * y + 1);
      add(at - 1, 2 * x + 1, 2 * y + 1);
      return;
    }
    if (half > 0.5) return;
    const place = Math.sqrt(half) * STEPS, step = place | 0;
    const weight = kernel[step] + (place - step) * (kernel[step + 1] - kernel[step]);
    sum[0] += weight * level.light[3 * i];
    sum[1] += weight * level.light[3 * i + 1];
    sum[2] += weight * level.light[3 * i + 2];
    sum[3] += weight * level.solid[i];
  };

  return fillCube(size, (x, y, z, out) => {
    nx = x; ny = y; nz = z;
    sum.fill(0);
    for (let row = 0; row < top.height; ++row)
      for (let column = 0; column < top.width; ++column) add(coarsest, column, row);
    for (let c = 0; c < 3; ++c) out[c] = sum[c] / sum[3];
  });
}

/** Resamples the light itself to a cube, bilinearly. @param {Float32Array} pixels @param {number} width @param {number} size @returns {CubeLevel} */
function mirror(pixels, width, size) {
  const height = width / 2;
  return fillCube(size, (x, y, z, out) => {
    const u = (Math.atan2(x, -z) / (2 * Math.PI) + 0.5) * width - 0.5;
    const v = Math.min(Math.max(Math.acos(Math.min(Math.max(y, -1), 1)) / Math.PI * height - 0.5, 0), height - 1);
    const x0 = Math.floor(u), y0 = Math.min(Math.floor(v), height - 2), fx = u - x0, fy = v - y0;
    const left = (x0 + width) % width, right = (x0 + 1) % width;
    for (let c = 0; c < 3; ++c) {
      const at = (/** @type {number} */ column, /** @type {number} */ row) => pixels[4 * (row * width + column) + c];
      out[c] = (at(left, y0) * (1 - fx) + at(right, y0) * fx) * (1 - fy) + (at(left, y0 + 1) * (1 - fx) + at(right, y0 + 1) * fx) * fy;
    }
  });
}

/** @param {number} size @param {(x: number, y: number, z: number, out: Float64Array) => void} value @returns {CubeLevel} */
function fillCube(size, value) {
  const faces = [], out = new Float64Array(3);
  for (let face = 0; face < 6; ++face) {
    const data = new Uint16Array(size * size * 4);
    for (let row = 0; row < size; ++row)
      for (let column = 0; column < size; ++column) {
        const s = 2 * (column + 0.5) / size - 1, t = 2 * (row + 0.5) / size - 1;
        const [x, y, z] = [[1, -t, -s], [-1, -t, s], [s, 1, t], [s, -1, -t], [s, -t, 1], [-s, -t, -1]][face];
        const length = Math.sqrt(x * x + y * y + z * z), at = 4 * (row * size + column);
        value(x / length, y / length, z / length, out);
        for (let c = 0; c < 3; ++c) data[at + c] = half(out[c]);
        data[at + 3] = 0x3c00;
      }
    faces.push(data);
  }
  return { size, faces };
}

const bits = new Uint32Array(1), asFloat = new Float32Array(bits.buffer);
/** Returns the bits of a non-negative value as a half float, rounded and clamped to the largest. @param {number} value */
function half(value) {
  asFloat[0] = Math.min(value, 65504);
  if (!(asFloat[0] > 6e-8)) return 0;
  if (asFloat[0] < 6.1e-5) return Math.round(asFloat[0] * 16777216); // subnormal
  return Math.min(((bits[0] - 0x38000000 + 0x1000) >> 13), 0x7bff);
}

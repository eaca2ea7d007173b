// Search for the sun in a light, by the rules of `item3d light`: the brightest lobe is a sun if it is small and strong.

const LARGEST = 2 * Math.PI * (1 - Math.cos(5 * Math.PI / 180)); // solid angle of a sun's lobe in steradians
const WEAKEST = 0.03; // share of the light's energy
const RIM = 0.1; // luminance of a lobe's rim, relative to its brightest texel

/**
 * Returns the azimuth and elevation of the sun in degrees, or null if the light has no sun above the horizon.
 * @param {Float32Array} pixels linear RGBA, equirectangular; the centre is towards -Z (azimuth 0), and +X (azimuth 90) is to the right
 * @param {number} width twice the height
 * @returns {[number, number]|null}
 */
export function sunOf(pixels, width) {
  const height = width / 2;
  const luminance = new Float32Array(width * height);
  const solid = Array.from({ length: height }, (_, y) => 2 * Math.PI / width * (Math.cos(Math.PI * y / height) - Math.cos(Math.PI * (y + 1) / height)));
  let energy = 0, brightest = 0;
  for (let i = 0; i < luminance.length; ++i) {
    luminance[i] = 0.2126 * pixels[4 * i] + 0.7152 * pixels[4 * i + 1] + 0.0722 * pixels[4 * i + 2];
    energy += luminance[i] * solid[Math.floor(i / width)];
    if (luminance[i] > luminance[brightest]) brightest = i;
  }
  let covered = 0, strength = 0, east = 0, up = 0, north = 0;
  for (const i of lobeAround(luminance, width, brightest)) {
    const y = Math.floor(i / width), polar = Math.PI * (y + 0.5) / height, around = 2 * Math.PI * ((i % width + 0.5) / width - 0.5);
    const part = luminance[i] * solid[y];
    covered += solid[y];
    if (covered > LARGEST) return null;
    strength += part;
    east += part * Math.sin(polar) * Math.sin(around);
    up += part * Math.cos(polar);
    north += part * Math.sin(polar) * Math.cos(around);
  }
  if (!(strength > 0 && strength >= WEAKEST * energy) || up < 0) return null;
  const degrees = 180 / Math.PI;
  return [(Math.atan2(east, north) * degrees + 360) % 360, Math.atan2(up, Math.hypot(east, north)) * degrees];
}

/** Lists the texels that are connected to a texel and have at least a tenth of its luminance. @param {Float32Array} luminance @param {number} width @param {number} from */
function* lobeAround(luminance, width, from) {
  const found = new Set([from]);
  for (const i of found) { // the iteration of a set reaches what is added meanwhile
    yield i;
    for (let dy = -1; dy <= 1; ++dy)
      for (let dx = -1; dx <= 1; ++dx) {
        const next = (Math.floor(i / width) + dy) * width + (i % width + dx + width) % width;
        if (luminance[next] >= RIM * luminance[from]) found.add(next);
      }
  }
}

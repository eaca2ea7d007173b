// The light of a stage: an equirectangular image that a worker prefilters into two cube textures. A new light of the same
// size reuses these textures, so that dragging the sun allocates nothing.
import * as THREE from '../three.js';
import { ROUGHNESS } from './prefilter.js';
import { sunOf } from './sun.js';

/**
 * Uniforms of a light, shared by all materials.
 * @typedef {{specular: {value: THREE.CubeTexture|null}, diffuse: {value: THREE.CubeTexture|null}, turn: {value: THREE.Matrix3}, intensity: {value: number}}} LightUniforms
 */

export const LEVELS = ROUGHNESS.length;
const SMALLEST = 2 ** (LEVELS - 1); // texels; the last level has one

export class StageLight {
  constructor() {
    this.loader = new THREE.HDRLoader().setDataType(THREE.FloatType);
    this.worker = new Worker(new URL('./prefilter_worker.js', import.meta.url), { type: 'module' });
    /** @type {Map<number, (levels: any) => void>} */
    this.waiting = new Map();
    this.worker.onmessage = ({ data }) => {
      this.waiting.get(data.id)?.(data);
      this.waiting.delete(data.id);
    };
    this.request = 0;
    /** @type {[number, number]|null} azimuth and elevation of the shown light's sun, before the rotation */
    this.sun = null;
    /** @type {LightUniforms} */
    this.uniforms = { specular: { value: null }, diffuse: { value: null }, turn: { value: new THREE.Matrix3() }, intensity: { value: 1 } };
    this.backdrop = makeBackdrop(this.uniforms);
  }

  /**
   * Shows the light at an address. If a later call is made meanwhile, the earlier one has no effect.
   * @param {string} url a Radiance image whose centre is towards -Z
   * @param {AbortSignal} [signal]
   * @returns {Promise<boolean>} true if this light is shown now
   */
  async show(url, signal) {
    const request = ++this.request;
    const response = await fetch(url, { signal });
    if (!response.ok) {
      const body = await response.json().catch(() => null);
      throw Object.assign(new Error(body?.error ?? `${response.status} ${response.statusText}`), { hint: body?.hint });
    }
    const { data, width, height } = /** @type {{data: Float32Array, width: number, height: number}} */ (this.loader.parse(await response.arrayBuffer()));
    const { pixels, across } = fitted(data, width, height);
    const sun = sunOf(pixels, across);
    const levels = await new Promise((resolve) => {
      this.waiting.set(request, resolve);
      this.worker.postMessage({ id: request, pixels, width: across, size: Math.max(across / 4, SMALLEST) }, [pixels.buffer]);
    });
    if (request !== this.request) return false;
    this.sun = sun;
    this.put('specular', levels.specular);
    this.put('diffuse', [levels.diffuse]);
    return true;
  }

  /** @param {'specular'|'diffuse'} name @param {import('./prefilter.js').CubeLevel[]} levels */
  put(name, levels) {
    const uniform = this.uniforms[name];
    const images = levels.map(({ size, faces }) => faces.map((data) => {
      const texture = new THREE.DataTexture(data, size, size);
      return texture;
    }));
    let cube = uniform.value;
    if (!cube || cube.userData.size !== levels[0].size) {
      cube?.dispose();
      cube = new THREE.CubeTexture();
      cube.format = THREE.RGBAFormat;
      cube.type = THREE.HalfFloatType;
      cube.colorSpace = THREE.NoColorSpace;
      cube.generateMipmaps = false;
      cube.magFilter = THREE.LinearFilter;
      cube.minFilter = levels.length > 1 ? THREE.LinearMipmapLinearFilter : THREE.LinearFilter;
      cube.flipY = false;
      cube.userData.size = levels[0].size;
    }
    cube.image = images[0];
    cube.mipmaps = /** @type {any} */ (images.slice(1).map((image) => ({ image })));
    cube.needsUpdate = true;
    uniform.value = cube;
  }

  /** @param {number} stops the light is multiplied by 2^stops */
  setExposure(stops) {
    this.uniforms.intensity.value = 2 ** stops;
  }

  /** @param {number} degrees rotation about +Y, from -Z towards +X, like --light-rotation */
  setRotation(degrees) {
    const turn = new THREE.Matrix4().makeRotationY(THREE.MathUtils.degToRad(degrees));
    this.uniforms.turn.value.setFromMatrix4(turn);
  }

  dispose() {
    this.worker.terminate();
    this.uniforms.specular.value?.dispose();
    this.uniforms.diffuse.value?.dispose();
  }
}

/** Returns the pixels in a size for the worker: twice as wide as high, with a power of two of at most 1024 as width. @param {Float32Array} data @param {number} width @param {number} height */
function fitted(data, width, height) {
  const across = Math.min(1024, 2 ** Math.round(Math.log2(width)));
  if (across === width && height * 2 === width) return { pixels: data, across };
  const pixels = new Float32Array(across * across / 2 * 4);
  for (let y = 0; y < across / 2; ++y)
    for (let x = 0; x < across; ++x) {
      const from = 4 * (Math.floor((y + 0.5) * height / (across / 2)) * width + Math.floor((x + 0.5) * width / across));
      pixels.set(data.subarray(from, from + 4), 4 * (y * across + x));
    }
  return { pixels, across };
}

/** Creates the backdrop, which shows the light out of focus behind the model. @param {LightUniforms} uniforms */
function makeBackdrop(uniforms) {
  const material = new THREE.ShaderMaterial({
    uniforms: { studioSpecular: uniforms.specular, studioTurn: uniforms.turn, studioIntensity: uniforms.intensity },
    vertexShader: /* glsl */ `
      varying vec3 direction;
      void main() {
        vec4 far = inverse(projectionMatrix) * vec4(position.xy, 1.0, 1.0);
        direction = inverse(mat3(viewMatrix)) * far.xyz;
        gl_Position = vec4(position.xy, 1.0, 1.0);
      }`,
    fragmentShader: /* glsl */ `
      uniform samplerCube studioSpecular;
      uniform mat3 studioTurn;
      uniform float studioIntensity;
      varying vec3 direction;
      void main() {
        vec3 light = textureLod(studioSpecular, studioTurn * direction, 2.2).rgb;
        gl_FragColor = vec4(light * studioIntensity, 1.0);
        #include <colorspace_fragment>
      }`,
    depthTest: true, depthWrite: false, depthFunc: THREE.LessEqualDepth,
  });
  const backdrop = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
  backdrop.frustumCulled = false;
  backdrop.renderOrder = -1;
  backdrop.visible = false;
  backdrop.raycast = () => {};
  return backdrop;
}

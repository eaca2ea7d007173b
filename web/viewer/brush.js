// A brush that paints on the surface. The GPU draws strokes in UV space, where each texel knows its position and normal.
// A stroke can therefore cross seams, and does not reach the other side of a thin part. To undo a stroke, the others are drawn again.
import * as THREE from '../three.js';

const SIZE = 1024;

/** @typedef {{begin: THREE.Vector3, end: THREE.Vector3, normal: THREE.Vector3, radius: number, erases: boolean}} Dab a piece of a stroke, in world space */

export class Brush {
  /** @param {THREE.WebGLRenderer} renderer @param {import('./look.js').Look} look */
  constructor(renderer, look) {
    this.renderer = renderer;
    this.look = look;
    /** @type {Map<number, THREE.WebGLRenderTarget>} masks by material */
    this.targets = new Map();
    this.scene = new THREE.Scene();
    this.camera = new THREE.Camera();
    this.material = new THREE.ShaderMaterial({
      uniforms: { begin: { value: new THREE.Vector3() }, end: { value: new THREE.Vector3() }, up: { value: new THREE.Vector3() },
        radius: { value: 1 }, erases: { value: 0 }, model: { value: new THREE.Matrix4() } },
      vertexShader: /* glsl */ `
        uniform mat4 model;
        varying vec3 place, facing;
        void main() {
          place = (model * vec4(position, 1.0)).xyz;
          facing = mat3(model) * normal;
          gl_Position = vec4(uv * 2.0 - 1.0, 0.0, 1.0);
        }`,
      fragmentShader: /* glsl */ `
        uniform vec3 begin, end, up;
        uniform float radius, erases;
        varying vec3 place, facing;
        void main() {
          vec3 along = end - begin;
          float t = clamp(dot(place - begin, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
          float inside = 1.0 - smoothstep(0.8, 1.0, distance(place, begin + t * along) / radius);
          inside *= smoothstep(-0.2, 0.1, dot(normalize(facing), up));
          gl_FragColor = vec4(vec3(erases > 0.5 ? 1.0 - inside : inside), 1.0);
        }`,
      side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true,
      blending: THREE.CustomBlending, blendEquation: THREE.MaxEquation, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
    });
    this.mesh = new THREE.Mesh(undefined, this.material);
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh);
    /** @type {Dab[][]} */
    this.strokes = [];
    /** @type {Dab[][]} strokes that were undone, the last one first to be drawn again */
    this.undone = [];
  }

  get painted() {
    return this.strokes.length > 0;
  }

  /** Begins a stroke. */
  begin() {
    this.strokes.push([]);
    this.undone = [];
  }

  /** Adds a piece to the stroke. @param {Dab} dab */
  add(dab) {
    this.strokes.at(-1)?.push(dab);
    this.draw(dab);
  }

  /** Undoes the last stroke. @returns {boolean} false if there is none */
  undo() {
    const stroke = this.strokes.pop();
    if (!stroke) return false;
    this.undone.push(stroke);
    for (const target of this.targets.values()) this.clear(target);
    for (const dab of this.strokes.flat()) this.draw(dab);
    return true;
  }

  /** Draws the stroke again that was undone last. @returns {boolean} false if there is none */
  redo() {
    const stroke = this.undone.pop();
    if (!stroke) return false;
    this.strokes.push(stroke);
    for (const dab of stroke) this.draw(dab);
    return true;
  }

  /** @param {Dab} dab */
  draw({ begin, end, normal, radius, erases }) {
    const u = this.material.uniforms;
    u.begin.value.copy(begin);
    u.end.value.copy(end);
    u.up.value.copy(normal);
    u.radius.value = radius;
    u.erases.value = erases ? 1 : 0;
    this.material.blendEquation = erases ? THREE.MinEquation : THREE.MaxEquation;
    const autoClear = this.renderer.autoClear;
    this.renderer.autoClear = false;
    for (const { index, meshes } of this.look.materials) {
      this.renderer.setRenderTarget(this.target(index));
      for (const mesh of meshes) {
        if (!mesh.geometry.getAttribute('uv')) continue;
        this.mesh.geometry = mesh.geometry;
        u.model.value.copy(mesh.matrixWorld);
        this.renderer.render(this.scene, this.camera);
      }
    }
    this.renderer.setRenderTarget(null);
    this.renderer.autoClear = autoClear;
  }

  /** Returns a material's mask. @param {number} index the material's index */
  target(index) {
    let target = this.targets.get(index);
    if (!target) {
      target = new THREE.WebGLRenderTarget(SIZE, SIZE, { depthBuffer: false, wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping });
      this.targets.set(index, target);
      this.clear(target);
    }
    return target;
  }

  /** @param {THREE.WebGLRenderTarget} target */
  clear(target) {
    this.renderer.setRenderTarget(target);
    this.renderer.clear();
    this.renderer.setRenderTarget(null);
  }

  /** Returns the masks for the viewer's veil. */
  masks() {
    return new Map([...this.targets].map(([index, target]) => [index, target.texture]));
  }

  /** Returns PNG images of the masks that are not empty. @returns {Promise<{index: number, name: string, blob: Blob}[]>} */
  async pictures() {
    const pictures = [];
    for (const { index, name } of this.look.materials) {
      const target = this.targets.get(index);
      if (!target) continue;
      const pixels = new Uint8ClampedArray(SIZE * SIZE * 4);
      this.renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, /** @type {any} */ (pixels));
      let any = false;
      for (let i = 0; i < pixels.length; i += 4) {
        any = any || pixels[i] > 127;
        pixels[i + 3] = 255;
      }
      if (!any) continue;
      const canvas = new OffscreenCanvas(SIZE, SIZE);
      canvas.getContext('2d')?.putImageData(new ImageData(pixels, SIZE, SIZE), 0, 0);
      pictures.push({ index, name, blob: await canvas.convertToBlob({ type: 'image/png' }) });
    }
    return pictures;
  }

  dispose() {
    for (const target of this.targets.values()) target.dispose();
    this.material.dispose();
  }
}

// Blends layers at any strength on the GPU. A map is the source's image plus, for each layer, the strength times the layer's
// change of the channels that are on. Sums are of the images' stored values, and are clamped at the end. `item3d layers`
// computes the same in integers.
import * as THREE from '../three.js';

/**
 * @typedef {import('./look.js').Look} Look
 * @typedef {{before: Look, after: Look, strength: number, channels: Set<string>}} MixLayer
 * @typedef {'base_color'|'orm'|'normal'} Slot
 */

const VERTEX = /* glsl */ `
varying vec2 at;
void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }`;

// Returns a slot's values as an image stores them: texture times factor, with colours encoded in sRGB.
const SAMPLE = /* glsl */ `
vec3 encoded(vec3 c) { return sRGBTransferOETF(vec4(c, 1.0)).rgb; }
vec4 sampleSlot(sampler2D main, sampler2D occlusion, vec4 factor, bool color) {
  vec4 texel = texture2D(main, at);
  if (color) return vec4(encoded(texel.rgb * factor.rgb), texel.a);
  return vec4(texture2D(occlusion, at).r * factor.r, texel.gb * factor.gb, 1.0);
}
vec4 normalSlot(sampler2D main) { return vec4(texture2D(main, at).rgb, 1.0); }`;

const CHANGE = /* glsl */ `
varying vec2 at;
uniform sampler2D mainA, mainB, occlusionA, occlusionB;
uniform vec4 factorA, factorB, weight;
uniform int slot;
${SAMPLE}
void main() {
  vec4 a = slot == 2 ? normalSlot(mainA) : sampleSlot(mainA, occlusionA, factorA, slot == 0);
  if (weight.a > 0.5) { gl_FragColor = a; return; }
  vec4 b = slot == 2 ? normalSlot(mainB) : sampleSlot(mainB, occlusionB, factorB, slot == 0);
  gl_FragColor = vec4((b - a).rgb * weight.rgb, 0.0);
}`;

const FINISH = /* glsl */ `
varying vec2 at;
uniform sampler2D sum;
uniform int slot;
void main() {
  vec4 value = clamp(texture2D(sum, at), 0.0, 1.0);
  gl_FragColor = slot == 0 ? sRGBTransferEOTF(value) : value;
}`;

export class LayerMix {
  /** @param {THREE.WebGLRenderer} renderer @param {Look} source @param {import('./shading.js').SharedUniforms} shared */
  constructor(renderer, source, shared) {
    this.renderer = renderer;
    this.anisotropy = shared.anisotropy;
    this.source = source;
    this.look = source.copy(shared);
    /** @type {Map<string, THREE.WebGLRenderTarget>} */
    this.targets = new Map();
    /** @type {THREE.WebGLRenderTarget|null} */
    this.sum = null;
    this.scene = new THREE.Scene();
    this.quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2));
    this.quad.frustumCulled = false;
    this.scene.add(this.quad);
    this.camera = new THREE.OrthographicCamera();
    // Row 0 of a render target is v = 0, as in a glTF image (flipY is off), so the same UVs read both.
    this.white = pixel([255, 255, 255, 255]);
    this.flat = pixel([128, 128, 255, 255]);
    const names = ['mainA', 'mainB', 'occlusionA', 'occlusionB'];
    this.change = new THREE.ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: CHANGE, depthTest: false, depthWrite: false,
      uniforms: { ...Object.fromEntries(names.map((name) => [name, { value: this.white }])),
        factorA: { value: new THREE.Vector4() }, factorB: { value: new THREE.Vector4() },
        weight: { value: new THREE.Vector4() }, slot: { value: 0 } },
      blending: THREE.CustomBlending, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
      blendSrcAlpha: THREE.OneFactor, blendDstAlpha: THREE.OneFactor, transparent: true,
    });
    this.finish = new THREE.ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FINISH, depthTest: false, depthWrite: false,
      uniforms: { sum: { value: null }, slot: { value: 0 } }, blending: THREE.NoBlending,
    });
  }

  /** Shows the source with these layers. @param {MixLayer[]} layers */
  set(layers) {
    const autoClear = this.renderer.autoClear;
    const before = this.renderer.getRenderTarget();
    this.renderer.autoClear = false;
    this.renderer.setScissorTest(false);
    for (const { index, material } of this.look.materials)
      for (const slot of /** @type {Slot[]} */ (['base_color', 'orm', 'normal'])) this.mix(index, material, slot, layers);
    this.renderer.setRenderTarget(before);
    this.renderer.autoClear = autoClear;
  }

  /** @param {number} index @param {THREE.MeshStandardMaterial} material @param {Slot} slot @param {MixLayer[]} layers */
  mix(index, material, slot, layers) {
    const source = this.source.material(index)[0]?.material;
    const uses = layers
      .map((layer) => ({ ...layer, a: layer.before.material(index)[0]?.material, b: layer.after.material(index)[0]?.material }))
      .filter(({ a, b }) => a && b && (mainOf(a, slot) !== mainOf(b, slot)));
    const key = `${index} ${slot}`;
    if (!source || (!uses.length && !this.targets.has(key))) return;
    const size = sizeOf([source, ...uses.flatMap(({ a, b }) => [a, b])], slot);
    const target = this.target(key, slot, size);
    const sum = this.scratch(size);
    this.renderer.setRenderTarget(sum);
    this.renderer.setClearColor(0, 0);
    this.renderer.clear();
    this.pass(slot, source, source, [0, 0, 0, 1]);
    for (const { a, b, strength, channels } of uses) {
      const on = (/** @type {string} */ name) => channels.has(name) ? strength : 0;
      const weight = slot === 'orm' ? [on('occlusion'), on('roughness'), on('metallic'), 0]
        : [on(slot), on(slot), on(slot), 0];
      this.pass(slot, a, b, weight);
    }
    this.quad.material = this.finish;
    this.finish.uniforms.sum.value = sum.texture;
    this.finish.uniforms.slot.value = slot === 'base_color' ? 0 : 1;
    this.renderer.setRenderTarget(target);
    this.renderer.render(this.scene, this.camera);
    const maps = /** @type {any} */ (material);
    const first = slot === 'orm' ? 'roughnessMap' : slot === 'normal' ? 'normalMap' : 'map';
    if (maps[first] !== target.texture) this.look.putTexture(material, slot, target.texture);
  }

  /** @param {Slot} slot @param {THREE.MeshStandardMaterial} a @param {THREE.MeshStandardMaterial} b @param {number[]} weight */
  pass(slot, a, b, weight) {
    const u = this.change.uniforms;
    const none = slot === 'normal' ? this.flat : this.white;
    u.mainA.value = mainOf(a, slot) ?? none;
    u.mainB.value = mainOf(b, slot) ?? none;
    u.occlusionA.value = a.aoMap ?? this.white;
    u.occlusionB.value = b.aoMap ?? this.white;
    u.factorA.value.fromArray(factorOf(a, slot));
    u.factorB.value.fromArray(factorOf(b, slot));
    u.weight.value.fromArray(weight);
    u.slot.value = slot === 'base_color' ? 0 : slot === 'orm' ? 1 : 2;
    this.quad.material = this.change;
    this.renderer.render(this.scene, this.camera);
  }

  /** @param {string} key @param {Slot} slot @param {number[]} size */
  target(key, slot, [width, height]) {
    let target = this.targets.get(key);
    if (target && target.width === width && target.height === height) return target;
    target?.dispose();
    target = new THREE.WebGLRenderTarget(width, height, {
      depthBuffer: false, generateMipmaps: true, minFilter: THREE.LinearMipmapLinearFilter, anisotropy: this.anisotropy,
      wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping,
      colorSpace: slot === 'base_color' ? THREE.SRGBColorSpace : THREE.NoColorSpace,
    });
    this.targets.set(key, target);
    return target;
  }

  /** @param {number[]} size */
  scratch([width, height]) {
    if (this.sum && (this.sum.width !== width || this.sum.height !== height)) {
      this.sum.dispose();
      this.sum = null;
    }
    this.sum ??= new THREE.WebGLRenderTarget(width, height, { depthBuffer: false, type: THREE.HalfFloatType });
    return this.sum;
  }

  dispose() {
    this.look.dispose();
    for (const target of this.targets.values()) target.dispose();
    this.sum?.dispose();
    this.change.dispose();
    this.finish.dispose();
    this.quad.geometry.dispose();
    this.white.dispose();
    this.flat.dispose();
  }
}

/** @param {THREE.MeshStandardMaterial} material @param {Slot} slot */
function mainOf(material, slot) {
  return slot === 'base_color' ? material.map : slot === 'orm' ? material.roughnessMap : material.normalMap;
}

/** @param {THREE.MeshStandardMaterial} material @param {Slot} slot */
function factorOf(material, slot) {
  if (slot === 'base_color') return [...material.color.toArray(), 1];
  return [1, material.roughness, material.metalness, 1];
}

/** @param {THREE.MeshStandardMaterial[]} materials @param {Slot} slot */
function sizeOf(materials, slot) {
  const images = /** @type {ImageBitmap[]} */ (materials.map((material) => mainOf(material, slot)?.image).filter(Boolean));
  return [Math.max(1, ...images.map((image) => image.width)), Math.max(1, ...images.map((image) => image.height))];
}

/** @param {number[]} values */
function pixel(values) {
  const texture = new THREE.DataTexture(new Uint8Array(values), 1, 1);
  texture.needsUpdate = true;
  return texture;
}

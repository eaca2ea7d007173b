// The shading of `item3d render` (docs/renderer.md) in three.js. It has the same split sum, energy of multiple scattering,
// lean of rough lobes and occlusion, and no tone curve except sRGB. All light comes from an environment (light.js). Two
// additions of three.js are left out: roughness from curvature, and the darkening of the diffuse part by specular reflection.
import * as THREE from '../three.js';
import { ROUGHNESS } from './prefilter.js';

/** Width of a pair of the veil's stripes, in CSS pixels. */
export const STRIPE = 11;

/**
 * Uniforms that all materials of a stage share.
 * @typedef {{view: {value: number}, maskStripe: {value: number}, light: import('./light.js').LightUniforms, anisotropy: number}} SharedUniforms
 */

/** @param {import('./light.js').LightUniforms} light @param {number} anisotropy anisotropy of textures @returns {SharedUniforms} */
export function sharedUniforms(light, anisotropy) {
  return { view: { value: 0 }, maskStripe: { value: STRIPE }, light, anisotropy };
}

const LIGHT = /* glsl */ `
uniform samplerCube studioSpecular, studioDiffuse;
uniform mat3 studioTurn;
uniform float studioIntensity;
vec3 studioWorld(const in vec3 direction) {
  return studioTurn * (vec4(direction, 0.0) * viewMatrix).xyz;
}
vec3 studioIrradiance(const in vec3 normal) {
  return studioIntensity * textureLod(studioDiffuse, studioWorld(normal), 0.0).rgb;
}
// Rough lobes lean towards the normal. The lean is faded in between roughness 0.25 and 0.5.
vec3 studioRadiance(const in vec3 view, const in vec3 normal, const in float roughness) {
  float alpha = roughness * roughness;
  float mirror = (1.0 - alpha) * (sqrt(max(1.0 - alpha, 0.0)) + alpha);
  mirror = mix(1.0, mirror, smoothstep(0.25, 0.5, roughness));
  vec3 world = studioWorld(mix(normal, reflect(-view, normal), mirror));
  return studioIntensity * textureLod(studioSpecular, world, studioLevel(roughness)).rgb;
}
`;

// Levels are interpolated in the logarithm of roughness, over which a lobe's shape changes little.
const LEVEL = `float studioLevel(const in float roughness) {
  ${ROUGHNESS.slice(1, -1).map((value, i) => `if (roughness < ${value.toFixed(4)}) return ${between(i)};`).join('\n  ')}
  return ${between(ROUGHNESS.length - 2)};
}`;

/** Returns GLSL that computes the level between ROUGHNESS[i] and the next. @param {number} i */
function between(i) {
  const low = ROUGHNESS[i], high = ROUGHNESS[i + 1];
  if (low === 0) return `roughness / ${high.toFixed(4)}`;
  return `${i}.0 + log(roughness / ${low.toFixed(4)}) / ${Math.log(high / low).toFixed(6)}`;
}

const SPECULAR = /* glsl */ `
void RE_IndirectSpecular_Studio(const in vec3 radiance, const in vec3 irradiance,
    const in vec3 clearcoatRadiance, const in vec3 position, const in vec3 normal,
    const in vec3 viewDir, const in vec3 clearcoatNormal, const in PhysicalMaterial material,
    inout ReflectedLight light) {
  vec2 bsdf = texture2D(dfgLUT, vec2(material.roughness, saturate(dot(normal, viewDir)))).rg;
  vec3 f0 = mix(vec3(0.04), material.diffuseColor, material.metalness);
  vec3 single = f0 * bsdf.x + bsdf.y;
  vec3 boost = 1.0 + f0 * (1.0 / (bsdf.x + bsdf.y) - 1.0);
  light.indirectSpecular += radiance * single * boost;
  light.indirectDiffuse += (1.0 - material.metalness) * material.diffuseColor * irradiance;
}
#undef RE_IndirectSpecular
#define RE_IndirectSpecular RE_IndirectSpecular_Studio
uniform int studioView;
uniform float studioMaskShown, studioMaskStripe;
uniform sampler2D studioMask;
varying vec2 vStudioUv;
float studioOcclusion = 1.0;
`;

const MAPS = `
iblIrradiance += studioIrradiance(geometryNormal);
radiance += studioRadiance(geometryViewDir, geometryNormal, material.roughness);`;

const OCCLUSION = /* glsl */ `
#ifdef USE_AOMAP
  #ifdef STUDIO_OCCLUSION_TOO
    studioOcclusion = (texelRoughness.r - 1.0) * aoMapIntensity + 1.0;
  #else
    studioOcclusion = (texture2D(aoMap, vAoMapUv).r - 1.0) * aoMapIntensity + 1.0;
  #endif
  reflectedLight.indirectDiffuse *= studioOcclusion;
  reflectedLight.indirectSpecular *= studioOcclusion;
#endif
`;

// Occlusion, roughness and metallic usually share one texture, which is then read only once.
const METALLIC = /* glsl */ `
float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
  #ifdef STUDIO_ONE_TEXTURE
    metalnessFactor *= texelRoughness.b;
  #else
    metalnessFactor *= texture2D(metalnessMap, vMetalnessMapUv).b;
  #endif
#endif
`;

// The region's veil: blue and pale stripes, which remain the same on the screen when the model turns, and an outline. One of the
// two colours differs from any colour of the model. The model's own brightness stays visible.
const VIEWS_FRAGMENT = /* glsl */ `
if (studioView == 1) gl_FragColor.rgb = diffuseColor.rgb;
else if (studioView == 2) gl_FragColor.rgb = sRGBTransferEOTF(vec4(vec3(roughnessFactor), 1.0)).rgb;
else if (studioView == 3) gl_FragColor.rgb = sRGBTransferEOTF(vec4(vec3(metalnessFactor), 1.0)).rgb;
else if (studioView == 4) gl_FragColor.rgb = sRGBTransferEOTF(vec4(vec3(studioOcclusion), 1.0)).rgb;
else if (studioView == 5) {
  vec3 world = normalize((vec4(normal, 0.0) * viewMatrix).xyz);
  gl_FragColor.rgb = sRGBTransferEOTF(vec4(0.5 + 0.5 * world, 1.0)).rgb;
} else if (studioView == 6) {
  vec2 cell = floor(vStudioUv * 16.0);
  float check = mod(cell.x + cell.y, 2.0);
  vec3 place = vec3(fract(vStudioUv), 0.35);
  gl_FragColor.rgb = sRGBTransferEOTF(vec4(mix(place, vec3(1.0), 0.18 * check), 1.0)).rgb;
}
if (studioMaskShown > 0.0) {
  float weight = texture2D(studioMask, vStudioUv).r * studioMaskShown;
  float bright = 0.35 + 0.65 * sqrt(luminance(gl_FragColor.rgb));
  float stripe = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / studioMaskStripe) - 0.5) * studioMaskStripe;
  float pale = 1.0 - smoothstep(0.16 * studioMaskStripe - 0.7, 0.16 * studioMaskStripe + 0.7, stripe);
  vec3 veil = bright * mix(vec3(0.02, 0.13, 0.8), vec3(0.75, 0.9, 1.0), pale);
  gl_FragColor.rgb = mix(gl_FragColor.rgb, veil, 0.72 * weight);
  float edge = abs(weight - 0.5) / max(fwidth(weight), 1e-4);
  gl_FragColor.rgb = mix(gl_FragColor.rgb, vec3(1.0), 1.0 - smoothstep(0.8, 1.8, edge));
}
`;

/**
 * Makes a glTF material shade as `item3d render` does. Extensions that the renderer does not show
 * (clearcoat, transmission, ...) are left out, so that the viewer agrees with renders.
 * @param {THREE.MeshStandardMaterial} source
 * @param {SharedUniforms} shared
 */
export function studioMaterial(source, shared) {
  const material = new THREE.MeshStandardMaterial();
  THREE.MeshStandardMaterial.prototype.copy.call(material, source);
  material.userData = { mask: { value: emptyMask() }, maskShown: { value: 0 } };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, {
      studioView: shared.view,
      studioSpecular: shared.light.specular,
      studioDiffuse: shared.light.diffuse,
      studioTurn: shared.light.turn,
      studioIntensity: shared.light.intensity,
      studioMaskStripe: shared.maskStripe,
      studioMask: material.userData.mask,
      studioMaskShown: material.userData.maskShown,
    });
    shader.vertexShader = insertAfter(
      replaceOnce(shader.vertexShader, 'void main() {', 'varying vec2 vStudioUv;\nvoid main() {'),
      '#include <begin_vertex>', 'vStudioUv = uv;');
    let fragment = shader.fragmentShader;
    fragment = replaceOnce(fragment, '#include <envmap_physical_pars_fragment>', `${LEVEL}\n${LIGHT}`);
    fragment = insertAfter(fragment, '#include <lights_physical_pars_fragment>', SPECULAR);
    fragment = insertAfter(fragment, '#include <lights_physical_fragment>',
      'material.roughness = clamp(roughnessFactor, 0.03, 1.0);');
    fragment = replaceOnce(fragment, '#include <metalnessmap_fragment>', METALLIC);
    fragment = replaceOnce(fragment, '#include <lights_fragment_maps>', MAPS);
    fragment = replaceOnce(fragment, '#include <aomap_fragment>', OCCLUSION);
    fragment = insertAfter(fragment, '#include <opaque_fragment>', VIEWS_FRAGMENT);
    shader.fragmentShader = fragment;
  };
  material.customProgramCacheKey = () => 'studio';
  shareTextures(material);
  return material;
}

/** Defines which maps share one texture. Must be called after maps have changed. @param {THREE.MeshStandardMaterial} material */
export function shareTextures(material) {
  const { roughnessMap, metalnessMap, aoMap } = material;
  const one = (/** @type {THREE.Texture|null} */ map) => roughnessMap !== null && map !== null && map.source === roughnessMap.source &&
    map.channel === roughnessMap.channel && map.matrix.equals(roughnessMap.matrix);
  material.defines = { ...material.defines };
  delete material.defines.STUDIO_ONE_TEXTURE;
  delete material.defines.STUDIO_OCCLUSION_TOO;
  if (one(metalnessMap)) material.defines.STUDIO_ONE_TEXTURE = '';
  if (one(aoMap)) material.defines.STUDIO_OCCLUSION_TOO = '';
  material.needsUpdate = true;
}

/** @type {THREE.DataTexture|null} */
let empty = null;
function emptyMask() {
  if (!empty) {
    empty = new THREE.DataTexture(new Uint8Array([0, 0, 0, 255]), 1, 1);
    empty.needsUpdate = true;
  }
  return empty;
}

/** @param {string} text @param {string} from @param {string} to */
function replaceOnce(text, from, to) {
  if (!text.includes(from)) throw new Error(`three.js has no ${from}`);
  return text.replace(from, to);
}

/** @param {string} text @param {string} from @param {string} addition */
function insertAfter(text, from, addition) {
  return replaceOnce(text, from, `${from}\n${addition}`);
}

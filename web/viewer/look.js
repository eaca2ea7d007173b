// A look: the meshes of a model with one set of materials, which shade as `item3d render` does. Looks may share geometry.
// Each owns its materials and the textures that it created or loaded.
import * as THREE from '../three.js';
import { shareTextures, studioMaterial } from './shading.js';

/** Slots of a material that an edit writes, and the maps that show each. */
export const SLOTS = { base_color: ['map'], orm: ['roughnessMap', 'metalnessMap', 'aoMap'], normal: ['normalMap'] };

/** @typedef {{index: number, name: string, material: THREE.MeshStandardMaterial, meshes: THREE.Mesh[]}} LookMaterial */

export class Look {
  /**
   * @param {THREE.Object3D} root
   * @param {LookMaterial[]} materials
   * @param {Set<THREE.Texture>} textures the textures that this look disposes of
   * @param {boolean} ownsGeometry
   */
  constructor(root, materials, textures, ownsGeometry) {
    this.root = root;
    this.materials = materials;
    this.textures = textures;
    this.ownsGeometry = ownsGeometry;
    this.disposed = false;
  }

  /**
   * Loads a look.
   * @param {string} url address of a .glb
   * @param {import('./shading.js').SharedUniforms} shared
   */
  static async load(url, shared) {
    const gltf = await new THREE.GLTFLoader().loadAsync(url);
    const { associations, json } = gltf.parser;
    /** @type {Map<THREE.Material, LookMaterial>} */
    const found = new Map();
    const textures = new Set();
    gltf.scene.traverse((object) => {
      const at = associations.get(object);
      if (at?.nodes !== undefined) object.userData.node = json.nodes[at.nodes].name ?? '';
      if (!(object instanceof THREE.Mesh)) return;
      const original = /** @type {THREE.MeshStandardMaterial} */ (object.material);
      let entry = found.get(original);
      if (!entry) {
        const index = associations.get(original)?.materials ?? 0;
        entry = { index, name: json.materials?.[index]?.name ?? original.name, material: studioMaterial(original, shared), meshes: [] };
        for (const map of texturesOf(entry.material)) {
          map.anisotropy = shared.anisotropy;
          textures.add(map);
        }
        found.set(original, entry);
      }
      object.material = entry.material;
      object.userData.material = entry.index;
      object.userData.materialName = entry.name;
      entry.meshes.push(object);
    });
    gltf.scene.updateMatrixWorld(true);
    return new Look(gltf.scene, [...found.values()], textures, true);
  }

  /** Returns a look that shares this one's geometry and, until they are replaced, its textures. @param {import('./shading.js').SharedUniforms} shared */
  copy(shared) {
    /** @type {Map<THREE.Material, LookMaterial>} */
    const copies = new Map(this.materials.map((entry) =>
      [entry.material, { ...entry, material: studioMaterial(entry.material, shared), meshes: [] }]));
    const root = this.root.clone(true);
    root.traverse((object) => {
      if (!(object instanceof THREE.Mesh)) return;
      const entry = copies.get(/** @type {THREE.Material} */ (object.material));
      if (!entry) return;
      object.material = entry.material;
      entry.meshes.push(object);
    });
    root.updateMatrixWorld(true);
    return new Look(root, [...copies.values()], new Set(), false);
  }

  /** Returns true if both looks have the same triangles and UV maps, so that textures of one fit the other. @param {Look} other */
  sharesSurface(other) {
    const mine = this.materials.flatMap((entry) => entry.meshes);
    const theirs = other.materials.flatMap((entry) => entry.meshes);
    return mine.length === theirs.length && mine.every((mesh, i) => sameSurface(mesh.geometry, theirs[i].geometry));
  }

  /** @param {number} index */
  material(index) {
    return this.materials.filter((entry) => entry.index === index);
  }

  /**
   * Puts an image into a slot of a material. If this look owns a texture of the same size there, the texture gets the image.
   * Otherwise a new texture replaces it.
   * @param {number} index the material's index @param {'base_color'|'orm'|'normal'} slot @param {ImageBitmap} image
   */
  setImage(index, slot, image) {
    for (const { material } of this.material(index)) {
      const maps = /** @type {any} */ (material);
      const old = /** @type {THREE.Texture|null} */ (maps[SLOTS[slot][0]]);
      const owned = old && this.textures.has(old);
      if (owned && old.image.width === image.width && old.image.height === image.height) {
        old.image.close?.();
        old.image = image;
        old.needsUpdate = true;
        continue;
      }
      const texture = old ? old.clone() : new THREE.Texture();
      texture.source = new THREE.Source(image);
      texture.flipY = false;
      texture.colorSpace = slot === 'base_color' ? THREE.SRGBColorSpace : THREE.NoColorSpace;
      if (!old) texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
      texture.generateMipmaps = true;
      texture.minFilter = THREE.LinearMipmapLinearFilter;
      texture.needsUpdate = true;
      this.putTexture(material, slot, texture);
      this.textures.add(texture);
    }
  }

  /**
   * @param {THREE.MeshStandardMaterial} material @param {'base_color'|'orm'|'normal'} slot
   * @param {THREE.Texture} texture holds the final values, so the material's factors become 1
   */
  putTexture(material, slot, texture) {
    const maps = /** @type {any} */ (material);
    for (const name of SLOTS[slot]) {
      const old = maps[name];
      maps[name] = texture;
      if (old && this.textures.has(old) && !texturesOf(material).includes(old)) {
        this.textures.delete(old);
        old.dispose();
        old.image?.close?.();
      }
    }
    if (slot === 'base_color') material.color.set(0xffffff);
    if (slot === 'orm') material.roughness = material.metalness = 1;
    shareTextures(material);
  }

  /** Shows the veil. @param {Map<number, THREE.Texture>} masks masks by material; the veil covers white texels */
  showMask(masks) {
    for (const { index, material } of this.materials) {
      const mask = masks.get(index);
      if (mask) material.userData.mask.value = mask;
      material.userData.maskShown.value = mask ? 1 : 0;
    }
  }

  dispose() {
    if (this.disposed) return;
    this.disposed = true;
    for (const texture of this.textures) {
      texture.dispose();
      texture.image?.close?.();
    }
    for (const { material, meshes } of this.materials) {
      material.dispose();
      if (this.ownsGeometry) for (const mesh of meshes) mesh.geometry.dispose();
    }
    this.root.removeFromParent();
  }
}

/** @param {THREE.MeshStandardMaterial} material */
export function texturesOf(material) {
  const { map, roughnessMap, metalnessMap, aoMap, normalMap, emissiveMap } = material;
  return [...new Set([map, roughnessMap, metalnessMap, aoMap, normalMap, emissiveMap])]
    .filter((texture) => texture !== null);
}

/** @param {THREE.BufferGeometry} a @param {THREE.BufferGeometry} b */
function sameSurface(a, b) {
  for (const name of ['position', 'uv']) {
    const one = a.getAttribute(name), other = b.getAttribute(name);
    if (!one !== !other) return false;
    if (!one) continue;
    if (one.count !== other.count) return false;
    const step = Math.max(1, Math.floor(one.count / 64));
    for (let i = 0; i < one.count; i += step)
      if (Math.abs(one.getX(i) - other.getX(i)) > 1e-5 || Math.abs(one.getY(i) - other.getY(i)) > 1e-5) return false;
  }
  return (a.index?.count ?? 0) === (b.index?.count ?? 0);
}

/** Views of a material. The shader uses their indices (shading.js). */
export const VIEWS = ['shaded', 'base_color', 'roughness', 'metallic', 'occlusion', 'normal', 'uv'];

/** Views of a material; the index is the shader's (shading.js). */
export const VIEWS = ['shaded', 'base_color', 'roughness', 'metallic', 'occlusion', 'normal', 'uv'];

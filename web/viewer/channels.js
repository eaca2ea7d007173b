// Channels of a layer, named as in `item3d layers`. They have a module of their own that does not need three.js.
export const CHANNELS = ['base_color', 'roughness', 'metallic', 'occlusion', 'normal'];

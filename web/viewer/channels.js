// Channels of a layer, by the names of `item3d layers`. A module of its own: it needs no three.js.
export const CHANNELS = ['base_color', 'roughness', 'metallic', 'occlusion', 'normal'];

// The parts of three.js that the studio uses. The server has the package beside app/, as three/.
export * from '../three/three.module.min.js';
export { GLTFLoader } from '../three/addons/loaders/GLTFLoader.js';
export { HDRLoader } from '../three/addons/loaders/HDRLoader.js';
export { OrbitControls } from '../three/addons/controls/OrbitControls.js';

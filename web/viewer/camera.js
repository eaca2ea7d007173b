// Cameras with the lens, the default view and the framing of `item3d render`.
import * as THREE from '../three.js';

export const DEFAULT_VIEW = { azimuth: 35, elevation: 18 };
const FIELD_OF_VIEW = 30; // degrees, along the image's shorter side
const FREE = 5 / 6; // a twelfth of the image stays free on each side

/**
 * Sets the aspect, and the vertical field of view so that the shorter side spans FIELD_OF_VIEW.
 * @param {THREE.PerspectiveCamera} camera @param {number} aspect
 */
export function setAspect(camera, aspect) {
  const half = Math.tan(THREE.MathUtils.degToRad(FIELD_OF_VIEW / 2));
  camera.aspect = aspect;
  camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(aspect >= 1 ? half : half / aspect));
  camera.updateProjectionMatrix();
}

/**
 * Moves the camera so that all points are in the image, as large as possible and centred.
 * @param {THREE.PerspectiveCamera} camera whose aspect is set
 * @param {Float32Array} points x, y and z of each point @param {number} azimuth @param {number} elevation in degrees
 * @returns {THREE.Vector3} the camera's target
 */
export function frame(camera, points, azimuth = DEFAULT_VIEW.azimuth, elevation = DEFAULT_VIEW.elevation) {
  const az = THREE.MathUtils.degToRad(azimuth), el = THREE.MathUtils.degToRad(elevation);
  const back = new THREE.Vector3(Math.sin(az) * Math.cos(el), Math.sin(el), Math.cos(az) * Math.cos(el));
  const right = new THREE.Vector3(Math.cos(az), 0, -Math.sin(az));
  const up = new THREE.Vector3().crossVectors(back, right);
  const slopeY = Math.tan(THREE.MathUtils.degToRad(camera.fov / 2)) * FREE;
  const slopeX = slopeY * camera.aspect;
  const box = boundsOf(points);
  const centre = box.getCenter(new THREE.Vector3());
  const reach = [-Infinity, -Infinity, -Infinity, -Infinity];
  const p = new THREE.Vector3();
  for (let i = 0; i < points.length; i += 3) {
    p.fromArray(points, i).sub(centre);
    const x = p.dot(right) / slopeX, y = p.dot(up) / slopeY, z = p.dot(back);
    reach[0] = Math.max(reach[0], x + z);
    reach[1] = Math.max(reach[1], -x + z);
    reach[2] = Math.max(reach[2], y + z);
    reach[3] = Math.max(reach[3], -y + z);
  }
  const size = Math.max(box.getSize(p).length(), 1e-6);
  const distance = Math.max((reach[0] + reach[1]) / 2, (reach[2] + reach[3]) / 2, 1e-3 * size);
  const target = centre.clone()
    .addScaledVector(right, (reach[0] - reach[1]) / 2 * slopeX)
    .addScaledVector(up, (reach[2] - reach[3]) / 2 * slopeY);
  camera.position.copy(target).addScaledVector(back, distance);
  camera.near = Math.max(distance - size, distance / 200);
  camera.far = distance + 4 * size;
  camera.up.set(0, 1, 0);
  camera.lookAt(target);
  camera.updateProjectionMatrix();
  return target;
}

/** @param {Float32Array} points */
export function boundsOf(points) {
  const box = new THREE.Box3();
  const p = new THREE.Vector3();
  for (let i = 0; i < points.length; i += 3) box.expandByPoint(p.fromArray(points, i));
  return box;
}

/** Returns the world positions of all vertices. @param {THREE.Object3D} root */
export function pointsOf(root) {
  /** @type {number[]} */
  const points = [];
  const p = new THREE.Vector3();
  root.traverse((object) => {
    if (!(object instanceof THREE.Mesh)) return;
    const positions = object.geometry.getAttribute('position');
    for (let i = 0; i < positions.count; ++i) {
      p.fromBufferAttribute(positions, i).applyMatrix4(object.matrixWorld);
      points.push(p.x, p.y, p.z);
    }
  });
  return new Float32Array(points);
}

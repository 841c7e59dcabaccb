// Geometry of the world: poses as matrices, bands along lines, and freeing graphics memory.

import { BufferAttribute, BufferGeometry, Matrix4, Quaternion, Vector3 } from "../../vendor/three/three.js";

/** @typedef {import("./frames.js").Pose} Pose */

export const UNIT = new Vector3(1, 1, 1);

/**
 * Create flat bands along lines, as if painted on the ground.
 * @param {[number, number, number][][]} strips
 * @param {number} width [m]
 */
export function ribbonOf(strips, width) {
  /** @type {number[]} */
  const places = [];
  for (const strip of strips) {
    const sides = strip.map((_, index) => edges(strip, index, width / 2));
    for (let index = 1; index < sides.length; index += 1) {
      const [a = [], b = []] = sides[index - 1] ?? [];
      const [c = [], d = []] = sides[index] ?? [];
      places.push(...a, ...b, ...c, ...b, ...d, ...c);
    }
  }
  const normals = new Float32Array(places.length);
  for (let index = 2; index < normals.length; index += 3) normals[index] = 1;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3));
  return geometry;
}

/**
 * Return the two edges of a band at one of its points.
 * @param {[number, number, number][]} strip
 * @param {number} index
 * @param {number} half
 */
function edges(strip, index, half) {
  const [x, y, z] = /** @type {[number, number, number]} */ (strip[index]);
  const last = strip.length - 1;
  const isLoop = last > 2 && Math.hypot(...difference(strip[0], strip[last])) < 1e-6;
  const before = strip[index - 1] ?? (isLoop ? strip[last - 1] : strip[index]);
  const after = strip[index + 1] ?? (isLoop ? strip[1] : strip[index]);
  const [dx, dy] = difference(after, before);
  const length = Math.hypot(/** @type {number} */ (dx), /** @type {number} */ (dy)) || 1;
  const [sx, sy] = [(-(/** @type {number} */ (dy)) / length) * half, (/** @type {number} */ (dx) / length) * half];
  return [
    [x - sx, y - sy, z],
    [x + sx, y + sy, z],
  ];
}

/**
 * @param {number[] | undefined} a
 * @param {number[] | undefined} b
 */
function difference(a = [0, 0, 0], b = [0, 0, 0]) {
  return a.map((value, index) => value - /** @type {number} */ (b[index]));
}

/** @param {Pose} pose */
export function matrixOf([x, y, z, qx, qy, qz, qw]) {
  const turn = new Quaternion(qx, qy, qz, qw);
  if (turn.lengthSq() === 0) turn.w = 1; // like rviz, read an all-zero rotation as none
  return new Matrix4().compose(new Vector3(x, y, z), turn.normalize(), UNIT);
}

/**
 * @param {ArrayLike<number>} numbers
 * @returns {[number, number, number][]}
 */
export function triples(numbers) {
  /** @type {[number, number, number][]} */
  const found = [];
  for (let index = 0; index + 2 < numbers.length; index += 3) {
    found.push([
      /** @type {number} */ (numbers[index]),
      /** @type {number} */ (numbers[index + 1]),
      /** @type {number} */ (numbers[index + 2]),
    ]);
  }
  return found;
}

/**
 * Free the graphics memory of an object and its children.
 * @param {any} object
 */
export function dispose(object) {
  object.traverse((/** @type {any} */ one) => {
    one.geometry?.dispose();
    one.material?.map?.dispose();
    one.material?.dispose();
  });
  object.removeFromParent();
}

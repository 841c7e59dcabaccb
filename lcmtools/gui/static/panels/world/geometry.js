// Geometry of the world: poses as matrices, bands along lines, and freeing graphics memory.

import * as THREE from "../../vendor/three/three.js";

/** @typedef {import("./frames.js").Pose} Pose */

const OLD = "#8d9196"; // of what has not been heard of for some time
export const UNIT = new THREE.Vector3(1, 1, 1);

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
  return geometryOf({ position: new Float32Array(places), normal: normals });
}

/**
 * Create a geometry from its attributes, which have three numbers for each corner.
 * @param {Record<string, Float32Array>} attributes
 */
export function geometryOf(attributes) {
  const geometry = new THREE.BufferGeometry();
  for (const [name, numbers] of Object.entries(attributes)) {
    geometry.setAttribute(name, new THREE.BufferAttribute(numbers, 3));
  }
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
  const [dx = 0, dy = 0] = difference(after, before);
  const length = Math.hypot(dx, dy) || 1;
  const [sx, sy] = [(-dy / length) * half, (dx / length) * half];
  return [
    [x - sx, y - sy, z],
    [x + sx, y + sy, z],
  ];
}

/** @param {number[] | undefined} a @param {number[] | undefined} b */
function difference(a = [0, 0, 0], b = [0, 0, 0]) {
  return a.map((value, index) => value - /** @type {number} */ (b[index]));
}

/** @param {Pose} pose */
export function matrixOf([x, y, z, qx, qy, qz, qw]) {
  const turn = new THREE.Quaternion(qx, qy, qz, qw);
  return new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), turn.normalize(), UNIT);
}

/** @param {ArrayLike<number>} numbers */
export function triples(numbers) {
  const all = Array.from(numbers);
  const starts = Array.from({ length: Math.floor(all.length / 3) }, (_, index) => 3 * index);
  return starts.map((start) => /** @type {[number, number, number]} */ (all.slice(start, start + 3)));
}

/**
 * Draw an object and its children in grey, or in their own colours again; not the ground.
 * @param {any} object
 * @param {boolean} isOld
 */
export function setOld(object, isOld) {
  object.traverse((/** @type {any} */ one) => {
    if (!one.material || object.userData.isGround) return;
    if (one.userData.own) {
      one.material = one.userData.own;
      delete one.userData.own;
    }
    if (!isOld) return;
    one.userData.own = one.material;
    one.material = Object.assign(one.material.clone(), { onBeforeCompile: one.material.onBeforeCompile });
    one.material.color?.set(OLD);
    one.material.vertexColors = false;
  });
}

/**
 * Free the graphics memory of an object and its children. Materials have none but their program, which
 * three.js would delete with the last of them, and translate again for the next message.
 * @param {any} object
 */
export function dispose(object) {
  object.traverse((/** @type {any} */ one) => {
    one.geometry?.dispose();
    (one.userData.own ?? one.material)?.map?.dispose();
  });
  object.removeFromParent();
}

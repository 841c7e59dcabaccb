// The trail of an odometry: a band that grows step by step, without making the whole anew.

import * as THREE from "../../vendor/three/three.js";
import { bandMaterial } from "./drawings.js";
import { ribbonOf } from "./geometry.js";

const MOST = 4000; // steps
const STEP = 0.03; // [m]
const JUMP = 1; // [m] that a robot does not drive between two messages: it was moved elsewhere
const WIDTH = 0.035; // [m]
const NUMBERS = 18; // of a step's two triangles

/** A trail in one fixed frame. */
export class Trail {
  /** @param {string} fixed @param {string} color */
  constructor(fixed, color) {
    this.fixed = fixed;
    /** The last places. @type {[number, number, number][]} */
    this.last = [];
    this.count = 0;
    this.position = new THREE.BufferAttribute(new Float32Array(MOST * NUMBERS), 3);
    const geometry = new THREE.BufferGeometry().setAttribute("position", this.position);
    geometry.setDrawRange(0, 0);
    this.mesh = Object.assign(new THREE.Mesh(geometry, bandMaterial(color, 0.75)), { frustumCulled: false, renderOrder: 2 });
  }

  /** @param {[number, number, number]} at */
  add(at) {
    const last = this.last.at(-1) ?? at;
    const way = Math.hypot(at[0] - last[0], at[1] - last[1]);
    if (this.last.length && way < STEP) return;
    if (way > JUMP) {
      Object.assign(this, { last: [], count: 0 });
      this.mesh.geometry.setDrawRange(0, 0);
    }
    this.last = [...this.last.slice(-2), at];
    if (this.last.length > 1) this.write(ribbonOf([this.last], WIDTH).attributes.position.array);
  }

  /**
   * Write the last step, and again the one before, which now ends at an angle.
   * @param {Float32Array} corners
   */
  write(corners) {
    const { array } = this.position;
    if (this.count === MOST) {
      array.copyWithin(0, array.length / 2);
      this.count /= 2;
      this.position.addUpdateRange(0, array.length);
    }
    this.count += 1;
    const end = this.count * NUMBERS;
    array.set(corners, end - corners.length);
    this.position.addUpdateRange(end - corners.length, corners.length);
    this.position.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, end / 3);
  }
}

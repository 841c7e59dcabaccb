// Frames as axes with names: x red, y green, z blue; grey where nothing has been heard for some time.

import * as THREE from "../../vendor/three/three.js";
import { dispose, matrixOf } from "./geometry.js";
import { label } from "./shapes.js";

const LENGTH = 0.3; // [m]
const WIDTH = 0.012;
const TEXT = 0.06;
const COLORS = ["#e0322c", "#2ca02c", "#2a62e0"].map((one) => new THREE.Color(one));
const OLD = new THREE.Color("#8d9196");
const NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0);
/** @type {[number, number, number, number]} */
const WHITE = [1, 1, 1, 1];

/** The axes of all frames. */
export class Axes {
  /** @param {any} scene */
  constructor(scene) {
    this.group = new THREE.Group();
    this.group.renderOrder = 10;
    scene.add(this.group);
    this.key = "";
    /** One for each axis. @type {any[]} */
    this.meshes = [];
    /** @type {any[]} */
    this.labels = [];
  }

  /**
   * Place the axes at a time; those of frames that nothing connects with the fixed one are not shown.
   * @param {import("./frames.js").Frames | null} frames null to show none
   * @param {string} fixed
   * @param {number} now [ms]
   */
  place(frames, fixed, now) {
    const names = frames?.names() ?? [];
    if (names.join("\n") !== this.key) this.make(names);
    names.forEach((name, index) => {
      const pose = frames?.pose(name, fixed, now);
      const isOld = frames?.isOld(name);
      const matrix = pose ? matrixOf(pose) : NOWHERE;
      this.meshes.forEach((mesh, axis) => {
        mesh.setMatrixAt(index, matrix);
        mesh.setColorAt(index, isOld ? OLD : COLORS[axis]);
      });
      this.labels[index].visible = Boolean(pose);
      if (pose) this.labels[index].position.set(pose[0], pose[1], pose[2] + TEXT);
    });
    for (const { instanceMatrix, instanceColor } of this.meshes) instanceMatrix.needsUpdate = instanceColor.needsUpdate = true;
  }

  /** @param {string[]} names */
  make(names) {
    this.key = names.join("\n");
    for (const child of [...this.group.children]) dispose(child);
    this.labels = names.map((text) => label({ text, pose: [0, 0, 0, 0, 0, 0, 1], scale: [0, 0, TEXT], color: WHITE }));
    this.meshes = names.length ? COLORS.map((_, axis) => bars(axis, names.length)) : [];
    if (names.length) this.group.add(...this.meshes, ...this.labels);
    for (const { material } of this.group.children) material.depthTest = false; // frames are inside of bodies
  }
}

/** @param {number} axis 0 for x @param {number} count */
function bars(axis, count) {
  const sizes = [0, 1, 2].map((one) => (one === axis ? LENGTH : WIDTH));
  const shape = new THREE.BoxGeometry(...sizes).translate(...sizes.map((size, one) => (one === axis ? size / 2 : 0)));
  const material = new THREE.MeshBasicMaterial({ toneMapped: false, transparent: true });
  return Object.assign(new THREE.InstancedMesh(shape, material, count), { frustumCulled: false });
}

// The camera of the world: its target, the body that it follows, and its keys.

import { heading } from "./frames.js";

const KEYS = /** @type {Record<string, [number, number, number]>} */ ({
  ArrowLeft: [-0.1, 0, 1],
  ArrowRight: [0.1, 0, 1],
  ArrowUp: [0, 0.07, 1],
  ArrowDown: [0, -0.07, 1],
  "+": [0, 0, 0.9],
  "=": [0, 0, 0.9],
  "-": [0, 0, 1 / 0.9],
});

/**
 * The camera's pose, which is saved between runs, and the body that it follows.
 * @typedef {{position: number[], target: number[], beside?: import("./frames.js").Pose | null}} Saved with the
 *   pose of the followed body
 */
export class Camera {
  /**
   * @param {import("./view.js").View} view
   * @param {import("./bodies.js").Bodies} bodies
   * @param {{follow: string | null, camera: Saved | null}} kept the settings; null follows the first robot
   * @param {() => void} changed called when the settings have changed
   */
  constructor(view, bodies, kept, changed) {
    this.view = view;
    this.bodies = bodies;
    this.kept = kept;
    this.changed = changed;
    const { position, target, beside } = /** @type {any} */ (kept.camera ?? {});
    /** The last pose of the followed body. @type {import("./frames.js").Pose | null} */
    this.followed = areFinite(beside, 7) ? beside : null;
    this.hasLooked = areFinite(position, 3) && areFinite(target, 3);
    if (this.hasLooked) view.lookAt(position, target);
    view.controls.addEventListener("end", () => this.keep());
  }

  /** Move with the followed body, unless the pointer drags it. @param {number} now [ms] */
  follow(now) {
    const pose = this.bodies.poseNamed(this.name, now);
    if (pose && this.followed && this.view.controls.enabled) {
      this.view.shift(pose[0] - this.followed[0], pose[1] - this.followed[1], pose[2] - this.followed[2]);
    }
    const isFirst = pose && !this.followed;
    this.followed = pose ?? this.followed;
    if (isFirst && this.hasLooked) this.keep(); // the view was chosen before the body was known
  }

  /** The name of the followed body, "" for none. */
  get name() {
    return this.kept.follow ?? this.bodies.robot();
  }

  /** @param {string} name "" for none */
  setFollowed(name) {
    this.kept.follow = name;
    this.followed = null;
    if (name) this.lookAt(name);
    this.changed();
  }

  /** Look at the followed body, or else the first one, from behind. */
  reset() {
    const now = performance.now();
    const pose = this.bodies.poseNamed(this.name, now) ?? this.bodies.poseOf(this.bodies.list()[0], now);
    this.hasLooked = true;
    this.view.lookFromBehind(pose ? [pose[0], pose[1], 0.3] : [0, 0, 0.3], pose ? heading(pose) : 0);
    this.keep();
  }

  lookFromAbove() {
    this.view.lookFromAbove();
    this.keep();
  }

  /** @param {string} name of a body */
  lookAt(name) {
    const pose = this.bodies.poseNamed(name, performance.now());
    if (!pose) return;
    const { target } = this.view.controls;
    this.view.shift(pose[0] - target.x, pose[1] - target.y, 0.2 - target.z);
    this.view.invalidate();
    this.keep();
  }

  keep() {
    const { camera, controls } = this.view;
    const [position, target] = [camera.position, controls.target].map((place) =>
      place.toArray().map((/** @type {number} */ value) => Math.round(value * 1000) / 1000),
    );
    this.kept.camera = { position, target, beside: this.bodies.poseNamed(this.name, performance.now()) };
    this.changed();
  }

  /** @param {KeyboardEvent} event */
  press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const turn = KEYS[event.key];
    if (turn) this.view.move(...turn);
    else if (event.key === "Home") this.reset();
    else if (event.key === "t") this.lookFromAbove();
    else return;
    event.preventDefault();
    this.keep();
  }
}

/**
 * Return whether saved numbers are as many as they must be, and finite.
 * @param {any} numbers
 * @param {number} count
 */
function areFinite(numbers, count) {
  return Array.isArray(numbers) && numbers.length === count && numbers.every(Number.isFinite);
}

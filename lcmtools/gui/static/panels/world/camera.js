// The camera of the world: its target, the body that it follows, and its keys.

const KEYS = /** @type {Record<string, [number, number, number]>} */ ({
  ArrowLeft: [-0.1, 0, 1],
  ArrowRight: [0.1, 0, 1],
  ArrowUp: [0, 0.07, 1],
  ArrowDown: [0, -0.07, 1],
  "+": [0, 0, 0.9],
  "=": [0, 0, 0.9],
  "-": [0, 0, 1 / 0.9],
});

/** The camera's pose, which is saved between runs. */
export class Camera {
  /**
   * @param {import("./view.js").View} view
   * @param {import("./bodies.js").Bodies} bodies
   * @param {{follow: string, camera: {position: number[], target: number[]} | null}} kept the settings
   * @param {() => void} changed called when the settings have changed
   */
  constructor(view, bodies, kept, changed) {
    this.view = view;
    this.bodies = bodies;
    this.kept = kept;
    this.changed = changed;
    /** The last pose of the followed body. @type {import("./frames.js").Pose | null} */
    this.followed = null;
    this.hasLooked = Boolean(kept.camera);
    if (kept.camera) view.lookAt(kept.camera.position, kept.camera.target);
    view.controls.addEventListener("end", () => this.keep());
  }

  /**
   * Move with the followed body, unless the pointer drags it.
   * @param {number} now [ms]
   */
  follow(now) {
    const pose = this.kept.follow ? this.bodies.poseNamed(this.kept.follow, now) : null;
    if (pose && this.followed && this.view.controls.enabled) {
      this.view.shift(pose[0] - this.followed[0], pose[1] - this.followed[1], pose[2] - this.followed[2]);
    }
    this.followed = pose;
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
    const pose = this.bodies.poseNamed(this.kept.follow, now) ?? this.bodies.poseOf(this.bodies.list()[0], now);
    this.hasLooked = true;
    this.view.lookFromBehind(pose ? [pose[0], pose[1], 0.3] : [0, 0, 0.3]);
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
    this.keep();
  }

  keep() {
    const { camera, controls } = this.view;
    this.kept.camera = { position: camera.position.toArray().map(rounded), target: controls.target.toArray().map(rounded) };
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

/** @param {number} value */
const rounded = (value) => Math.round(value * 1000) / 1000;

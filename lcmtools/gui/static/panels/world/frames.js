// The tree of frames, with poses interpolated between messages. Must not know drawing.

const DELAY = 60; // [ms] behind the newest pose, so that there is a pose on each side
const KEPT = 4;
const DEEPEST = 50;

/**
 * @typedef {[number, number, number, number, number, number, number]} Pose position [m] and quaternion
 * @typedef {{time: number, pose: Pose}} Sample
 * @typedef {{parent: string, source: string, samples: Sample[]}} Frame
 */

/** @type {Pose} */
const HERE = [0, 0, 0, 0, 0, 0, 1];

/** A tree of frames. */
export class Frames {
  constructor() {
    /** @type {Map<string, Frame>} */
    this.frames = new Map();
    /** @type {Map<string, Pose>} */
    this.held = new Map();
  }

  /**
   * Add a frame's pose in its parent. An odometry's pose counts only without a transform.
   * @param {string} source the topic
   * @param {string} parent
   * @param {string} child
   * @param {Pose} pose
   * @param {number} now [ms]
   * @param {boolean} isWeak
   */
  add(source, parent, child, pose, now, isWeak = false) {
    let frame = this.frames.get(child);
    if (isWeak && frame && frame.source !== source) return;
    if (!frame || frame.parent !== parent) {
      frame = { parent, source, samples: [] };
      this.frames.set(child, frame);
    }
    frame.source = source;
    frame.samples.push({ time: now, pose });
    if (frame.samples.length > KEPT) frame.samples.shift();
  }

  /**
   * Remove the frames of a topic.
   * @param {string} source
   */
  drop(source) {
    for (const [name, frame] of this.frames) if (frame.source === source) this.frames.delete(name);
  }

  /**
   * Override a frame's pose, as while it is dragged, until it is released (null).
   * @param {string} name
   * @param {Pose | null} pose in its parent
   */
  hold(name, pose) {
    if (pose) this.held.set(name, pose);
    else this.held.delete(name);
  }

  /**
   * Return the names of frames and parents.
   * @returns {string[]}
   */
  names() {
    const found = new Set(this.frames.keys());
    for (const { parent } of this.frames.values()) found.add(parent);
    return [...found].sort();
  }

  /**
   * Return the root with the most descendants, or "world" if that is a root.
   * @returns {string}
   */
  root() {
    /** @type {Map<string, number>} */
    const counts = new Map();
    for (const name of this.frames.keys()) {
      const root = this.rootOf(name);
      counts.set(root, (counts.get(root) ?? 0) + (root === "world" ? 1e6 : 1));
    }
    return [...counts].sort((a, b) => b[1] - a[1])[0]?.[0] ?? "world";
  }

  /** @param {string} name */
  rootOf(name) {
    for (let depth = 0; depth < DEEPEST; depth += 1) {
      const parent = this.frames.get(name)?.parent;
      if (parent === undefined) break;
      name = parent;
    }
    return name;
  }

  /**
   * Return a frame's pose in another frame at a time; null if they are not connected.
   * @param {string} name
   * @param {string} fixed
   * @param {number} now [ms]
   * @returns {Pose | null}
   */
  pose(name, fixed, now) {
    if (name === fixed) return HERE;
    if (this.rootOf(name) !== this.rootOf(fixed)) return null;
    return product(inverse(this.inRoot(fixed, now)), this.inRoot(name, now));
  }

  /**
   * @param {string} name
   * @param {number} now
   * @returns {Pose}
   */
  inRoot(name, now) {
    /** @type {Pose} */
    let pose = HERE;
    for (let depth = 0; depth < DEEPEST; depth += 1) {
      const frame = this.frames.get(name);
      if (!frame) break;
      pose = product(this.held.get(name) ?? between(frame.samples, now - DELAY), pose);
      name = frame.parent;
    }
    return pose;
  }
}

/**
 * Return the pose at a time, interpolated between samples.
 * @param {Sample[]} samples
 * @param {number} time
 * @returns {Pose}
 */
function between(samples, time) {
  let after = samples.length - 1;
  while (after > 0 && /** @type {Sample} */ (samples[after - 1]).time > time) after -= 1;
  const next = /** @type {Sample} */ (samples[after]);
  const before = samples[after - 1];
  if (!before || time >= next.time) return next.pose;
  const share = Math.max(0, (time - before.time) / (next.time - before.time));
  return mixed(before.pose, next.pose, share);
}

/**
 * @param {Pose} a
 * @param {Pose} b
 * @param {number} share of b
 * @returns {Pose}
 */
export function mixed(a, b, share) {
  const dot = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6];
  const sign = dot < 0 ? -1 : 1;
  const found = /** @type {Pose} */ (
    a.map((value, index) => value + ((index < 3 ? 1 : sign) * /** @type {number} */ (b[index]) - value) * share)
  );
  const length = Math.hypot(found[3], found[4], found[5], found[6]) || 1;
  for (let index = 3; index < 7; index += 1) found[index] = /** @type {number} */ (found[index]) / length;
  return found;
}

/**
 * Compose two poses: return `inner`, given in the frame at `outer`, in the frame of `outer`.
 * @param {Pose} outer
 * @param {Pose} inner
 * @returns {Pose}
 */
export function product(outer, inner) {
  const [x, y, z] = rotated(outer, inner[0], inner[1], inner[2]);
  const [, , , ax, ay, az, aw] = outer;
  const [, , , bx, by, bz, bw] = inner;
  return [
    outer[0] + x,
    outer[1] + y,
    outer[2] + z,
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

/**
 * @param {Pose} pose
 * @returns {Pose}
 */
export function inverse([x, y, z, qx, qy, qz, qw]) {
  /** @type {Pose} */
  const turn = [0, 0, 0, -qx, -qy, -qz, qw];
  const [bx, by, bz] = rotated(turn, -x, -y, -z);
  return [bx, by, bz, -qx, -qy, -qz, qw];
}

/**
 * @param {Pose} pose of which only the rotation is used
 * @param {number} x
 * @param {number} y
 * @param {number} z
 * @returns {[number, number, number]}
 */
function rotated([, , , qx, qy, qz, qw], x, y, z) {
  const tx = 2 * (qy * z - qz * y);
  const ty = 2 * (qz * x - qx * z);
  const tz = 2 * (qx * y - qy * x);
  return [
    x + qw * tx + qy * tz - qz * ty,
    y + qw * ty + qz * tx - qx * tz,
    z + qw * tz + qx * ty - qy * tx,
  ];
}

/**
 * Return the heading of a pose [rad].
 * @param {Pose} pose
 */
export function heading([, , , x, y, z, w]) {
  return Math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z));
}

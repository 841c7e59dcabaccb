// The tree of frames, with poses interpolated between messages. Must not know drawing.

const DELAY = 60; // [ms] behind the newest pose, so that there is a pose on each side
const KEPT = 4;
const DEEPEST = 50;
const STILL = 1e-5; // [m], and of a quaternion: a robot at rest in a simulator moves less

/**
 * @typedef {[number, number, number, number, number, number, number]} Pose position [m] and quaternion
 * @typedef {{time: number, pose: Pose}} Sample
 * @typedef {{name: string, parent: string, source: string, samples: Sample[], isOld?: boolean}} Frame
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
    /** The topics that have fallen silent. @type {Set<string>} */
    this.silent = new Set();
  }

  /**
   * Add a frame's pose in its parent; return true if it differs from the last one. An odometry's pose
   * counts only without a transform.
   * @param {string} source the topic
   * @param {string} parent
   * @param {string} child
   * @param {Pose} pose
   * @param {number} now [ms]
   * @param {boolean} isWeak
   */
  add(source, parent, child, pose, now, isWeak = false) {
    let frame = this.frames.get(child);
    if (isWeak && frame && frame.source !== source) return false;
    if (!frame || frame.parent !== parent) {
      frame = { name: child, parent, source, samples: [] };
      this.frames.set(child, frame);
    }
    frame.source = source;
    const last = frame.samples.at(-1)?.pose;
    frame.samples.push({ time: now, pose });
    if (frame.samples.length > KEPT) frame.samples.shift();
    return !last || last.some((value, index) => Math.abs(value - /** @type {number} */ (pose[index])) > STILL);
  }

  /**
   * Return true if a frame's place is old: what says it, or a parent's, has fallen silent.
   * @param {string} name
   */
  isOld(name) {
    return this.chain(name).some(({ source, isOld }) => isOld ?? this.silent.has(source));
  }

  /**
   * Take all frames that a topic has now; return true if one of them moves or has become old.
   * @param {string} source the topic
   * @param {{frames: [parent: string, child: string][], old: string[]}} data
   * @param {number[]} poses one after the other
   * @param {number} now [ms]
   */
  replace(source, { frames, old }, poses, now) {
    let hasChanged = false;
    frames.forEach(([parent, child], index) => {
      const pose = /** @type {Pose} */ (poses.slice(7 * index, 7 * index + 7));
      hasChanged = this.add(source, parent, child, pose, now) || hasChanged;
    });
    const names = new Set(frames.map(([, child]) => child));
    for (const [name, frame] of this.frames) {
      if (frame.source !== source) continue;
      const isOld = old.includes(name);
      hasChanged ||= Boolean(frame.isOld) !== isOld;
      frame.isOld = isOld;
      if (!names.has(name)) this.frames.delete(name);
    }
    return hasChanged;
  }

  /** Return a frame and its parents, up to the root's child. @param {string} name */
  chain(name) {
    /** @type {Frame[]} */
    const found = [];
    for (let frame = this.frames.get(name); frame && found.length < DEEPEST; frame = this.frames.get(frame.parent)) {
      found.push(frame);
    }
    return found;
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

  /** Return the names of frames and parents. */
  names() {
    return [...new Set([...this.frames.values()].flatMap(({ name, parent }) => [name, parent]))].sort();
  }

  /** Return the root with the most descendants, or "world" if that is a root. */
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
    return this.chain(name).at(-1)?.parent ?? name;
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

  /** @param {string} name @param {number} now @returns {Pose} */
  inRoot(name, now) {
    return this.chain(name).reduce(
      (pose, frame) => product(this.held.get(frame.name) ?? between(frame.samples, now - DELAY), pose),
      HERE,
    );
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
  const [a, b] = [before.pose, next.pose];
  const sign = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6] < 0 ? -1 : 1;
  const found = a.map((value, index) => value + ((index < 3 ? 1 : sign) * (b[index] ?? 0) - value) * share);
  const length = Math.hypot(...found.slice(3)) || 1;
  return /** @type {Pose} */ (found.map((value, index) => (index < 3 ? value : value / length)));
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

/** @param {Pose} pose @returns {Pose} */
function inverse([x, y, z, qx, qy, qz, qw]) {
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

/** Return the heading of a pose [rad]. @param {Pose} pose */
export function heading([, , , x, y, z, w]) {
  return Math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z));
}

// What is held to drive: the joystick, sliders, keys and a gamepad, each as shares of the limits.

/**
 * @typedef {{forward: number, turn: number}} Share from -1 to 1; turn is positive to the left
 */

/** By key: forward, and left. Letters as rqt's robot steering has them; X and Z let go. */
const KEYS = {
  w: [1, 0], s: [-1, 0], a: [0, 1], d: [0, -1],
  arrowup: [1, 0], arrowdown: [-1, 0], arrowleft: [0, 1], arrowright: [0, -1],
};
const DEAD_ZONE = 0.06;

/** The keys that are held; Shift is full speed. */
export class HeldKeys {
  constructor() {
    /** @type {Set<string>} */
    this.down = new Set();
    this.isFull = false;
  }

  /**
   * Take a key that goes down or up; returns whether it has a meaning.
   * @param {KeyboardEvent} event
   */
  take(event) {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.altKey || event.metaKey) return false;
    this.isFull = event.shiftKey;
    if (key === "shift") return true;
    if (event.type === "keydown" && (key === "x" || key === "z")) {
      this.letGo(key === "x" ? 0 : 1);
      return true;
    }
    if (!(key in KEYS)) return false;
    if (event.type === "keydown") {
      if (!event.repeat) this.down.add(key); // after a stop it has to be pressed again
    } else this.down.delete(key);
    return true;
  }

  /** @param {number} axis 0 for forward, 1 for turning */
  letGo(axis) {
    for (const [key, share] of Object.entries(KEYS)) if (share[axis]) this.down.delete(key);
  }

  /**
   * What they mean, or null where none is held.
   * @param {number} share the part of the limits that keys give without Shift
   * @returns {Share | null}
   */
  share(share) {
    if (!this.down.size) return null;
    const part = this.isFull ? 1 : share;
    let [forward, turn] = [0, 0];
    for (const key of this.down) {
      const [x, y] = KEYS[/** @type {keyof typeof KEYS} */ (key)];
      forward += x ?? 0;
      turn += y ?? 0;
    }
    return { forward: Math.sign(forward) * part, turn: Math.sign(turn) * part };
  }

  clear() {
    this.down.clear();
    this.isFull = false;
  }
}

/**
 * The sticks of a gamepad: the left one drives, and the right one turns too. Null at rest.
 * @param {Gamepad | null} gamepad
 * @returns {Share | null}
 */
export function gamepadShare(gamepad) {
  if (!gamepad?.connected) return null;
  const [x = 0, y = 0, right = 0] = gamepad.axes.map(withoutRest);
  const turn = Math.abs(right) > Math.abs(x) ? right : x;
  return turn || y ? { forward: -y || 0, turn: -turn || 0 } : null;
}

/**
 * Sticks do not come back to 0 quite.
 * @param {number} value
 */
function withoutRest(value) {
  const size = Math.max(0, Math.abs(value) - 2 * DEAD_ZONE) / (1 - 2 * DEAD_ZONE);
  return Math.sign(value) * Math.min(1, size);
}

/**
 * A point on the joystick, in radii right and down from its middle; nearly straight is straight.
 * @param {number} right
 * @param {number} down
 * @returns {Share}
 */
export function joystickShare(right, down) {
  const size = Math.max(1, Math.hypot(right, down));
  /** @param {number} value */
  const straight = (value) => (Math.abs(value) < DEAD_ZONE ? 0 : value);
  return { forward: straight(-down / size) || 0, turn: straight(-right / size) || 0 };
}

/**
 * All that is held together, or null where nothing is.
 * @param {(Share | null)[]} shares
 * @returns {Share | null}
 */
export function together(shares) {
  const held = shares.filter((share) => share !== null);
  if (!held.length) return null;
  /** @param {number} value */
  const within = (value) => Math.max(-1, Math.min(1, value));
  return {
    forward: within(held.reduce((sum, share) => sum + share.forward, 0)),
    turn: within(held.reduce((sum, share) => sum + share.turn, 0)),
  };
}

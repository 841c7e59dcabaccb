// The commands of joystick, sliders, keys and gamepad while held, as fractions of the limits.

/**
 * @typedef {{forward: number, turn: number}} Share from -1 to 1; turn is positive to the left
 */

/** Forward and left by key. Letters as in rqt's robot steering; X and Z stop driving and turning. */
const KEYS = {
  w: [1, 0], s: [-1, 0], a: [0, 1], d: [0, -1],
  arrowup: [1, 0], arrowdown: [-1, 0], arrowleft: [0, 1], arrowright: [0, -1],
};
const DEAD_ZONE = 0.06;

/** The keys that are held; Shift means full speed. */
export class HeldKeys {
  constructor() {
    /** @type {Set<string>} */
    this.down = new Set();
    this.isFull = false;
  }

  /**
   * Process a key that goes down or up; return true if it has a meaning.
   * @param {KeyboardEvent} event
   */
  handle(event) {
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
      if (!event.repeat) this.down.add(key); // after a stop it must be pressed again
    } else this.down.delete(key);
    return true;
  }

  /** @param {number} axis 0 for forward, 1 for turning */
  letGo(axis) {
    for (const [key, share] of Object.entries(KEYS)) if (share[axis]) this.down.delete(key);
  }

  /**
   * Return the command of the held keys, or null if none is held.
   * @param {number} share the fraction of the limits without Shift
   * @returns {Share | null}
   */
  share(share) {
    if (!this.down.size) return null;
    const part = this.isFull ? 1 : share;
    const held = [...this.down].map((key) => KEYS[/** @type {keyof typeof KEYS} */ (key)]);
    /** @param {number} axis */
    const along = (axis) => Math.sign(held.reduce((sum, one) => sum + (one[axis] ?? 0), 0)) * part;
    return { forward: along(0), turn: along(1) };
  }

  clear() {
    this.down.clear();
    this.isFull = false;
  }
}

/**
 * Return the command of a gamepad's sticks: the left one drives, the right one also turns. Null at
 * rest, and while no button is held: a stick that is worn or lies on the table must not drive.
 * @param {Gamepad | null} gamepad
 * @returns {Share | null}
 */
export function gamepadShare(gamepad) {
  if (!gamepad?.connected || !gamepad.buttons.some((button) => button.pressed)) return null;
  const [x = 0, y = 0, right = 0] = gamepad.axes.map(withoutRest);
  const turn = Math.abs(right) > Math.abs(x) ? right : x;
  return turn || y ? { forward: -y || 0, turn: -turn || 0 } : null;
}

/** Apply a dead zone: sticks do not return to exactly 0. @param {number} value */
function withoutRest(value) {
  const size = Math.max(0, Math.abs(value) - 2 * DEAD_ZONE) / (1 - 2 * DEAD_ZONE);
  return Math.sign(value) * Math.min(1, size);
}

/**
 * Return the command of a point on the joystick, in radii from its centre; nearly straight is straight.
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
 * Return the sum of all commands, or null if nothing is held.
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

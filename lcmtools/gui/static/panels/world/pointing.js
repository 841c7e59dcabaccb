// Moving bodies and choosing poses in the world with the pointer.

import { hexColor } from "../../theme.js";
import { pointer } from "./drawings.js";
import { heading } from "./frames.js";
import { dispose } from "./geometry.js";

const PERIOD = 70; // [ms] between two poses while a body is dragged
const TURN = 0.01; // [rad] for each pixel with Shift

/**
 * @typedef {import("./frames.js").Pose} Pose
 */

/** Applies the chosen tool to the pointer's events. */
export class Pointing {
  /** @param {import("../world.js").default} world @param {import("./view.js").View} view */
  constructor(world, view) {
    this.world = world;
    this.view = view;
    /** @type {((event: PointerEvent) => void) | null} */
    this.onMove = null;
    /** @type {(() => void) | null} */
    this.onEnd = null;
    const { canvas } = view;
    canvas.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.onMove?.(event));
    for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, () => this.end());
  }

  /** @param {PointerEvent} event */
  begin(event) {
    if (event.button !== 0 || !event.isPrimary) return;
    const { view } = this;
    const tool = this.world.context.canCommand ? this.world.tool : "look";
    if (tool !== "look") view.refresh();
    const started = tool === "move" ? this.drag(event) : tool === "pose" ? this.aim(event) : false;
    if (!started) return;
    view.controls.enabled = false;
    try {
      view.canvas.setPointerCapture(event.pointerId);
    } catch {
      // the pointer was released already
    }
  }

  end() {
    this.onEnd?.();
    this.onMove = this.onEnd = null;
    this.view.controls.enabled = true;
    this.view.invalidate(300);
  }

  /**
   * Start to move the body under the pointer; with Shift, to turn it.
   * @param {PointerEvent} event
   */
  drag(event) {
    const { view } = this;
    const { bodies, frames, simulator } = this.world;
    const hits = view.ray(event).intersectObjects(view.content.children, true);
    const body = hits.length ? bodies.ofMesh(hits[0].object, simulator.nodes) : null;
    const start = body && frames.pose(body.frame, "world", performance.now());
    const from = hits.length ? view.place(event, hits[0].point.z) : null;
    if (!body || !start || !from) return false;
    const height = hits[0].point.z;
    let pose = flat(start[0], start[1], heading(start));
    let [x, y] = [event.clientX, event.clientY];
    let grip = [from[0] - start[0], from[1] - start[1]];
    let wanted = /** @type {Pose | null} */ (null);
    let isBusy = false;
    const send = async () => {
      if (isBusy) return;
      isBusy = true;
      while (wanted) {
        const [px, py, , , , qz, qw] = wanted;
        wanted = null;
        await simulator.call("set_pose", { name: body.name, x: px, y: py, qz, qw }, body.node);
        await new Promise((resolve) => setTimeout(resolve, PERIOD));
      }
      isBusy = false;
      if (!this.onMove) frames.hold(body.frame, null);
    };
    this.onMove = (moved) => {
      const at = view.place(moved, height);
      if (moved.shiftKey) {
        pose = flat(pose[0], pose[1], heading(pose) - TURN * (moved.clientX - x));
        if (at) grip = [at[0] - pose[0], at[1] - pose[1]];
      } else if (at) {
        pose = flat(at[0] - /** @type {number} */ (grip[0]), at[1] - /** @type {number} */ (grip[1]), heading(pose));
      }
      [x, y] = [moved.clientX, moved.clientY];
      wanted = pose;
      frames.hold(body.frame, pose);
      view.invalidate(300);
      send();
    };
    this.onEnd = () => {
      if (!isBusy) frames.hold(body.frame, null);
    };
    return Number.isFinite(y);
  }

  /**
   * Start to choose a pose: first the position, then, by dragging, the heading.
   * @param {PointerEvent} event
   */
  aim(event) {
    const { view } = this;
    const color = hexColor("--accent");
    const at = view.place(event);
    if (!at) return false;
    let pose = flat(at[0], at[1], 0);
    let arrow = pointer(pose, color);
    view.content.add(arrow);
    this.onMove = (moved) => {
      const end = view.place(moved);
      if (!end || Math.hypot(end[0] - at[0], end[1] - at[1]) < 0.05) return;
      pose = flat(at[0], at[1], Math.atan2(end[1] - at[1], end[0] - at[0]));
      dispose(arrow);
      arrow = pointer(pose, color);
      view.content.add(arrow);
      view.invalidate();
    };
    this.onEnd = () => {
      dispose(arrow);
      this.world.sendPose(pose);
    };
    return true;
  }
}

/** @param {number} x @param {number} y @param {number} yaw @returns {Pose} */
function flat(x, y, yaw) {
  return [x, y, 0, 0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)];
}

// The displays of the world: one for each topic, by the type of its messages.

import { Group } from "../../vendor/three/three.js";
import { KINDS, LIFT, band } from "./drawings.js";
import { dispose, matrixOf } from "./geometry.js";
import { hasPlace } from "./numbers.js";
import { MESH, bodyOf } from "./shapes.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {import("./frames.js").Frames} Frames
 */

const TRAIL = 4000; // points
const TRAIL_STEP = 0.03; // [m]

/** The display of a topic. Its group is placed in its frame whenever the view is drawn. */
export class Display {
  /**
   * @param {string} topic
   * @param {string} type
   */
  constructor(topic, type) {
    this.topic = topic;
    this.type = type;
    this.color = "#ff8800";
    /** True if points are drawn in this colour instead of their own. */
    this.isPainted = false;
    /** The display's problem, or the amount that it shows. */
    this.status = "";
    /** @type {{frame: string, group: any, ns?: string}[]} */
    this.parts = [];
    /** @type {any} */
    this.latest = null;
    /** @type {ArrayBuffer} */
    this.payload = new ArrayBuffer(0);
    /** True if the latest message must be converted when the view is drawn next. */
    this.isStale = false;
    /** @type {{fixed: string, places: [number, number, number][]}} */
    this.trail = { fixed: "", places: [] };
  }

  /**
   * @param {any} data
   * @param {ArrayBuffer} [payload]
   */
  receive(data, payload = new ArrayBuffer(0)) {
    this.latest = data;
    this.payload = payload;
    this.isStale = true;
    if (data.kind === "markers") this.make(); // markers have the names of bodies
  }

  make() {
    this.isStale = false;
    if (!this.latest) return;
    const { kind, frame } = this.latest;
    if (kind === "markers") this.makeBodies(this.latest.markers);
    else if (!hasPlace(this.latest)) {
      this.clear();
      this.status = "not drawn: its place is not finite";
    } else if (KINDS[kind]?.draw) {
      this.status = "";
      if (this.parts[0]?.frame !== frame) {
        this.clear();
        this.parts = [{ frame, group: new Group() }];
      }
      const { group } = /** @type {{group: any}} */ (this.parts[0]);
      for (const child of [...group.children]) dispose(child);
      KINDS[kind].draw(group, this.latest, this.payload, this.color, this.isPainted);
    }
  }

  /** @param {import("./shapes.js").Marker[]} all */
  makeBodies(all) {
    this.clear();
    const markers = all.filter(hasPlace);
    /** @type {Map<string, import("./shapes.js").Marker[]>} */
    const bodies = new Map();
    for (const marker of markers) {
      const key = `${marker.frame}\n${marker.ns}`;
      bodies.set(key, [...(bodies.get(key) ?? []), marker]);
    }
    this.parts = [...bodies.values()].map((body) => {
      const { frame, ns } = /** @type {import("./shapes.js").Marker} */ (body[0]);
      const group = bodyOf(body);
      Object.assign(group.userData, { topic: this.topic, frame, ns });
      return { frame, group, ns };
    });
    const meshes = markers.filter(({ type }) => type === MESH).length;
    const files = meshes ? `, ${meshes} not drawn: files that messages name are not read` : "";
    const odd = all.length - markers.length;
    const places = odd ? `, ${odd} not drawn: their places are not finite` : "";
    this.status = `${markers.length} markers${files}${places}`;
  }

  /** @param {string} color */
  paint(color) {
    if (this.color === color) return;
    this.color = color;
    this.isPainted = true;
    this.make();
  }

  /**
   * Place everything at its pose at a time.
   * @param {any} content
   * @param {Frames} frames
   * @param {import("./bodies.js").Bodies} bodies
   * @param {number} now
   */
  place(content, frames, bodies, now) {
    let lost = "";
    if (this.isStale) this.make();
    for (const { frame, group } of this.parts) {
      const pose = frames.pose(bodies.frameOf(frame, this.topic), bodies.fixed, now);
      group.visible = pose !== null;
      if (pose) group.matrix.copy(matrixOf(pose));
      else lost = frame;
      group.matrixAutoUpdate = false;
      if (group.parent !== content) content.add(group);
    }
    this.lost = lost && `no transform from ${lost} to ${bodies.fixed}`;
    if (this.trailMesh?.parent !== content && this.trailMesh) content.add(this.trailMesh);
  }

  /**
   * Extend the trail of an odometry.
   * @param {Frames} frames
   * @param {string} fixed
   * @param {number} now
   */
  leaveTrail(frames, fixed, now) {
    const { trail, latest } = this;
    if (latest?.kind !== "odometry" || !hasPlace(latest)) return;
    if (trail.fixed !== fixed) Object.assign(trail, { fixed, places: [], group: undefined });
    const base = frames.pose(latest.frame, fixed, now);
    const pose = base && matrixOf(base).multiply(matrixOf(latest.pose));
    if (!pose) return;
    const at = /** @type {[number, number, number]} */ ([pose.elements[12], pose.elements[13], LIFT]);
    const last = trail.places.at(-1);
    const way = last ? Math.hypot(at[0] - last[0], at[1] - last[1]) : Infinity;
    if (way < TRAIL_STEP) return;
    if (way > 1 && last) trail.places = []; // the robot was moved elsewhere
    trail.places.push(at);
    if (trail.places.length > TRAIL) trail.places.shift();
    if (this.trailMesh) dispose(this.trailMesh);
    this.trailMesh = band(trail.places, 0.035, this.color, 0.75);
  }

  clear() {
    for (const { group } of this.parts) dispose(group);
    this.parts = [];
  }

  close() {
    this.clear();
    if (this.trailMesh) dispose(this.trailMesh);
  }
}

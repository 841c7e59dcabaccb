// The displays of the world: one for each topic, by the type of its messages.

import * as THREE from "../../vendor/three/three.js";
import { counted } from "../../texts.js";
import { KINDS, LIFT } from "./drawings.js";
import { dispose, matrixOf, setOld } from "./geometry.js";
import { hasPlace } from "./numbers.js";
import { MESH, SOLIDS, TRIANGLES, bodyOf } from "./shapes.js";
import { Trail } from "./trail.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {import("./frames.js").Frames} Frames
 */

/** The display of a topic. Its group is placed in its frame whenever the view is drawn. */
export class Display {
  /** @param {string} topic @param {string} type */
  constructor(topic, type) {
    this.topic = topic;
    this.type = type;
    this.color = "#ff8800";
    /** True if points are drawn in this colour instead of their own. */
    this.isPainted = false;
    /** The server's problem with the topic. */
    this.problem = "";
    /** What is wrong with the latest message, or the amount that is shown of it. */
    this.status = "";
    /** @type {{frame: string, group: any, ns?: string, isOld?: boolean}[]} */
    this.parts = [];
    /** The latest message as text, but for what does not change the drawing. */
    this.key = "";
    /** @type {any} */
    this.latest = null;
    /** @type {ArrayBuffer} */
    this.payload = new ArrayBuffer(0);
    /** True if the latest message must be converted when the view is drawn next. */
    this.isStale = false;
    /** @type {Trail | undefined} */
    this.trail = undefined;
    /** @type {import("../../connection.js").Stream | undefined} */
    this.stream = undefined;
  }

  /**
   * Take a message; return true if it changes the drawing.
   * @param {any} data
   * @param {ArrayBuffer} [payload]
   */
  receive(data, payload = new ArrayBuffer(0)) {
    const key = JSON.stringify({ ...data, time: 0, twist: 0 }, (_, value) => (typeof value === "number" ? Math.round(value * 1e5) : value));
    const [bytes, before] = [new Uint8Array(payload), new Uint8Array(this.payload)];
    const hasBytes = bytes.length === before.length && bytes.every((value, index) => value === before[index]);
    const isSame = key === this.key && hasBytes;
    Object.assign(this, { latest: data, payload, key });
    if (isSame) return false;
    this.isStale = true;
    if (data.kind === "markers") this.make(); // markers have the names of bodies
    return true;
  }

  /** Draw the latest message; one that cannot be drawn says so, and the other displays go on. */
  make() {
    this.isStale = false;
    if (!this.latest) return;
    try {
      this.draw();
    } catch (error) {
      this.clear();
      this.status = `not drawn: ${error instanceof Error ? error.message : error}`;
    }
  }

  draw() {
    const { kind, frame } = this.latest;
    if (kind === "markers") this.makeBodies(this.latest.markers);
    else if (!hasPlace(this.latest)) {
      this.clear();
      this.status = "not drawn: its place is not finite";
    } else if (KINDS[kind]?.draw) {
      this.status = this.latest.odd ? `${this.latest.odd} not drawn: their places are not finite` : "";
      this.clear();
      const group = new THREE.Group();
      this.parts = [{ frame, group }];
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
    const parts = [
      [markers.filter(({ type, scale }) => SOLIDS.includes(type) && scale.filter(Boolean).length < 2), "their scale is 0"],
      [markers.filter(({ type }) => type === MESH), "files that messages name are not read"],
      [all.filter((one) => !hasPlace(one)), "their places are not finite"],
      [all.filter(({ type }) => type < 0 || type > TRIANGLES), "their types are unknown"],
      [all.filter(({ color, colors }) => !(color[3] > 0) && !colors.length), "their color.a is 0"],
    ];
    const undrawn = parts.flatMap(([some = [], why]) => (some.length ? [`${some.length} not drawn: ${why}`] : []));
    this.status = [counted(markers.length, "marker"), ...undrawn].join(", ");
  }

  /** @param {string} color */
  paint(color) {
    if (this.color === color) return;
    this.color = color;
    this.isPainted = true;
    this.trail?.mesh.material.color.set(color);
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
    for (const part of this.parts) {
      const { frame, group } = part;
      const isOld = frames.silent.has(this.topic) || frames.isOld(bodies.frameOf(frame, this.topic));
      if (isOld !== Boolean(part.isOld)) setOld(group, (part.isOld = isOld));
      const pose = frames.pose(bodies.frameOf(frame, this.topic), bodies.fixed, now);
      group.visible = pose !== null;
      if (pose) group.matrix.copy(matrixOf(pose));
      else lost = frame ? `no transform from ${frame} to ${bodies.fixed}` : "its frame_id is empty";
      group.matrixAutoUpdate = false;
      if (group.parent !== content) content.add(group);
    }
    this.lost = lost;
    if (this.trail && !this.trail.mesh.parent) content.add(this.trail.mesh);
  }

  /**
   * Extend the trail of an odometry.
   * @param {Frames} frames
   * @param {string} fixed
   * @param {number} now
   */
  leaveTrail(frames, fixed, now) {
    const { latest } = this;
    if (latest?.kind !== "odometry" || !hasPlace(latest)) return;
    if (this.trail?.fixed !== fixed) {
      if (this.trail) dispose(this.trail.mesh);
      this.trail = new Trail(fixed, this.color);
    }
    const base = frames.pose(latest.frame, fixed, now);
    const pose = base && matrixOf(base).multiply(matrixOf(latest.pose));
    if (!pose) return;
    this.trail.add([pose.elements[12], pose.elements[13], LIFT]);
  }

  clear() {
    for (const { group } of this.parts) dispose(group);
    this.parts = [];
  }

  close() {
    this.stream?.close();
    this.clear();
    if (this.trail) dispose(this.trail.mesh);
  }
}

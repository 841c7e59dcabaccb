// The moving bodies of the world, which are robots, objects and odometries, and their poses.

import { product } from "./frames.js";
import { hasPlace } from "./numbers.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {{name: string, frame: string, at?: Pose}} Body with its frame, or its pose in one
 */

/** Return the name of a body for people: a robot's may be the root, "/". @param {string} name */
export const bodyText = (name) => (name === "/" ? "the robot" : name);

/** The bodies that the displays show. */
export class Bodies {
  /**
   * @param {Map<string, import("./displays.js").Display>} displays by topic
   * @param {import("./frames.js").Frames} frames
   */
  constructor(displays, frames) {
    this.displays = displays;
    this.frames = frames;
    /** The fixed frame, in which poses are given. */
    this.fixed = "world";
  }

  /** Return the bodies by name: robots, objects, odometries. */
  list() {
    /** @type {Map<string, Omit<Body, "name">>} */
    const found = new Map();
    for (const display of this.displays.values()) {
      for (const { frame, ns } of display.parts) {
        if (ns && this.frames.frames.get(frame)?.parent === "world") found.set(ns, { frame });
      }
      const { latest } = display;
      if (latest?.kind === "odometry" && hasPlace(latest) && !latest.child.startsWith("ground_truth")) {
        // transforms may give the same frame the pose of another odometry
        const isSame = this.frames.frames.get(latest.child)?.parent === latest.frame;
        found.set(display.topic, isSame ? { frame: latest.child } : { frame: latest.frame, at: latest.pose });
      }
    }
    /** @param {string} name */
    const rank = (name) => (this.displays.has(name) ? 2 : name.startsWith("/") ? 0 : 1);
    return [...found]
      .map(([name, where]) => ({ name, ...where }))
      .sort((a, b) => rank(a.name) - rank(b.name) || a.name.localeCompare(b.name, undefined, { numeric: true }));
  }

  /** Return the name of the first robot; "" if there is none. */
  robot() {
    return this.list().find(({ name }) => name.startsWith("/"))?.name ?? "";
  }

  /**
   * Return a body's pose in the fixed frame; null if they are not connected.
   * @param {Body | undefined} body
   * @param {number} now [ms]
   * @returns {Pose | null}
   */
  poseOf(body, now) {
    const pose = body ? this.frames.pose(body.frame, this.fixed, now) : null;
    return pose && body?.at ? product(pose, body.at) : pose;
  }

  /**
   * Return the pose of the body with a name; null if there is none.
   * @param {string} name
   * @param {number} now [ms]
   */
  poseNamed(name, now) {
    return this.poseOf(this.list().find((one) => one.name === name), now);
  }

  /**
   * Return a sensor's frame, or if it is unknown, the frame of the odometry in its namespace.
   * @param {string} frame
   * @param {string} topic
   */
  frameOf(frame, topic) {
    if (this.frames.frames.has(frame) || frame === this.fixed || this.frames.names().includes(frame)) return frame;
    let [best, found] = ["", frame];
    for (const [name, display] of this.displays) {
      const space = name.slice(0, name.lastIndexOf("/") + 1);
      if (display.latest?.kind === "odometry" && topic.startsWith(space) && space.length > best.length) {
        best = space;
        found = display.latest.child;
      }
    }
    return found;
  }

  /**
   * Return the body that a mesh belongs to if one of these simulators can move it.
   * @param {any} object
   * @param {string[]} simulators
   */
  ofMesh(object, simulators) {
    while (object && !object.userData.topic) object = object.parent;
    const { topic, ns } = object?.userData ?? {};
    const node = simulators.find((name) => topic === `${name}/world`);
    const body = this.list().find(({ name }) => name === ns);
    return node && body ? { node, name: body.name, frame: body.frame } : null;
  }
}

// The sidebar of the world: displays with checkboxes and colours, and the robots' poses.

import { element, fill, set, write } from "../../elements.js";
import { KINDS } from "./drawings.js";
import { heading } from "./frames.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {import("../world.js").Topic} Topic
 * @typedef {{
 *   isShown: (topic: Topic) => boolean,
 *   color: (topic: Topic) => string,
 *   show: (topic: Topic, isShown: boolean) => void,
 *   paint: (topic: Topic, color: string) => void,
 *   look: (name: string) => void,
 * }} Owner
 */

/** The sidebar. */
export class Sidebar {
  /** @param {Owner} owner */
  constructor(owner) {
    this.owner = owner;
    /** @type {Map<string, {row: HTMLElement, status: HTMLElement}>} */
    this.rows = new Map();
    this.displays = element("ul", { class: "world-displays" });
    this.none = element("p", { class: "muted" }, "Nothing on the bus can be drawn yet.");
    this.undrawnTypes = element("span", { class: "mono" });
    this.undrawn = element(
      "details",
      { class: "world-undrawn muted", hidden: true },
      element("summary", {}, "Types without a drawing"),
      this.undrawnTypes,
      element("p", {}, "A type gets one by a line of DRAWINGS in lcmtools/gui/drawings.py."),
    );
    this.bodies = element("ul", { class: "world-bodies", "aria-label": "Poses" });
    this.element = element(
      "aside",
      { class: "world-side" },
      element("h3", {}, "Displays"),
      this.none,
      this.displays,
      this.undrawn,
      element("h3", {}, "Robots and objects"),
      this.bodies,
    );
  }

  /** @param {Topic[]} topics */
  setTopics(topics) {
    this.none.hidden = topics.length > 0;
    this.rows.clear();
    fill(
      this.displays,
      topics.map((topic) => this.row(topic)),
    );
  }

  /** @param {string[]} types */
  setUndrawn(types) {
    this.undrawn.hidden = types.length === 0;
    write(this.undrawnTypes, types.join(", "));
  }

  /** @param {Topic} topic */
  row(topic) {
    const { owner } = this;
    const kind = KINDS[topic.kind];
    const tick = element("input", { type: "checkbox", onchange: () => owner.show(topic, tick.checked) });
    tick.checked = owner.isShown(topic);
    const status = element("small");
    const color = kind?.hasColor
      ? element("input", {
          type: "color",
          "aria-label": `Colour of ${topic.topic}`,
          oninput: (/** @type {Event} */ event) => owner.paint(topic, /** @type {HTMLInputElement} */ (event.target).value),
        })
      : null;
    if (color) color.value = owner.color(topic);
    const row = element(
      "li",
      { title: `${topic.topic}, ${topic.type}` },
      element("label", {}, tick, element("span", { class: "mono" }, topic.topic)),
      color,
      status,
    );
    this.rows.set(topic.topic, { row, status });
    this.setStatus(topic.topic, kind?.name ?? `panels/world/drawings.js has no kind '${topic.kind}'`, !kind);
    return row;
  }

  /**
   * @param {string} topic
   * @param {string} text the problem or the type
   * @param {boolean} isBad
   */
  setStatus(topic, text, isBad) {
    const found = this.rows.get(topic);
    if (!found) return;
    write(found.status, text);
    found.row.classList.toggle("is-bad", isBad);
  }

  /** @param {{name: string, pose: Pose}[]} bodies */
  setBodies(bodies) {
    while (this.bodies.children.length > bodies.length) this.bodies.lastElementChild?.remove();
    bodies.forEach(({ name, pose }, index) => {
      let line = this.bodies.children[index];
      if (!line) {
        const button = element("button", { type: "button", onclick: () => this.owner.look(button.dataset["name"] ?? "") });
        line = element("li", {}, button, element("span", { class: "number" }));
        this.bodies.append(line);
      }
      const [button, text] = /** @type {[HTMLElement, HTMLElement]} */ ([...line.children]);
      button.dataset["name"] = name;
      set(button, "title", `Look at ${name}`);
      write(button, name);
      const [x, y, yaw] = [pose[0], pose[1], (heading(pose) * 180) / Math.PI];
      write(text, `x ${x.toFixed(2)} m, y ${y.toFixed(2)} m, ${yaw.toFixed(0)}°`);
      line.setAttribute("data-pose", `${name} ${x.toFixed(4)} ${y.toFixed(4)} ${heading(pose).toFixed(4)}`);
    });
  }
}

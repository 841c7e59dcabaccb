// The sidebar of the world: displays with checkboxes and colours, and the robots' poses.

import { button, element, fill, set, write } from "../../elements.js";
import { bodyText } from "./bodies.js";
import { KINDS } from "./drawings.js";
import { heading } from "./frames.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {import("../world.js").Topic} Topic
 */

/** The sidebar. */
export class Sidebar {
  /** @param {import("../world.js").default} world */
  constructor(world) {
    this.world = world;
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
    fill(this.displays, topics.map((topic) => this.row(topic)));
  }

  /** @param {string[]} types */
  setUndrawn(types) {
    this.undrawn.hidden = types.length === 0;
    write(this.undrawnTypes, types.join(", "));
  }

  /** @param {Topic} topic */
  row(topic) {
    const { world } = this;
    const kind = KINDS[topic.kind];
    const checked = world.isShown(topic);
    const tick = element("input", { type: "checkbox", checked, onchange: () => world.show(topic, tick.checked) });
    const status = element("small");
    const color = element("input", {
      type: "color",
      value: world.colorOf(topic),
      "aria-label": `Colour of ${topic.topic}`,
      oninput: () => world.paint(topic, color.value),
    });
    const row = element(
      "li",
      { title: `${topic.topic}, ${topic.type}` },
      element("label", {}, tick, element("span", { class: "mono" }, topic.topic)),
      kind?.hasColor && color,
      status,
    );
    this.rows.set(topic.topic, { row, status });
    this.setStatus(topic.topic, kind?.name ?? `panels/world/drawings.js has no kind '${topic.kind}'`, !kind);
    return row;
  }

  /** @param {string} topic @param {string} text the problem or the type @param {boolean} isBad */
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
        const look = button("", () => this.world.camera?.lookAt(look.dataset["name"] ?? ""));
        line = element("li", {}, look, element("span", { class: "number" }));
        this.bodies.append(line);
      }
      const [look, text] = /** @type {[HTMLElement, HTMLElement]} */ ([...line.children]);
      look.dataset["name"] = name;
      set(look, "title", `Look at ${bodyText(name)}`);
      write(look, bodyText(name));
      const [x, y, yaw] = [pose[0], pose[1], (heading(pose) * 180) / Math.PI];
      write(text, `x ${x.toFixed(2)} m, y ${y.toFixed(2)} m, ${yaw.toFixed(0)}°`);
      line.setAttribute("data-pose", `${name} ${x.toFixed(4)} ${y.toFixed(4)} ${heading(pose).toFixed(4)}`);
    });
  }
}

// The tree of frames: each frame below its parent, with its age, its publisher, and what is wrong.

import { element, fill, set, write } from "../elements.js";
import { ageText } from "../texts.js";

/** @typedef {[frame: string, depth: number, age: number | null, publisher: string, topic: string, fault: string]} Line */

const INDENT = 16; // [px]

/** The frames panel. */
export default class FrameTree {
  /** @param {import("../context.js").Context} context */
  constructor(context) {
    this.title = "Frames";
    this.about = element("p", { class: "notice", role: "status", hidden: true });
    this.body = element("tbody");
    const heads = ["Frame", "Age", "Fault", "Publisher", "Topic"].map((text) => element("th", { scope: "col" }, text));
    const table = element("table", { class: "frame-tree", role: "treegrid", "aria-label": "Frames" }, element("thead", {}, element("tr", {}, heads)), this.body);
    this.element = element("div", { class: "frames" }, this.about, element("div", { class: "table", tabindex: 0 }, table));
    context.open("frame-tree", {}, (data) => this.show(data));
  }

  /** @param {{about: string, lines: Line[]}} data */
  show({ about, lines }) {
    this.about.hidden = !about;
    write(this.about, about);
    while (this.body.rows.length > lines.length) this.body.deleteRow(-1);
    lines.forEach(([frame, depth, age, publisher, topic, fault], index) => {
      const row = this.body.rows[index] ?? this.body.insertRow();
      if (!row.cells.length) fill(row, ["mono", "number", "is-bad", "", "mono"].map((name) => element("td", { class: name })));
      [frame, age === null ? "" : `${ageText(age)} ago`, fault, publisher, topic].forEach((text, column) => {
        const cell = /** @type {HTMLElement} */ (row.cells[column]);
        write(cell, text);
        set(cell, "title", text);
      });
      /** @type {HTMLElement} */ (row.cells[0]).style.paddingLeft = `${8 + INDENT * depth}px`;
      set(row, "aria-level", depth + 1);
    });
  }
}

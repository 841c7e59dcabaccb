// The topics and their numeric fields as a tree with checkboxes.

import { element, fill } from "../../elements.js";
import { stylesheet } from "../stylesheet.js";

/** @typedef {{value: string, detail: string}} Choice */

/** A tree that requests the fields of a topic when it is unfolded. */
export class FieldTree {
  /**
   * @param {(text: string) => Promise<Choice[]>} suggest returns the topics, or the fields of one
   * @param {(field: string) => boolean} isChosen
   * @param {(field: string, isChosen: boolean) => void} choose
   */
  constructor(suggest, isChosen, choose) {
    stylesheet("./choice.css");
    this.suggest = suggest;
    this.isChosen = isChosen;
    this.choose = choose;
    this.element = element("div", { class: "field-tree", role: "group", "aria-label": "Fields", hidden: true });
  }

  async toggle() {
    this.element.hidden = !this.element.hidden;
    if (this.element.hidden) return;
    const topics = await this.suggest("").catch(() => []);
    fill(this.element, topics.length ? topics.map((topic) => this.branch(topic)) : "There are no topics yet.");
    this.element.querySelector("summary")?.focus();
  }

  /** @param {Choice} topic */
  branch({ value, detail }) {
    const leaves = element("div");
    const branch = element(
      "details",
      { ontoggle: () => branch.open && this.grow(leaves, value) },
      element("summary", {}, element("span", { class: "mono" }, value), " ", element("small", {}, detail)),
      leaves,
    );
    return branch;
  }

  /** @param {HTMLElement} leaves @param {string} topic */
  async grow(leaves, topic) {
    const fields = await this.suggest(`${topic}/`).catch(() => []);
    fill(leaves, fields.length ? fields.map((field) => this.leaf(field, topic)) : element("small", {}, "no numbers"));
  }

  /** @param {Choice} field @param {string} topic */
  leaf({ value, detail }, topic) {
    const onchange = () => this.choose(value, box.checked);
    const box = element("input", { type: "checkbox", checked: this.isChosen(value), onchange });
    const path = value.slice(topic.length + 1);
    return element("label", {}, box, element("span", { class: "mono" }, path), " ", element("small", {}, detail));
  }
}

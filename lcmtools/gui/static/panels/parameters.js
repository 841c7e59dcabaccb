// The parameters of a node, read again and again; a changed value is sent to the node.

import { div, element, fill } from "../elements.js";
import { mistakeText } from "../texts.js";
import { nameList } from "./choice.js";
import { TYPED, onlyForCommanders, say } from "./form.js";

const PERIOD = 2000; // [ms] between two reads

/**
 * @typedef {{name: string, value: string, type: string, description: string, minimum: string | null,
 *   maximum: string | null, read_only: boolean}} Parameter
 */

/** The parameters panel. */
export default class Parameters {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    this.context = context;
    this.title = "Parameters";
    /** @type {Map<string, HTMLInputElement>} */
    this.inputs = new Map();
    this.shown = "";
    this.isAsking = false;
    this.choice = nameList("Node", settings.node, () => {
      this.fields.replaceChildren();
      say(this.result, "");
      this.read();
      context.changed();
    }, { fills: true });
    this.fields = element("fieldset", { class: "form-fields plain", "aria-label": "Parameters" });
    this.result = element("p", { class: "result", role: "status" });
    const foot = div("form-foot", onlyForCommanders(context, this.fields), this.result);
    this.element = div("publish", div("tools", this.choice.element), this.fields, foot);
    context.open("offers", {}, (data) => {
      this.choice.offer(data.nodes);
      if (!this.choice.element.value) say(this.result, data.nodes.length ? "Choose a node." : "No node has parameters.");
    });
    context.onChange(() => this.read());
    const timer = setInterval(() => this.read(), PERIOD);
    context.signal.addEventListener("abort", () => clearInterval(timer));
  }

  settings() {
    return { node: this.choice.element.value };
  }

  async read() {
    const node = this.choice.element.value;
    if (!node || this.isAsking || document.hidden || !this.context.connection.isOpen) return;
    this.isAsking = true;
    try {
      const found = await this.context.ask("node-parameters", { node });
      if (node === this.choice.element.value) this.show(node, found);
      this.context.showProblem(this, "");
    } catch (error) {
      this.context.showProblem(this, mistakeText(error));
    }
    this.fields.classList.toggle("muted", this.context.problems.has(this)); // the values are old
    this.isAsking = false;
    if (node !== this.choice.element.value) this.read();
  }

  /**
   * Show values; an input that is being edited stays.
   * @param {string} node
   * @param {Parameter[]} found
   */
  show(node, found) {
    const names = [node, ...found.map(({ name }) => name)].join(" ");
    if (names !== this.shown || !this.fields.children.length) {
      this.shown = names;
      this.inputs.clear();
      fill(this.fields, found.length ? found.map((one) => this.row(node, one)) : element("p", { class: "muted" }, "It has none."));
    }
    for (const { name, value } of found) {
      const input = this.inputs.get(name);
      if (!input) continue;
      if (input !== document.activeElement || input.value === input.defaultValue) input.value = value;
      input.defaultValue = value;
    }
  }

  /** @param {string} node @param {Parameter} parameter */
  row(node, { name, type, description, minimum, maximum, read_only: isFixed }) {
    const within = minimum || maximum ? `, ${minimum ?? "-∞"} to ${maximum ?? "∞"}` : "";
    const onchange = () => this.change(node, name, input);
    const onkeydown = (/** @type {KeyboardEvent} */ event) => {
      if (event.key === "Escape") input.value = input.defaultValue;
    };
    const input = element("input", { ...TYPED, class: "mono", disabled: isFixed, onchange, onkeydown });
    this.inputs.set(name, input);
    const kind = `${type}${within}${isFixed ? ", read only" : ""}`;
    const parts = [element("span", {}, name), input, element("small", {}, kind)];
    return element("label", { class: "form-row", title: description || null }, parts);
  }

  /** @param {string} node @param {string} name @param {HTMLInputElement} input */
  async change(node, name, input) {
    try {
      const found = await this.context.do("set-parameter", { node, name, value: input.value });
      input.value = input.defaultValue; // until the node's value is shown
      this.show(node, found);
      say(this.result, `${node}/${name} is now ${input.value}`);
    } catch (error) {
      input.value = input.defaultValue;
      say(this.result, mistakeText(error), true);
    }
  }
}

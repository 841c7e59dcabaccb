// The services of the nodes: a form that calls one, and its answer as a tree.

import { button, div, element, fill, set, write } from "../elements.js";
import { mistakeText } from "../texts.js";
import { nameList } from "./choice.js";
import { MessageForm, onlyForCommanders, say, sentBy } from "./form.js";
import { MessageTree } from "./message.js";

/** The services panel. */
export default class Services {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    this.context = context;
    this.title = "Services";
    /** @type {{name: string, types: string[], nodes: string[]}[]} */
    this.offered = [];
    this.type = this.shown = "";
    /** @type {MessageTree | null} */
    this.tree = null;
    this.choice = nameList("Service", settings.service, () => {
      this.show();
      context.changed();
    }, { fills: true });
    this.about = element("span", { class: "muted" });
    this.form = new MessageForm(context);
    this.deadline = element("input", { class: "rate", "aria-label": "Deadline [s]", inputmode: "decimal", value: "3" });
    this.button = button("Call", () => this.call(), { class: "primary", title: "Ctrl-Enter" });
    const rights = onlyForCommanders(context, this.button);
    this.result = element("p", { class: "result", role: "status" });
    this.answer = element("section", { class: "detail", "aria-label": "Answer", hidden: true });
    const wait = element("label", {}, "wait ", this.deadline, " s");
    const form = element(
      "form",
      { class: "publish", "aria-label": "Call", ...sentBy(this.button) },
      div("tools", this.choice.element, this.about),
      this.form.element,
      div("form-foot", this.button, wait, rights, this.result),
    );
    this.element = div("topics", form, this.answer);
    context.open("offers", {}, (data) => {
      this.offered = data.services;
      this.choice.offer(this.offered.map(({ name }) => name));
      this.show();
    });
  }

  settings() {
    return { service: this.choice.element.value };
  }

  /** Show the chosen service's type and nodes, and the form of its request. */
  async show() {
    const name = this.choice.element.value;
    const service = this.offered.find((one) => one.name === name);
    const type = service?.types[0] ?? "";
    const gone = name ? "no node offers it" : "";
    write(this.about, service ? `${service.types.join(", ") || "unknown type"} of ${service.nodes.join(", ")}` : gone);
    const otherwise = name ? "Its type is unknown." : this.offered.length ? "Choose a service." : "No node offers a service.";
    const shown = [name, type, otherwise].join(" ");
    if (shown === this.shown || (name && !service)) return; // what was typed stays
    this.shown = shown;
    this.type = type;
    this.hideAnswer();
    say(this.result, "");
    try {
      await this.form.load(type && `${type}_Request`, otherwise);
    } catch (error) {
      say(this.result, mistakeText(error), true);
    }
  }

  hideAnswer() {
    this.tree?.close();
    this.answer.hidden = true;
  }

  async call() {
    const service = this.choice.element.value;
    const request = { service, type: `${this.type}_Request`, values: this.form.values(), deadline: Number(this.deadline.value) };
    say(this.result, `waiting for ${service} …`);
    this.hideAnswer();
    set(this.button, "disabled", true);
    try {
      const { number, seconds, failure } = await this.context.do("call", request);
      const after = `${service} answered after ${(seconds * 1000).toFixed(0)} ms`;
      say(this.result, failure ? `${after}: ${failure}` : after, Boolean(failure));
      const about = element("span", { class: "muted" });
      this.tree = new MessageTree(this.context, "", (text) => write(about, text), "answer", { number });
      fill(this.answer, div("tools", element("h3", { class: "mono" }, service), about), this.tree.element);
      this.answer.hidden = false;
    } catch (error) {
      say(this.result, mistakeText(error), true);
    }
    set(this.button, "disabled", !this.context.canCommand);
  }
}

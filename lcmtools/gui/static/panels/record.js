// A recording on the server's computer: its topics, and what it has so far.

import { button, div, element, fill, write } from "../elements.js";
import { mistakeText } from "../texts.js";
import { onlyForCommanders, say } from "./form.js";

/** The panel for recording; all pages show the same recording. */
export default class Record {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    this.context = context;
    this.title = "Record";
    this.isRunning = false;
    this.offered = "";
    /** @type {Set<string>} */
    this.ticked = new Set(Array.isArray(settings.topics) ? settings.topics.map(String) : []);
    this.button = button("Record", () => this.press(), { class: "primary" });
    this.choice = element("span", { class: "muted" });
    this.topics = element("fieldset", { class: "form-fields plain", "aria-label": "Topics" });
    this.result = element("p", { class: "result", role: "status" });
    const rights = onlyForCommanders(context, this.button, this.topics);
    const tools = div("tools", this.button, this.choice, rights);
    this.element = div("publish", tools, this.topics, div("form-foot", this.result));
    this.showChoice();
    context.open("offers", {}, (data) => this.offer(data.topics));
    context.open("recording", {}, (data) => this.show(data));
  }

  settings() {
    return { topics: [...this.ticked] };
  }

  /** @param {string[]} topics */
  offer(topics) {
    const names = [...new Set([...topics, ...this.ticked])].sort();
    if (names.join(" ") === this.offered) return;
    this.offered = names.join(" ");
    fill(this.topics, names.map((name) => this.row(name)));
  }

  /** @param {string} name */
  row(name) {
    const onchange = () => {
      if (!this.ticked.delete(name)) this.ticked.add(name);
      this.showChoice();
      this.context.changed();
    };
    const box = element("input", { type: "checkbox", checked: this.ticked.has(name), onchange });
    return element("label", { class: "tick mono" }, box, name);
  }

  /** @param {string[]} topics that are recorded, by whichever page, or will be by this one */
  showChoice(topics = [...this.ticked]) {
    write(this.choice, topics.join(", ") || "all topics but hidden ones");
  }

  /** @param {{topics?: string[], seconds?: number, told: string, fault: string}} state */
  show({ topics, seconds, told, fault }) {
    this.isRunning = topics !== undefined;
    this.topics.hidden = this.isRunning;
    this.showChoice(topics);
    write(this.button, this.isRunning ? "Stop" : "Record");
    const text = this.isRunning ? `recording for ${seconds} s: ${told}` : told && `recorded ${told}`;
    say(this.result, [text, fault].filter(Boolean).join("; "), Boolean(fault));
  }

  async press() {
    try {
      if (this.isRunning) await this.context.do("stop-recording");
      else await this.context.do("record", { topics: [...this.ticked] });
      this.context.showProblem(this, "");
    } catch (error) {
      this.context.showProblem(this, mistakeText(error));
    }
  }
}

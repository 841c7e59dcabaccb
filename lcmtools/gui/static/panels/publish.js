// A form that publishes a message, once or at a rate.

import { button, div, element, fill, set, write } from "../elements.js";
import { clockText, mistakeText } from "../texts.js";
import { MessageForm, onlyForCommanders, say, sentBy } from "./form.js";

let forms = 0;

/** The form for a given topic, or for a topic that the user enters. */
export class PublishForm {
  /**
   * @param {import("../context.js").Context} context
   * @param {string} topic "" if the user enters it
   * @param {string} type "" if unknown
   */
  constructor(context, topic, type) {
    this.context = context;
    const list = `types-${++forms}`;
    /** @type {import("../connection.js").Stream | null} */
    this.stream = null;
    const onchange = () => this.loadTopic();
    this.topic = element("input", { "aria-label": "Topic", placeholder: "Topic", spellcheck: "false", onchange });
    this.topic.value = topic;
    const about = { "aria-label": "Type", placeholder: "Type", spellcheck: "false", list };
    this.type = element("input", { ...about, onchange: () => this.loadType() });
    this.type.value = type;
    this.types = element("datalist", { id: list });
    this.form = new MessageForm(context);
    this.rate = element("input", { class: "rate", "aria-label": "Rate [Hz]", inputmode: "decimal", value: "10" });
    this.once = button("Publish once", () => this.publish(), { class: "primary", title: "Ctrl-Enter" });
    this.repeat = button("Repeat", () => this.changeRepeat(), { "aria-pressed": "false" });
    const rights = onlyForCommanders(context, this.once, this.repeat);
    this.result = element("p", { class: "result", role: "status" });
    const rate = element("label", {}, "at ", this.rate, " Hz");
    this.element = element(
      "form",
      { class: "publish", "aria-label": "Publish", ...sentBy(this.once) },
      div("form-head", this.topic, this.type, this.types),
      this.form.element,
      div("form-foot", this.once, this.repeat, rate, rights, this.result),
    );
    this.loadType();
    this.listTypes();
  }

  async listTypes() {
    /** @type {string[]} */
    const names = await this.context.ask("types").catch(() => []); // it can be typed without suggestions
    fill(this.types, names.map((name) => element("option", { value: name })));
  }

  /** Fill in the type of the topic, if that is known and none was entered. */
  async loadTopic() {
    /** @type {{value: string, detail: string}[]} */
    const topics = await this.context.ask("topics", { kind: "any" }).catch(() => []);
    const name = this.topic.value.trim();
    const found = topics.find(({ value }) => value === name) ?? topics.find(({ value }) => value === `/${name}`);
    if (!found) return;
    this.topic.value = found.value;
    if (this.type.value.trim() || !found.detail) return;
    this.type.value = found.detail;
    await this.loadType();
  }

  async loadType() {
    this.close();
    try {
      this.type.value = await this.form.load(this.type.value.trim());
      say(this.result, "");
    } catch (error) {
      say(this.result, mistakeText(error), true);
    }
  }

  message() {
    return { topic: this.topic.value.trim(), type: this.type.value.trim(), values: this.form.values() };
  }

  async publish() {
    try {
      await this.context.do("publish", this.message());
      say(this.result, `published at ${clockText(Date.now() / 1000)}`);
    } catch (error) {
      say(this.result, mistakeText(error), true);
    }
  }

  changeRepeat() {
    if (this.stream) {
      this.close();
      return;
    }
    const rate = Number(this.rate.value);
    if (!(rate >= 0.01 && rate <= 200)) {
      say(this.result, "the rate is from 0.01 to 200 Hz", true);
      this.rate.focus();
      return;
    }
    set(this.repeat, "aria-pressed", "true");
    write(this.repeat, "Stop");
    this.stream = this.context.open(
      "publishing",
      { ...this.message(), rate },
      (data) => say(this.result, `published ${data.count}`),
      (text) => {
        if (!text) return;
        this.close();
        say(this.result, text, true);
      },
    );
  }

  close() {
    this.stream?.close();
    this.stream = null;
    set(this.repeat, "aria-pressed", "false");
    write(this.repeat, "Repeat");
  }
}

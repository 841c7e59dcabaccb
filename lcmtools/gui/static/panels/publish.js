// A form that publishes a message: an input for each number and text, arrays as YAML.

import { button, element, fill, set, write } from "../elements.js";
import { mistakeText } from "../texts.js";

let forms = 0;

/** @typedef {import("./message.js").Field} Field */

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
    /** @type {Field[]} */
    this.fields = [];
    /** @type {import("../connection.js").Stream | null} */
    this.stream = null;
    /** @type {Map<string, any>} */
    this.inputs = new Map();
    this.topic = element("input", { "aria-label": "Topic", placeholder: "Topic", spellcheck: "false" });
    this.topic.value = topic;
    this.type = element("input", {
      "aria-label": "Type",
      placeholder: "Type",
      spellcheck: "false",
      list,
      onchange: () => this.loadType(),
    });
    this.type.value = type;
    this.types = element("datalist", { id: list });
    this.body = element("div", { class: "form-fields" });
    this.rate = element("input", { class: "rate", "aria-label": "Rate [Hz]", inputmode: "decimal", value: "10" });
    this.once = element("button", { type: "submit", class: "primary" }, "Publish once");
    this.repeat = button("Repeat", () => this.changeRepeat(), { "aria-pressed": "false" });
    this.rights = element("p", { class: "muted" }, "this page may only watch, not command");
    this.result = element("p", { class: "result", role: "status" });
    this.element = element(
      "form",
      {
        class: "publish",
        "aria-label": "Publish",
        onsubmit: (/** @type {Event} */ event) => {
          event.preventDefault();
          this.publish();
        },
      },
      element("div", { class: "form-head" }, this.topic, this.type, this.types),
      this.body,
      element("div", { class: "form-foot" }, this.once, this.repeat, element("label", {}, "at ", this.rate, " Hz"), this.rights, this.result),
    );
    context.onChange(() => this.showRights());
    this.loadType();
    this.listTypes();
  }

  close() {
    this.stop();
  }

  showRights() {
    const may = this.context.canCommand;
    set(this.once, "disabled", !may);
    set(this.repeat, "disabled", !may);
    this.rights.hidden = may || !this.context.connection.isOpen;
  }

  async listTypes() {
    try {
      const names = await this.context.ask("types");
      fill(this.types, names.map((/** @type {string} */ name) => element("option", { value: name })));
    } catch {
      // the type can be typed without suggestions
    }
  }

  async loadType() {
    const type = this.type.value.trim();
    this.stop();
    this.inputs.clear();
    if (!type) {
      fill(this.body, element("p", { class: "muted" }, "Choose a type."));
      return;
    }
    try {
      const about = await this.context.ask("type", { type });
      this.fields = about.fields;
      this.type.value = about.type;
      this.say("");
      fill(this.body, about.comment ? element("p", { class: "muted" }, about.comment) : null, this.rows(about.fields, ""));
    } catch (error) {
      fill(this.body);
      this.say(mistakeText(error), true);
    }
  }

  /**
   * @param {Field[]} fields
   * @param {string} before
   * @returns {HTMLElement[]}
   */
  rows(fields, before) {
    return fields.map((field) => {
      const path = before ? `${before}.${field.name}` : field.name;
      if (field.fields.length && !field.isArray) {
        return element(
          "fieldset",
          {},
          element("legend", { title: field.comment || null }, field.name, " ", element("small", {}, field.type)),
          this.rows(field.fields, path),
        );
      }
      const input = this.input(field);
      this.inputs.set(path, input);
      return element(
        "label",
        { class: "form-row", title: field.comment || null },
        element("span", {}, field.name),
        input,
        element("small", {}, field.unit || field.type),
      );
    });
  }

  /** @param {Field} field */
  input(field) {
    const about = { spellcheck: "false", autocomplete: "off" };
    if (field.isArray) return element("input", { ...about, class: "mono", placeholder: "[] in YAML" });
    if (field.type === "bool") return element("input", { type: "checkbox", checked: field.default === true });
    if (field.isTime) return element("input", { ...about, class: "mono", value: field.type.endsWith("Duration") ? "0" : "now" });
    const isNumber = typeof field.default === "number";
    const input = element("input", { ...about, class: isNumber ? "mono" : null, inputmode: isNumber ? "decimal" : null });
    input.value = String(field.default ?? "");
    return input;
  }

  values() {
    /** @type {Record<string, any>} */
    const values = {};
    for (const [path, input] of this.inputs) {
      const parts = path.split(".");
      const last = /** @type {string} */ (parts.pop());
      let inner = values;
      for (const part of parts) inner = inner[part] ??= {};
      inner[last] = input.type === "checkbox" ? input.checked : input.value;
    }
    return values;
  }

  message() {
    return { topic: this.topic.value.trim(), type: this.type.value.trim(), values: this.values() };
  }

  async publish() {
    try {
      await this.context.do("publish", this.message());
      this.say(`published at ${new Date().toLocaleTimeString()}`);
    } catch (error) {
      this.say(mistakeText(error), true);
    }
  }

  changeRepeat() {
    if (this.stream) {
      this.stop();
      return;
    }
    const rate = Number(this.rate.value);
    if (!(rate >= 0.01 && rate <= 200)) {
      this.say("the rate is from 0.01 to 200 Hz", true);
      this.rate.focus();
      return;
    }
    set(this.repeat, "aria-pressed", "true");
    write(this.repeat, "Stop");
    this.stream = this.context.open(
      "publishing",
      { ...this.message(), rate },
      (data) => this.say(`published ${data.count}`),
      (text) => {
        if (text) this.stop();
        if (text) this.say(text, true);
      },
    );
  }

  stop() {
    this.stream?.close();
    this.stream = null;
    set(this.repeat, "aria-pressed", "false");
    write(this.repeat, "Repeat");
  }

  /**
   * @param {string} text
   * @param {boolean} [isError]
   */
  say(text, isError = false) {
    write(this.result, text);
    this.result.classList.toggle("is-bad", isError);
  }
}

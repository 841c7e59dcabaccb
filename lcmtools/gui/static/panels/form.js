// A form for a message: an input for each number and text, arrays as YAML; and who may send it.

import { element, fill, set, write } from "../elements.js";

/** @typedef {import("./message.js").Field} Field */

/** The attributes of an input for names and numbers. */
export const TYPED = { spellcheck: "false", autocomplete: "off" };

/** The fields of a message, for a type that is loaded. */
export class MessageForm {
  /** @param {import("../context.js").Context} context */
  constructor(context) {
    this.context = context;
    /** @type {Map<string, any>} */
    this.inputs = new Map();
    this.asked = 0;
    this.element = element("div", { class: "form-fields" });
  }

  /**
   * Show the fields of a type; without one, a text instead. Return the type's full name.
   * @param {string} type
   * @param {string} [otherwise]
   * @returns {Promise<string>} rejected with an Error
   */
  async load(type, otherwise = "Choose a type.") {
    const asked = ++this.asked;
    this.inputs.clear();
    fill(this.element, type ? null : element("p", { class: "muted" }, otherwise));
    if (!type) return "";
    const about = await this.context.ask("type", { type });
    if (asked !== this.asked) return type; // another type has been chosen meanwhile
    const comment = about.comment ? element("p", { class: "muted" }, about.comment) : null;
    fill(this.element, comment, this.rows(about.fields, ""));
    return about.type;
  }

  /** @param {Field[]} fields @param {string} before @returns {HTMLElement[]} */
  rows(fields, before) {
    return fields.map((field) => {
      const path = before ? `${before}.${field.name}` : field.name;
      if (field.fields.length && !field.isArray) {
        const legend = [field.name, " ", element("small", {}, field.type)];
        const head = element("legend", { title: field.comment || null }, legend);
        return element("fieldset", {}, head, this.rows(field.fields, path));
      }
      const input = this.input(field);
      this.inputs.set(path, input);
      const parts = [element("span", {}, field.name), input, element("small", {}, field.unit || field.type)];
      return element("label", { class: "form-row", title: field.comment || null }, parts);
    });
  }

  /** @param {Field} field */
  input(field) {
    if (field.isArray) return element("input", { ...TYPED, class: "mono", placeholder: "[] in YAML" });
    if (field.type === "bool") return element("input", { type: "checkbox", checked: field.default === true });
    const value = field.isTime ? (field.type.endsWith("Duration") ? "0" : "now") : (field.default ?? "");
    const isNumber = typeof field.default === "number";
    const look = { class: isNumber || field.isTime ? "mono" : null, inputmode: isNumber ? "decimal" : null };
    return element("input", { ...TYPED, ...look, value });
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
}

/**
 * Disable buttons and inputs while the page may not command; return a line that says so.
 * @param {import("../context.js").Context} context
 * @param {...Element} controls
 */
export function onlyForCommanders(context, ...controls) {
  const line = element("p", { class: "muted" }, "this page may only watch, not command");
  context.onChange(() => {
    for (const control of controls) set(control, "disabled", !context.canCommand);
    line.hidden = context.canCommand || !context.connection.isOpen;
  });
  return line;
}

/**
 * Return the handlers of a form that is sent by its button or Ctrl-Enter, and not by Enter in an input.
 * @param {HTMLButtonElement} sender
 */
export function sentBy(sender) {
  return {
    onsubmit: (/** @type {Event} */ event) => event.preventDefault(),
    onkeydown: (/** @type {KeyboardEvent} */ event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) sender.click();
    },
  };
}

/**
 * Write the result of an action.
 * @param {Element} target
 * @param {string} text
 * @param {boolean} [isBad]
 */
export function say(target, text, isBad = false) {
  write(target, text);
  target.classList.toggle("is-bad", isBad);
}

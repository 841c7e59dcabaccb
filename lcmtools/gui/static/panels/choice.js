// An input for the name of a topic or a field, with suggestions.

import { element, fill } from "../elements.js";
import { stylesheet } from "./stylesheet.js";

let count = 0;

/**
 * Create an input with suggestions, which are requested when it is used.
 * @param {object} options
 * @param {string} options.label
 * @param {string} [options.value]
 * @param {string} [options.placeholder]
 * @param {(text: string) => Promise<{value: string, detail?: string}[]>} options.suggest
 * @param {(value: string) => void} options.choose called with the entered text
 */
export function choiceField({ label, value = "", placeholder = "", suggest, choose }) {
  stylesheet("./choice.css");
  const list = element("datalist", { id: `choices-${count++}` });
  const input = element("input", {
    type: "text",
    class: "choice mono",
    list: list.id,
    placeholder,
    "aria-label": label,
    title: label,
    autocomplete: "off",
    autocapitalize: "off",
    spellcheck: "false",
    onfocus: () => offer(),
    oninput: () => offer(),
    onchange: () => choose(input.value.trim()),
  });
  input.value = value;
  let asked = 0;
  async function offer() {
    const number = ++asked;
    /** @type {{value: string, detail?: string}[]} */
    const found = await suggest(input.value.trim()).catch(() => []);
    if (number === asked) fill(list, found.map(option));
  }
  return { element: element("span", { class: "choice-field" }, input, list), input };
}

/** @param {{value: string, detail?: string}} choice */
function option({ value, detail }) {
  return element("option", { value }, detail ?? null);
}

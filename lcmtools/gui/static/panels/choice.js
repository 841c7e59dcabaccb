// Inputs for a name: of a topic or a field, with suggestions, or one of a list.

import { element, fill, offer } from "../elements.js";
import { stylesheet } from "./stylesheet.js";

const LATER = 1000; // [ms] until candidates are asked for again
let count = 0;

/**
 * Create an input with suggestions, which are requested when it is used.
 * @param {object} options
 * @param {string} options.label
 * @param {string} [options.value]
 * @param {string} [options.placeholder]
 * @param {(text: string) => Promise<{value: string, detail?: string}[]>} options.suggest
 * @param {(value: string) => void} options.choose called with the entered text
 * @param {boolean} [options.fills] choose the only candidate at first
 */
export function choiceField({ label, value = "", placeholder = "", suggest, choose, fills = false }) {
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
    onfocus: suggestNow,
    oninput: suggestNow,
    onchange: () => choose(input.value.trim()),
  });
  input.value = value;
  let asked = 0;
  if (!value && fills) fillWithOnlyOne();
  /** Choose the only candidate when there is one, unless something was entered meanwhile. */
  async function fillWithOnlyOne() {
    const [only, other] = await suggest("").catch(() => []);
    if (other || input.value) return;
    if (!only) {
      setTimeout(() => input.isConnected && fillWithOnlyOne(), LATER);
      return;
    }
    input.value = only.value;
    choose(only.value);
  }
  async function suggestNow() {
    const number = ++asked;
    /** @type {{value: string, detail?: string}[]} */
    const found = await suggest(input.value.trim()).catch(() => []);
    const options = found.map(({ value: one, detail }) => element("option", { value: one }, detail));
    if (number === asked) fill(list, options);
  }
  return { element: element("span", { class: "choice-field" }, input, list), input };
}

/**
 * Create a list of names to choose from; the chosen one stays, even if it is not in the list.
 * @param {string} label
 * @param {unknown} wanted the chosen name at first
 * @param {() => void} choose called when another name is chosen
 * @param {object} [options]
 * @param {string} [options.none] the text of the choice without a name
 * @param {boolean} [options.fills] choose the only name at first
 */
export function nameList(label, wanted, choose, { none = `${label} …`, fills = false } = {}) {
  const select = element("select", { "aria-label": label, onchange: choose });
  /** @type {string | undefined} */
  let offered;
  /** @param {string[]} names */
  function offerNames(names, chosen = select.value) {
    const all = [...new Set([...names, chosen, ""])].sort();
    if (all.join(" ") === offered) return;
    offered = all.join(" ");
    offer(select, all.map((name) => [name, name || none]), chosen);
    if (!fills || !names.length) return;
    fills = false; // only at first
    if (names.length > 1 || chosen) return;
    select.value = names[0] ?? "";
    choose();
  }
  offerNames([], typeof wanted === "string" ? wanted : "");
  return { element: select, offer: offerNames };
}

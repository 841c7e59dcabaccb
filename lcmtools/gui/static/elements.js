// Functions that create DOM elements. Nothing here parses HTML: text from the bus stays text.

/**
 * @typedef {Node | string | null | undefined | false} Child
 * @typedef {string | number | boolean | null | undefined | EventListener} Attribute
 */

const SVG = "http://www.w3.org/2000/svg";

/**
 * Create an element. An attribute can be a function, for a listener ("onclick"), or true, for an
 * empty attribute; with false, null or undefined it is omitted.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, any>} [attributes]
 * @param {...(Child | Child[])} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function element(tag, attributes = {}, ...children) {
  return equip(document.createElement(tag), attributes, children);
}

/**
 * Create a div of a class.
 * @param {string} name
 * @param {...(Child | Child[])} children
 */
export function div(name, ...children) {
  return element("div", { class: name }, ...children);
}

/**
 * Create an SVG element.
 * @template {keyof SVGElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, any>} [attributes]
 * @param {...(Child | Child[])} children
 * @returns {SVGElementTagNameMap[T]}
 */
export function drawing(tag, attributes = {}, ...children) {
  return equip(document.createElementNS(SVG, tag), attributes, children);
}

/**
 * @template {Element} T
 * @param {T} made
 * @param {Record<string, any>} attributes
 * @param {(Child | Child[])[]} children
 */
function equip(made, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) set(made, name, value);
  fill(made, ...children);
  return made;
}

/**
 * Set an attribute or a listener of an element.
 * @param {Element} target
 * @param {string} name
 * @param {any} value
 */
export function set(target, name, value) {
  if (typeof value === "function") target.addEventListener(name.slice(2), value);
  else if (value === true) target.setAttribute(name, "");
  else if (value === false || value === null || value === undefined) target.removeAttribute(name);
  else if (target.getAttribute(name) !== String(value)) target.setAttribute(name, String(value));
}

/**
 * Set a text if it has changed, so that the browser does not lay out the page needlessly.
 * @param {Node} target
 * @param {string} text
 */
export function write(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

/**
 * Replace the children of an element.
 * @param {Element} target
 * @param {...(Child | Child[])} children
 */
export function fill(target, ...children) {
  const present = children.flat().filter(Boolean);
  target.replaceChildren(.../** @type {(Node | string)[]} */ (present));
}

/** The paths of the icons, in a square of 16 by 16. */
const ICONS = {
  add: "M8 3v10M3 8h10",
  close: "M4 4l8 8M12 4l-8 8",
  larger: "M3 6V3h3M10 3h3v3M13 10v3h-3M6 13H3v-3",
  smaller: "M6 3v3H3M13 6h-3V3M10 13v-3h3M3 10h3v3",
  menu: "M3.5 8h.01M8 8h.01M12.5 8h.01",
  theme: "M8 2.5a5.5 5.5 0 1 0 0 11zM8 2.5a5.5 5.5 0 0 1 0 11",
  link: "M6.5 9.5l3-3M7 4.5l1-1a2.8 2.8 0 0 1 4 4l-1 1M9 11.5l-1 1a2.8 2.8 0 0 1-4-4l1-1",
  pause: "M5.5 3.5v9M10.5 3.5v9",
  play: "M5 3.5l7 4.5-7 4.5z",
  step: "M4 3.5l6 4.5-6 4.5zM12 3.5v9",
  clear: "M3 4.5h10M6 4.5V3h4v1.5M4.5 4.5l.6 8.5h5.8l.6-8.5",
  settings: "M3 5h6M11.5 5H13M3 11h1.5M7 11h6M10 3.5v3M5.5 9.5v3",
  save: "M8 2.5v7M5 7l3 3 3-3M3 13h10",
  plot: "M2.5 12.5h11M3 10l3-4 3 2.5 4-5.5",
  undo: "M3.5 8a4.5 4.5 0 1 0 1.5-3.4M3.5 3v3h3",
  layouts: "M2.5 3h11v10h-11zM7 3v10M7 8h6.5",
};

/**
 * Create an icon; it is hidden from screen readers because its button has a label.
 * @param {keyof typeof ICONS} name
 */
export function icon(name) {
  return drawing(
    "svg",
    { viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true" },
    drawing("path", { d: ICONS[name] }),
  );
}

/**
 * Create a button with text.
 * @param {Child | Child[]} label
 * @param {(event: Event) => void} onclick
 * @param {Record<string, any>} [attributes]
 */
export function button(label, onclick, attributes = {}) {
  return element("button", { type: "button", ...attributes, onclick }, label);
}

/**
 * Create a button with an icon, and a label for screen readers and its tooltip.
 * @param {keyof typeof ICONS} name
 * @param {string} label
 * @param {(event: Event) => void} onclick
 * @param {Record<string, any>} [attributes]
 */
export function iconButton(name, label, onclick, attributes = {}) {
  const made = button(null, onclick, { class: "icon-button", ...attributes });
  relabel(made, name, label);
  return made;
}

/** The attributes of a button that opens a menu. */
export const OPENS_MENU = { "aria-haspopup": "menu", "aria-expanded": "false" };

/**
 * Change the icon of a button and its label.
 * @param {HTMLButtonElement} target
 * @param {keyof typeof ICONS} name
 * @param {string} label
 */
export function relabel(target, name, label) {
  if (target.title === label) return;
  fill(target, icon(name));
  set(target, "title", label);
  set(target, "aria-label", label);
}

/**
 * Create an input that searches while the user types.
 * @param {string} placeholder
 * @param {string} label
 * @param {unknown} value at first, if it is a text
 * @param {() => void} oninput
 */
export function searchField(placeholder, label, value, oninput) {
  const made = element("input", { type: "search", placeholder, "aria-label": label, oninput });
  made.value = typeof value === "string" ? value : "";
  return made;
}

/**
 * Create a select; each option is a value and its text.
 * @param {string} label
 * @param {[value: string, text: string][]} options
 * @param {string} value
 * @param {(value: string) => void} choose
 */
export function selection(label, options, value, choose) {
  const made = element("select", { "aria-label": label, title: label, onchange: () => choose(made.value) });
  offer(made, options, value);
  return made;
}

/**
 * Replace the options of a select.
 * @param {HTMLSelectElement} select
 * @param {[value: string, text: string][]} options
 * @param {string} value
 */
export function offer(select, options, value) {
  fill(select, options.map(([one, text]) => element("option", { value: one }, text)));
  select.value = value;
}

/**
 * Show a menu at a button until an entry is chosen or the focus leaves it.
 * @param {HTMLElement} opener
 * @param {{label: string, detail?: string, run: () => void, disabled?: boolean}[]} entries
 */
export function openMenu(opener, entries) {
  /** @type {HTMLButtonElement[]} */
  const items = entries.map(({ label, detail, run, disabled }) => {
    const choose = () => {
      close(true);
      run();
    };
    const words = [element("span", {}, label), detail ? element("small", {}, detail) : null];
    return button(words, choose, { role: "menuitem", disabled });
  });
  const menu = element("div", { class: "menu", role: "menu", "aria-label": opener.title }, items);
  let isOpen = true;
  /** @param {boolean} comesBack */
  function close(comesBack) {
    if (!isOpen) return; // removing a focused element also triggers focusout
    isOpen = false;
    menu.remove();
    opener.setAttribute("aria-expanded", "false");
    if (comesBack) opener.focus();
  }
  menu.addEventListener("focusout", (event) => {
    if (!menu.contains(/** @type {Node | null} */ (event.relatedTarget))) close(false);
  });
  menu.addEventListener("keydown", (event) => {
    const active = items.filter((item) => !item.disabled);
    const place = active.indexOf(/** @type {HTMLButtonElement} */ (document.activeElement));
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) active[(place + step + active.length) % active.length]?.focus();
    else if (event.key === "Home") active[0]?.focus();
    else if (event.key === "End") active.at(-1)?.focus();
    else if (event.key === "Escape") close(true);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  document.body.append(menu);
  placeAt(menu, opener);
  opener.setAttribute("aria-expanded", "true");
  items.find((item) => !item.disabled)?.focus();
}

/** Place something below its opener, within the page. @param {HTMLElement} shown @param {HTMLElement} opener */
function placeAt(shown, opener) {
  const at = opener.getBoundingClientRect();
  shown.style.top = `${Math.min(at.bottom + 4, innerHeight - shown.offsetHeight - 8)}px`;
  shown.style.left = `${Math.max(8, Math.min(at.left, innerWidth - shown.offsetWidth - 8))}px`;
}

/**
 * Create a button that shows rarely used tools, until Escape or a press elsewhere.
 * @param {string} label
 * @param {string} title
 * @param {...(Child | Child[])} tools
 */
export function more(label, title, ...tools) {
  const shown = element("div", { class: "menu more", popover: "auto", role: "group", "aria-label": title }, ...tools);
  const opener = button(label, () => {}, { title, "aria-expanded": "false" });
  opener.popoverTargetElement = shown;
  shown.addEventListener("toggle", ({ newState }) => {
    set(opener, "aria-expanded", String(newState === "open"));
    if (newState === "open") placeAt(shown, opener);
  });
  return [opener, shown];
}

// A topic's latest message as a tree, with the comments and units of its type.

import { element, iconButton, set, write } from "../elements.js";

/**
 * @typedef {{name: string, type: string, comment: string, unit: string, isArray: boolean,
 *   isTime: boolean, fields: Field[], default: any}} Field
 * @typedef {{type: string, comment: string, fields: Field[]}} Type
 * @typedef {[path: string, label: string, depth: number, text: string, opens: 0 | 1 | 2,
 *   isNumber: boolean]} Line
 */

/** The tree of one topic's messages, or of an answer. */
export class MessageTree {
  /**
   * @param {import("../context.js").Context} context
   * @param {string} topic "" for messages that are not of a topic
   * @param {(text: string) => void} onAbout called with a summary of each message
   * @param {string} [stream] the stream that they come by
   * @param {object} [source] its parameters
   */
  constructor(context, topic, onAbout, stream = "message", source = { topic }) {
    this.context = context;
    this.topic = topic;
    this.source = source;
    this.onAbout = onAbout;
    /** @type {Set<string>} */
    this.toggled = new Set();
    /** @type {Line[]} */
    this.lines = [];
    this.focused = "";
    this.type = "";
    /** @type {Map<string, Field>} */
    this.fields = new Map();
    this.element = element("div", {
      class: "tree",
      role: "tree",
      "aria-label": topic ? `Message of ${topic}` : "Answer",
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.press(event),
    });
    this.stream = context.open(stream, this.parameters(), (data) => this.receive(data));
  }

  parameters() {
    return { ...this.source, toggled: [...this.toggled] };
  }

  close() {
    this.stream.close();
  }

  /** @param {any} data */
  receive(data) {
    const { type, size, lines, bytes } = data;
    this.onAbout(`${type || "unknown type"}${size === undefined ? "" : `, ${size} B`}`);
    if (type !== this.type) this.loadType(type);
    this.lines = lines ?? hexLines(bytes ?? "");
    this.show();
  }

  /** @param {string} type */
  async loadType(type) {
    this.type = type;
    this.fields = new Map();
    if (!type) return;
    try {
      const about = await this.context.ask("type", { type });
      if (type === this.type) this.fields = new Map(withPaths(about.fields));
      this.show();
    } catch {
      // the message is shown without comments
    }
  }

  show() {
    const rows = this.element.children;
    while (rows.length > this.lines.length) rows[rows.length - 1]?.remove();
    while (rows.length < this.lines.length) this.element.append(this.row());
    if (!this.lines.some(([path]) => path === this.focused)) this.focused = this.lines[0]?.[0] ?? "";
    this.lines.forEach((line, index) => this.fill(/** @type {HTMLElement} */ (rows[index]), line));
  }

  row() {
    const parts = ["tree-name", "tree-value mono", "tree-unit", "tree-comment"].map((name) => element("span", { class: name }));
    const onclick = () => this.choose(row.dataset.path ?? "");
    const row = element("div", { role: "treeitem", class: "tree-row", onclick }, parts);
    return row;
  }

  /** @param {HTMLElement} row @param {Line} line */
  fill(row, [path, label, depth, text, opens, isNumber]) {
    const field = this.fields.get(path.replace(/\[\d*\]/g, ""));
    const [name, value, unit, comment] = row.children;
    row.dataset.path = path;
    set(row, "aria-level", depth + 1);
    set(row, "aria-expanded", opens ? String(opens === 2) : null);
    set(row, "tabindex", path === this.focused ? 0 : -1);
    row.style.setProperty("--depth", String(depth));
    write(/** @type {Element} */ (name), label);
    write(/** @type {Element} */ (value), text);
    set(/** @type {Element} */ (value), "title", text.length > 20 ? text : null);
    value?.classList.toggle("is-number", isNumber);
    write(/** @type {Element} */ (unit), field && isNumber ? field.unit : "");
    write(/** @type {Element} */ (comment), field?.comment ?? "");
    set(row, "title", field?.comment || null);
    this.offerPlot(row, path, isNumber);
  }

  /** @param {HTMLElement} row @param {string} path @param {boolean} isNumber */
  offerPlot(row, path, isNumber) {
    const button = row.children[4];
    if (!isNumber || !this.topic) button?.remove();
    else if (!button) {
      const plot = (/** @type {Event} */ event) => {
        event.stopPropagation();
        this.context.add("plot", { fields: [`${this.topic}/${row.dataset.path}`] });
      };
      row.append(iconButton("plot", `Plot ${path}`, plot, { tabindex: -1 }));
    }
  }

  /** @param {string} path */
  choose(path) {
    this.focused = path;
    const line = this.lines.find(([one]) => one === path);
    if (line?.[4]) this.toggle(path);
    this.show();
    this.rowOf(path)?.focus({ preventScroll: true });
  }

  /** @param {string} path */
  toggle(path) {
    if (!this.toggled.delete(path)) this.toggled.add(path);
    this.stream.change(this.parameters());
  }

  /** @param {string} path */
  rowOf(path) {
    const index = this.lines.findIndex(([one]) => one === path);
    return /** @type {HTMLElement | undefined} */ (this.element.children[index]);
  }

  /** @param {KeyboardEvent} event */
  press(event) {
    const index = this.lines.findIndex(([path]) => path === this.focused);
    const line = this.lines[index];
    if (!line || event.target instanceof HTMLButtonElement) return;
    const [path, , depth, , opens] = line;
    let next = index;
    if (event.key === "ArrowDown") next = index + 1;
    else if (event.key === "ArrowUp") next = index - 1;
    else if (event.key === "Home") next = 0;
    else if (event.key === "End") next = this.lines.length - 1;
    else if (event.key === "ArrowRight" && opens === 2) next = index + 1;
    else if (event.key === "ArrowLeft" && opens !== 2) {
      next = this.lines.slice(0, index).findLastIndex((other) => other[2] < depth);
    } else if ((event.key === "ArrowRight" && opens === 1) || (event.key === "ArrowLeft" && opens === 2)) {
      this.toggle(path);
    } else if (event.key === "Enter" || event.key === " ") {
      if (opens) this.toggle(path);
      else if (line[5]) /** @type {HTMLElement} */ (this.rowOf(path)?.children[4])?.click();
    } else return;
    event.preventDefault();
    this.focused = this.lines[Math.max(0, Math.min(next, this.lines.length - 1))]?.[0] ?? path;
    this.show();
    this.rowOf(this.focused)?.focus();
  }
}

/**
 * Return the fields of a type with their paths, without array indices.
 * @param {Field[]} fields
 * @param {string} [before] the start of their paths
 * @returns {[path: string, field: Field][]}
 */
function withPaths(fields, before = "") {
  return fields.flatMap((field) => {
    const path = before + field.name;
    return [[path, field], ...withPaths(field.fields, `${path}.`)];
  });
}

/**
 * Return the lines for bytes that cannot be decoded.
 * @param {string} hex
 * @returns {Line[]}
 */
function hexLines(hex) {
  const rows = hex.match(/.{1,32}/g) ?? [];
  return rows.map((row, index) => {
    const bytes = row.match(/../g) ?? [];
    return [`${index}`, (index * 16).toString(16).padStart(4, "0"), 0, bytes.join(" "), 0, false];
  });
}

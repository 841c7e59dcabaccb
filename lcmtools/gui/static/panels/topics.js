// The topics: a table of all, sorted and filtered.

import { element, fill, set, write } from "../elements.js";

/**
 * @typedef {{topic: string, types: string[], isAnnounced: boolean, messages: number,
 *   rate: number | null, jitter: number | null, bandwidth: number | null, lost: number | null,
 *   loss: number | null, senders: string[], listeners: string[], age: number | null,
 *   isSilent: boolean}} Row
 * @typedef {{name: string, title: string, isNumber?: boolean, text: (row: Row) => string,
 *   key: (row: Row) => string | number | null}} Column
 */

/** @type {Column[]} */
const COLUMNS = [
  { name: "topic", title: "Topic", text: (row) => row.topic, key: (row) => row.topic },
  { name: "type", title: "Type", text: typeText, key: (row) => row.types[0] ?? null },
  { name: "rate", title: "Rate", isNumber: true, text: (row) => rateText(row.rate), key: (row) => row.rate },
  {
    name: "bandwidth",
    title: "Bandwidth",
    isNumber: true,
    text: (row) => (row.bandwidth === null ? "–" : `${sizeText(row.bandwidth)}/s`),
    key: (row) => row.bandwidth,
  },
  { name: "loss", title: "Loss", isNumber: true, text: lossText, key: (row) => row.loss },
  { name: "age", title: "Last", isNumber: true, text: (row) => ageText(row.age), key: (row) => row.age },
  { name: "senders", title: "Senders", text: (row) => row.senders.join(", ") || "–", key: (row) => row.senders[0] ?? null },
  { name: "listeners", title: "Listeners", text: (row) => row.listeners.join(", ") || "–", key: (row) => row.listeners[0] ?? null },
];

/** The panel of the topics. */
export default class Topics {
  /**
   * @param {import("../context.js").Context} context
   * @param {any} settings
   */
  constructor(context, settings) {
    this.context = context;
    this.title = "Topics";
    this.sort = COLUMNS.some(({ name }) => name === settings.sort) ? settings.sort : "topic";
    this.isReversed = settings.reverse === true;
    /** @type {Row[]} */
    this.rows = [];
    /** @type {Map<string, HTMLTableRowElement>} */
    this.lines = new Map();
    this.filter = element("input", {
      type: "search",
      placeholder: "Filter",
      "aria-label": "Filter topics",
      oninput: () => this.changed(),
    });
    this.filter.value = typeof settings.filter === "string" ? settings.filter : "";
    this.count = element("span", { class: "muted", role: "status" });
    this.head = element("tr");
    this.body = element("tbody");
    this.element = element(
      "div",
      { class: "topics" },
      element("div", { class: "tools" }, this.filter, this.count),
      element("div", { class: "table" }, element("table", {}, element("thead", {}, this.head), this.body)),
    );
    this.showHead();
    context.open("topics", {}, (data) => {
      this.rows = data.rows;
      this.show();
    });
  }

  settings() {
    return { sort: this.sort, reverse: this.isReversed, filter: this.filter.value };
  }

  close() {}

  changed() {
    this.show();
    this.context.changed();
  }

  showHead() {
    const cells = COLUMNS.map(({ name, title, isNumber }) => {
      const order = name !== this.sort ? "none" : this.isReversed ? "descending" : "ascending";
      const mark = { none: "", ascending: " ▴", descending: " ▾" }[order];
      const button = element("button", { type: "button", onclick: () => this.sortBy(name) }, title + mark);
      return element("th", { scope: "col", class: isNumber ? "number" : null, "aria-sort": order }, button);
    });
    fill(this.head, cells);
  }

  /** @param {string} name */
  sortBy(name) {
    const isNumber = COLUMNS.find((column) => column.name === name)?.isNumber ?? false;
    this.isReversed = name === this.sort ? !this.isReversed : isNumber;
    this.sort = name;
    const place = COLUMNS.findIndex((column) => column.name === name);
    this.showHead();
    this.head.querySelectorAll("button")[place]?.focus();
    this.changed();
  }

  show() {
    const wanted = this.filter.value.toLowerCase();
    const found = this.rows.filter((row) =>
      [row.topic, ...row.types, ...row.senders, ...row.listeners].some((text) => text.toLowerCase().includes(wanted)),
    );
    found.sort((a, b) => this.compare(a, b));
    const names = new Set(found.map((row) => row.topic));
    for (const [name, line] of [...this.lines]) {
      if (!names.has(name)) {
        line.remove();
        this.lines.delete(name);
      }
    }
    found.forEach((row, index) => {
      const line = this.line(row);
      if (this.body.children[index] !== line) this.body.insertBefore(line, this.body.children[index] ?? null);
    });
    const all = `${this.rows.length} topics`;
    write(this.count, found.length === this.rows.length ? all : `${found.length} of ${all}`);
  }

  /**
   * @param {Row} a
   * @param {Row} b
   */
  compare(a, b) {
    const column = COLUMNS.find(({ name }) => name === this.sort);
    const [one, other] = [column?.key(a) ?? null, column?.key(b) ?? null];
    if (one === null || other === null) return Number(one === null) - Number(other === null);
    const order = one < other ? -1 : one > other ? 1 : 0;
    return (this.isReversed ? -order : order) || (a.topic < b.topic ? -1 : 1);
  }

  /** @param {Row} row */
  line(row) {
    let line = this.lines.get(row.topic);
    if (!line) {
      line = element(
        "tr",
        {},
        COLUMNS.map(({ isNumber }) => element("td", { class: isNumber ? "number" : null })),
      );
      this.lines.set(row.topic, line);
    }
    line.classList.toggle("is-silent", row.isSilent);
    COLUMNS.forEach((column, index) => {
      const cell = /** @type {HTMLElement} */ (line.children[index]);
      const text = column.text(row);
      write(cell, text);
      if (!column.isNumber) set(cell, "title", text);
    });
    line.children[4]?.classList.toggle("is-bad", Boolean(row.lost));
    return line;
  }
}

/** @param {Row} row */
function typeText({ types, isAnnounced }) {
  const [first, ...others] = types;
  return first ? (others.length && !isAnnounced ? `${first} +${others.length}` : first) : "unknown";
}

/** @param {number | null} rate */
function rateText(rate) {
  if (rate === null) return "–";
  return `${rate >= 100 ? rate.toFixed(0) : rate.toFixed(1)} Hz`;
}

/** @param {number} bytes */
export function sizeText(bytes) {
  const units = ["B", "KB", "MB", "GB"];
  let value = bytes;
  let unit = 0;
  while (value >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  return `${value.toFixed(unit && value < 99.95 ? 1 : 0)} ${units[unit]}`;
}

/** @param {Row} row */
function lossText({ loss }) {
  if (loss === null) return "–";
  return loss ? `${(loss * 100).toFixed(loss < 0.1 ? 1 : 0)} %` : "0";
}

/** @param {number | null} age */
function ageText(age) {
  if (age === null) return "–";
  return age < 1 ? "now" : age < 120 ? `${age.toFixed(0)} s ago` : `${(age / 60).toFixed(0)} min ago`;
}

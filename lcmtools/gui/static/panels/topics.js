// The table of all topics, sorted and filtered, with the chosen topic's message or a form to publish.

import { button, div, element, fill, iconButton, searchField, set, write } from "../elements.js";
import { ageText, counted, jitterText, lossText, rateText, sizeText } from "../texts.js";
import { MessageTree } from "./message.js";
import { PublishForm } from "./publish.js";

/**
 * @typedef {{channel: string, types: string[], announced: boolean, messages: number,
 *   rate: number | null, jitter: number | null, bandwidth: number | null,
 *   senders_lost: number | null, senders_loss: number | null, senders: string[],
 *   listeners: string[] | null, age: number | null, silent: boolean}} Row null is not known
 * @typedef {{name: string, title: string, isNumber?: boolean, text: (row: Row) => string,
 *   key: (row: Row) => string | number | null}} Column
 */

/** @type {Column[]} */
const COLUMNS = [
  { name: "topic", title: "Topic", text: (row) => row.channel, key: (row) => row.channel },
  { name: "type", title: "Type", text: typeText, key: (row) => row.types[0] ?? null },
  numbers("rate", "Rate", (row) => row.rate, rateText),
  numbers("bandwidth", "Bandwidth", (row) => row.bandwidth, (rate) => `${sizeText(rate)}/s`),
  numbers("loss", "Loss", (row) => row.senders_loss, lossText),
  numbers("age", "Last", (row) => row.age, (age) => (age < 1 ? "now" : `${ageText(age)} ago`)),
  { name: "senders", title: "Senders", text: (row) => row.senders.join(", ") || "–", key: (row) => row.senders[0] ?? null },
  { name: "listeners", title: "Listeners", text: (row) => names(row.listeners, "–"), key: (row) => row.listeners?.[0] ?? null },
];

/** The topics panel. */
export default class Topics {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    this.context = context;
    this.title = "Topics";
    this.sort = COLUMNS.some(({ name }) => name === settings.sort) ? settings.sort : "topic";
    this.isReversed = settings.reverse === true;
    /** @type {Row[]} */
    this.rows = [];
    /** Programs that receive without saying what. @type {string[]} */
    this.programs = [];
    /** @type {Map<string, HTMLTableRowElement>} */
    this.lines = new Map();
    this.filter = searchField("Filter", "Filter topics", settings.filter, () => this.changed());
    this.count = element("span", { class: "muted", role: "status" });
    /** The topic in the lower part, null for none, "" if the user enters it. @type {string | null} */
    this.chosen = typeof settings.topic === "string" ? settings.topic : null;
    this.isPublishing = settings.publish === true;
    /** @type {MessageTree | PublishForm | null} */
    this.part = null;
    this.head = element("tr");
    this.body = element("tbody", { onkeydown: (/** @type {KeyboardEvent} */ event) => this.press(event) });
    this.detail = element("section", { class: "detail", hidden: true });
    this.facts = element("p", { class: "facts" });
    const publish = button("Publish …", () => this.choose("", true));
    const list = div(
      "topics-list",
      div("tools", this.filter, this.count, element("span", { class: "space" }), publish),
      div("table", element("table", {}, element("thead", {}, this.head), this.body)),
    );
    this.element = div("topics-panel", div("topics", list, this.detail));
    this.showHead();
    this.showDetail();
    context.open("topics", {}, (data) => {
      this.rows = data.rows;
      this.programs = data.programs;
      this.show();
      this.showFacts();
    });
  }

  settings() {
    const { sort, isReversed: reverse, chosen: topic, isPublishing: publish } = this;
    return { sort, reverse, filter: this.filter.value, topic, publish };
  }

  close() {
    this.part?.close();
  }

  /**
   * Show a topic's message, or a form to publish on it; null for neither.
   * @param {string | null} topic
   * @param {boolean} isPublishing
   */
  choose(topic, isPublishing) {
    this.chosen = topic;
    this.isPublishing = isPublishing;
    this.showDetail();
    this.changed();
  }

  showDetail() {
    this.part?.close();
    this.part = null;
    this.detail.hidden = this.chosen === null;
    if (this.chosen === null) return;
    const topic = this.chosen;
    const about = element("span", { class: "muted" });
    const row = this.rows.find((one) => one.channel === topic);
    this.part = this.isPublishing
      ? new PublishForm(this.context, topic, row?.types[0] ?? "")
      : new MessageTree(this.context, topic, (text) => write(about, text));
    const tab = (/** @type {string} */ label, isForm = false) =>
      button(label, () => this.choose(topic, isForm), { "aria-pressed": String(this.isPublishing === isForm) });
    fill(
      this.detail,
      div(
        "tools",
        element("h3", { class: "mono" }, topic || "Publish"),
        topic ? [tab("Message"), tab("Publish", true)] : null,
        about,
        element("span", { class: "space" }),
        iconButton("close", "Close the message", () => this.choose(null, false)),
      ),
      topic ? this.facts : null,
      this.part.element,
    );
    set(this.detail, "aria-label", topic || "Publish");
    this.showFacts();
  }

  showFacts() {
    const row = this.rows.find((one) => one.channel === this.chosen);
    if (!row) return write(this.facts, "");
    if (this.part instanceof PublishForm && !this.part.type.value && row.types[0]) {
      this.part.type.value = row.types[0]; // the form was opened before the topics were known
      this.part.loadType();
    }
    const jitter = known(row, row.jitter, jitterText);
    const others = row.types.length > 1 ? `; could be ${row.types.slice(1).join(", ")}` : "";
    const lost = row.senders_lost ? `; ${counted(row.senders_lost, "message")} of its senders lost` : "";
    write(
      this.facts,
      `${counted(row.messages, "message")}, ${known(row, row.rate, rateText)}, jitter ${jitter}${lost}${others}\n` +
        `from ${names(row.senders, "nobody")} to ${names(row.listeners, "no node")}` +
        (this.programs.length ? `; listening, to what is not known: ${this.programs.join(", ")}` : ""),
    );
  }

  /** @param {KeyboardEvent} event */
  press(event) {
    const rows = [...this.body.rows];
    const place = rows.findIndex((row) => row === event.target);
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (place < 0) return;
    if (step) this.focusRow(rows[place + step]);
    else if (event.key === "Enter" || event.key === " ") rows[place]?.click();
    else return;
    event.preventDefault();
  }

  /** @param {HTMLElement | undefined} row */
  focusRow(row) {
    if (!row) return;
    for (const one of this.body.rows) set(one, "tabindex", one === row ? 0 : -1);
    row.focus();
  }

  changed() {
    this.show();
    this.context.changed();
  }

  showHead() {
    const cells = COLUMNS.map(({ name, title, isNumber }) => {
      const order = name !== this.sort ? "none" : this.isReversed ? "descending" : "ascending";
      const mark = { none: "", ascending: " ▴", descending: " ▾" }[order];
      const about = { scope: "col", class: isNumber ? "number" : null, "aria-sort": order };
      return element("th", { ...about, "data-column": name }, button(title + mark, () => this.sortBy(name)));
    });
    fill(this.head, cells);
  }

  /** @param {string} name */
  sortBy(name) {
    const place = COLUMNS.findIndex((column) => column.name === name);
    this.isReversed = name === this.sort ? !this.isReversed : Boolean(COLUMNS[place]?.isNumber);
    this.sort = name;
    this.showHead();
    this.head.querySelectorAll("button")[place]?.focus();
    this.changed();
  }

  show() {
    const wanted = this.filter.value.toLowerCase();
    const found = this.rows.filter((row) =>
      [row.channel, ...row.types, ...row.senders, ...(row.listeners ?? [])].some((text) => text.toLowerCase().includes(wanted)),
    );
    found.sort((a, b) => this.compare(a, b));
    const names = new Set(found.map((row) => row.channel));
    for (const [name, line] of this.lines) {
      if (names.has(name)) continue;
      line.remove();
      this.lines.delete(name);
    }
    found.forEach((row, index) => {
      const line = this.line(row);
      if (this.body.children[index] !== line) this.body.insertBefore(line, this.body.children[index] ?? null);
    });
    const stop = this.body.querySelector("[tabindex='0']") ?? this.body.firstElementChild;
    if (stop) set(stop, "tabindex", 0);
    const all = counted(this.rows.length, "topic");
    write(this.count, found.length === this.rows.length ? all : `${found.length} of ${all}`);
  }

  /** @param {Row} a @param {Row} b */
  compare(a, b) {
    const column = COLUMNS.find(({ name }) => name === this.sort);
    const [one, other] = [column?.key(a) ?? null, column?.key(b) ?? null];
    if (one === null || other === null) return Number(one === null) - Number(other === null);
    const order = one < other ? -1 : one > other ? 1 : 0;
    return (this.isReversed ? -order : order) || (a.channel < b.channel ? -1 : 1);
  }

  /** @param {Row} row */
  line(row) {
    let line = this.lines.get(row.channel);
    if (!line) {
      const onclick = () => {
        const isShown = this.chosen === row.channel && !this.isPublishing;
        this.choose(isShown ? null : row.channel, false);
      };
      const cells = COLUMNS.map(({ name, isNumber }) =>
        element("td", { class: isNumber ? "number" : null, "data-column": name }),
      );
      line = element("tr", { tabindex: -1, onclick }, cells);
      this.lines.set(row.channel, line);
    }
    line.classList.toggle("is-silent", row.silent);
    set(line, "aria-selected", String(row.channel === this.chosen));
    COLUMNS.forEach((column, index) => {
      const cell = /** @type {HTMLElement} */ (line.cells[index]);
      const text = column.text(row);
      write(cell, text);
      if (!column.isNumber) set(cell, "title", text);
    });
    line.cells[4]?.classList.toggle("is-bad", Boolean(row.senders_lost));
    return line;
  }
}

/** @param {Row} row */
function typeText({ types, announced }) {
  const [first, ...others] = types;
  return first ? (others.length && !announced ? `${first} +${others.length}` : first) : "unknown";
}

/**
 * Return a column of numbers, some of which are unknown.
 * @param {string} name
 * @param {string} title
 * @param {(row: Row) => number | null} key
 * @param {(value: number) => string} text
 * @returns {Column}
 */
function numbers(name, title, key, text) {
  return { name, title, isNumber: true, key, text: (row) => known(row, key(row), text) };
}

/** @param {Row} row @param {number | null} value @param {(value: number) => string} text */
function known({ messages }, value, text) {
  return value !== null ? text(value) : messages > 1 ? "not known" : "–";
}

/** @param {string[] | null} all @param {string} none */
function names(all, none) {
  return all ? all.join(", ") || none : "not known";
}

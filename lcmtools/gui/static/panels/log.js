// The log of the nodes, filtered by level, node and text; repeated lines are shown once, counted.

import { div, element, iconButton, searchField, selection, set, write } from "../elements.js";
import { clockText, counted } from "../texts.js";
import { nameList } from "./choice.js";

const MOST = 2000; // lines kept
const NEAR = 12; // last lines that are searched for an equal one
/** @type {[number, string][]} */
const LEVELS = [[1, "DEBUG"], [2, "INFO"], [4, "WARN"], [8, "ERROR"], [16, "FATAL"]];

/**
 * @typedef {{time: number, level: number, node: string, text: string, place: string,
 *   count: number, row: HTMLTableRowElement | null, isPlaced: boolean}} LogLine ``isPlaced`` unless its
 *   row belongs elsewhere
 */

/** The log panel. */
export default class Log {
  /** @param {import("../context.js").Context} context @param {any} settings */
  constructor(context, settings) {
    this.context = context;
    this.title = "Log";
    /** @type {LogLine[]} */
    this.lines = [];
    this.isPaused = false;
    this.isAtEnd = true;
    this.leftOut = 0;
    const level = LEVELS.some(([one]) => one === settings.level) ? String(settings.level) : "1";
    this.level = selection("Lowest level", LEVELS.map(([one, name]) => [String(one), name]), level, () => this.changed());
    this.node = nameList("Node", settings.node, () => this.changed(), { none: "all nodes" });
    this.search = searchField("Search", "Search the lines", settings.search, () => this.changed());
    this.pause = iconButton("pause", "Pause", () => this.setPaused(!this.isPaused), { "aria-pressed": "false" });
    this.count = element("span", { class: "muted" });
    this.none = element("p", { class: "muted", hidden: true });
    this.body = element("tbody");
    this.scroller = element(
      "div",
      { class: "table", tabindex: 0, role: "log", "aria-label": "Log lines", "aria-live": "off" },
      element("table", { class: "log-lines" }, this.body),
      this.none,
    );
    this.scroller.addEventListener("scroll", () => {
      const { scrollTop, scrollHeight, clientHeight } = this.scroller;
      this.isAtEnd = scrollHeight - scrollTop - clientHeight < 30;
    });
    this.element = div(
      "log",
      div(
        "tools",
        this.level,
        this.node.element,
        this.search,
        this.pause,
        iconButton("clear", "Clear", () => this.clear()),
        this.count,
      ),
      this.scroller,
    );
    context.open("log", {}, (data) => this.receive(data));
    this.show();
  }

  settings() {
    return { level: Number(this.level.value), node: this.node.element.value, search: this.search.value };
  }

  changed() {
    this.isAtEnd = true;
    for (const line of this.lines) line.isPlaced = false;
    this.body.replaceChildren();
    this.show();
    this.context.changed();
  }

  clear() {
    this.lines = [];
    this.leftOut = 0;
    this.body.replaceChildren();
    this.showNodes();
    this.show();
  }

  /** @param {boolean} isPaused */
  setPaused(isPaused) {
    this.isPaused = isPaused;
    set(this.pause, "aria-pressed", String(isPaused));
    this.show();
  }

  /**
   * @param {{lines: [number, number, string, string, string][], leftOut: number, isFirst: boolean}} data
   *   ``isFirst`` of a stream, also after a lost connection: it has lines that are known
   */
  receive({ lines: all, leftOut, isFirst }) {
    const last = this.lines.at(-1)?.time ?? 0;
    const lines = isFirst ? all.filter(([time]) => time > last) : all;
    if (lines[0] && lines[0][0] < last - 1) this.clear(); // a played log has jumped back
    const nodes = new Set(this.lines.map((line) => line.node));
    for (const [time, level, node, text, place] of lines) this.add({ time, level, node, text, place, count: 1, row: null, isPlaced: false });
    this.leftOut += leftOut;
    for (const old of this.lines.splice(0, Math.max(0, this.lines.length - MOST))) old.row?.remove();
    if (lines.some(([, , node]) => !nodes.has(node))) this.showNodes();
    if (!this.isPaused) this.show();
  }

  /** @param {LogLine} line */
  add(line) {
    const known = this.lines
      .slice(-NEAR)
      .find((one) => one.text === line.text && one.node === line.node && one.level === line.level);
    if (known) {
      known.count += 1;
      known.time = line.time;
      known.isPlaced = false; // it belongs where its latest time is
      this.lines.splice(this.lines.lastIndexOf(known), 1);
    }
    const place = this.lines.findLastIndex(({ time }) => time <= line.time) + 1; // a long line comes later
    this.lines.splice(place, 0, known ?? line);
  }

  showNodes() {
    this.node.offer(this.lines.map(({ node }) => node));
  }

  show() {
    const wanted = this.search.value.toLowerCase();
    const lowest = Number(this.level.value);
    const node = this.node.element.value;
    let shown = 0;
    /** @type {HTMLTableRowElement | null} */
    let next = null;
    for (const line of this.lines.toReversed()) {
      const fits =
        line.level >= lowest &&
        (!node || line.node === node) &&
        (!wanted || line.text.toLowerCase().includes(wanted));
      if (!fits) continue;
      shown += 1;
      line.row ??= this.row(line);
      if (!line.isPlaced) this.body.insertBefore(line.row, next);
      line.isPlaced = true;
      next = line.row;
      write(/** @type {Element} */ (line.row.cells[0]), clockText(line.time));
      write(/** @type {Element} */ (line.row.cells[4]), line.count > 1 ? `× ${line.count}` : "");
    }
    const out = this.leftOut ? `, ${this.leftOut} left out` : "";
    write(this.count, `${counted(shown, "line")}${out}${this.isPaused ? ", paused" : ""}`);
    this.none.hidden = shown > 0;
    write(this.none, this.lines.length ? "No line fits the filter." : "No node has logged anything yet.");
    if (this.isAtEnd && !this.isPaused) this.scroller.scrollTop = this.scroller.scrollHeight;
  }

  /** @param {LogLine} line */
  row({ level, node, text, place }) {
    const name = LEVELS.findLast(([one]) => one <= level)?.[1] ?? "DEBUG";
    return element(
      "tr",
      { class: `level-${name.toLowerCase()}` },
      element("td", { class: "number" }),
      element("td", { class: "level" }, name),
      element("td", { title: node }, node),
      element("td", { class: "text", title: place || null }, text),
      element("td", { class: "number" }),
    );
  }
}

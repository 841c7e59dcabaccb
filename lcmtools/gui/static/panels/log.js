// The log of the nodes, filtered by level, node and text; repeated lines are shown once, counted.

import { element, fill, iconButton, set, write } from "../elements.js";
import { clockText } from "../texts.js";

const MOST = 2000; // lines kept
const NEAR = 12; // last lines that are searched for an equal one
/** @type {[number, string][]} */
const LEVELS = [
  [1, "DEBUG"],
  [2, "INFO"],
  [4, "WARN"],
  [8, "ERROR"],
  [16, "FATAL"],
];

/**
 * @typedef {{time: number, level: number, node: string, text: string, place: string,
 *   count: number, row: HTMLTableRowElement | null}} LogLine
 */

/** The log panel. */
export default class Log {
  /**
   * @param {import("../context.js").Context} context
   * @param {any} settings
   */
  constructor(context, settings) {
    this.context = context;
    this.title = "Log";
    /** @type {LogLine[]} */
    this.lines = [];
    this.isPaused = false;
    this.isAtEnd = true;
    this.leftOut = 0;
    this.level = element(
      "select",
      { "aria-label": "Lowest level", onchange: () => this.changed() },
      LEVELS.map(([level, name]) => element("option", { value: level }, name)),
    );
    this.level.value = LEVELS.some(([level]) => level === settings.level) ? String(settings.level) : "1";
    this.node = element("select", { "aria-label": "Node", onchange: () => this.changed() });
    this.wantedNode = typeof settings.node === "string" ? settings.node : "";
    this.search = element("input", {
      type: "search",
      placeholder: "Search",
      "aria-label": "Search the lines",
      oninput: () => this.changed(),
    });
    this.search.value = typeof settings.search === "string" ? settings.search : "";
    this.pause = iconButton("pause", "Pause", () => this.setPaused(!this.isPaused), { "aria-pressed": "false" });
    this.count = element("span", { class: "muted" });
    this.body = element("tbody");
    this.scroller = element(
      "div",
      { class: "table", tabindex: 0, role: "log", "aria-label": "Log lines", "aria-live": "off" },
      element("table", { class: "log-lines" }, this.body),
    );
    this.scroller.addEventListener("scroll", () => {
      const { scrollTop, scrollHeight, clientHeight } = this.scroller;
      this.isAtEnd = scrollHeight - scrollTop - clientHeight < 30;
    });
    this.element = element(
      "div",
      { class: "log" },
      element(
        "div",
        { class: "tools" },
        this.level,
        this.node,
        this.search,
        this.pause,
        iconButton("clear", "Clear", () => this.clear()),
        this.count,
      ),
      this.scroller,
    );
    this.showNodes();
    context.open("log", {}, (data) => this.receive(data));
  }

  settings() {
    return { level: Number(this.level.value), node: this.wantedNode, search: this.search.value };
  }

  close() {}

  changed() {
    this.wantedNode = this.node.value;
    this.isAtEnd = true;
    for (const line of this.lines) line.row = null;
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

  /** @param {{lines: [number, number, string, string, string][], leftOut: number}} data */
  receive({ lines, leftOut }) {
    const [first] = lines;
    const last = this.lines[this.lines.length - 1];
    if (first && last && first[0] < last.time - 1) this.clear(); // a played log has jumped back
    const nodes = new Set(this.lines.map((line) => line.node));
    for (const [time, level, node, text, place] of lines) this.add({ time, level, node, text, place, count: 1, row: null });
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
    } else this.lines.push(line);
  }

  showNodes() {
    const names = [...new Set([...this.lines.map((line) => line.node), this.wantedNode])].filter(Boolean).sort();
    fill(
      this.node,
      element("option", { value: "" }, "all nodes"),
      names.map((name) => element("option", { value: name }, name)),
    );
    this.node.value = this.wantedNode;
  }

  show() {
    const wanted = this.search.value.toLowerCase();
    const lowest = Number(this.level.value);
    let shown = 0;
    for (const line of this.lines) {
      const fits =
        line.level >= lowest &&
        (!this.wantedNode || line.node === this.wantedNode) &&
        (!wanted || line.text.toLowerCase().includes(wanted));
      if (!fits) continue;
      shown += 1;
      if (!line.row) {
        line.row = this.row(line);
        this.body.append(line.row);
      }
      write(/** @type {Element} */ (line.row.cells[0]), clockText(line.time));
      write(/** @type {Element} */ (line.row.cells[4]), line.count > 1 ? `× ${line.count}` : "");
    }
    const out = this.leftOut ? `, ${this.leftOut} left out` : "";
    write(this.count, `${shown} lines${out}${this.isPaused ? ", paused" : ""}`);
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

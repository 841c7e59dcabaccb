// The table below a plot: curves, their latest values, and their values at the pointer.

import { button, div, element, fill, iconButton, write } from "../../elements.js";
import { lineOf, nameOf } from "./chart.js";
import { rowAt } from "./curves.js";
import { numberText, timeText } from "./texts.js";

/** @typedef {import("./chart.js").Series} Series */

const PERIOD = 200; // [ms] between two updates of the numbers

/** The table of the curves. */
export class CurveTable {
  /**
   * @param {import("./chart.js").Chart} chart
   * @param {{toggle: (series: Series) => void, remove: (text: string) => void, about: () => string}} owner
   *   ``about`` is the line below the table
   */
  constructor(chart, owner) {
    this.chart = chart;
    this.owner = owner;
    /** The time at the pointer; NaN for none. */
    this.cursor = NaN;
    this.next = 0;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    /** @type {{latest: HTMLElement, atCursor: HTMLElement}[]} */
    this.cells = [];
    this.body = element("tbody");
    this.headLatest = element("th", { scope: "col", class: "number" }, "Latest");
    this.headCursor = element("th", { scope: "col", class: "number" });
    this.status = element("span", { class: "muted" });
    const name = element("th", { scope: "col" }, "Curve");
    const remove = element("th", { scope: "col" }, element("span", { class: "spoken" }, "Remove"));
    const head = element("tr", {}, name, this.headLatest, this.headCursor, remove);
    const caption = element("caption", { class: "spoken" }, "The curves and their latest values");
    const table = element("table", {}, caption, element("thead", {}, head), this.body);
    this.element = div("plot-table", table, this.status);
  }

  close() {
    clearTimeout(this.timer);
  }

  /**
   * Create the rows: one for each curve, and for each field without a curve yet.
   * @param {{text: string}[]} fields
   */
  make(fields) {
    this.cells = [];
    const { series } = this.chart;
    const lines = fields.flatMap(({ text }) => {
      const found = series.filter((one) => one.text === text);
      if (found.length) return found.map((one) => this.line(one));
      const name = element("span", { class: "curve mono muted" }, text);
      return this.row(text, name, element("td", { class: "number" }, "–"), element("td"));
    });
    fill(this.body, lines);
    this.next = 0;
  }

  /** @param {Series} series */
  line(series) {
    const { color, style } = lineOf(this.chart.series.indexOf(series));
    const swatch = element("span", { class: "swatch", "aria-hidden": "true" });
    swatch.style.borderTopColor = `var(${color})`;
    swatch.style.borderTopStyle = style;
    const about = { class: "curve mono", "aria-pressed": String(series.isShown), title: `Show or hide ${series.label}` };
    const toggle = button(nameOf(series), () => this.toggle(series), about);
    toggle.prepend(swatch);
    const [latest, atCursor] = [element("td", { class: "number" }), element("td", { class: "number" })];
    this.cells.push({ latest, atCursor });
    return this.row(series.text, toggle, latest, atCursor);
  }

  /** @param {string} text of the field @param {HTMLElement} head @param {...HTMLElement} cells */
  row(text, head, ...cells) {
    const remove = iconButton("close", `Remove ${text}`, () => this.owner.remove(text));
    return element("tr", {}, element("th", { scope: "row" }, head), cells, element("td", {}, remove));
  }

  /** @param {Series} series */
  toggle(series) {
    const index = this.chart.series.indexOf(series);
    this.owner.toggle(series);
    /** @type {NodeListOf<HTMLElement>} */ (this.body.querySelectorAll("button.curve"))[index]?.focus();
  }

  /** @param {number} time NaN for none */
  pointTo(time) {
    this.cursor = time;
    this.next = 0;
    this.show();
  }

  /** Update the numbers, several times a second. */
  show() {
    const now = performance.now();
    clearTimeout(this.timer);
    if (now < this.next) {
      this.timer = setTimeout(() => this.show(), this.next - now);
      return;
    }
    this.next = now + PERIOD;
    const { curves, span, origin, series } = this.chart;
    const isLog = !Number.isNaN(span.hand);
    const hasCursor = !Number.isNaN(this.cursor) && curves.times.length > 0;
    write(this.headLatest, isLog ? `Played at ${timeText(span.hand, 0.01, origin)}` : "Latest");
    write(this.headCursor, hasCursor ? `at ${timeText(this.cursor, 0.01, origin)}` : "");
    series.forEach(({ curve }, index) => {
      const cells = this.cells[index];
      if (!cells) return;
      write(cells.latest, numberText(isLog ? this.valueAt(curve, span.hand) : curves.last[curve]?.value));
      write(cells.atCursor, hasCursor ? numberText(this.valueAt(curve, this.cursor)) : "");
    });
    write(this.status, this.owner.about());
  }

  /** @param {number} curve @param {number} time */
  valueAt(curve, time) {
    const { curves } = this.chart;
    return curves.valueBefore(curve, rowAt(curves.times, time + 1e-6) - 1);
  }
}

// Plots: fields of messages over time.

import { button, element, iconButton, set } from "../elements.js";
import { choiceField } from "./choice.js";
import { Chart } from "./plot/chart.js";
import { Curves } from "./plot/curves.js";
import { FieldTree } from "./plot/fieldtree.js";
import { KEPT, Span } from "./plot/span.js";
import { CurveTable } from "./plot/table.js";
import { lengthText } from "./plot/texts.js";
import { fileName, saveFile } from "./save.js";
import { stylesheet } from "./stylesheet.js";

/**
 * @typedef {{text: string, problem: string, curves: number[]}} About
 * @typedef {import("./plot/chart.js").Series} Series
 */

const WINDOWS = [5, 10, 30, 60, 300, 600, 0]; // [s], and all
const LONGEST = 3600;
const USUAL = 10;

/** The plot panel. */
export default class Plot {
  /**
   * @param {import("../context.js").Context} context
   * @param {any} settings
   */
  constructor(context, settings) {
    stylesheet("./plot/plot.css");
    this.context = context;
    this.isLog = context.source === "log";
    /** @type {string[]} */
    this.fields = Array.isArray(settings.fields) ? settings.fields.filter((/** @type {any} */ one) => typeof one === "string") : [];
    /** @type {Set<string>} */
    this.hidden = new Set(Array.isArray(settings.hidden) ? settings.hidden : []);
    this.curves = new Curves();
    const usual = this.isLog ? 0 : USUAL;
    this.span = new Span(this.curves, settings.window >= 0 && settings.window !== null ? Math.min(LONGEST, Number(settings.window)) : usual);
    /** The curves by the server's numbers; a curve keeps its samples when others are added. */
    /** @type {string[]} */
    this.labels = [];
    /** The index of each label among the curves. @type {Map<string, number>} */
    this.places = new Map();
    /** @type {About[]} */
    this.about = [];
    this.leftOut = 0;
    /** Of a log, every n-th message is plotted. */
    this.every = 1;
    /** The number of the present choice of fields, to ignore updates of earlier choices. */
    this.choiceNumber = 0;
    this.isWaiting = false;
    this.chart = new Chart(this.curves, this.span, {
      moved: () => this.moved(),
      pointed: (time) => this.table.pointTo(time),
      signal: context.signal,
    });
    this.chart.isClock = settings.clock === true;
    this.table = new CurveTable(this.chart, {
      toggle: (series) => this.toggle(series),
      remove: (text) => this.remove(text),
      about: () => this.aboutText(),
    });
    this.choice = choiceField({
      label: "Add a field",
      placeholder: "Add /topic/field",
      suggest: (text) => this.context.ask("numbers", { text }),
      choose: (text) => this.add(text),
    });
    this.tree = new FieldTree(
      (text) => context.ask("numbers", { text }),
      (field) => this.fields.includes(field),
      (field, isChosen) => (isChosen ? this.add(field) : this.setFields(this.fields.filter((one) => one !== field))),
    );
    this.treeButton = button("Fields", () => this.openTree(), { "aria-expanded": "false", title: "Choose fields from a tree" });
    this.pauseButton = iconButton("pause", "Pause (space)", () => this.chart.pause(), { "aria-pressed": "false" });
    this.length = element(
      "select",
      { "aria-label": "Length of the window", title: "Length of the window", onchange: () => this.setWindow(Number(this.length.value)) },
      [...new Set([...WINDOWS, this.span.length])]
        .sort((a, b) => (a || Infinity) - (b || Infinity))
        .map((value) => element("option", { value }, lengthText(value))),
    );
    this.length.value = String(this.span.length);
    this.clock = element(
      "select",
      { "aria-label": "Times", title: "Times", onchange: () => this.setClock(this.clock.value === "clock") },
      element("option", { value: "seconds" }, "seconds"),
      element("option", { value: "clock" }, "clock"),
    );
    this.clock.value = this.chart.isClock ? "clock" : "seconds";
    this.element = this.layOut();
    this.stream = context.open("plot", { fields: this.fields }, (data, payload) => this.receive(data, payload));
    context.onChange(() => this.moveHand());
  }

  get title() {
    const topics = this.fields.length > 2 ? `${this.fields.slice(0, 2).join(", ")}, …` : this.fields.join(", ");
    return topics ? `Plot ${topics}` : "Plot";
  }

  settings() {
    return { fields: this.fields, window: this.span.length, clock: this.chart.isClock, hidden: [...this.hidden] };
  }

  close() {
    this.chart.close();
    this.table.close();
  }

  layOut() {
    const name = () => fileName(this.fields.join("_")).slice(0, 80);
    return element(
      "div",
      { class: "plot" },
      element(
        "div",
        { class: "tools" },
        this.choice.element,
        this.treeButton,
        element("span", { class: "space" }),
        this.pauseButton,
        button("Follow", () => this.chart.choose(null), { title: "Show the last samples as they come (Home)" }),
        this.length,
        this.clock,
        button("CSV", () => this.saveCsv(`${name()}.csv`), { title: "Save what is shown as CSV" }),
        button("PNG", () => this.chart.savePicture(`${name()}.png`), { title: "Save what is shown as PNG" }),
        this.isLog ? null : iconButton("clear", "Forget the samples", () => this.forget()),
      ),
      this.tree.element,
      this.chart.element,
      this.table.element,
    );
  }

  openTree() {
    this.tree.toggle();
    set(this.treeButton, "aria-expanded", String(!this.tree.element.hidden));
  }

  /** @param {string} text */
  add(text) {
    if (!text || text.endsWith(".")) return;
    this.choice.input.value = "";
    if (!this.fields.includes(text)) this.setFields([...this.fields, text]);
  }

  /** @param {string} text */
  remove(text) {
    this.setFields(this.fields.filter((one) => one !== text));
    this.choice.input.focus();
  }

  /** @param {string[]} fields */
  setFields(fields) {
    this.fields = fields;
    this.choiceNumber += 1;
    this.stream.change({ fields, choice: this.choiceNumber });
    this.about = fields.map((text) => this.about.find((one) => one.text === text) ?? { text, problem: "", curves: [] });
    this.rebuild();
    this.context.changed();
  }

  /** @param {number} [start] of a log [s since 1970] */
  forget(start) {
    this.curves.clear(start);
    this.places = new Map(this.labels.map((label, place) => [label, place]));
    this.leftOut = 0;
    this.span.chosen = null;
    this.rebuild();
  }

  /**
   * @param {{choice: number, curves?: string[], fields?: About[], leftOut?: number, start?: number,
   *   every?: number}} data ``start`` begins a log anew
   * @param {ArrayBuffer} [payload]
   */
  receive(data, payload) {
    if (data.choice !== this.choiceNumber) return;
    if (data.start !== undefined) {
      const { chosen } = this.span;
      this.every = data.every ?? 1;
      this.forget(data.start);
      this.span.chosen = chosen;
      this.moveHand();
    }
    if (data.fields && data.curves) {
      this.labels = data.curves;
      this.about = data.fields;
      for (const label of this.labels) if (!this.places.has(label)) this.places.set(label, this.places.size);
      this.rebuild();
      const problems = data.fields.filter(({ problem }) => problem);
      this.context.showProblem(this, problems.map(({ problem }) => problem).join("\n"));
    }
    this.leftOut += data.leftOut ?? 0;
    if (payload) {
      const kept = this.isLog ? Infinity : Math.max(KEPT, this.span.length);
      this.curves.add(new Float64Array(payload), (curve) => this.place(curve), kept);
    }
    this.draw();
  }

  /** @param {number} curve by the server's number */
  place(curve) {
    return this.places.get(this.labels[curve] ?? "") ?? 0;
  }

  /** Rebuild the chart and the table after the curves have changed. */
  rebuild() {
    const series = this.about.flatMap(({ text, curves }) =>
      curves.map((curve) => {
        const label = this.labels[curve] ?? text;
        return { curve: this.place(curve), label, text, isShown: !this.hidden.has(label) };
      }),
    );
    this.chart.show(series);
    this.table.make(this.about);
    this.draw();
  }

  draw() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.chart.draw();
      this.table.show();
    });
  }

  moved() {
    set(this.pauseButton, "aria-pressed", String(Boolean(this.span.chosen)));
    this.draw();
  }

  /** Show the playback position of the log. */
  moveHand() {
    const time = this.context.connection.state.log?.time;
    if (time === undefined || time === this.span.hand) return;
    this.span.hand = time;
    this.draw();
  }

  /** @param {number} seconds */
  setWindow(seconds) {
    this.span.length = seconds;
    this.chart.choose(null);
    this.context.changed();
  }

  /** @param {boolean} isClock */
  setClock(isClock) {
    this.chart.isClock = isClock;
    this.rebuild();
    this.context.changed();
  }

  /** @param {Series} series */
  toggle({ label, isShown }) {
    if (isShown) this.hidden.add(label);
    else this.hidden.delete(label);
    this.rebuild();
    this.context.changed();
  }

  aboutText() {
    const part = this.every > 1 ? `, one of ${this.every} messages` : "";
    const out = this.leftOut ? ` · ${this.leftOut} left out: this page was too slow` : "";
    return `${this.curves.count} samples${part}${out}`;
  }

  /** @param {string} name */
  saveCsv(name) {
    const [from, to] = this.span.shown();
    const csv = this.curves.csv(from, to, this.chart.series.filter(({ isShown }) => isShown));
    saveFile(name, new Blob([csv], { type: "text/csv" }));
  }
}

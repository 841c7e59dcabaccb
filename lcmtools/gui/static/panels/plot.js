// Plots: fields of messages over time.

import { button, div, element, iconButton, more, offer, selection, set } from "../elements.js";
import { choiceField } from "./choice.js";
import { Chart } from "./plot/chart.js";
import { Curves } from "./plot/curves.js";
import { FieldTree } from "./plot/fieldtree.js";
import { KEPT, Span } from "./plot/span.js";
import { CurveTable } from "./plot/table.js";
import { lengthText } from "./plot/texts.js";
import { fileName, saveFile } from "./save.js";
import { counted } from "../texts.js";
import { stylesheet } from "./stylesheet.js";

/**
 * @typedef {{text: string, problem: string, curves: number[]}} About
 * @typedef {import("./plot/chart.js").Series} Series
 */

const WINDOWS = [5, 10, 30, 60, 300, 600, 0]; // [s], and all
const LONGEST = 3600;
const USUAL = 10;
/** The times that samples can have, for the server. @type {[string, string][]} */
const TIMES = [
  ["arrival", "over time of arrival"],
  ["stamp", "over header stamp"],
  ["simulated", "over simulated time"],
];
/** @type {["least" | "most" | "span", string, string][]} */
const AXIS = [
  ["least", "from", "Lower end of the value axis"],
  ["most", "to", "Upper end of the value axis"],
  ["span", "span", "Least span of the value axis: smaller changes are not enlarged"],
];

/** The plot panel. */
export default class Plot {
  /** @param {import("../context.js").Context} context @param {any} settings */
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
    /** The curves by the server's numbers; a curve keeps its samples when others are added. @type {string[]} */
    this.labels = [];
    /** @type {string[]} */
    this.units = [];
    /** The time of the samples, or the label of the curve across. @type {string} */
    this.x = typeof settings.x === "string" ? settings.x : "arrival";
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
    for (const [name] of AXIS) if (Number.isFinite(settings.axis?.[name])) this.chart.axis[name] = settings.axis[name];
    this.table = new CurveTable(this.chart, {
      toggle: (series) => this.toggle(series),
      remove: (text) => {
        this.remove(text);
        this.choice.input.focus();
      },
      about: () => this.aboutText(),
    });
    const suggest = (/** @type {string} */ text) => context.ask("numbers", { text });
    this.choice = choiceField({
      label: "Add a field",
      placeholder: "Add /topic/field",
      suggest,
      choose: (text) => this.add(text),
    });
    this.tree = new FieldTree(
      suggest,
      (field) => this.fields.includes(field),
      (field, isChosen) => (isChosen ? this.add(field) : this.remove(field)),
    );
    this.treeButton = button("Fields", () => this.openTree(), { "aria-expanded": "false", title: "Choose fields from a tree" });
    this.pauseButton = iconButton("pause", "Pause (space)", () => this.chart.pause(), { "aria-pressed": "false" });
    const lengths = [...new Set([...WINDOWS, this.span.length])].sort((a, b) => (a || Infinity) - (b || Infinity));
    const texts = /** @type {[string, string][]} */ (lengths.map((one) => [String(one), lengthText(one)]));
    this.length = selection("Length of the window", texts, String(this.span.length), (value) => {
      this.span.length = Number(value);
      this.chart.choose(null);
      context.changed();
    });
    const shown = this.chart.isClock ? "clock" : "seconds";
    this.clock = selection("Times", [["seconds", "seconds"], ["clock", "clock"]], shown, (value) => {
      this.chart.isClock = value === "clock";
      this.changed();
    });
    this.across = selection("Horizontal axis", [], "", (value) => this.setX(value));
    this.element = this.layOut();
    this.stream = context.open("plot", { fields: this.fields, time: this.time }, (data, payload) => this.receive(data, payload));
    context.onChange(() => this.moveHand());
    this.rebuild();
  }

  /** The time that the samples have. */
  get time() {
    return TIMES.some(([name]) => name === this.x) ? this.x : "arrival";
  }

  get title() {
    const topics = this.fields.length > 2 ? `${this.fields.slice(0, 2).join(", ")}, …` : this.fields.join(", ");
    return topics ? `Plot ${topics}` : "Plot";
  }

  settings() {
    const { isClock: clock, axis } = this.chart;
    return { fields: this.fields, window: this.span.length, clock, x: this.x, axis, hidden: [...this.hidden] };
  }

  close() {
    this.chart.close();
    this.table.close();
  }

  layOut() {
    const name = () => fileName(this.fields.join("_")).slice(0, 80);
    return div(
      "plot",
      div(
        "tools",
        this.choice.element,
        this.treeButton,
        element("span", { class: "space" }),
        this.pauseButton,
        more(
          "More …",
          "The axes, and what is saved",
          this.length,
          this.across,
          this.clock,
          AXIS.map(([name, text, title]) => this.limitField(name, text, title)),
          button("Follow", () => this.chart.choose(null), { title: "Show the last samples as they come (Home)" }),
          button("Save as CSV", () => this.saveCsv(`${name()}.csv`), { title: "Save what is shown as CSV" }),
          button("Save as PNG", () => this.chart.savePicture(`${name()}.png`), { title: "Save what is shown as PNG" }),
          this.isLog ? null : button("Forget the samples", () => this.forget()),
        ),
      ),
      this.tree.element,
      this.chart.element,
      this.table.element,
    );
  }

  /** @param {"least" | "most" | "span"} name @param {string} text @param {string} title */
  limitField(name, text, title) {
    const { axis } = this.chart;
    const onchange = () => {
      axis[name] = input.value === "" ? null : Number(input.value);
      const isWrong = axis.least !== null && axis.most !== null && axis.least >= axis.most;
      this.context.showProblem(axis, isWrong ? `the value axis cannot go from ${axis.least} to ${axis.most}` : "");
      this.draw();
      this.context.changed();
    };
    const about = { type: "number", step: "any", class: "limit", placeholder: text, title };
    const input = element("input", { ...about, "aria-label": title, value: axis[name], onchange });
    return input;
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
  }

  /** @param {string[]} fields */
  setFields(fields) {
    this.fields = fields;
    this.choiceNumber += 1;
    const across = this.chart.across?.text;
    if (across && !fields.includes(across)) this.x = "arrival";
    this.stream.change({ fields, time: this.time, choice: this.choiceNumber });
    this.about = fields.map((text) => this.about.find((one) => one.text === text) ?? { text, problem: "", curves: [] });
    this.changed();
  }

  /** @param {string} x as in ``this.x`` */
  setX(x) {
    const before = this.time;
    this.x = x;
    if (this.time === before) return this.changed();
    this.forget();
    this.setFields(this.fields);
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
   * @param {{choice: number, curves?: string[], units?: string[], fields?: About[], leftOut?: number,
   *   start?: number | null, every?: number}} data ``start`` begins a log anew
   * @param {ArrayBuffer} [payload]
   */
  receive(data, payload) {
    if (data.choice !== this.choiceNumber) return;
    if (data.start !== undefined) {
      const { chosen } = this.span;
      this.every = data.every ?? 1;
      this.forget(data.start ?? undefined);
      this.span.chosen = chosen;
      this.moveHand();
    }
    if (data.fields && data.curves) {
      this.labels = data.curves;
      this.units = data.units ?? [];
      this.about = data.fields;
      for (const label of this.labels) if (!this.places.has(label)) this.places.set(label, this.places.size);
      this.rebuild();
      const problems = new Set(data.fields.map(({ problem }) => problem));
      this.context.showProblem(this, [...problems].filter(Boolean).join("\n"));
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
        return { curve: this.place(curve), label, unit: this.units[curve] ?? "", text, isShown: !this.hidden.has(label) };
      }),
    );
    const isOver = this.x.includes("/");
    this.chart.across = isOver && series.length ? (series.find(({ label }) => label === this.x) ?? { curve: -1, label: this.x, unit: "", text: "", isShown: true }) : null;
    const labels = new Set([...series.map(({ label }) => label), ...(isOver ? [this.x] : [])]);
    offer(this.across, [...TIMES, .../** @type {[string, string][]} */ ([...labels].map((label) => [label, `over ${label}`]))], this.x);
    this.clock.disabled = isOver;
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
    const time = this.time === "arrival" ? this.context.connection.state.log?.time : NaN;
    if (time === undefined || time === this.span.hand) return;
    this.span.hand = time;
    this.draw();
  }

  /** @param {Series} series */
  toggle({ label, isShown }) {
    if (isShown) this.hidden.add(label);
    else this.hidden.delete(label);
    this.changed();
  }

  changed() {
    this.rebuild();
    this.context.changed();
  }

  aboutText() {
    const part = this.every > 1 ? `, one of ${this.every} messages` : "";
    const out = this.leftOut ? ` · ${this.leftOut} left out: this page was too slow` : "";
    if (!this.fields.length) return "Nothing is plotted yet: enter a topic's field above, or choose from Fields.";
    return `${counted(this.curves.count, "sample")}${part}${out}`;
  }

  /** @param {string} name */
  saveCsv(name) {
    const [from, to] = this.span.shown();
    const csv = this.curves.csv(from, to, this.chart.series.filter(({ isShown }) => isShown));
    saveFile(name, new Blob([csv], { type: "text/csv" }));
  }
}

// Plots: fields of messages over time.

import uPlot from "../vendor/uplot/uPlot.js";
import { color, element, fill, iconButton, set, write } from "../elements.js";
import { choiceField } from "./choice.js";
import { Curves, rowAt } from "./curves.js";
import { FieldTree } from "./fieldtree.js";
import { fileName, saveFile, savePicture } from "./save.js";
import { stylesheet } from "./stylesheet.js";

/**
 * @typedef {{text: string, problem: string, curves: number[]}} About
 * @typedef {{curve: number, label: string, text: string, isShown: boolean}} Series
 */

const COLORS = 8;
const DASHES = [[], [8, 4], [2, 3]];
const KEPT = 600; // [s] that can be looked back at, and a longer window
const WINDOWS = [5, 10, 30, 60, 300, 600];
const STEPS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600];
const TICK_ROOM = 80; // [px] between two ticks of the time
const PAN = 0.1; // of what is shown
const ZOOM = 0.8;
const TABLE_PERIOD = 200; // [ms] between two changes of the numbers in the table

/** The panel of a plot. */
export default class Plot {
  /**
   * @param {import("../context.js").Context} context
   * @param {any} settings
   */
  constructor(context, settings) {
    stylesheet("../vendor/uplot/uPlot.css");
    stylesheet("./plot.css");
    this.context = context;
    /** @type {string[]} */
    this.fields = Array.isArray(settings.fields) ? settings.fields.filter((/** @type {any} */ one) => typeof one === "string") : [];
    this.window = settings.window > 0 ? Math.min(3600, Number(settings.window)) : 10;
    this.isClock = settings.clock === true;
    /** @type {Set<string>} */
    this.hidden = new Set(Array.isArray(settings.hidden) ? settings.hidden : []);
    this.curves = new Curves();
    /** The curves as the server numbers them; the samples of one stay when others are added. */
    /** @type {string[]} */
    this.labels = [];
    /** The place of each label among the curves. @type {Map<string, number>} */
    this.places = new Map();
    /** @type {About[]} */
    this.about = [];
    /** @type {Series[]} */
    this.series = [];
    /** The times that are shown; null for the last ones, as they come. */
    /** @type {{from: number, to: number} | null} */
    this.range = null;
    this.cursor = NaN;
    this.leftOut = 0;
    /** Updates of fields that were chosen before are still on their way. */
    this.choiceNumber = 0;
    this.nextTable = 0;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.tableTimer = undefined;
    this.isWaiting = false;
    /** @type {uPlot | null} */
    this.chart = null;
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
    this.treeButton = element(
      "button",
      { type: "button", "aria-expanded": "false", title: "Choose fields from a tree", onclick: () => this.openTree() },
      "Fields",
    );
    this.pauseButton = iconButton("pause", "Pause (space)", () => this.pause(), { "aria-pressed": "false" });
    this.length = element(
      "select",
      { "aria-label": "Length of the window", title: "Length of the window", onchange: () => this.setWindow(Number(this.length.value)) },
      [...new Set([...WINDOWS, this.window])].sort((a, b) => a - b).map((value) => element("option", { value }, lengthText(value))),
    );
    this.length.value = String(this.window);
    this.clock = element(
      "select",
      { "aria-label": "Times", title: "Times", onchange: () => this.setClock(this.clock.value === "clock") },
      element("option", { value: "seconds" }, "seconds"),
      element("option", { value: "clock" }, "clock"),
    );
    this.clock.value = this.isClock ? "clock" : "seconds";
    this.room = element("div", {
      class: "plot-room",
      tabindex: 0,
      role: "group",
      "aria-label": "Plot. Space pauses, the arrows move, plus and minus zoom, Home follows. The values are in the table below.",
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
      ondblclick: () => this.follow(),
    });
    this.room.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.room.addEventListener("pointerdown", (event) => this.pan(event), { capture: true });
    this.body = element("tbody");
    this.headCursor = element("th", { scope: "col", class: "number" }, "");
    this.status = element("span", { class: "muted" });
    this.element = this.layOut();
    this.stream = context.open("plot", { fields: this.fields }, (data, payload) => this.take(data, payload));
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.room);
    this.scheme = matchMedia("(prefers-color-scheme: dark)");
    this.scheme.addEventListener("change", () => this.rebuild(), { signal: context.signal });
    const theme = new MutationObserver(() => this.rebuild());
    theme.observe(document.documentElement, { attributeFilter: ["data-theme"] });
    context.signal.addEventListener("abort", () => theme.disconnect());
  }

  get title() {
    const topics = this.fields.length > 2 ? `${this.fields.slice(0, 2).join(", ")}, …` : this.fields.join(", ");
    return topics ? `Plot ${topics}` : "Plot";
  }

  settings() {
    return { fields: this.fields, window: this.window, clock: this.isClock, hidden: [...this.hidden] };
  }

  close() {
    this.observer.disconnect();
    clearTimeout(this.tableTimer);
    this.chart?.destroy();
  }

  layOut() {
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
        element("button", { type: "button", title: "Show the last samples as they come (Home)", onclick: () => this.follow() }, "Follow"),
        this.length,
        this.clock,
        element("button", { type: "button", title: "Save what is shown as CSV", onclick: () => this.saveCsv() }, "CSV"),
        element("button", { type: "button", title: "Save what is shown as PNG", onclick: () => this.savePng() }, "PNG"),
        iconButton("clear", "Forget the samples", () => this.forget()),
      ),
      this.tree.element,
      this.room,
      element(
        "div",
        { class: "plot-table" },
        element(
          "table",
          {},
          element("caption", { class: "spoken" }, "The curves and their latest values"),
          element(
            "thead",
            {},
            element(
              "tr",
              {},
              element("th", { scope: "col" }, "Curve"),
              element("th", { scope: "col", class: "number" }, "Latest"),
              this.headCursor,
              element("th", { scope: "col" }, element("span", { class: "spoken" }, "Remove")),
            ),
          ),
          this.body,
        ),
        this.status,
      ),
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

  forget() {
    this.curves.clear();
    this.places = new Map(this.labels.map((label, place) => [label, place]));
    this.leftOut = 0;
    this.range = null;
    this.rebuild();
  }

  /**
   * @param {{choice: number, curves?: string[], fields?: About[], leftOut?: number}} data
   * @param {ArrayBuffer} [payload]
   */
  take(data, payload) {
    if (data.choice !== this.choiceNumber) return;
    if (data.fields && data.curves) {
      this.labels = data.curves;
      this.about = data.fields;
      for (const label of this.labels) if (!this.places.has(label)) this.places.set(label, this.places.size);
      this.rebuild();
      const problems = data.fields.filter(({ problem }) => problem);
      this.context.tell(this, problems.map(({ problem }) => problem).join("\n"));
    }
    if (data.leftOut) {
      this.leftOut += data.leftOut;
      this.nextTable = 0;
    }
    if (payload) {
      const samples = new Float64Array(payload);
      this.curves.add(samples, (curve) => this.place(curve), Math.max(KEPT, this.window));
    }
    this.draw();
  }

  /** @param {number} curve as the server numbers it */
  place(curve) {
    return this.places.get(this.labels[curve] ?? "") ?? 0;
  }

  /** Make the chart anew: the curves, or the colours, are others. */
  rebuild() {
    this.series = this.about.flatMap(({ text, curves }) =>
      curves.map((curve) => {
        const label = this.labels[curve] ?? text;
        return { curve: this.place(curve), label, text, isShown: !this.hidden.has(label) };
      }),
    );
    this.chart?.destroy();
    this.chart = new uPlot(this.options(), this.data(), this.room);
    this.makeTable();
    this.draw();
  }

  /** @returns {uPlot.Options} */
  options() {
    const [line, muted] = [color("--line"), color("--muted")];
    const grid = { stroke: line, width: 1 };
    const font = "11px system-ui, sans-serif";
    const axis = { stroke: muted, grid, ticks: { ...grid, size: 4 }, font };
    return {
      width: Math.max(50, this.room.clientWidth),
      height: Math.max(50, this.room.clientHeight),
      legend: { show: false },
      pxAlign: 0,
      cursor: {
        drag: { x: true, y: false, setScale: false },
        points: { size: 6 },
        move: (_, left, top) => [left, top],
      },
      hooks: {
        setSelect: [(chart) => this.zoomTo(chart)],
        setCursor: [(chart) => this.pointTo(chart)],
      },
      scales: {
        x: { time: false, range: () => this.shownRange() },
        y: { range: (_, least, most) => room(least, most) },
      },
      axes: [
        {
          ...axis,
          space: TICK_ROOM,
          size: 26,
          gap: 4,
          incrs: STEPS,
          splits: (_, __, from, to, step) => this.ticks(from, to, step),
          values: (_, ticks, __, ___, step) => ticks.map((tick) => this.timeText(tick, step)),
        },
        { ...axis, size: 58, gap: 4, values: (_, ticks, __, ___, step) => ticks.map((tick) => tickText(tick, step)) },
      ],
      series: [{}, ...this.series.map((one, index) => this.line(one, index))],
    };
  }

  /**
   * @param {Series} series
   * @param {number} index
   * @returns {uPlot.Series}
   */
  line({ curve, label, isShown }, index) {
    return {
      label,
      show: isShown,
      stroke: color(`--series-${(index % COLORS) + 1}`),
      dash: DASHES[Math.floor(index / COLORS) % DASHES.length],
      width: 1.6,
      spanGaps: false,
      points: { size: 4 },
      gaps: (chart) => this.gaps(chart, curve),
    };
  }

  /**
   * Where a curve has no line [px].
   * @param {uPlot} chart
   * @param {number} curve
   * @returns {[number, number][]}
   */
  gaps(chart, curve) {
    const { min = 0, max = 0 } = chart.scales["x"] ?? {};
    const shown = this.curves.last[curve]?.gaps.filter(([from, to]) => !(to < (min ?? 0)) && !(from > (max ?? 0)));
    return (shown ?? []).map(([from, to]) => [
      Number.isNaN(from) ? 0 : chart.valToPos(from, "x", true),
      chart.valToPos(to, "x", true),
    ]);
  }

  /** @returns {uPlot.AlignedData} */
  data() {
    const { times, columns } = this.curves;
    const none = new Array(times.length);
    return [times, ...this.series.map(({ curve }) => columns[curve] ?? none)];
  }

  /** @returns {[number, number]} */
  shownRange() {
    if (this.range) return [this.range.from, this.range.to];
    const { end } = this.curves;
    return [end - this.window, end];
  }

  draw() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.chart?.setData(this.data());
      this.showTable();
    });
  }

  resize() {
    const { clientWidth, clientHeight } = this.room;
    if (clientWidth > 0 && clientHeight > 0) this.chart?.setSize({ width: clientWidth, height: clientHeight });
  }

  /**
   * @param {number} from
   * @param {number} to
   * @param {number} step
   */
  ticks(from, to, step) {
    const base = this.base(step);
    const ticks = [];
    for (let at = Math.ceil((from - base) / step); base + at * step <= to; at++) ticks.push(base + at * step);
    return ticks;
  }

  /**
   * Where the ticks begin: at the first sample or, by the clock, at a round time of the day.
   * @param {number} step
   */
  base(step) {
    if (!this.isClock || Number.isNaN(this.curves.start)) return 0;
    const zone = new Date(this.curves.start * 1000).getTimezoneOffset() * 60;
    return -((this.curves.start - zone) % Math.max(1, step));
  }

  /**
   * @param {number} time
   * @param {number} step
   */
  timeText(time, step) {
    const digits = step >= 1 ? 0 : Math.min(3, Math.ceil(-Math.log10(step)));
    if (!this.isClock) return `${time.toFixed(digits)}${step >= 1 ? " s" : ""}`;
    const date = new Date(Math.round((this.curves.start + time) * 1000));
    const two = (/** @type {number} */ value) => String(value).padStart(2, "0");
    const clock = `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}`;
    return digits ? `${clock}.${String(date.getMilliseconds()).padStart(3, "0").slice(0, digits)}` : clock;
  }

  /** @param {{from: number, to: number} | null} range */
  setRange(range) {
    this.range = range;
    set(this.pauseButton, "aria-pressed", String(Boolean(range)));
    this.draw();
  }

  pause() {
    if (this.range) {
      this.follow();
      return;
    }
    const [from, to] = this.shownRange();
    this.setRange({ from, to });
  }

  follow() {
    this.setRange(null);
  }

  /** @param {number} seconds */
  setWindow(seconds) {
    this.window = seconds;
    this.setRange(null);
    this.context.changed();
  }

  /** @param {boolean} isClock */
  setClock(isClock) {
    this.isClock = isClock;
    this.rebuild();
    this.context.changed();
  }

  /** @param {uPlot} chart */
  zoomTo(chart) {
    const { left, width } = chart.select;
    if (width < 3) return;
    this.setRange({ from: chart.posToVal(left, "x"), to: chart.posToVal(left + width, "x") });
    chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  /**
   * @param {number} factor below 1 shows less
   * @param {number} [at] a time that stays where it is
   */
  zoom(factor, at) {
    const [from, to] = this.shownRange();
    const about = at ?? (this.range ? (from + to) / 2 : to);
    const length = Math.max(0.01, Math.min(2 * KEPT, (to - from) * factor));
    const start = about - ((about - from) / (to - from)) * length;
    this.setRange({ from: start, to: start + length });
  }

  /** @param {number} part of what is shown */
  moveBy(part) {
    const [from, to] = this.shownRange();
    const way = (to - from) * part;
    this.setRange({ from: from + way, to: to + way });
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    if (!this.chart) return;
    event.preventDefault();
    if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      this.moveBy(((event.deltaX || event.deltaY) / 100) * PAN);
      return;
    }
    const at = this.chart.posToVal(event.clientX - this.chart.over.getBoundingClientRect().left, "x");
    this.zoom(event.deltaY > 0 ? 1 / ZOOM : ZOOM, at);
  }

  /**
   * Move what is shown: by a finger, the middle button, or with Shift.
   * @param {PointerEvent} event
   */
  pan(event) {
    const isPan = event.pointerType === "touch" || event.button === 1 || event.shiftKey;
    if (!isPan || !this.chart) return;
    event.preventDefault();
    event.stopPropagation();
    const [from, to] = this.shownRange();
    const perPixel = (to - from) / this.chart.over.clientWidth;
    const { signal, abort } = aborting();
    this.room.setPointerCapture(event.pointerId);
    const move = (/** @type {PointerEvent} */ now) => {
      const way = (event.clientX - now.clientX) * perPixel;
      if (now.pointerId === event.pointerId && way) this.setRange({ from: from + way, to: to + way });
    };
    this.room.addEventListener("pointermove", move, { signal });
    for (const end of ["pointerup", "pointercancel"]) this.room.addEventListener(end, abort, { signal });
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.target !== this.room) return;
    if (event.key === " ") this.pause();
    else if (event.key === "ArrowLeft") this.moveBy(-PAN);
    else if (event.key === "ArrowRight") this.moveBy(PAN);
    else if (event.key === "+" || event.key === "=") this.zoom(ZOOM);
    else if (event.key === "-") this.zoom(1 / ZOOM);
    else if (event.key === "Home" || event.key === "0") this.follow();
    else return;
    event.preventDefault();
  }

  /** @param {uPlot} chart */
  pointTo(chart) {
    const left = chart.cursor.left ?? -1;
    this.cursor = left >= 0 ? chart.posToVal(left, "x") : NaN;
    this.nextTable = 0;
    this.showTable();
  }

  makeTable() {
    /** @type {{latest: HTMLElement, atCursor: HTMLElement}[]} */
    this.cells = [];
    const lines = this.about.flatMap((about) => {
      const found = this.series.filter(({ text }) => text === about.text);
      return found.length ? found.map((one) => this.tableLine(one)) : [this.emptyLine(about)];
    });
    fill(this.body, lines);
    this.nextTable = 0;
  }

  /** @param {Series} series */
  tableLine(series) {
    const index = this.series.indexOf(series);
    const swatch = element("span", { class: "swatch", "aria-hidden": "true" });
    swatch.style.borderTopColor = `var(--series-${(index % COLORS) + 1})`;
    swatch.style.borderTopStyle = index < COLORS ? "solid" : index < 2 * COLORS ? "dashed" : "dotted";
    const toggle = element(
      "button",
      { type: "button", class: "curve mono", "aria-pressed": String(series.isShown), title: `Show or hide ${series.label}`, onclick: () => this.toggle(series) },
      swatch,
      series.label,
    );
    const latest = element("td", { class: "number" });
    const atCursor = element("td", { class: "number" });
    this.cells?.push({ latest, atCursor });
    return element("tr", {}, element("th", { scope: "row" }, toggle), latest, atCursor, this.removeCell(series.text));
  }

  /** @param {About} about */
  emptyLine({ text }) {
    const cells = [element("td", { class: "number" }, "–"), element("td")];
    return element("tr", {}, element("th", { scope: "row" }, element("span", { class: "curve mono muted" }, text)), cells, this.removeCell(text));
  }

  /** @param {string} text */
  removeCell(text) {
    return element("td", {}, iconButton("close", `Remove ${text}`, () => this.remove(text)));
  }

  /** @param {Series} series */
  toggle(series) {
    if (series.isShown) this.hidden.add(series.label);
    else this.hidden.delete(series.label);
    const index = this.series.indexOf(series);
    this.rebuild();
    this.body.querySelectorAll("button.curve")[index]?.dispatchEvent(new Event("focus"));
    /** @type {HTMLElement | undefined} */ (this.body.querySelectorAll("button.curve")[index])?.focus();
    this.context.changed();
  }

  showTable() {
    const now = performance.now();
    clearTimeout(this.tableTimer);
    if (now < this.nextTable) {
      this.tableTimer = setTimeout(() => this.showTable(), this.nextTable - now);
      return;
    }
    this.nextTable = now + TABLE_PERIOD;
    const { times, last } = this.curves;
    const hasCursor = !Number.isNaN(this.cursor) && times.length > 0;
    const row = rowAt(times, this.cursor + 1e-9) - 1;
    write(this.headCursor, hasCursor ? `at ${this.timeText(this.cursor, 0.01)}` : "");
    this.series.forEach(({ curve }, index) => {
      const cells = this.cells?.[index];
      if (!cells) return;
      write(cells.latest, numberText(last[curve]?.value));
      write(cells.atCursor, hasCursor ? numberText(this.curves.valueBefore(curve, row) ?? undefined) : "");
    });
    const out = this.leftOut ? ` · ${this.leftOut} left out: this page was too slow` : "";
    write(this.status, `${this.curves.count} samples${out}`);
  }

  shownSeries() {
    return this.series.filter(({ isShown }) => isShown);
  }

  saveCsv() {
    const [from, to] = this.shownRange();
    const csv = this.curves.csv(from, to, this.shownSeries());
    saveFile(`${fileName(this.fields.join("_")).slice(0, 80)}.csv`, new Blob([csv], { type: "text/csv" }));
  }

  savePng() {
    if (!this.chart) return;
    const { canvas } = this.chart.ctx;
    const shown = this.shownSeries();
    const [line, left] = [18 * devicePixelRatio, 12 * devicePixelRatio];
    const copy = element("canvas", { width: canvas.width, height: canvas.height + line * (shown.length + 1) });
    const context = copy.getContext("2d");
    if (!context) return;
    context.fillStyle = color("--surface");
    context.fillRect(0, 0, copy.width, copy.height);
    context.drawImage(canvas, 0, line * (shown.length + 0.5));
    context.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    shown.forEach(({ label, curve }, index) => {
      const place = this.series.findIndex((one) => one.curve === curve);
      context.fillStyle = color(`--series-${(place % COLORS) + 1}`);
      context.fillRect(left, line * (index + 0.7), 2 * left, 2 * devicePixelRatio);
      context.fillStyle = color("--text");
      context.fillText(label, 4 * left, line * (index + 1));
    });
    savePicture(`${fileName(this.fields.join("_")).slice(0, 80)}.png`, copy);
  }
}

/**
 * The ends of the axis of values: what there is, and some room.
 * @param {number | null} least
 * @param {number | null} most
 * @returns {[number, number]}
 */
function room(least, most) {
  if (least === null || most === null || !Number.isFinite(least) || !Number.isFinite(most)) return [-1, 1];
  const more = (most - least) * 0.08 || Math.abs(most) * 0.1 || 1;
  return [least - more, most + more];
}

/**
 * @param {number} tick
 * @param {number} step between two ticks
 */
function tickText(tick, step) {
  if (Math.abs(tick) < step / 1000) return "0";
  const isPlain = step >= 1e-4 && Math.abs(tick) < 1e6;
  return isPlain ? tick.toFixed(Math.max(0, Math.ceil(-Math.log10(step) - 1e-9))) : tick.toExponential(1);
}

/** @param {number | null | undefined} value */
export function numberText(value) {
  if (value === undefined) return "–";
  if (value === null || Number.isNaN(value)) return "nan";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return String(value);
  const size = Math.abs(value);
  return size >= 1e6 || size < 1e-4 ? value.toExponential(4) : value.toPrecision(6);
}

/** @param {number} seconds */
function lengthText(seconds) {
  return seconds < 60 ? `${seconds} s` : `${seconds / 60} min`;
}

function aborting() {
  const controller = new AbortController();
  return { signal: controller.signal, abort: () => controller.abort() };
}

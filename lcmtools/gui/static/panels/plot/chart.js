// The chart of a plot: axes and curves, and zooming and panning by pointer, wheel and keys.

import uPlot from "../../vendor/uplot/uPlot.js";
import { element } from "../../elements.js";
import { color, onTheme } from "../../theme.js";
import { savePicture } from "../save.js";
import { stylesheet } from "../stylesheet.js";
import { axisLimits, valueSteps } from "./limits.js";
import { tickText, timeText, timeTicks } from "./texts.js";

/** @typedef {{curve: number, label: string, unit: string, text: string, isShown: boolean}} Series */

const COLORS = 8;
const STYLES = ["solid", "dashed", "dotted"];
const DASHES = [[], [8, 4], [2, 3]];
const STEPS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600];
const TICK_ROOM = 80; // [px] between two ticks of the time axis
/** @type {import("./limits.js").Axis} */
const FREE = { least: null, most: null, span: null };
const SIDE = 58; // [px] of the value axis, at least
const PAN = 0.1; // of the shown span
const ZOOM = 0.8;

/**
 * Return the style of the n-th curve: its colour in style.css, and its line.
 * @param {number} index
 */
export function lineOf(index) {
  const style = Math.floor(index / COLORS) % STYLES.length;
  return { color: `--series-${(index % COLORS) + 1}`, style: STYLES[style] ?? "solid", dash: DASHES[style] };
}

/** @param {{label: string, unit: string}} series */
export function nameOf({ label, unit }) {
  return unit ? `${label} [${unit}]` : label;
}

/** A chart of curves over a span of time, or over another curve. */
export class Chart {
  /**
   * @param {import("./curves.js").Curves} curves
   * @param {import("./span.js").Span} span
   * @param {{moved: () => void, pointed: (time: number) => void, signal: AbortSignal}} owner told when the
   *   span is another one, and when the pointer is at another time, NaN for none
   */
  constructor(curves, span, owner) {
    stylesheet("../vendor/uplot/uPlot.css");
    this.curves = curves;
    this.span = span;
    this.owner = owner;
    this.isClock = false;
    /** The curve across, null for the time. @type {Series | null} */
    this.across = null;
    /** @type {import("./limits.js").Axis} */
    this.axis = { ...FREE };
    /** The limits of both axes where one curve is plotted over another. @type {{x: [number, number], y: [number, number]}} */
    this.limits = { x: [-1, 1], y: [-1, 1] };
    /** @type {Series[]} */
    this.series = [];
    /** @type {uPlot | null} */
    this.chart = null;
    this.hand = element("div", { class: "plot-hand", hidden: true });
    this.element = element("div", {
      class: "plot-room",
      tabindex: 0,
      role: "group",
      "aria-label": "Plot. Space pauses, the arrows move, plus and minus zoom, Home follows. The values are in the table below.",
      onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
      ondblclick: () => this.choose(null),
    });
    this.element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.element.addEventListener("pointerdown", (event) => this.pan(event), { capture: true });
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.element);
    onTheme(() => this.rebuild(), owner.signal);
  }

  close() {
    this.observer.disconnect();
    this.chart?.destroy();
  }

  /** The time of the axis' zero [s since 1970] if it shows the time of day; else null. */
  get origin() {
    return this.isClock && !Number.isNaN(this.curves.start) ? this.curves.start : null;
  }

  /** @param {Series[]} series */
  show(series) {
    this.series = series;
    this.rebuild();
  }

  /** Rebuild the chart after the curves or the colours have changed. */
  rebuild() {
    this.chart?.destroy();
    this.chart = new uPlot(this.options(), this.data(), this.element);
    this.chart.over.append(this.hand);
    this.showHand();
  }

  draw() {
    this.chart?.setData(this.data());
    this.showHand();
  }

  /** Show the playback position of a log. */
  showHand() {
    const [from, to] = this.span.shown();
    const part = (this.span.hand - from) / (to - from);
    this.hand.hidden = !(part >= 0 && part <= 1) || Boolean(this.across);
    this.hand.style.left = `${(100 * part).toFixed(2)}%`;
  }

  /** @returns {uPlot.Options} */
  options() {
    const [line, muted] = [color("--line"), color("--muted")];
    const drag = { x: true, y: false, setScale: false };
    const grid = { stroke: line, width: 1 };
    const axis = { stroke: muted, grid, ticks: { ...grid, size: 4 }, gap: 4, font: "11px system-ui, sans-serif" };
    const { across } = this;
    /** @type {uPlot.Axis} */
    const values = {
      ...axis,
      incrs: (_, __, from, to) => valueSteps(to - from),
      splits: (_, __, from, to, step) => timeTicks(from, to, step, null),
      values: (_, ticks, __, ___, step) => ticks.map((tick) => tickText(tick, step)),
    };
    /** @type {uPlot.Axis} */
    const times = {
      ...axis,
      incrs: STEPS,
      splits: (_, __, from, to, step) => timeTicks(from, to, step, this.origin),
      values: (_, ticks, __, ___, step) => ticks.map((tick) => timeText(tick, step, this.origin)),
    };
    return {
      mode: across ? 2 : 1,
      width: Math.max(50, this.element.clientWidth),
      height: Math.max(50, this.element.clientHeight),
      legend: { show: false },
      pxAlign: 0,
      cursor: across ? { show: false } : { drag, points: { size: 6 }, move: (_, left, top) => [left, top] },
      hooks: { setSelect: [(chart) => this.zoomTo(chart)], setCursor: [(chart) => this.pointTo(chart)] },
      scales: {
        x: { time: false, range: () => (across ? this.limits.x : this.span.shown()) },
        y: { range: (_, least, most) => (across ? this.limits.y : axisLimits(least, most, this.axis)) },
      },
      axes: [
        { ...(across ? { ...values, label: nameOf(across), labelSize: 18, labelFont: axis.font } : times), space: TICK_ROOM, size: 26 },
        { ...values, size: (_, texts) => Math.max(SIDE, 12 + 7 * Math.max(0, ...(texts ?? []).map((text) => text.length))) },
      ],
      series: [{}, ...this.series.map((one, index) => this.line(one, index))],
    };
  }

  /** @param {Series} series @param {number} index @returns {uPlot.Series} */
  line({ curve, label, isShown }, index) {
    const { color: name, dash } = lineOf(index);
    const look = { label, stroke: color(name), dash, width: 1.6 };
    if (!this.across) return { ...look, show: isShown, spanGaps: false, points: { size: 6, fill: look.stroke }, gaps: (chart) => this.gaps(chart, curve) };
    const facets = ["x", "y"].map((scale) => ({ scale, auto: true }));
    return { ...look, show: isShown && curve !== this.across.curve, facets, points: { show: false }, paths: pathOver };
  }

  /**
   * Return the gaps of a curve, without a line [px].
   * @param {uPlot} chart
   * @param {number} curve
   * @returns {[number, number][]}
   */
  gaps(chart, curve) {
    const { min = 0, max = 0 } = chart.scales["x"] ?? {};
    const shown = this.curves.last[curve]?.gaps.filter(([from, to]) => !(to < (min ?? 0)) && !(from > (max ?? 0)));
    /** @type {(time: number) => number} */
    const place = (time) => (Number.isNaN(time) ? 0 : chart.valToPos(time, "x", true));
    return (shown ?? []).map(([from, to]) => [place(from), place(to)]);
  }

  /** @returns {uPlot.AlignedData} */
  data() {
    const { times, columns } = this.curves;
    const { across, series } = this;
    if (across) return this.dataOver(across);
    const none = new Array(times.length);
    return [times, ...series.map(({ curve }) => columns[curve] ?? none)];
  }

  /**
   * Return the shown samples over those of another curve, and set the limits of both axes to them.
   * @param {Series} across
   * @returns {any}
   */
  dataOver(across) {
    const span = this.span.shown();
    const pairs = this.series.map(({ curve, isShown }) =>
      isShown && curve !== across.curve ? this.curves.over(across.curve, curve, span) : [[], []],
    );
    const [x, y] = [ends(pairs.map(([xs = []]) => xs)), ends(pairs.map(([, ys = []]) => ys))];
    this.limits = { x: axisLimits(...x, FREE), y: axisLimits(...y, this.axis) };
    if (this.series.every(({ unit }) => unit && unit === across.unit) && !Object.values(this.axis).some((one) => one !== null)) this.scaleEqually();
    return [null, ...pairs];
  }

  /** Give both axes the same scale, as for the path of a robot. */
  scaleEqually() {
    const { x, y } = this.limits;
    const { clientWidth: width = 1, clientHeight: height = 1 } = this.chart?.over ?? {};
    if (!width || !height) return;
    const scale = Math.max((x[1] - x[0]) / width, (y[1] - y[0]) / height);
    for (const [limits, size] of /** @type {[[number, number], number][]} */ ([[x, width], [y, height]])) {
      const more = (scale * size - (limits[1] - limits[0])) / 2;
      limits[0] -= more;
      limits[1] += more;
    }
  }

  resize() {
    const { clientWidth, clientHeight } = this.element;
    if (clientWidth > 0 && clientHeight > 0) this.chart?.setSize({ width: clientWidth, height: clientHeight });
  }

  /** @param {[number, number] | null} span null to follow */
  choose(span) {
    this.span.chosen = span;
    this.owner.moved();
  }

  /** Hold the shown span, or follow the newest samples again. */
  pause() {
    this.choose(this.span.chosen ? null : this.span.shown());
  }

  /** @param {number} factor as in ``Span`` @param {number} [at] */
  zoom(factor, at) {
    this.choose(this.span.zoomed(factor, at));
  }

  /** @param {number} part of what is shown */
  moveBy(part) {
    const [from, to] = this.span.shown();
    const way = (to - from) * part;
    this.choose([from + way, to + way]);
  }

  /** @param {uPlot} chart */
  zoomTo(chart) {
    const { left, width } = chart.select;
    if (width < 3) return;
    this.choose([chart.posToVal(left, "x"), chart.posToVal(left + width, "x")]);
    chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  /** @param {uPlot} chart */
  pointTo(chart) {
    const left = chart.cursor.left ?? -1;
    this.owner.pointed(left >= 0 ? chart.posToVal(left, "x") : NaN);
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    if (!this.chart) return;
    event.preventDefault();
    const isPan = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
    if (isPan) return this.moveBy(((event.deltaX || event.deltaY) / 100) * PAN);
    const at = this.across ? undefined : this.chart.posToVal(event.clientX - this.chart.over.getBoundingClientRect().left, "x");
    this.zoom(event.deltaY > 0 ? 1 / ZOOM : ZOOM, at);
  }

  /**
   * Pan by touch, with the middle button, or with Shift.
   * @param {PointerEvent} event
   */
  pan(event) {
    if (this.across) return;
    const isPan = event.pointerType === "touch" || event.button === 1 || event.shiftKey;
    if (!isPan || !this.chart) return;
    event.preventDefault();
    event.stopPropagation();
    const [from, to] = this.span.shown();
    const perPixel = (to - from) / this.chart.over.clientWidth;
    const ends = new AbortController();
    this.element.setPointerCapture(event.pointerId);
    const move = (/** @type {PointerEvent} */ now) => {
      const way = (event.clientX - now.clientX) * perPixel;
      if (now.pointerId === event.pointerId && way) this.choose([from + way, to + way]);
    };
    this.element.addEventListener("pointermove", move, ends);
    for (const end of ["pointerup", "pointercancel"]) this.element.addEventListener(end, () => ends.abort(), ends);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.target !== this.element) return;
    if (event.key === " ") this.pause();
    else if (event.key === "ArrowLeft") this.moveBy(-PAN);
    else if (event.key === "ArrowRight") this.moveBy(PAN);
    else if (event.key === "+" || event.key === "=") this.zoom(ZOOM);
    else if (event.key === "-") this.zoom(1 / ZOOM);
    else if (event.key === "Home" || event.key === "0") this.choose(null);
    else return;
    event.preventDefault();
  }

  /**
   * Save the chart as a picture, with the names of the curves above it.
   * @param {string} name of the file
   */
  savePicture(name) {
    if (!this.chart) return;
    const { canvas } = this.chart.ctx;
    const shown = this.series.flatMap(({ label, unit, isShown }, index) => (isShown ? [{ label: nameOf({ label, unit }), index }] : []));
    const [line, left] = [18 * devicePixelRatio, 12 * devicePixelRatio];
    const copy = element("canvas", { width: canvas.width, height: canvas.height + line * (shown.length + 1) });
    const pen = copy.getContext("2d");
    if (!pen) return;
    pen.fillStyle = color("--surface");
    pen.fillRect(0, 0, copy.width, copy.height);
    pen.drawImage(canvas, 0, line * (shown.length + 0.5));
    pen.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    shown.forEach(({ label, index }, row) => {
      pen.fillStyle = color(lineOf(index).color);
      pen.fillRect(left, line * (row + 0.7), 2 * left, 2 * devicePixelRatio);
      pen.fillStyle = color("--text");
      pen.fillText(label, 4 * left, line * (row + 1));
    });
    savePicture(name, copy);
  }
}

/**
 * Return the least and the largest number of columns; null without any.
 * @param {import("./curves.js").Column[]} columns
 * @returns {[number | null, number | null]}
 */
function ends(columns) {
  let [least, most] = [Infinity, -Infinity];
  for (const value of columns.flat()) {
    if (typeof value === "number") [least, most] = [Math.min(least, value), Math.max(most, value)];
  }
  return least > most ? [null, null] : [least, most];
}

/**
 * Draw a curve over another one, with a circle around the latest sample.
 * @param {uPlot} chart
 * @param {number} index of the series
 */
function pathOver(chart, index) {
  const [xs, ys] = /** @type {any} */ (chart.data[index]);
  const stroke = new Path2D();
  let isDown = false;
  xs.forEach((/** @type {number | null} */ x, /** @type {number} */ at) => {
    if (x === null || ys[at] === null) {
      isDown = false;
      return;
    }
    const place = /** @type {[number, number]} */ ([chart.valToPos(x, "x", true), chart.valToPos(ys[at], "y", true)]);
    stroke[isDown ? "lineTo" : "moveTo"](...place);
    isDown = true;
    if (at === xs.length - 1) stroke.arc(...place, 3 * devicePixelRatio, 0, 7);
  });
  return { stroke };
}

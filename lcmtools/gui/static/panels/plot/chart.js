// The chart of a plot: axes and curves, and zooming and panning by pointer, wheel and keys.

import uPlot from "../../vendor/uplot/uPlot.js";
import { element } from "../../elements.js";
import { color, onTheme } from "../../theme.js";
import { savePicture } from "../save.js";
import { stylesheet } from "../stylesheet.js";
import { tickText, timeText, timeTicks } from "./texts.js";

/** @typedef {{curve: number, label: string, text: string, isShown: boolean}} Series */

const COLORS = 8;
const STYLES = ["solid", "dashed", "dotted"];
const DASHES = [[], [8, 4], [2, 3]];
const STEPS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600];
const TICK_ROOM = 80; // [px] between two ticks of the time axis
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

/** A chart of curves over a span of time. */
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

  /**
   * Replace the curves.
   * @param {Series[]} series
   */
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
    this.hand.hidden = !(part >= 0 && part <= 1);
    this.hand.style.left = `${(100 * part).toFixed(2)}%`;
  }

  /** @returns {uPlot.Options} */
  options() {
    const [line, muted] = [color("--line"), color("--muted")];
    const grid = { stroke: line, width: 1 };
    const axis = { stroke: muted, grid, ticks: { ...grid, size: 4 }, font: "11px system-ui, sans-serif" };
    return {
      width: Math.max(50, this.element.clientWidth),
      height: Math.max(50, this.element.clientHeight),
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
        x: { time: false, range: () => this.span.shown() },
        y: { range: (_, least, most) => room(least, most) },
      },
      axes: [
        {
          ...axis,
          space: TICK_ROOM,
          size: 26,
          gap: 4,
          incrs: STEPS,
          splits: (_, __, from, to, step) => timeTicks(from, to, step, this.origin),
          values: (_, ticks, __, ___, step) => ticks.map((tick) => timeText(tick, step, this.origin)),
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
    const { color: name, dash } = lineOf(index);
    return {
      label,
      show: isShown,
      stroke: color(name),
      dash,
      width: 1.6,
      spanGaps: false,
      points: { size: 4 },
      gaps: (chart) => this.gaps(chart, curve),
    };
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

  /**
   * @param {number} factor
   * @param {number} [at]
   */
  zoom(factor, at) {
    this.span.zoom(factor, at);
    this.owner.moved();
  }

  /** @param {number} part */
  moveBy(part) {
    this.span.moveBy(part);
    this.owner.moved();
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
    if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      this.moveBy(((event.deltaX || event.deltaY) / 100) * PAN);
      return;
    }
    const at = this.chart.posToVal(event.clientX - this.chart.over.getBoundingClientRect().left, "x");
    this.zoom(event.deltaY > 0 ? 1 / ZOOM : ZOOM, at);
  }

  /**
   * Pan by touch, with the middle button, or with Shift.
   * @param {PointerEvent} event
   */
  pan(event) {
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
    const shown = this.series.flatMap(({ label, isShown }, index) => (isShown ? [{ label, index }] : []));
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
 * Return the limits of the value axis: the values with a margin.
 * @param {number | null} least
 * @param {number | null} most
 * @returns {[number, number]}
 */
function room(least, most) {
  if (least === null || most === null || !Number.isFinite(least) || !Number.isFinite(most)) return [-1, 1];
  const more = (most - least) * 0.08 || Math.abs(most) * 0.1 || 1;
  return [least - more, most + more];
}

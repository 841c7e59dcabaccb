// The samples of curves, as rows: a time, and a value or none for each curve.

import { numberText } from "./texts.js";

/**
 * @typedef {(number | null | undefined)[]} Column null is no number, undefined no sample of this curve
 * @typedef {{time: number, value: number, drawn: number, interval: number, count: number,
 *   gaps: [number, number][], odd: Map<number, number>}} Last the last sample of a curve, the time
 *   of the last that is finite, its usual interval, how many it has had, the times between which it
 *   has no line, and the values that are not finite, by their times
 */

const SAMPLE = 3; // numbers of a sample: its time [s since 1970], its value, its curve
const MOST_ROWS = 200_000;
const GAP = 5; // usual intervals without a sample that interrupt a curve
const SHORTEST_GAP = 0.5; // [s]

/** Times, and the values of each curve at these. */
export class Curves {
  /** @param {number} [start] the time of zero [s since 1970], by default that of the first sample */
  constructor(start = NaN) {
    /** Seconds since ``start``, ascending. @type {number[]} */
    this.times = [];
    /** @type {Column[]} */
    this.columns = [];
    /** @type {Last[]} */
    this.last = [];
    this.start = start;
    this.count = 0;
  }

  /** @param {number} [start] as in the constructor */
  clear(start) {
    Object.assign(this, new Curves(start));
  }

  /** The time of the first row [s since ``start``]; 0 without any. */
  get first() {
    return this.times[0] ?? 0;
  }

  /** The time of the last row [s since ``start``]; 0 without any. */
  get end() {
    return this.times[this.times.length - 1] ?? 0;
  }

  /**
   * Add samples, in any order; if a curve's time jumps back, as in a log, the earlier ones are removed.
   * @param {Float64Array} samples
   * @param {(curve: number) => number} place of a sample's curve among these
   * @param {number} kept seconds of samples that are kept
   */
  add(samples, place, kept) {
    for (let at = 0; at < samples.length; at += SAMPLE) {
      const [time, value, curve] = [samples[at] ?? 0, samples[at + 1] ?? NaN, place(samples[at + 2] ?? 0)];
      if (time - this.start < (this.last[curve]?.time ?? NaN) - 1) this.clear();
      if (Number.isNaN(this.start)) this.start = time;
      this.addOne(time - this.start, value, curve);
      this.count += 1;
    }
    this.drop(kept);
  }

  /** @param {number} time @param {number} value @param {number} curve */
  addOne(time, value, curve) {
    while (this.columns.length <= curve) {
      this.columns.push(new Array(this.times.length).fill(undefined));
      this.last.push({ time: NaN, value: NaN, drawn: NaN, interval: 0, count: 0, gaps: [], odd: new Map() });
    }
    const last = /** @type {Last} */ (this.last[curve]);
    const interval = time - last.time;
    const isLate = last.count > 1 && interval > Math.max(SHORTEST_GAP, GAP * last.interval);
    const isDrawn = Number.isFinite(value);
    if (isDrawn && (isLate || last.drawn !== last.time)) last.gaps.push([last.drawn, time]);
    if (!isDrawn) last.odd.set(time, value);
    /** @type {Column} */ (this.columns[curve])[this.rowOf(time)] = isDrawn ? value : null;
    if (interval > 0 && !isLate) last.interval = last.interval ? last.interval * 0.9 + interval * 0.1 : interval;
    Object.assign(last, { time, value, count: last.count + 1, drawn: isDrawn ? time : last.drawn });
  }

  /**
   * Return the row of a time, which is added if there is none.
   * @param {number} time
   */
  rowOf(time) {
    const row = time > this.end ? this.times.length : rowAt(this.times, time);
    if (this.times[row] === time) return row;
    this.times.splice(row, 0, time);
    for (const column of this.columns) column.splice(row, 0, undefined);
    return row;
  }

  /** @param {number} kept [s] */
  drop(kept) {
    const oldest = this.end - kept;
    const extra = Math.max(rowAt(this.times, oldest), this.times.length - MOST_ROWS);
    if (extra < Math.max(1000, this.times.length / 10)) return;
    this.times.splice(0, extra);
    for (const column of this.columns) column.splice(0, extra);
    for (const last of this.last) {
      last.gaps = last.gaps.filter(([, to]) => to >= this.first);
      for (const time of last.odd.keys()) if (time < this.first) last.odd.delete(time);
    }
  }

  /**
   * Return the value of a curve at a row, or its last value before; undefined if there is none.
   * @param {number} curve
   * @param {number} row
   */
  valueBefore(curve, row) {
    const column = this.columns[curve] ?? [];
    for (let at = row; at >= 0; at--) if (column[at] !== undefined) return this.valueAt(curve, at);
    return undefined;
  }

  /**
   * Return the value of a curve at a row, finite or not; undefined if it has none.
   * @param {number} curve
   * @param {number} row
   */
  valueAt(curve, row) {
    const value = this.columns[curve]?.[row];
    return value === null ? this.last[curve]?.odd.get(/** @type {number} */ (this.times[row])) : value;
  }

  /**
   * Return the samples of a curve between two times over another one's latest values.
   * @param {number} across the other curve
   * @param {number} curve
   * @param {[number, number]} span
   * @returns {[Column, Column]} null where a value is not finite
   */
  over(across, curve, [from, to]) {
    /** @type {[Column, Column]} */
    const [xs, ys] = [[], []];
    const last = rowAfter(this.times, to);
    let x = /** @type {number | null | undefined} */ (undefined);
    for (let row = 0; row < last; row++) {
      const [newX, y] = [this.columns[across]?.[row], this.columns[curve]?.[row]];
      if (newX !== undefined) x = newX;
      if (x === undefined || y === undefined || /** @type {number} */ (this.times[row]) < from) continue;
      xs.push(x);
      ys.push(y);
    }
    return [xs, ys];
  }

  /**
   * Return the samples between two times as CSV: a line for each row, empty cells without a sample.
   * @param {number} from
   * @param {number} to
   * @param {{curve: number, label: string}[]} shown
   */
  csv(from, to, shown) {
    const lines = [["time", ...shown.map(({ label }) => quoted(label))].join(",")];
    const last = rowAfter(this.times, to);
    for (let row = rowAt(this.times, from); row < last; row++) {
      const values = shown.map(({ curve }) => this.valueAt(curve, row));
      if (values.every((value) => value === undefined)) continue;
      const cells = values.map((value) => (value === undefined ? "" : Number.isFinite(value) ? String(value) : numberText(value)));
      lines.push([(this.start + (this.times[row] ?? 0)).toFixed(6), ...cells].join(","));
    }
    return `${lines.join("\n")}\n`;
  }
}

/** @param {string} label */
function quoted(label) {
  return /[",\n]/.test(label) ? `"${label.replaceAll('"', '""')}"` : label;
}

/**
 * Return the first row at a time or after it.
 * @param {number[]} times
 * @param {number} time
 */
export function rowAt(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (/** @type {number} */ (times[middle]) < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * Return the first row after a time.
 * @param {number[]} times
 * @param {number} time
 */
function rowAfter(times, time) {
  let row = rowAt(times, time);
  while (row < times.length && times[row] === time) row += 1;
  return row;
}

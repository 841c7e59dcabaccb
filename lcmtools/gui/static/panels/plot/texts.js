// Numbers and times of a plot as text.

import { clockText } from "../../texts.js";

/** @param {number} tick @param {number} step between two ticks */
export function tickText(tick, step) {
  if (Math.abs(tick) < step / 1000) return "0";
  const isPlain = step >= 1e-4 && Math.abs(tick) < 1e6;
  if (isPlain) return tick.toFixed(Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
  const digits = Math.ceil(Math.log10(Math.abs(tick)) - Math.log10(step) - 1e-9); // that tell two ticks apart
  return tick.toExponential(Math.min(9, Math.max(1, digits)));
}

/** @param {number | undefined} value undefined for no sample */
export function numberText(value) {
  if (value === undefined) return "–";
  if (Number.isNaN(value)) return "nan";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return String(value);
  const size = Math.abs(value);
  return size >= 1e6 || size < 1e-4 ? value.toExponential(4) : value.toPrecision(6);
}

/** @param {number} seconds 0 for all */
export function lengthText(seconds) {
  if (!seconds) return "all";
  return seconds < 60 ? `${seconds} s` : `${seconds / 60} min`;
}

/**
 * Format a time on the axis, as exactly as its ticks require.
 * @param {number} time [s since ``start``]
 * @param {number} step between two ticks
 * @param {number | null} start [s since 1970] for the time of day, null for seconds
 */
export function timeText(time, step, start) {
  const digits = step >= 1 ? 0 : Math.min(3, Math.ceil(-Math.log10(step)));
  if (start === null) return `${time.toFixed(digits)}${step >= 1 ? " s" : ""}`;
  const text = clockText(start + time);
  return digits ? text.slice(0, 9 + digits) : text.slice(0, 8);
}

/**
 * Return the ticks of the time axis: from 0 or, by the clock, from a round time of day.
 * @param {number} from
 * @param {number} to
 * @param {number} step
 * @param {number | null} start [s since 1970]
 */
export function timeTicks(from, to, step, start) {
  const zone = start === null ? 0 : new Date(start * 1000).getTimezoneOffset() * 60;
  const base = start === null || Number.isNaN(start) ? 0 : -((start - zone) % Math.max(1, step));
  const ticks = [];
  for (let at = Math.ceil((from - base) / step); base + at * step <= to; at++) ticks.push(base + at * step);
  return ticks;
}

// Numbers, times and errors as text, shared by several panels.

/**
 * Format the time of day, in milliseconds.
 * @param {number} time [s since 1970]
 */
export function clockText(time) {
  const date = new Date(Math.round(time * 1000));
  const two = (/** @type {number} */ value) => String(value).padStart(2, "0");
  const parts = [date.getHours(), date.getMinutes(), date.getSeconds()].map(two).join(":");
  return `${parts}.${String(date.getMilliseconds()).padStart(3, "0")}`;
}

/** Format a time as a part of a file's name, as the page's clock has it. @param {number} time [s since 1970] */
export function fileTimeText(time) {
  const day = new Date(Math.round(time * 1000)).toLocaleDateString("sv"); // as in ISO 8601
  return `${day}_${clockText(time)}`.replace(/[:.]/g, "-");
}

/** Return a number of things: "1 line", "2 lines". @param {number} count @param {string} noun */
export function counted(count, noun) {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}

// The next five are the same in Python, which tests/fixtures/texts.json proves.

/** @param {number} rate [Hz] */
export function rateText(rate) {
  return `${rate.toFixed(1)} Hz`;
}

/** @param {number} bytes */
export function sizeText(bytes) {
  const units = ["B", "KB", "MB", "GB"];
  let value = bytes;
  let unit = 0;
  while (value >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  const digits = !unit || value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
  return `${value.toFixed(digits)} ${units[unit]}`;
}

/** @param {number} seconds since something was heard */
export function ageText(seconds) {
  const units = /** @type {[string, number][]} */ ([["d", 86400], ["h", 3600], ["min", 60]]);
  const large = units.find(([, length]) => seconds >= 2 * length);
  if (large) return `${(seconds / large[1]).toFixed(0)} ${large[0]}`;
  return `${seconds.toFixed(seconds < 10 ? 1 : 0)} s`;
}

/** @param {number} loss a share of lost messages, 0 to 1 */
export function lossText(loss) {
  if (loss === 0) return "0";
  return loss < 0.1 ? `${Math.max(loss * 100, 0.1).toFixed(1)}%` : `${(loss * 100).toFixed(0)}%`;
}

/** @param {number} seconds the spread of the intervals between messages */
export function jitterText(seconds) {
  return seconds < 1 ? `${(seconds * 1000).toFixed(1)} ms` : `${seconds.toFixed(2)} s`;
}

/** @param {unknown} error that was thrown */
export function mistakeText(error) {
  return error instanceof Error ? error.message : String(error);
}

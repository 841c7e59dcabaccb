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

/** @param {number} rate [Hz] */
export function rateText(rate) {
  return `${rate >= 100 ? rate.toFixed(0) : rate.toFixed(1)} Hz`;
}

/** @param {unknown} error that was thrown */
export function mistakeText(error) {
  return error instanceof Error ? error.message : String(error);
}

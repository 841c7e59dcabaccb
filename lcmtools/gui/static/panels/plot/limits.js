// The limits of the value axis; lcmtools/observe/measuring/curves.py has the same rule.

const MARGIN = 0.08; // of the values' span, above and below
const LEAST_SPAN = 1e-5; // a smaller span is noise
const LARGEST = Number.MAX_VALUE / 2; // so that the span is finite
const RESOLUTION = 1e-8; // of the values' size: so is this

/**
 * Return the limits of the value axis: the values with a margin, or equal ones in the middle.
 * @param {number | null} least
 * @param {number | null} most
 * @returns {[number, number]}
 */
export function valueLimits(least, most) {
  if (least === null || most === null || !Number.isFinite(least) || !Number.isFinite(most)) return [-1, 1];
  const size = Math.max(Math.abs(least), Math.abs(most));
  if (size === 0) return [-1, 1];
  const span = most - least;
  if (!Number.isFinite(span)) return [least, most];
  if (span >= Math.max(LEAST_SPAN, RESOLUTION * size)) return [least - MARGIN * span, most + MARGIN * span];
  const [middle, more] = [least + span / 2, Math.max(0.1 * size, LEAST_SPAN)];
  return [middle - more, middle + more];
}

/** @typedef {{least: number | null, most: number | null, span: number | null}} Axis what the user has chosen */

/**
 * Return the limits of the value axis as chosen, else as in ``valueLimits``.
 * @param {number | null} least
 * @param {number | null} most
 * @param {Axis} axis
 * @returns {[number, number]}
 */
export function axisLimits(least, most, axis) {
  let [from, to] = /** @type {[number, number]} */ (valueLimits(least, most).map((one) => Math.max(-LARGEST, Math.min(LARGEST, one))));
  const more = ((axis.span ?? 0) - (to - from)) / 2;
  if (more > 0) [from, to] = [from - more, to + more];
  const [low, high] = [axis.least ?? from, axis.most ?? to];
  if (low < high) return [low, high];
  return axis.least === null ? [high - (axis.span || 1), high] : [low, low + (axis.span || 1)];
}

/**
 * Return the steps that ticks of a value axis may have: 1, 2 and 5 times powers of ten.
 * @param {number} span of the axis
 */
export function valueSteps(span) {
  const power = Math.floor(Math.log10(span));
  return [-2, -1, 0].flatMap((more) => [1, 2, 5].map((digit) => Number(`${digit}e${power + more}`)));
}

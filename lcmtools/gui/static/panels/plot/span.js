// The span of time that a plot shows: the latest, all, or one that the user has chosen.

export const KEPT = 600; // [s] of a bus's samples that are kept at least

/** A span of time [s since the first sample, or the start of a log]. */
export class Span {
  /**
   * @param {import("./curves.js").Curves} curves
   * @param {number} length [s]; 0 for all that there is
   */
  constructor(curves, length) {
    this.curves = curves;
    this.length = length;
    /** The span that the user has chosen; null to follow the newest samples. @type {[number, number] | null} */
    this.chosen = null;
    /** The playback position of a log [s]; NaN for a bus. */
    this.hand = NaN;
  }

  /**
   * Return the first and the last time shown; of a log, those around its position.
   * @returns {[number, number]}
   */
  shown() {
    const { curves, length, hand } = this;
    const { first, end } = curves;
    if (this.chosen) return this.chosen;
    if (!length) return [first, end > first ? end : first + 1];
    const to = Number.isNaN(hand) ? Math.max(end, first + length) : hand + length / 2;
    return [to - length, to];
  }

  /**
   * Return a longer or shorter span than the shown one.
   * @param {number} factor below 1 shows less
   * @param {number} [at] the time that keeps its place
   * @returns {[number, number]}
   */
  zoomed(factor, at) {
    const [from, to] = this.shown();
    const { first, end } = this.curves;
    const about = at ?? (this.chosen || !Number.isNaN(this.hand) ? (from + to) / 2 : to);
    const most = Math.max(2 * KEPT, end - first);
    const length = Math.max(0.01, Math.min(most, (to - from) * factor));
    const start = about - ((about - from) / (to - from)) * length;
    return [start, start + length];
  }
}

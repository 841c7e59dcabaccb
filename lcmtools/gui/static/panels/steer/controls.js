// The steering controls: sliders that spring back, and inputs for the limits.

import { drawing, element, write } from "../../elements.js";

/**
 * Create a slider that drives while it is held.
 * @param {"forward" | "turn"} kind
 * @param {string} label
 * @param {{isEnded: () => boolean, begin: () => void, hold: (value: number | null) => void}} owner
 *   after a stop it must be released before it drives again
 */
export function heldSlider(kind, label, { isEnded, begin, hold }) {
  const letGo = () => {
    slider.value = "0";
    hold(null);
  };
  const slider = element("input", {
    type: "range",
    class: `hold ${kind}`,
    min: -1,
    max: 1,
    step: 0.05,
    value: 0,
    "aria-label": label,
    title: label,
    onpointerdown: begin,
    onkeydown: (/** @type {KeyboardEvent} */ event) => event.repeat || begin(),
    oninput: () => {
      if (isEnded()) slider.value = "0";
      else hold(Number(slider.value));
    },
    onchange: (/** @type {Event} */ event) => {
      if (!slider.matches(":focus-visible")) letGo();
      event.stopPropagation();
    },
    onpointerup: letGo,
    onpointercancel: letGo,
    onkeyup: letGo,
    onblur: letGo,
  });
  return slider;
}

/**
 * @param {string} label
 * @param {string} about
 * @param {string} unit
 * @param {number} value
 * @param {number} largest
 * @param {(value: number) => void} change
 */
export function limitField(label, about, unit, value, largest, change) {
  const title = `${about} [${unit}]`;
  let last = value;
  const input = element("input", {
    type: "number",
    min: 0.1,
    max: largest,
    step: 0.1,
    value,
    "aria-label": title,
    title,
    onchange: () => {
      last = limited(Number(input.value), last, largest);
      input.value = String(last);
      change(last);
    },
  });
  return element("label", {}, element("span", {}, label), input, element("small", {}, unit));
}

/** @param {number} part @param {(part: number) => void} change */
export function partField(part, change) {
  const percent = (/** @type {number} */ value) => `${Math.round(value * 100)} %`;
  const shown = element("small", {}, percent(part));
  const input = element("input", {
    type: "range",
    min: 0.1,
    max: 1,
    step: 0.1,
    value: part,
    "aria-label": "Speed by keys, in parts of the limits",
    oninput: () => {
      write(shown, percent(Number(input.value)));
      change(Number(input.value));
    },
  });
  return element("label", {}, element("span", {}, "Keys"), input, shown);
}

/** Create the lines of the joystick. */
export function cross() {
  const arrows = ["M50 9l5 7H45z", "M50 91l5-7H45z", "M9 50l7-5v10z", "M91 50l-7-5v10z"];
  return drawing(
    "svg",
    { viewBox: "0 0 100 100", "aria-hidden": "true" },
    drawing("circle", { cx: 50, cy: 50, r: 25 }),
    drawing("path", { d: "M50 22V78M22 50H78", class: "axes" }),
    arrows.map((d) => drawing("path", { d, class: "arrow" })),
  );
}

/** @param {number} value */
export function signed(value) {
  const shown = value.toFixed(2);
  return Number(shown) > 0 ? `+${shown}` : Number(shown) < 0 ? shown.replace("-", "\u2212") : "0.00";
}

/**
 * Return a limit that was saved or entered; the usual one if it is none.
 * @param {any} value
 * @param {number} usual
 * @param {number} largest
 */
export function limited(value, usual, largest) {
  return Math.min(largest, typeof value === "number" && Number.isFinite(value) && value > 0 ? value : usual);
}

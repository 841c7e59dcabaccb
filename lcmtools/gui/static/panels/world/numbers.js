// Numbers of messages. Those that JSON lacks come as the texts "nan", "inf" and "-inf".

const LACKING = /** @type {Record<string, number>} */ ({ nan: NaN, inf: Infinity, "-inf": -Infinity });
const NUMBERS = ["pose", "twist", "covariance", "first", "step", "shortest", "longest", "resolution", "origin"];
const NUMBERS_OF_MARKERS = ["pose", "scale", "color", "points", "colors"];
const LARGEST = 1e30;
const PLACES = ["pose", "first", "step", "resolution", "origin", "scale", "points"];

/** Return a message's data with numbers in place of the texts for them. @param {any} data */
export function withNumbers(data) {
  if (data.kind !== "markers") return converted(data, NUMBERS);
  return { ...data, markers: data.markers.map((/** @type {any} */ one) => converted(one, NUMBERS_OF_MARKERS)) };
}

/**
 * Return true where all numbers that a drawing is placed by are finite, also as float32.
 * @param {any} data of a message, or a marker
 */
export function hasPlace(data) {
  return PLACES.every((name) => !(name in data) || [data[name]].flat().every((value) => Number.isFinite(value) && Math.abs(value) < LARGEST));
}

/** @param {any} data @param {string[]} names */
function converted(data, names) {
  const found = { ...data };
  for (const name of names) if (name in found) found[name] = numeric(found[name]);
  return found;
}

/** @param {any} value @returns {any} */
function numeric(value) {
  return Array.isArray(value) ? value.map(numeric) : (LACKING[value] ?? value);
}

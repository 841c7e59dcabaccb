// Saving what a panel shows as a file.

import { element } from "../elements.js";

/**
 * Let the browser save a file.
 * @param {string} name
 * @param {Blob} content
 */
export function saveFile(name, content) {
  const address = URL.createObjectURL(content);
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/**
 * Let the browser save a picture.
 * @param {string} name
 * @param {HTMLCanvasElement} canvas
 */
export function savePicture(name, canvas) {
  canvas.toBlob((content) => content && saveFile(name, content), "image/png");
}

/**
 * A topic as a part of a file's name.
 * @param {string} topic
 */
export function fileName(topic) {
  return topic.replace(/[^\w.-]+/g, "_").replace(/^_+|_+$/g, "") || "lcmtools";
}

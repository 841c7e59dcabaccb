// Saving the content of a panel as a file.

import { element } from "../elements.js";

/**
 * Save a file through the browser.
 * @param {string} name
 * @param {Blob} content
 */
export function saveFile(name, content) {
  const address = URL.createObjectURL(content);
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/**
 * Save a canvas as a picture through the browser.
 * @param {string} name
 * @param {HTMLCanvasElement} canvas
 */
export function savePicture(name, canvas) {
  canvas.toBlob((content) => content && saveFile(name, content), "image/png");
}

/** Convert a topic into a part of a file's name. @param {string} topic */
export function fileName(topic) {
  return topic.replace(/[^\w.-]+/g, "_").replace(/^_+|_+$/g, "") || "lcmtools";
}

// The panels. A module is imported when its panel is first opened.

/**
 * @typedef {import("../context.js").Context} Context
 * @typedef {{element: HTMLElement, title: string, settings: () => any, close: () => void}} Panel
 * @typedef {{new (context: Context, settings: any): Panel}} PanelClass
 * @typedef {{title: string, detail: string, module: () => Promise<{default: PanelClass}>}} Kind
 */

/** @type {Record<string, Kind>} */
export const PANELS = {
  topics: {
    title: "Topics",
    detail: "rates, loss, senders, messages",
    module: () => import("./topics.js"),
  },
};

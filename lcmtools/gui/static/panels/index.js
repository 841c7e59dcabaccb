// The panels. A module is imported when its panel is first opened.

/**
 * @typedef {import("../context.js").Context} Context
 * @typedef {{element: HTMLElement, title: string, settings?: () => any, close?: () => void,
 *   focus?: () => void}} Panel
 * @typedef {{new (context: Context, settings: any): Panel}} PanelClass
 * @typedef {{title: string, detail: string, isLarge?: boolean, isWide?: boolean, module: () => Promise<{default: PanelClass}>}} Kind
 */

/** @type {(title: string, detail: string, module: Kind["module"]) => Kind} */
const kind = (title, detail, module) => ({ title, detail, module });

/** @type {Record<string, Kind>} */
export const PANELS = {
  steer: kind("Steer", "drive a robot by joystick, keys or gamepad", () => import("./steer.js")),
  plot: { ...kind("Plot", "fields of messages over time", () => import("./plot.js")), isWide: true },
  world: { ...kind("World", "robots, sensors and paths in 3D", () => import("./world.js")), isLarge: true },
  frames: kind("Frames", "the tree of coordinate frames", () => import("./frames.js")),
  image: kind("Image", "colour, grey and depth", () => import("./image.js")),
  log: kind("Log", "lines of the nodes", () => import("./log.js")),
  graph: kind("Graph", "nodes, topics and what is wrong with them", () => import("./graph.js")),
  topics: kind("Topics", "rates, loss, senders, messages", () => import("./topics.js")),
  services: kind("Services", "call a service of a node", () => import("./services.js")),
  parameters: kind("Parameters", "read and set the parameters of nodes", () => import("./parameters.js")),
  record: kind("Record", "record topics into a log", () => import("./record.js")),
};

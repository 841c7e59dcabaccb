// The panels. A module is imported when its panel is first opened.

/**
 * @typedef {import("../context.js").Context} Context
 * @typedef {{element: HTMLElement, title: string, settings: () => any, close: () => void}} Panel
 * @typedef {{new (context: Context, settings: any): Panel}} PanelClass
 * @typedef {{title: string, detail: string, isLarge?: boolean, module: () => Promise<{default: PanelClass}>}} Kind
 */

/** @type {Record<string, Kind>} */
export const PANELS = {
  steer: {
    title: "Steer",
    detail: "drive a robot by joystick, keys or gamepad",
    module: () => import("./steer.js"),
  },
  plot: {
    title: "Plot",
    detail: "fields of messages over time",
    module: () => import("./plot.js"),
  },
  world: {
    title: "World",
    detail: "robots, sensors and paths in 3D",
    isLarge: true,
    module: () => import("./world.js"),
  },
  image: {
    title: "Image",
    detail: "colour, grey and depth",
    module: () => import("./image.js"),
  },
  log: {
    title: "Log",
    detail: "lines of the nodes",
    module: () => import("./log.js"),
  },
  graph: {
    title: "Graph",
    detail: "nodes, topics and what is wrong with them",
    module: () => import("./graph.js"),
  },
  topics: {
    title: "Topics",
    detail: "rates, loss, senders, messages",
    module: () => import("./topics.js"),
  },
};

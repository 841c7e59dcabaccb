// The displays of the world: one for each topic, by the kind of its messages.

import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  DoubleSide,
  Group,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  NearestFilter,
  PlaneGeometry,
  Points,
  PointsMaterial,
} from "../../vendor/three/three.js";
import { bodyOf, dispose, matrixOf, ribbonOf, triples } from "./shapes.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {import("./frames.js").Frames} Frames
 * @typedef {(group: any, data: any, payload: ArrayBuffer, color: string, isPainted: boolean) => void} Draw
 */

/** The stream, and whether it is shown at first, by the type of a topic. */
export const TYPES = /** @type {Record<string, {stream: string, name: string, isOff?: boolean, hasColor?: boolean}>} */ ({
  "visualization_msgs/MarkerArray": { stream: "markers", name: "markers" },
  "visualization_msgs/Marker": { stream: "markers", name: "markers" },
  "tf2_msgs/TFMessage": { stream: "frames", name: "frames" },
  "nav_msgs/Odometry": { stream: "newest", name: "odometry", hasColor: true },
  "nav_msgs/Path": { stream: "newest", name: "path", hasColor: true },
  "nav_msgs/OccupancyGrid": { stream: "newest", name: "map" },
  "sensor_msgs/LaserScan": { stream: "newest", name: "laser", hasColor: true },
  "sensor_msgs/PointCloud2": { stream: "newest", name: "points", isOff: true, hasColor: true },
  "sensor_msgs/PointCloud": { stream: "newest", name: "points", isOff: true, hasColor: true },
  "geometry_msgs/PoseStamped": { stream: "newest", name: "pose", hasColor: true },
  "geometry_msgs/PoseWithCovarianceStamped": { stream: "newest", name: "pose", hasColor: true },
  "geometry_msgs/PoseArray": { stream: "newest", name: "poses", hasColor: true },
});

const FLOAT = 7; // of sensor_msgs/PointField
const FAR = 6; // [m] from where on points are all of one shade
const MOST_POINTS = 400_000;
const TRAIL = 4000; // points
const TRAIL_STEP = 0.03; // [m]
const LIFT = 0.012; // [m] of what is drawn on the ground

/** What a topic shows. Its group is placed in its frame each time that the view is drawn. */
export class Display {
  /**
   * @param {string} topic
   * @param {string} type
   */
  constructor(topic, type) {
    this.topic = topic;
    this.type = type;
    this.color = "#ff8800";
    /** Points are in this colour, and not in their own. */
    this.isPainted = false;
    /** What is wrong with it, or how much it shows. */
    this.status = "";
    /** @type {{frame: string, group: any, ns?: string}[]} */
    this.parts = [];
    /** @type {any} */
    this.latest = null;
    /** @type {ArrayBuffer} */
    this.payload = new ArrayBuffer(0);
    /** @type {{fixed: string, places: [number, number, number][]}} */
    this.trail = { fixed: "", places: [] };
  }

  /**
   * @param {any} data
   * @param {ArrayBuffer} [payload]
   */
  take(data, payload = new ArrayBuffer(0)) {
    this.latest = data;
    this.payload = payload;
    this.make();
  }

  make() {
    if (!this.latest) return;
    const { kind, frame } = this.latest;
    if (kind === "markers") this.makeBodies(this.latest.markers);
    else if (DRAW[kind]) {
      if (this.parts[0]?.frame !== frame) {
        this.clear();
        this.parts = [{ frame, group: new Group() }];
      }
      const { group } = /** @type {{group: any}} */ (this.parts[0]);
      for (const child of [...group.children]) dispose(child);
      DRAW[kind](group, this.latest, this.payload, this.color, this.isPainted);
    }
  }

  /** @param {import("./shapes.js").Marker[]} markers */
  makeBodies(markers) {
    this.clear();
    /** @type {Map<string, import("./shapes.js").Marker[]>} */
    const bodies = new Map();
    for (const marker of markers) {
      const key = `${marker.frame}\n${marker.ns}`;
      bodies.set(key, [...(bodies.get(key) ?? []), marker]);
    }
    this.parts = [...bodies.values()].map((body) => {
      const { frame, ns } = /** @type {import("./shapes.js").Marker} */ (body[0]);
      const group = bodyOf(body);
      Object.assign(group.userData, { topic: this.topic, frame, ns });
      return { frame, group, ns };
    });
    this.status = `${markers.length} markers`;
  }

  /** @param {string} color */
  paint(color) {
    if (this.color === color) return;
    this.color = color;
    this.isPainted = true;
    this.make();
  }

  /**
   * Put everything where it is at a time.
   * @param {any} content
   * @param {Frames} frames
   * @param {string} fixed
   * @param {number} now
   * @param {(frame: string, topic: string) => string} frameOf a known frame for one that is not
   */
  place(content, frames, fixed, now, frameOf) {
    let lost = "";
    for (const { frame, group } of this.parts) {
      const pose = frames.pose(frameOf(frame, this.topic), fixed, now);
      group.visible = pose !== null;
      if (pose) group.matrix.copy(matrixOf(pose));
      else lost = frame;
      group.matrixAutoUpdate = false;
      if (group.parent !== content) content.add(group);
    }
    this.lost = lost && `no transform from ${lost} to ${fixed}`;
    if (this.trailMesh?.parent !== content && this.trailMesh) content.add(this.trailMesh);
  }

  /**
   * Leave a trail where the odometry is.
   * @param {Frames} frames
   * @param {string} fixed
   * @param {number} now
   */
  leaveTrail(frames, fixed, now) {
    const { trail, latest } = this;
    if (latest?.kind !== "odometry") return;
    if (trail.fixed !== fixed) Object.assign(trail, { fixed, places: [], group: undefined });
    const base = frames.pose(latest.frame, fixed, now);
    const pose = base && matrixOf(base).multiply(matrixOf(latest.pose));
    if (!pose) return;
    const at = /** @type {[number, number, number]} */ ([pose.elements[12], pose.elements[13], LIFT]);
    const last = trail.places.at(-1);
    const way = last ? Math.hypot(at[0] - last[0], at[1] - last[1]) : Infinity;
    if (way < TRAIL_STEP) return;
    if (way > 1 && last) trail.places = []; // it was put elsewhere
    trail.places.push(at);
    if (trail.places.length > TRAIL) trail.places.shift();
    if (this.trailMesh) dispose(this.trailMesh);
    this.trailMesh = band(trail.places, 0.035, this.color, 0.75);
  }

  clear() {
    for (const { group } of this.parts) dispose(group);
    this.parts = [];
  }

  close() {
    this.clear();
    if (this.trailMesh) dispose(this.trailMesh);
  }
}

/** @type {Record<string, Draw>} */
const DRAW = {
  scan: (group, data, payload, color) => {
    const ranges = new Float32Array(payload);
    /** @type {number[]} */
    const places = [];
    ranges.forEach((range, index) => {
      if (!(range >= data.shortest && range <= data.longest)) return;
      const angle = data.first + index * data.step;
      places.push(range * Math.cos(angle), range * Math.sin(angle), 0);
    });
    group.add(cloudOf(new Float32Array(places), null, color, 5));
    group.add(fan(ranges, data, color));
  },
  points: (group, _, payload, color) => group.add(cloudOf(new Float32Array(payload), null, color, 3)),
  cloud: (group, data, payload, color, isPainted) => {
    const { places, colors } = readCloud(data, payload, isPainted ? color : "");
    group.add(cloudOf(places, colors, color, 3));
  },
  path: (group, _, payload, color) => {
    const places = triples(new Float32Array(payload)).map(([x, y, z]) => /** @type {[number, number, number]} */ ([x, y, z + LIFT]));
    group.add(band(places, 0.025, color, 0.9));
  },
  odometry: (group, data, _, color) => group.add(pointer(data.pose, color)),
  pose: (group, data, _, color) => group.add(pointer(data.pose, color)),
  poses: (group, _, payload, color) => {
    const numbers = new Float32Array(payload);
    const count = Math.floor(numbers.length / 7);
    const mesh = new InstancedMesh(arrowShape(0.25), new MeshBasicMaterial({ color }), count);
    for (let index = 0; index < count; index += 1) {
      mesh.setMatrixAt(index, matrixOf(/** @type {any} */ ([...numbers.subarray(7 * index, 7 * index + 7)])));
    }
    mesh.frustumCulled = false;
    group.add(mesh);
  },
  grid: (group, data, payload) => group.add(map(data, new Int8Array(payload))),
};

/**
 * @param {Float32Array} places
 * @param {Float32Array | null} colors
 * @param {string} color
 * @param {number} size [px]
 */
function cloudOf(places, colors, color, size) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  if (colors) geometry.setAttribute("color", new BufferAttribute(colors, 3));
  const look = { size: size * Math.min(devicePixelRatio, 2), sizeAttenuation: false, toneMapped: false };
  const found = new Points(geometry, new PointsMaterial(colors ? { ...look, vertexColors: true } : { ...look, color }));
  found.frustumCulled = false;
  return found;
}

/**
 * What a laser sees of the ground between its rays, as a veil.
 * @param {Float32Array} ranges
 * @param {any} data
 * @param {string} color
 */
function fan(ranges, data, color) {
  const places = new Float32Array(9 * Math.max(0, ranges.length - 1));
  const ends = Array.from(ranges, (range, index) => {
    const way = range >= data.shortest && range <= data.longest ? range : range > data.shortest ? data.longest : 0;
    const angle = data.first + index * data.step;
    return [way * Math.cos(angle), way * Math.sin(angle)];
  });
  for (let index = 1; index < ends.length; index += 1) {
    const [a, b] = /** @type {number[][]} */ ([ends[index - 1], ends[index]]);
    places.set([0, 0, 0, .../** @type {number[]} */ (a), 0, .../** @type {number[]} */ (b), 0], 9 * (index - 1));
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  const look = { color, transparent: true, opacity: 0.1, depthWrite: false, side: DoubleSide, toneMapped: false };
  const found = new Mesh(geometry, new MeshBasicMaterial(look));
  found.frustumCulled = false;
  found.renderOrder = 3;
  return found;
}

/**
 * @param {[number, number, number][]} places
 * @param {number} width
 * @param {string} color
 * @param {number} opacity
 */
function band(places, width, color, opacity) {
  const look = { color, transparent: true, opacity, side: DoubleSide, depthWrite: false, toneMapped: false };
  const offset = { polygonOffset: true, polygonOffsetFactor: -3, polygonOffsetUnits: -12 };
  const found = new Mesh(ribbonOf([places], width), new MeshBasicMaterial({ ...look, ...offset }));
  found.renderOrder = 2;
  found.frustumCulled = false;
  return found;
}

/**
 * An arrow on the ground.
 * @param {Pose} pose
 * @param {string} color
 */
export function pointer(pose, color) {
  const look = { color, side: DoubleSide, roughness: 0.6, polygonOffset: true, polygonOffsetFactor: -4, polygonOffsetUnits: -16 };
  const found = new Mesh(arrowShape(0.7), new MeshStandardMaterial(look));
  found.applyMatrix4(new Matrix4().multiplyMatrices(matrixOf(pose), new Matrix4().makeTranslation(0, 0, LIFT)));
  found.renderOrder = 2;
  return found;
}

/** @param {number} length [m] */
function arrowShape(length) {
  const [neck, half, wide] = [0.62 * length, 0.07 * length, 0.2 * length];
  const corners = [0, -half, neck, -half, neck, half, 0, -half, neck, half, 0, half, neck, -wide, length, 0, neck, wide];
  const places = new Float32Array((corners.length / 2) * 3);
  for (let index = 0; index < corners.length / 2; index += 1) {
    places.set([/** @type {number} */ (corners[2 * index]), /** @type {number} */ (corners[2 * index + 1]), 0], 3 * index);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.computeVertexNormals();
  return geometry;
}

/**
 * The points of sensor_msgs/PointCloud2 that are numbers, with their own colours; where they have
 * none, or one is chosen, its shade shows the distance.
 * @param {any} data
 * @param {ArrayBuffer} payload
 * @param {string} chosen
 */
function readCloud(data, payload, chosen) {
  const view = new DataView(payload);
  const little = !data.isBigEndian;
  /** @param {string} name */
  const field = (name) => data.fields.find((/** @type {any[]} */ one) => one[0] === name);
  const [x, y, z] = ["x", "y", "z"].map((name) => (field(name)?.[2] === FLOAT ? field(name)[1] : -1));
  const rgb = field("rgb") ?? field("rgba");
  const total = Math.min(data.width * data.height, Math.floor(payload.byteLength / (data.pointStep || 1)));
  const step = Math.max(1, Math.ceil(total / MOST_POINTS));
  const places = new Float32Array(3 * Math.ceil(total / step));
  const colors = new Float32Array(places.length);
  let at = 0;
  if (x < 0 || y < 0 || z < 0) return { places: places.subarray(0, 0), colors: colors.subarray(0, 0) };
  const tone = new Color();
  for (let index = 0; index < total; index += step) {
    const start = Math.floor(index / data.width) * data.rowStep + (index % data.width) * data.pointStep;
    if (start + data.pointStep > payload.byteLength) break;
    const place = [view.getFloat32(start + x, little), view.getFloat32(start + y, little), view.getFloat32(start + z, little)];
    if (!place.every(Number.isFinite)) continue;
    places.set(place, at);
    const distance = Math.min(1, Math.hypot(...place) / FAR);
    if (chosen) tone.set(chosen).offsetHSL(-0.14 * distance, -0.35 * distance, 0.2 - 0.38 * distance);
    else if (rgb) tone.setHex(view.getUint32(start + rgb[1], little) & 0xffffff);
    else tone.setHSL(0.66 * distance, 0.9, 0.5);
    tone.toArray(colors, at);
    at += 3;
  }
  return { places: places.subarray(0, at), colors: colors.subarray(0, at) };
}

/**
 * @param {any} data
 * @param {Int8Array} cells
 */
function map(data, cells) {
  const canvas = document.createElement("canvas");
  canvas.width = data.width || 1;
  canvas.height = data.height || 1;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const image = pen.createImageData(canvas.width, canvas.height);
  cells.forEach((cell, index) => {
    const row = canvas.height - 1 - Math.floor(index / canvas.width);
    const light = cell < 0 ? 128 : 255 - 2.55 * cell;
    image.data.set([light, light, light, cell < 0 ? 90 : 255], 4 * (row * canvas.width + (index % canvas.width)));
  });
  pen.putImageData(image, 0, 0);
  const [width, height] = [data.width * data.resolution, data.height * data.resolution];
  const texture = new CanvasTexture(canvas);
  texture.magFilter = NearestFilter;
  const look = { map: texture, transparent: true, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4 };
  const found = new Mesh(new PlaneGeometry(width, height).translate(width / 2, height / 2, 0.004), new MeshBasicMaterial(look));
  found.applyMatrix4(matrixOf(data.origin));
  return found;
}

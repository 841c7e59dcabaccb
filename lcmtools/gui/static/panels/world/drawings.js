// Functions that draw a message, by its kind: points, bands, arrows, maps.

import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  DoubleSide,
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
import { matrixOf, ribbonOf, triples } from "./geometry.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {(group: any, data: any, payload: ArrayBuffer, color: string, isPainted: boolean) => void} Draw
 */

const FLOAT = 7; // of sensor_msgs/PointField
const FAR = 6; // [m] distance beyond which all points have the same shade
const MOST_POINTS = 400_000;
export const LIFT = 0.012; // [m] above the ground, for drawings on it

/**
 * The kinds of drawings: their name in the list, and how a message is drawn in its frame.
 * Which types have a kind, and what the page gets of a message, is in lcmtools/gui/drawings.py.
 * @type {Record<string, {name: string, stream?: string, isOff?: boolean, hasColor?: boolean, draw?: Draw}>}
 */
export const KINDS = {
  markers: { name: "markers", stream: "markers" },
  frames: { name: "frames", stream: "frames" },
  scan: {
    name: "laser",
    hasColor: true,
    draw: (group, data, payload, color) => {
      const ranges = new Float32Array(payload);
      /** @type {number[]} */
      const places = [];
      ranges.forEach((range, index) => {
        if (!(range >= data.shortest && range <= data.longest && Number.isFinite(range))) return;
        const angle = data.first + index * data.step;
        places.push(range * Math.cos(angle), range * Math.sin(angle), 0);
      });
      group.add(cloudOf(new Float32Array(places), null, color, 5));
      group.add(fan(ranges, data, color));
    },
  },
  points: {
    name: "points",
    isOff: true,
    hasColor: true,
    draw: (group, _, payload, color) => group.add(cloudOf(new Float32Array(payload), null, color, 3)),
  },
  cloud: {
    name: "points",
    isOff: true,
    hasColor: true,
    draw: (group, data, payload, color, isPainted) => {
      const { places, colors } = readCloud(data, payload, isPainted ? color : "");
      group.add(cloudOf(places, colors, color, 3));
    },
  },
  path: {
    name: "path",
    hasColor: true,
    draw: (group, _, payload, color) => {
      const places = triples(new Float32Array(payload)).map(([x, y, z]) => /** @type {[number, number, number]} */ ([x, y, z + LIFT]));
      group.add(band(places, 0.025, color, 0.9));
    },
  },
  odometry: { name: "odometry", hasColor: true, draw: (group, data, _, color) => group.add(pointer(data.pose, color)) },
  pose: { name: "pose", hasColor: true, draw: (group, data, _, color) => group.add(pointer(data.pose, color)) },
  poses: {
    name: "poses",
    hasColor: true,
    draw: (group, _, payload, color) => {
      const numbers = new Float32Array(payload);
      const count = Math.floor(numbers.length / 7);
      const mesh = new InstancedMesh(arrowShape(0.25), new MeshBasicMaterial({ color }), count);
      for (let index = 0; index < count; index += 1) {
        mesh.setMatrixAt(index, matrixOf(/** @type {any} */ ([...numbers.subarray(7 * index, 7 * index + 7)])));
      }
      mesh.frustumCulled = false;
      group.add(mesh);
    },
  },
  grid: { name: "map", draw: (group, data, payload) => group.add(map(data, new Int8Array(payload))) },
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
 * Draw the area that a laser sees as a translucent surface.
 * @param {Float32Array} ranges
 * @param {any} data
 * @param {string} color
 */
function fan(ranges, data, color) {
  const places = new Float32Array(9 * Math.max(0, ranges.length - 1));
  const ends = Array.from(ranges, (range, index) => {
    const seen = range >= data.shortest && range <= data.longest ? range : range > data.shortest ? data.longest : 0;
    const way = Number.isFinite(seen) ? seen : 0;
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
export function band(places, width, color, opacity) {
  const look = { color, transparent: true, opacity, side: DoubleSide, depthWrite: false, toneMapped: false };
  const offset = { polygonOffset: true, polygonOffsetFactor: -3, polygonOffsetUnits: -12 };
  const found = new Mesh(ribbonOf([places], width), new MeshBasicMaterial({ ...look, ...offset }));
  found.renderOrder = 2;
  found.frustumCulled = false;
  return found;
}

/**
 * Draw an arrow on the ground.
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
 * Draw the finite points of a sensor_msgs/PointCloud2 in their own colours; if they have none, or
 * a colour is chosen, the shade shows the distance.
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

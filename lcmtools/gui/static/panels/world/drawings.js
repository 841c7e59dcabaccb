// Functions that draw a message, by its kind: points, bands, arrows, maps.

import * as THREE from "../../vendor/three/three.js";
import { geometryOf, matrixOf, ribbonOf, triples } from "./geometry.js";
import { litMaterial } from "./light.js";

/**
 * @typedef {import("./frames.js").Pose} Pose
 * @typedef {(group: any, data: any, payload: ArrayBuffer, color: string, isPainted: boolean) => void} Draw
 */

const FLOAT = 7; // of sensor_msgs/PointField
const DOUBLE = 8;
const PACKED = [5, 6, FLOAT]; // types of four bytes, for a packed colour
const MOST_CELLS = 4096; // of a map's side; of a larger one every second, third ... cell is drawn
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
      const places = Array.from(ranges).flatMap((range, index) => {
        if (!(range >= data.shortest && range <= data.longest && Number.isFinite(range))) return [];
        const angle = data.first + index * data.step;
        return [range * Math.cos(angle), range * Math.sin(angle), 0];
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
      group.add(band(places, color));
    },
  },
  odometry: { name: "odometry", hasColor: true, draw: (group, data, _, color) => group.add(pointer(data.pose, color)) },
  pose: { name: "pose", hasColor: true, draw: (group, data, _, color) => group.add(pointer(data.pose, color)) },
  poses: {
    name: "poses",
    hasColor: true,
    draw: (group, _, payload, color) => {
      const numbers = Array.from(new Float32Array(payload));
      const count = Math.floor(numbers.length / 7);
      const mesh = new THREE.InstancedMesh(arrowShape(0.25), new THREE.MeshBasicMaterial({ color }), count);
      for (let index = 0; index < count; index += 1) {
        mesh.setMatrixAt(index, matrixOf(/** @type {any} */ (numbers.slice(7 * index, 7 * index + 7))));
      }
      group.add(Object.assign(mesh, { frustumCulled: false }));
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
  const geometry = geometryOf(colors ? { position: places, color: colors } : { position: places });
  const look = { size: size * Math.min(devicePixelRatio, 2), sizeAttenuation: false, toneMapped: false };
  const material = new THREE.PointsMaterial(colors ? { ...look, vertexColors: true } : { ...look, color });
  return Object.assign(new THREE.Points(geometry, material), { frustumCulled: false });
}

/**
 * Draw the area that a laser sees as a translucent surface.
 * @param {Float32Array} ranges
 * @param {any} data
 * @param {string} color
 */
function fan(ranges, data, color) {
  const ends = Array.from(ranges, (range, index) => {
    const seen = range >= data.shortest && range <= data.longest ? range : range > data.shortest ? data.longest : 0;
    const way = Number.isFinite(seen) ? seen : 0;
    const angle = data.first + index * data.step;
    return [way * Math.cos(angle), way * Math.sin(angle)];
  });
  const places = ends.slice(1).flatMap((end, index) => [0, 0, 0, ...(ends[index] ?? end), 0, ...end, 0]);
  const look = { color, transparent: true, opacity: 0.1, depthWrite: false, side: THREE.DoubleSide, toneMapped: false };
  const geometry = geometryOf({ position: new Float32Array(places) });
  const found = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(look));
  return Object.assign(found, { frustumCulled: false, renderOrder: 3 });
}

/**
 * Create the material of a band on the ground.
 * @param {string} color
 * @param {number} opacity
 */
export function bandMaterial(color, opacity) {
  const look = { color, transparent: true, opacity, side: THREE.DoubleSide, depthWrite: false, toneMapped: false };
  return new THREE.MeshBasicMaterial({ ...look, polygonOffset: true, polygonOffsetFactor: -3, polygonOffsetUnits: -12 });
}

/** @param {[number, number, number][]} places @param {string} color */
function band(places, color) {
  const found = new THREE.Mesh(ribbonOf([places], 0.025), bandMaterial(color, 0.9));
  return Object.assign(found, { frustumCulled: false, renderOrder: 2 });
}

/**
 * Draw an arrow on the ground.
 * @param {Pose} pose
 * @param {string} color
 */
export function pointer(pose, color) {
  const look = { color, side: THREE.DoubleSide, roughness: 0.6, polygonOffset: true, polygonOffsetFactor: -4, polygonOffsetUnits: -16 };
  const found = new THREE.Mesh(arrowShape(0.7), litMaterial(look));
  found.applyMatrix4(new THREE.Matrix4().multiplyMatrices(matrixOf(pose), new THREE.Matrix4().makeTranslation(0, 0, LIFT)));
  found.renderOrder = 2;
  return found;
}

/** @param {number} length [m] */
function arrowShape(length) {
  const [neck, half, wide] = [0.62 * length, 0.07 * length, 0.2 * length];
  const shaft = [0, -half, 0, neck, -half, 0, neck, half, 0, 0, -half, 0, neck, half, 0, 0, half, 0];
  const geometry = geometryOf({ position: new Float32Array([...shaft, neck, -wide, 0, length, 0, 0, neck, wide, 0]) });
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
  const [x, y, z] = ["x", "y", "z"].map((name) => reader(view, field(name), little));
  const rgb = [field("rgb"), field("rgba")].find((one) => one && PACKED.includes(one[2]));
  const total = Math.min(data.width * data.height, Math.floor(payload.byteLength / (data.pointStep || 1)));
  const step = Math.max(1, Math.ceil(total / MOST_POINTS));
  const places = new Float32Array(3 * Math.ceil(total / step));
  const colors = new Float32Array(places.length);
  let at = 0;
  if (!x || !y || !z) throw new Error("it has no x, y and z as float32 or float64");
  const tone = new THREE.Color();
  for (let index = 0; index < total; index += step) {
    const start = Math.floor(index / data.width) * data.rowStep + (index % data.width) * data.pointStep;
    if (start + data.pointStep > payload.byteLength) break;
    const place = [x(start), y(start), z(start)];
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
 * Return a function that reads a field of the point that begins at an offset; null if it is no float.
 * @param {DataView} view
 * @param {[string, number, number] | undefined} field its name, offset and type
 * @param {boolean} little
 * @returns {((start: number) => number) | null}
 */
function reader(view, field, little) {
  const [, offset = 0, type] = field ?? [];
  if (type === FLOAT) return (start) => view.getFloat32(start + offset, little);
  return type === DOUBLE ? (start) => view.getFloat64(start + offset, little) : null;
}

/** @param {any} data @param {Int8Array} cells */
function map(data, cells) {
  const step = Math.max(1, Math.ceil(Math.max(data.width, data.height) / MOST_CELLS));
  const canvas = document.createElement("canvas");
  canvas.width = Math.floor(data.width / step) || 1;
  canvas.height = Math.floor(data.height / step) || 1;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const image = pen.createImageData(canvas.width, canvas.height);
  for (let row = 0; row < canvas.height; row += 1) {
    for (let column = 0; column < canvas.width; column += 1) {
      const cell = cells[row * step * data.width + column * step] ?? -1;
      const light = cell < 0 ? 128 : 255 - 2.55 * cell;
      const at = 4 * ((canvas.height - 1 - row) * canvas.width + column);
      image.data[at] = image.data[at + 1] = image.data[at + 2] = light;
      image.data[at + 3] = cell < 0 ? 90 : 255;
    }
  }
  pen.putImageData(image, 0, 0);
  const [width, height] = [data.width * data.resolution, data.height * data.resolution];
  const texture = new THREE.CanvasTexture(canvas);
  texture.magFilter = THREE.NearestFilter;
  const look = { map: texture, transparent: true, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4 };
  const found = new THREE.Mesh(new THREE.PlaneGeometry(width, height).translate(width / 2, height / 2, 0.004), new THREE.MeshBasicMaterial(look));
  found.applyMatrix4(matrixOf(data.origin));
  return found;
}

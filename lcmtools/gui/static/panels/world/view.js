// The view: sky, sun, ground and camera. It is drawn only after changes.

import * as THREE from "../../vendor/three/three.js";
import { lines, plainGround } from "./ground.js";
import { light } from "./light.js";

const FARTHEST = 250; // [m]
const LIGHT = { zenith: "#5f9fe0", horizon: "#e3ecf4", below: "#c9cfd0", sun: 2.5, sky: 2.1 };
const DARK = { zenith: "#0d1622", horizon: "#33424f", below: "#20262c", sun: 1.3, sky: 0.8 };
const START = new THREE.Vector3(-2.5, -2.6, 1.15);
const SUN = new THREE.Vector3(-6, 3, 10);
const SHADOW_REACH = 14; // [m]
/** How well it is drawn: plainly or with shadows, and the resolution. A computer that is too slow gets the next one. */
const QUALITIES = [
  { isPlain: false, share: 1 },
  { isPlain: true, share: 1 },
  { isPlain: true, share: 0.7 },
  { isPlain: true, share: 0.5 },
];
const LONGEST = 65; // [ms] from one frame to the next, on average
const AVERAGED = 20; // frames
const PLAIN_PERIOD = 30; // [ms] from one plain frame to the next: the processor has other work
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i; // names of renderers without a GPU

/** A scene on a canvas. */
export class View {
  /** @param {HTMLElement} place throws without WebGL */
  constructor(place) {
    // three.js writes an error to the console before it throws
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl) throw new Error("no WebGL");
    const about = gl.getExtension("WEBGL_debug_renderer_info");
    const hasGpu = !about || !SOFTWARE.test(String(gl.getParameter(about.UNMASKED_RENDERER_WEBGL)));
    gl.getExtension("WEBGL_lose_context")?.loseContext();
    this.renderer = new THREE.WebGLRenderer({ antialias: hasGpu });
    this.renderer.debug.checkShaderErrors = false; // which waits for each program
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.canvas = /** @type {HTMLCanvasElement} */ (this.renderer.domElement);
    place.append(this.canvas);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.05, 2 * FARTHEST);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.minDistance = 0.3;
    this.controls.maxDistance = 120;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.invalidate());
    this.content = new THREE.Group();
    this.scene.add(this.content);
    this.raycaster = new THREE.Raycaster();
    this.raycaster.params.Points.threshold = 0.03;
    this.until = 0;
    this.isDirty = true;
    this.drawn = 0;
    this.quality = hasGpu ? 0 : 1;
    /** The average time from one frame to the next [ms], which begins with a guess. */
    this.pace = LONGEST / 2;
    const { sky, sun, dome } = lights();
    this.sky = sky;
    this.sun = sun;
    this.dome = dome;
    light.isPlain = !hasGpu;
    this.ground = plainGround();
    this.scene.add(sky, sun, sun.target, dome, this.ground);
    this.scene.fog = new THREE.Fog("#ffffff", 30, 150);
    this.lookAt(START.toArray(), [0, 0, 0]);
    this.sizes = new ResizeObserver(() => this.resize(place));
    this.sizes.observe(place);
    this.stage = place;
    /** @type {(now: number) => void} */
    this.beforeDrawing = () => {};
    /** Called when everything must be made anew. */
    this.onPlain = () => {};
    this.setQuality(this.quality);
    let lastTime = 0;
    const draw = () => {
      this.frame = requestAnimationFrame(draw);
      const now = performance.now();
      if ((now > this.until && !this.isDirty) || !this.canvas.clientWidth) {
        lastTime = 0;
        return;
      }
      if (light.isPlain && now < lastTime + PLAIN_PERIOD) return;
      this.isDirty = false;
      if (lastTime) this.judge(now - lastTime);
      lastTime = now;
      this.beforeDrawing(now);
      this.controls.update();
      this.follow();
      this.renderer.render(this.scene, this.camera);
      this.canvas.dataset["frames"] = String(++this.drawn);
    };
    this.frame = requestAnimationFrame(draw);
    this.invalidate();
  }

  /** @param {number} quality an index of QUALITIES */
  setQuality(quality) {
    const { isPlain, share } = /** @type {{isPlain: boolean, share: number}} */ (QUALITIES[quality]);
    Object.assign(this, { quality, pace: LONGEST / 2 });
    this.sky.visible = this.sun.visible = !isPlain;
    if (light.isPlain !== isPlain) {
      light.isPlain = isPlain;
      this.ground.removeFromParent();
      this.ground = plainGround();
      this.scene.add(this.ground);
      this.onPlain();
    }
    this.renderer.setPixelRatio(share * Math.min(devicePixelRatio, 2));
    this.canvas.dataset["quality"] = String(this.quality);
    this.resize(this.stage);
  }

  /** Draw less well if frames are slow. @param {number} duration [ms] from one frame to the next */
  judge(duration) {
    this.pace += (Math.min(duration, 2 * LONGEST) - this.pace) / AVERAGED;
    if (this.pace > LONGEST && this.quality < QUALITIES.length - 1) this.setQuality(this.quality + 1);
  }

  /** Draw again, and keep drawing for some time [ms]. @param {number} [time] */
  invalidate(time = 100) {
    this.isDirty = true;
    this.until = Math.max(this.until, performance.now() + time);
  }

  /** Update all poses now, for pointer events that cannot wait for the next frame. */
  refresh() {
    this.beforeDrawing(performance.now());
    this.camera.updateMatrixWorld();
    this.scene.updateMatrixWorld();
  }

  /** @param {boolean} isDark */
  setTheme(isDark) {
    const look = isDark ? DARK : LIGHT;
    for (const name of /** @type {("zenith" | "horizon" | "below")[]} */ (["zenith", "horizon", "below"])) {
      this.dome.material.uniforms[name].value.set(look[name]).convertLinearToSRGB();
    }
    this.sky.color.set(isDark ? "#8fa6c4" : "#dcebff");
    this.sky.groundColor.set(isDark ? "#4a4f55" : "#d8d3ca");
    this.sky.intensity = look.sky;
    this.sun.intensity = look.sun;
    const { skyColor, groundColor, sunColor, sunDirection } = light.uniforms;
    skyColor.value.copy(this.sky.color).multiplyScalar(look.sky / Math.PI);
    groundColor.value.copy(this.sky.groundColor).multiplyScalar(look.sky / Math.PI);
    sunColor.value.copy(this.sun.color).multiplyScalar(look.sun / Math.PI);
    sunDirection.value.copy(SUN).normalize();
    this.scene.fog.color.set(look.horizon);
    lines.color.value.set(isDark ? "#06090c" : "#20303c");
    this.invalidate();
  }

  /** Move the sun, the sky and the ground's lines with the camera. */
  follow() {
    this.dome.position.copy(this.camera.position);
    lines.centre.value.copy(this.controls.target);
    const distance = this.camera.position.distanceTo(this.controls.target);
    const reach = Math.min(60, Math.max(5, distance * 1.1, SHADOW_REACH * 0.5));
    const { target, shadow, position } = this.sun;
    const texel = (2 * reach) / shadow.mapSize.x;
    target.position.copy(this.controls.target);
    target.position.x = Math.round(target.position.x / (16 * texel)) * 16 * texel;
    target.position.y = Math.round(target.position.y / (16 * texel)) * 16 * texel;
    target.position.z = 0;
    position.copy(target.position).addScaledVector(SUN, 3);
    if (shadow.camera.right !== reach) {
      Object.assign(shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 1, far: 90 });
      shadow.camera.updateProjectionMatrix();
    }
  }

  /**
   * Place the camera at a position, looking at a target.
   * @param {number[]} position
   * @param {number[]} target
   */
  lookAt(position, target) {
    this.camera.position.fromArray(position);
    this.controls.target.fromArray(target);
    this.controls.update();
    this.invalidate();
  }

  /** @param {number[]} target @param {number} yaw of what is looked at [rad] */
  lookFromBehind(target, yaw) {
    const at = new THREE.Vector3().fromArray(target);
    this.lookAt(START.clone().applyAxisAngle(new THREE.Vector3(0, 0, 1), yaw).add(at).toArray(), target);
  }

  lookFromAbove() {
    const { target } = this.controls;
    const distance = Math.max(6, this.camera.position.distanceTo(target));
    this.lookAt([target.x - 0.001 * distance, target.y, target.z + distance], target.toArray());
  }

  /**
   * Move the camera and its target, for the next drawing.
   * @param {number} x
   * @param {number} y
   * @param {number} z
   */
  shift(x, y, z) {
    for (const place of [this.camera.position, this.controls.target]) place.add({ x, y, z });
  }

  /**
   * Turn the camera about the target [rad], and change its distance by a factor.
   * @param {number} turn
   * @param {number} rise
   * @param {number} factor
   */
  move(turn, rise, factor) {
    const { position } = this.camera;
    const { target } = this.controls;
    const offset = position.clone().sub(target);
    const flat = Math.hypot(offset.x, offset.y) || 1e-6;
    const distance = Math.min(120, Math.max(0.3, offset.length() * factor));
    const up = Math.min(1.55, Math.max(0.02, Math.atan2(offset.z, flat) + rise));
    const around = Math.atan2(offset.y, offset.x) + turn;
    offset.set(Math.cos(up) * Math.cos(around), Math.cos(up) * Math.sin(around), Math.sin(up));
    position.copy(target).addScaledVector(offset, distance);
    this.invalidate();
  }

  /** Return the ray through a point of the window. @param {PointerEvent} event */
  ray(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    this.raycaster.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return this.raycaster;
  }

  /**
   * Return the intersection of the ray through a point of the window with a height; null if there is none.
   * @param {PointerEvent} event
   * @param {number} height
   * @returns {[number, number] | null}
   */
  place(event, height = 0) {
    const { origin, direction } = this.ray(event).ray;
    const way = (height - origin.z) / direction.z;
    if (!(way > 0) || way > FARTHEST) return null;
    return [origin.x + way * direction.x, origin.y + way * direction.y];
  }

  /** @param {HTMLElement} place */
  resize(place) {
    const { clientWidth: width, clientHeight: height } = place;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  close() {
    cancelAnimationFrame(this.frame);
    this.sizes.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

/** Create the light of the sky and the sun, and the sky itself. */
function lights() {
  const sky = new THREE.HemisphereLight();
  const sun = new THREE.DirectionalLight("#fff4e2");
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.bias = -0.0004;
  sun.shadow.normalBias = 0.012;
  sun.shadow.radius = 4;
  const dome = new THREE.Mesh(
    new THREE.SphereGeometry(FARTHEST, 24, 48).rotateX(Math.PI / 2),
    new THREE.ShaderMaterial({
      side: THREE.BackSide,
      depthWrite: false,
      fog: false,
      uniforms: { zenith: { value: new THREE.Color() }, horizon: { value: new THREE.Color() }, below: { value: new THREE.Color() } },
      vertexShader: `varying vec3 color; uniform vec3 zenith, horizon, below;
        void main() {
          float height = normalize(position).z;
          color = height > 0.0 ? mix(horizon, zenith, pow(height, 0.55)) : mix(horizon, below, min(1.0, -height * 8.0));
          gl_Position = (projectionMatrix * modelViewMatrix * vec4(position, 1.0)).xyww; // behind everything
        }`,
      fragmentShader: `varying vec3 color; void main() { gl_FragColor = vec4(color, 1.0); }`,
    }),
  );
  dome.renderOrder = 1; // only where nothing else is
  return { sky, sun, dome };
}

// The ground's material, which contains the grid lines, so that they do not flicker.

import * as THREE from "../../vendor/three/three.js";
import { light, lightCorners, litMaterial } from "./light.js";

const SIZE = 500; // [m]

/** The parameters shared by all grounds: the colour of the lines, and the centre from which they fade. */
export const lines = { color: { value: new THREE.Color() }, centre: { value: new THREE.Vector3() } };

/** Create a material with a line every metre, a strong one every ten, fading with the distance. */
export function groundMaterial() {
  const material = litMaterial({ vertexColors: true, roughness: 0.95 });
  const { isPlain } = light;
  material.onBeforeCompile = (/** @type {any} */ shader) => {
    if (isPlain) lightCorners(shader);
    shader.uniforms.lineColor = lines.color;
    shader.uniforms.lineCentre = lines.centre;
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec3 linePlace;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nlinePlace = (modelMatrix * vec4(transformed, 1.0)).xyz;");
    shader.fragmentShader = shader.fragmentShader
      .replace(
        "#include <common>",
        `#include <common>
        varying vec3 linePlace; uniform vec3 lineColor, lineCentre;
        float lineAt(vec2 pixel, float size, float width) {
          vec2 at = linePlace.xy / size;
          pixel /= size;
          vec2 far = abs(fract(at - 0.5) - 0.5) - width / size;
          vec2 found = 1.0 - smoothstep(vec2(0.0), 1.5 * pixel, far);
          return max(found.x, found.y) * (1.0 - smoothstep(0.12, 0.5, max(pixel.x, pixel.y)));
        }`,
      )
      .replace(
        "#include <color_fragment>",
        `#include <color_fragment>
        float lineFade = 1.0 - smoothstep(6.0, 45.0, distance(linePlace, lineCentre));
        vec2 linePixel = fwidth(linePlace.xy);
        float line = max(0.2 * lineAt(linePixel, 1.0, 0.004), 0.38 * lineAt(linePixel, 10.0, 0.009)) * lineFade;
        diffuseColor.rgb = mix(diffuseColor.rgb, lineColor, line);`,
      );
  };
  return material;
}

/** Create the ground that is shown if no message has one. */
export function plainGround() {
  const material = groundMaterial();
  material.vertexColors = false;
  material.color.set("#b9bdb8");
  const found = new THREE.Mesh(new THREE.PlaneGeometry(SIZE, SIZE), material);
  found.position.z = -0.002;
  return Object.assign(found, { receiveShadow: true });
}

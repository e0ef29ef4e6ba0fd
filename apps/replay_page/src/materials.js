// Shaders. Colours are those of the screen from end to end: nothing is converted.

import { Color, DoubleSide, ShaderMaterial, Vector2 } from "three";
import { GRID, PAPER } from "./palette.js";

/** What all of them share: `focal` is the distance of the screen from the eye in its own pixels. */
export const shared = { focal: { value: 1000 }, pixelRatio: { value: 1 } };

const unit = (bytes) => new Color(bytes[0] / 255, bytes[1] / 255, bytes[2] / 255);

// Where a vertex of an instance is. Robots that would be narrower than `smallest` pixels are enlarged: a swarm stays
// visible in a large world. A heading beyond 1e8 is that of a robot that is not there.
const PLACE = `
  attribute vec4 pose;
  attribute vec3 tint;
  attribute vec4 paint;
  uniform float radius;
  uniform float smallest;
  uniform float focal;
  uniform float pixelRatio;
  varying vec3 color;

  float across() {
    vec4 center = viewMatrix * vec4(pose.xyz, 1.0);
    return 2.0 * radius * focal / max(-center.z, 1e-6) / pixelRatio;
  }
  vec4 place(float seen) {
    float grown = max(1.0, smallest / max(seen, 1e-6));
    float c = cos(pose.w);
    float s = sin(pose.w);
    vec3 p = position * grown;
    return vec4(pose.x + c * p.x - s * p.y, pose.y + s * p.x + c * p.y, pose.z + p.z, 1.0);
  }
  const vec4 NOWHERE = vec4(0.0, 0.0, 2.0, 1.0);
`;

/** Faces of bodies: tops in full light, walls by where they face. */
export function facesMaterial(radius, smallest) {
  return new ShaderMaterial({
    uniforms: { ...shared, radius: { value: radius }, smallest: { value: smallest } },
    vertexShader: `${PLACE}
      void main() {
        float seen = across();
        vec3 own = paint.w < 0.5 ? tint : paint.rgb;
        bool isMark = paint.w > 1.5;
        if (isMark && paint.w < 2.5) own = vec3(dot(tint, vec3(0.299, 0.587, 0.114)) > 0.59 ? 0.15 : 1.0);
        float facing = abs(cos(pose.w) * normal.y + sin(pose.w) * normal.x); // 1: north or south
        color = own * (normal.z > 0.5 ? 1.0 : 0.62 + 0.2 * facing);
        gl_Position = pose.w > 1e8 || (isMark && seen < 9.0)
            ? NOWHERE : projectionMatrix * viewMatrix * place(seen);
      }`,
    fragmentShader: `
      varying vec3 color;
      void main() { gl_FragColor = vec4(color, 1.0); }`,
    side: DoubleSide, // contours go either way round
    polygonOffset: true, // edges win
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}

/** Edges of bodies; of tiny ones they would hide the colour. */
export function edgesMaterial(radius, smallest) {
  return new ShaderMaterial({
    uniforms: { ...shared, radius: { value: radius }, smallest: { value: smallest } },
    vertexShader: `${PLACE}
      void main() {
        float seen = across();
        color = 0.6 * (paint.w < 0.5 ? tint : paint.rgb);
        gl_Position = pose.w > 1e8 || seen < 7.0
            ? NOWHERE : projectionMatrix * viewMatrix * place(seen);
      }`,
    fragmentShader: `
      varying vec3 color;
      void main() { gl_FragColor = vec4(color, 1.0); }`,
  });
}

/** The floor, with a grid whose lines are a pixel wide at any distance and fade where they would run together. */
export function floorMaterial() {
  return new ShaderMaterial({
    uniforms: { pitch: { value: 1 }, paper: { value: unit(PAPER) }, line: { value: unit(GRID) } },
    vertexShader: `
      varying vec2 place;
      void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        place = world.xy;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: `
      uniform float pitch;
      uniform vec3 paper;
      uniform vec3 line;
      varying vec2 place;
      void main() {
        vec2 at = place / pitch;
        vec2 pixel = max(fwidth(at), 1e-6);
        vec2 near = abs(fract(at - 0.5) - 0.5) / pixel;
        vec2 strength = (1.0 - min(near, 1.0)) * (1.0 - smoothstep(0.15, 0.4, pixel));
        gl_FragColor = vec4(mix(paper, line, max(strength.x, strength.y)), 1.0);
      }`,
    polygonOffset: true,
    polygonOffsetFactor: 2,
    polygonOffsetUnits: 2,
  });
}

/**
 * Trails: a strip of lines each robot, through where it was. Vertex 0 is where it is, vertex k > 0 where it was k - 1
 * marks before `newest`, in row newest - k + 1, counted around, of a texture of rows of places.
 */
export function trailsMaterial(texture, { columns, rowsEach, marks }) {
  return new ShaderMaterial({
    uniforms: {
      places: { value: texture },
      newest: { value: 0 },
      count: { value: 1 },
      size: { value: new Vector2(columns, rowsEach) },
    },
    vertexShader: `
      attribute vec4 pose;
      attribute vec3 tint;
      uniform sampler2D places;
      uniform float newest;
      uniform float count;
      uniform vec2 size;
      varying vec4 color;
      void main() {
        float k = position.x;
        vec2 at = pose.xy;
        float strength = pose.w > 1e8 ? 0.0 : 0.75 * (1.0 - k / count);
        if (k > 0.5 && pose.w < 1e8) {
          int mark = int(mod(newest - k + 1.0 + ${marks}.0, ${marks}.0) + 0.5);
          int columns = int(size.x);
          int robot = gl_InstanceID;
          vec2 was = texelFetch(places, ivec2(robot % columns, mark * int(size.y) + robot / columns), 0).xy;
          if (was.x < 1e8) at = was; else strength = 0.0;
        }
        color = vec4(0.85 * tint, strength);
        gl_Position = projectionMatrix * viewMatrix * vec4(at, pose.z + 0.01, 1.0);
      }`,
    fragmentShader: `
      varying vec4 color;
      void main() { gl_FragColor = color; }`,
    transparent: true,
    depthWrite: false,
  });
}

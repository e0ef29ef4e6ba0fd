// Shaders. All colours are in the colour space of the screen; nothing is converted.

import { Color, DoubleSide, NotEqualStencilFunc, ReplaceStencilOp, ShaderMaterial, Vector2 } from "three";
import { DARK } from "./palette.js";

// Least sizes of bodies, in pixels, for which edges and shadows are drawn.
export const LEAST_WITH_EDGES = 7;
export const LEAST_WITH_SHADOW = 9;

/** Uniforms of all shaders. `focal` is the focal length in device pixels. */
export const shared = {
  focal: { value: 1000 },
  pixelRatio: { value: 1 },
  screen: { value: new Vector2(1, 1) }, // CSS pixels
  dark: { value: 0 }, // 1: dark background
  paper: { value: new Color() },
  line: { value: new Color() }, // colour of the grid
};

export function useTheme(theme) {
  shared.dark.value = theme === DARK ? 1 : 0;
  for (const name of ["paper", "line"]) shared[name].value.setRGB(...theme[name].map((byte) => byte / 255));
}

// On a dark background, dark colours are lightened.
const SHOWN = `
  uniform float dark;
  vec3 shown(vec3 color) {
    float light = dot(color, vec3(0.299, 0.587, 0.114));
    return mix(color, vec3(0.74, 0.77, 0.82), dark * 0.5 * (1.0 - smoothstep(0.05, 0.5, light)));
  }
`;

// Position of a vertex of an instance. Robots narrower than `smallest` pixels are enlarged, so that a swarm stays
// visible in a large world. A heading above 1e8 marks a robot that is not in the world.
const PLACE = `
  ${SHOWN}
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

/** Faces of bodies: tops in full light, walls shaded by their direction. */
export function facesMaterial(radius, smallest) {
  return new ShaderMaterial({
    uniforms: { ...shared, radius: { value: radius }, smallest: { value: smallest } },
    vertexShader: `${PLACE}
      varying float isTop;
      varying vec3 fromEye;
      void main() {
        float seen = across();
        vec3 own = paint.w < 0.5 ? tint : paint.rgb;
        bool isMark = paint.w > 1.5;
        if (isMark && paint.w < 2.5) own = vec3(dot(tint, vec3(0.299, 0.587, 0.114)) > 0.59 ? 0.15 : 1.0);
        color = shown(own);
        isTop = step(0.5, normal.z);
        vec4 at = viewMatrix * place(seen);
        fromEye = at.xyz;
        gl_Position = pose.w > 1e8 || (isMark && seen < 9.0) ? NOWHERE : projectionMatrix * at;
      }`,
    // Light comes from the north-west, as on maps. Contours have either orientation, so walls are lit on the visible side.
    fragmentShader: `
      varying vec3 color;
      varying float isTop;
      varying vec3 fromEye;
      void main() {
        vec2 facing = (cross(dFdx(fromEye), dFdy(fromEye)) * mat3(viewMatrix)).xy;
        float wall = 0.8 + 0.16 * dot(facing / max(length(facing), 1e-20), vec2(-0.55, 0.835));
        gl_FragColor = vec4(color * (isTop > 0.5 ? 1.0 : wall), 1.0);
      }`,
    side: DoubleSide, // contours have either orientation
    polygonOffset: true, // edges are drawn over faces
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}

/** Edges of bodies; not drawn around tiny shapes, whose colour they would hide. The attribute `width` is that of the shape, as
 *  a fraction of the width of the body. */
export function edgesMaterial(radius, smallest) {
  return new ShaderMaterial({
    uniforms: { ...shared, radius: { value: radius }, smallest: { value: smallest } },
    vertexShader: `${PLACE}
      attribute float width;
      void main() {
        float seen = across();
        vec3 own = shown(paint.w < 0.5 ? tint : paint.rgb);
        color = mix(0.6 * own, mix(own, vec3(1.0), 0.35), dark);
        gl_Position = pose.w > 1e8 || seen * width < ${LEAST_WITH_EDGES}.0
            ? NOWHERE : projectionMatrix * viewMatrix * place(seen);
      }`,
    fragmentShader: `
      varying vec3 color;
      void main() { gl_FragColor = vec4(color, 1.0); }`,
  });
}

/** Shadows of bodies on the floor. The stencil darkens each pixel only once. */
export function shadowsMaterial(radius, smallest) {
  return new ShaderMaterial({
    uniforms: { ...shared, radius: { value: radius }, smallest: { value: smallest } },
    vertexShader: `${PLACE}
      void main() {
        float seen = across();
        vec4 at = place(seen);
        at.xy += vec2(0.22, -0.334) * max(at.z, 0.0);
        at.z = 0.0;
        color = vec3(0.0);
        gl_Position = pose.w > 1e8 || paint.w > 1.5 || seen < ${LEAST_WITH_SHADOW}.0 ? NOWHERE : projectionMatrix * viewMatrix * at;
      }`,
    fragmentShader: `
      uniform float dark;
      void main() { gl_FragColor = vec4(mix(vec3(0.2, 0.15, 0.08), vec3(0.0), dark), mix(0.11, 0.38, dark)); }`,
    transparent: true,
    side: DoubleSide,
    depthWrite: false,
    stencilWrite: true,
    stencilRef: 1,
    stencilFunc: NotEqualStencilFunc,
    stencilZPass: ReplaceStencilOp,
  });
}

/** The floor with a grid. Its lines are a pixel wide at any distance and fade where they would merge. */
export function floorMaterial() {
  return new ShaderMaterial({
    uniforms: { pitch: { value: 1 }, paper: shared.paper, line: shared.line },
    vertexShader: `
      varying vec2 place;
      void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        place = world.xy;
        gl_Position = projectionMatrix * viewMatrix * world;
        gl_Position.z += 1e-4 * gl_Position.w; // slightly farther away, so that flat bodies on the floor are in front of it
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
  });
}

/**
 * Trails: one ribbon per robot through its past positions. Position 0 is the current one, position k > 0 that of k - 1 marks
 * before `newest`, in row newest - k + 1 (modulo `marks`) of the texture. A vertex is a position number and a side, -1 or 1.
 */
export function trailsMaterial(texture, { columns, rowsEach, marks }) {
  return new ShaderMaterial({
    uniforms: {
      dark: shared.dark,
      places: { value: texture },
      newest: { value: 0 },
      count: { value: 1 },
      last: { value: 0 }, // last known position
      size: { value: new Vector2(columns, rowsEach) },
      screen: shared.screen,
    },
    vertexShader: `
      ${SHOWN}
      attribute vec4 pose;
      attribute vec3 tint;
      uniform sampler2D places;
      uniform float newest;
      uniform float count;
      uniform float last;
      uniform vec2 size;
      uniform vec2 screen;
      varying vec4 color;

      vec2 placeOf(float k) {
        if (k < 0.5) return pose.xy;
        int mark = int(mod(newest - k + 1.0 + ${marks}.0, ${marks}.0) + 0.5);
        int columns = int(size.x);
        return texelFetch(places, ivec2(gl_InstanceID % columns, mark * int(size.y) + gl_InstanceID / columns), 0).xy;
      }
      vec4 seen(vec2 at) { return projectionMatrix * viewMatrix * vec4(at, pose.z + 0.02, 1.0); }
      // An unknown position is replaced by the neighbouring one.
      vec2 orElse(vec2 at, vec2 other) { return at.x < 1e8 ? at : other; }

      void main() {
        float k = position.x;
        vec2 own = placeOf(k);
        vec4 at = seen(orElse(own, pose.xy));
        vec4 newer = seen(orElse(placeOf(max(k - 1.0, 0.0)), own));
        vec4 older = seen(orElse(placeOf(min(k + 1.0, last)), own));
        vec2 along = (newer.xy / newer.w - older.xy / older.w) * screen;
        vec2 across = length(along) > 1e-3 && newer.w > 0.0 && older.w > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(0.0);
        at.xy += position.y * across * 0.8 * at.w / screen * 2.0;
        float strength = pose.w > 1e8 || own.x > 1e8 ? 0.0 : 0.7 * (1.0 - k / count);
        color = vec4(mix(0.85, 1.0, dark) * shown(tint), strength);
        gl_Position = at;
      }`,
    fragmentShader: `
      varying vec4 color;
      void main() { gl_FragColor = color; }`,
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
  });
}

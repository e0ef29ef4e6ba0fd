// Meshes of a type of bodies in its own frame: tops, walls, edges, and a mark at the front of robots.

import { BufferAttribute, BufferGeometry } from "three";
import { bytesOf } from "./palette.js";

// Source of the colour of a vertex: the body, the shape itself, or contrast with the body.
const BODY = 0;
const OWN = 1;
const CONTRAST = 2;

class MeshBuilder {
  positions = [];
  normals = [];
  paints = [];
  pose = [0, 0, 0, 0];
  cos = 1;
  sin = 0;
  color = null;

  /** Places everything that is added from now on at the pose of a body and in its colour. */
  standAt({ pose, color }) {
    this.pose = pose;
    this.cos = Math.cos(pose[3]);
    this.sin = Math.sin(pose[3]);
    this.color = [...bytesOf(color).map((byte) => byte / 255), OWN];
  }

  add(x, y, z, normal, paint) {
    const { pose, cos, sin } = this;
    this.positions.push(pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y, pose[2] + z);
    this.normals.push(cos * normal[0] - sin * normal[1], sin * normal[0] + cos * normal[1], normal[2]);
    this.paints.push(...(paint[3] === BODY && this.color ? this.color : paint));
  }

  build() {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(this.positions), 3));
    geometry.setAttribute("normal", new BufferAttribute(new Float32Array(this.normals), 3));
    geometry.setAttribute("paint", new BufferAttribute(new Float32Array(this.paints), 4));
    return geometry;
  }
}

class EdgeBuilder extends MeshBuilder {
  widths = [];

  /** `width`: see widthOf() */
  addEdge([ax, ay, bx, by], z, paint, width) {
    this.add(ax, ay, z, UP, paint);
    this.add(bx, by, z, UP, paint);
    this.widths.push(width, width);
  }

  build() {
    const geometry = super.build();
    geometry.setAttribute("width", new BufferAttribute(new Float32Array(this.widths), 1));
    return geometry;
  }
}

function paintOf(shape) {
  if (!shape.color) return [0, 0, 0, BODY];
  return [...bytesOf(shape.color).map((byte) => byte / 255), OWN];
}

const UP = [0, 0, 1];

// Adjacent pieces overlap by this fraction of the type's radius. Without it the floor shows through between them.
const OVERLAP = 1e-4;

/** A convex polygon with its edges moved outwards by `by`. */
function grown(corners, by) {
  const count = corners.length / 2;
  let area = 0;
  eachEdge(corners, (ax, ay, bx, by) => (area += ax * by - bx * ay));
  const out = area > 0 ? by : -by;
  const normal = (i) => {
    const [a, b] = [2 * (i % count), 2 * ((i + 1) % count)];
    const [x, y] = [corners[b] - corners[a], corners[b + 1] - corners[a + 1]];
    const length = Math.hypot(x, y) || 1;
    return [y / length, -x / length];
  };
  const moved = [];
  for (let i = 0; i < count; i++) {
    const [before, behind] = [normal(i + count - 1), normal(i)];
    const scale = out / Math.max(1 + before[0] * behind[0] + before[1] * behind[1], 0.2); // limits the offset at sharp corners
    moved.push(corners[2 * i] + scale * (before[0] + behind[0]), corners[2 * i + 1] + scale * (before[1] + behind[1]));
  }
  return moved;
}

function addTop(mesh, corners, z, paint) {
  for (let i = 4; i < corners.length; i += 2)
    for (const k of [0, i - 2, i]) mesh.add(corners[k], corners[k + 1], z, UP, paint);
}

/** Calls `call` with the end points of each edge of a closed polygon. */
function eachEdge(corners, call) {
  for (let i = 0, last = corners.length - 2; i < corners.length; last = i, i += 2)
    call(corners[last], corners[last + 1], corners[i], corners[i + 1]);
}

function addWall(mesh, corners, low, high, paint) {
  eachEdge(corners, (ax, ay, bx, by) => {
    const length = Math.hypot(bx - ax, by - ay) || 1;
    const normal = [(by - ay) / length, (ax - bx) / length, 0];
    for (const [x, y, z] of [[ax, ay, low], [bx, by, low], [bx, by, high], [ax, ay, low], [bx, by, high], [ax, ay, high]])
      mesh.add(x, y, z, normal, paint);
  });
}

/** Whether a convex polygon of either orientation contains a point. */
function holds(corners, x, y) {
  let left = 0;
  let right = 0;
  eachEdge(corners, (ax, ay, bx, by) => {
    const side = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
    if (side >= 0) left++;
    if (side <= 0) right++;
  });
  return left === corners.length / 2 || right === corners.length / 2;
}

/** The rectangle around shapes: its length (along x) and width (along y), and `box`, its least x and y and largest x and y. */
function extentOf(shapes) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const shape of shapes)
    for (const corners of shape.walls)
      for (let i = 0; i < corners.length; i += 2) {
        box[0] = Math.min(box[0], corners[i]);
        box[1] = Math.min(box[1], corners[i + 1]);
        box[2] = Math.max(box[2], corners[i]);
        box[3] = Math.max(box[3], corners[i + 1]);
      }
  return { length: box[2] - box[0], width: box[3] - box[1], box };
}

/** The longer side of the rectangle around a shape, as a fraction of the diameter of its type. */
function widthOf(shape, type, step) {
  const { length, width } = extentOf([shape]);
  return (Math.max(length, width) * step) / (2 * type.radius_m);
}

/** Adds a triangle at the front that points forward, in a colour that contrasts with the shape below it. Adds nothing if
 *  this shape is of another part than `shown` (see meshesOf()). */
function addMark(mesh, shapes, shown) {
  const { length, width, box } = extentOf(shapes);
  if (!(length > 0 && width > 0)) return;
  const half = 0.26 * Math.min(length, width);
  const y = (box[1] + box[3]) / 2;
  const tip = box[2] - 0.1 * length;
  const base = tip - 1.3 * half;
  const under = shapes.filter((shape) => shape.tops.some((corners) => holds(corners, (tip + 2 * base) / 3, y))).pop();
  if (shown !== ALL && (under?.shown ?? NONE) !== shown) return;
  let paint = [0, 0, 0, CONTRAST];
  if (under?.color && (under.shown ?? NONE) === NONE) {
    const [r, g, b] = bytesOf(under.color);
    const shade = 0.299 * r + 0.587 * g + 0.114 * b > 150 ? 0.15 : 1;
    paint = [shade, shade, shade, CONTRAST + 1]; // its own colour, but hidden together with the marks
  }
  const z = Math.max(...shapes.map((shape) => shape.z_m[1])) + 0.08 * half;
  addTop(mesh, [tip, y, base, y + half, base, y - half], z, paint);
}

const ROOT = -1; // shapes that no joint moves
const NONE = -1; // shapes whose colour no device sets
const ALL = null;

function addType(type, step, faces, edges, joint = ALL, shown = ALL) {
  const inMetres = (corners) => corners.map((x) => x * step);
  const widths = type.shapes.map((shape) => widthOf(shape, type, step));
  const widest = widths.reduce((most, width) => Math.max(most, width), 0);
  const all = type.shapes
    // The edges of the widest shape are drawn whenever those of the body are.
    .map((shape, i) => ({ ...shape, width: widths[i] === widest ? 1 : widths[i] }))
    .filter((shape) => joint === ALL || (shape.joint ?? ROOT) === joint)
    .map((shape) => ({ ...shape, tops: shape.tops.map(inMetres), walls: shape.walls.map(inMetres) }))
    .sort((a, b) => a.z_m[1] - b.z_m[1]);
  for (const shape of all) {
    if (shown !== ALL && (shape.shown ?? NONE) !== shown) continue;
    const paint = paintOf(shown > NONE ? {} : shape);
    const [low, high] = shape.z_m;
    const pieces = shape.tops.length > 1 ? shape.tops.map((corners) => grown(corners, OVERLAP * type.radius_m)) : shape.tops;
    for (const corners of pieces) addTop(faces, corners, high, paint);
    for (const corners of shape.walls) {
      addWall(faces, corners, low, high, paint);
      eachEdge(corners, (...ends) => edges.addEdge(ends, high, paint, shape.width));
    }
  }
  if (type.mobile && all.length > 0 && (joint === ALL || joint === ROOT)) addMark(faces, all, shown);
}

/**
 * Meshes of a type in its own frame, with its joints at rest: faces (triangles) and edges (lines).
 * joint   which shapes: -1 those that no joint moves, else those that this joint moves; not given: all
 * shown   which of these: -1 those whose colour no device sets, else those of the part with this index in `shown_parts`,
 *         which have the colour of the instance; not given: all
 */
export function meshesOf(type, step, joint = ALL, shown = ALL) {
  const faces = new MeshBuilder();
  const edges = new EdgeBuilder();
  addType(type, step, faces, edges, joint, shown);
  return { faces: faces.build(), edges: edges.build() };
}

/** Meshes of many fixed bodies in the world's frame and in their colours, merged into one. */
export function meshesOfAll(bodies, types, step) {
  const faces = new MeshBuilder();
  const edges = new EdgeBuilder();
  for (const body of bodies) {
    for (const mesh of [faces, edges]) mesh.standAt(body);
    addType(types[body.type], step, faces, edges);
  }
  return { faces: faces.build(), edges: edges.build() };
}

// The scene: camera, floor, static bodies and robots.

import {
  ColorManagement,
  LinearSRGBColorSpace,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  Plane,
  PlaneGeometry,
  Raycaster,
  RingGeometry,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { MapControls } from "three/examples/jsm/controls/MapControls.js";
import { Bodies } from "./bodies.js";
import { meshesOf, meshesOfAll } from "./geometry.js";
import { Limbs } from "./limbs.js";
import { floorMaterial, shared, useTheme } from "./materials.js";
import { LIGHT, bytesOf } from "./palette.js";
import { GONE } from "./recording.js";
import { Scan } from "./scan.js";
import { Trails } from "./trails.js";

ColorManagement.enabled = false;

const SMALLEST = 4; // least size of a robot, pixels
const REACH = 12; // most distance of a click from a robot, pixels
const FOV = 30; // degrees: narrow, so that walls hide little from above
const RING_SIDES = 64;
const RING_PIXELS = 3; // width of the ring around the selected robot
const GRID_PIXELS = 48; // least distance between grid lines
const INSTANCES = 32; // least number of equal static bodies that are drawn as instances
const LOOSE = 2; // size of the picture relative to the box around all robots from which on the picture is fitted again
const LARGE = 1e9; // m; a radius with which bodies are always drawn with edges and shadows

/** The largest number that is 1, 2 or 5 times a power of ten and at most x. */
export function roundLength(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  const share = x / power;
  return (share >= 5 ? 5 : share >= 2 ? 2 : 1) * power;
}

/** Radius around the origin and height of the shapes that no joint moves, m. */
function trunkOf({ shapes, radius_m: all }, step) {
  const rigid = shapes.filter((shape) => shape.joint === undefined);
  let square = 0;
  for (const corners of rigid.flatMap((shape) => shape.walls))
    for (let i = 0; i < corners.length; i += 2) square = Math.max(square, corners[i] ** 2 + corners[i + 1] ** 2);
  return { radius: square > 0 ? Math.sqrt(square) * step : all, top: Math.max(0, ...rigid.map((shape) => shape.z_m[1])) };
}

export class View {
  constructor(canvas, recording) {
    const { header } = recording;
    this.recording = recording;
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true });
    this.renderer.outputColorSpace = LinearSRGBColorSpace; // no conversion of colours
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FOV, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new MapControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.15;
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = 1.5;

    const [x0, y0, x1, y1] = header.bounds_m;
    this.size = Math.max(x1 - x0, y1 - y0, 0.1);
    this.floor = new Mesh(new PlaneGeometry(40 * this.size, 40 * this.size), floorMaterial());
    this.floor.position.set((x0 + x1) / 2, (y0 + y1) / 2, 0);
    this.floor.renderOrder = -1;
    this.scene.add(this.floor);

    this.poses = new Float32Array(4 * recording.robots).fill(GONE);
    this.tints = new Uint8Array(3 * recording.robots);
    this.addFixed(header);
    this.addRobots(header);
    this.trails = new Trails(this.renderer, recording, this.poses, this.tints);
    this.scan = new Scan(recording);
    this.ring = new Mesh(
      new RingGeometry(0.5, 1, RING_SIDES),
      new MeshBasicMaterial({ depthTest: false, transparent: true }),
    );
    this.ring.visible = false;
    this.ring.renderOrder = 2;
    this.scene.add(this.trails.object, this.scan.object, this.ring);
    this.useTints(null);
    this.theme(LIGHT);
    this.resize();
    this.fit();
  }

  /** Adds static bodies: many of one type as instances, all others merged into one mesh. */
  addFixed({ fixed, types, shape_step_m: step }) {
    const byType = new Map(types.map((_, type) => [type, []]));
    for (const body of fixed) byType.get(body.type).push(body);
    const few = [];
    const add = (bodies) => this.scene.add(...bodies.objects);
    for (const [type, bodies] of byType) {
      if (bodies.length < INSTANCES) {
        few.push(...bodies);
        continue;
      }
      const poses = new Float32Array(bodies.flatMap((body) => body.pose));
      const tints = new Uint8Array(bodies.flatMap((body) => bytesOf(body.color)));
      add(new Bodies(meshesOf(types[type], step), LARGE, poses, tints, 0));
    }
    if (few.length > 0) add(new Bodies(meshesOfAll(few, types, step), LARGE, new Float32Array(4), new Uint8Array(3), 0));
  }

  addRobots(header) {
    this.swarms = [];
    this.limbs = [];
    // Upper bound of the height of robots above their origins, m; infinite if joints can lift their parts.
    const most = (numbers) => numbers.reduce((high, number) => Math.max(high, number), 0);
    const tops = header.types.map((type) => most(type.shapes.map((shape) => shape.z_m[1])));
    this.tallest = header.types.some((type) => type.joints.length > 0) ? Infinity : most(tops);
    this.trunks = header.types.map((type) => trunkOf(type, header.shape_step_m));
    this.limbsOf = new Array(header.types.length).fill(null); // by type
    this.typeOf = new Int32Array(this.recording.robots);
    let first = 0;
    for (const [type, count] of header.robots.types) {
      const last = first + count;
      this.typeOf.fill(type, first, last);
      const poses = this.poses.subarray(4 * first, 4 * last);
      const tints = this.tints.subarray(3 * first, 3 * last);
      const look = header.types[type];
      const parts = this.recording.parts.filter((part) => part.first === first); // parts of which devices set the colour
      const add = (joint, where) => {
        for (const { shown, tints: own } of [{ shown: -1, tints }, ...parts]) {
          const isOfThese = (shape) => (shape.joint ?? -1) === joint && (shape.shown ?? -1) === shown;
          if ((joint >= 0 || shown >= 0) && !look.shapes.some(isOfThese)) continue;
          const bodies = new Bodies(meshesOf(look, header.shape_step_m, joint, shown), look.radius_m, where, own, SMALLEST);
          this.swarms.push(bodies);
          this.scene.add(...bodies.objects);
        }
      };
      add(-1, poses); // shapes that no joint moves
      if (look.joints.length > 0) {
        const limbs = new Limbs(this.recording, look, first, count);
        limbs.joints.forEach(({ places }, joint) => add(joint, places));
        this.limbs.push(limbs);
        this.limbsOf[type] = limbs;
      }
      first = last;
    }
  }

  /** `theme` is LIGHT or DARK. */
  theme(theme) {
    useTheme(theme);
    this.renderer.setClearColor(shared.paper.value);
    this.ring.material.color.set(theme.accent);
    this.scan.theme(theme);
  }

  /** Indices of the fields needed to draw robots. */
  get fields() {
    return this.limbs.flatMap((limbs) => limbs.fields);
  }

  /** Updates the poses of robots, interpolated between a frame and the next; false if not unpacked yet. */
  pose(frame, mix) {
    const ready = this.limbs.map((limbs) => limbs.ready(frame, mix)).every(Boolean); // map() before every(): requests all fields
    this.recording.prefetch(frame);
    if (!ready || !this.recording.posesInto(frame, mix, this.poses)) return false;
    for (const limbs of this.limbs) limbs.update(frame, mix, this.poses);
    return true;
  }

  /** x, y, z, heading in the world of a robot, or of the part that one of its joints moves. */
  placeOf(robot, joint = -1) {
    const limbs = joint >= 0 ? this.limbsOf[this.typeOf[robot]] : null;
    return limbs ? limbs.place(joint, robot) : this.poses.subarray(4 * robot, 4 * robot + 4);
  }

  /** Sets the colours of the robots, three bytes each; null: those of the world. Those of parts are in `recording.parts`. */
  useTints(tints) {
    this.tints.set(tints ?? this.recording.own);
    for (const bodies of this.swarms) bodies.tintsChanged();
    this.trails.tint.needsUpdate = true;
  }

  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(window.innerWidth, window.innerHeight, false);
    this.camera.aspect = window.innerWidth / window.innerHeight;
    this.camera.updateProjectionMatrix();
    this.focal = window.innerHeight / (2 * Math.tan((FOV * Math.PI) / 360)); // CSS pixels
    shared.focal.value = this.focal * ratio;
    shared.pixelRatio.value = ratio;
    shared.screen.value.set(window.innerWidth, window.innerHeight);
  }

  /** The box around the robots that are in the world, [x0, y0, x1, y1] in m; null if there are none. */
  robotsBox() {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let r = 0; r < this.recording.robots; r++) {
      if (!this.recording.mobile[r] || this.poses[4 * r + 3] > 1e8) continue;
      for (const k of [0, 1]) {
        box[k] = Math.min(box[k], this.poses[4 * r + k]);
        box[k + 2] = Math.max(box[k + 2], this.poses[4 * r + k]);
      }
    }
    return box[0] <= box[2] ? box : null;
  }

  /** Keeps all robots in the picture. The view moves only if a robot leaves it, or if it has become much too large. */
  followAll() {
    const box = this.robotsBox();
    if (!box) return;
    const [x0, y0, x1, y1] = this.fitted ?? box;
    const sides = Math.max(box[2] - box[0], box[3] - box[1], this.size * 0.02);
    const isInside = box[0] >= x0 && box[1] >= y0 && box[2] <= x1 && box[3] <= y1;
    if (this.fitted && isInside && Math.max(x1 - x0, y1 - y0) < LOOSE * sides) return;
    const margin = 0.15 * sides;
    this.fitted = [box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin];
    this.fit(this.slanted, this.fitted);
  }

  /** Moves the camera so that a part of the floor, by default the whole world, fits between title and bar, in a top or an
   * oblique view. */
  fit(slanted = false, [x0, y0, x1, y1] = this.recording.header.bounds_m) {
    const corners = [[x0, y0], [x0, y1], [x1, y0], [x1, y1]].map(([x, y]) => new Vector3(x, y, 0));
    const target = new Vector3((x0 + x1) / 2, (y0 + y1) / 2, 0);
    // Slightly off the vertical: straight down, the up direction would be undefined.
    const back = (slanted ? new Vector3(-0.25, -0.8, 0.65) : new Vector3(0, -1e-4, 1)).normalize();
    const north = new Vector3(-back.x, -back.y, 0).normalize(); // up on the screen, along the floor
    const right = new Vector3(north.y, -north.x, 0);
    const up = new Vector3().crossVectors(back, right);
    const tangent = Math.tan((FOV * Math.PI) / 360);
    const { innerWidth: width, innerHeight: height } = window;
    const side = 1 - Math.min(48 / width, 0.3);
    const below = height - document.getElementById("scale").getBoundingClientRect().top; // CSS pixels of the controls
    const above = document.getElementById("about").getBoundingClientRect().bottom;
    const low = -1 + Math.min((2 * (below + 8)) / height, 0.8);
    const high = 1 - Math.min((2 * (above + 8)) / height, 0.4);

    /** The box of the corners on the screen from this distance, or null if a corner is behind the camera. */
    const seenFrom = (distance) => {
      const box = [Infinity, Infinity, -Infinity, -Infinity];
      for (const corner of corners) {
        const v = corner.clone().sub(target).addScaledVector(back, -distance);
        const depth = -v.dot(back);
        if (depth < 0.05 * distance) return null;
        const at = [v.dot(right) / (depth * tangent * this.camera.aspect), v.dot(up) / (depth * tangent)];
        for (const k of [0, 1]) {
          box[k] = Math.min(box[k], at[k]);
          box[k + 2] = Math.max(box[k + 2], at[k]);
        }
      }
      return box;
    };
    const extent = Math.max(x1 - x0, y1 - y0, this.size); // robots may be far outside of the bounds
    let distance = 0;
    for (let pass = 0; pass < 4; pass++) {
      let [near, far] = [0, 20 * extent];
      for (let i = 0; i < 40; i++) {
        distance = (near + far) / 2;
        const box = seenFrom(distance);
        if (box && box[2] - box[0] <= 2 * side && box[3] - box[1] <= high - low) far = distance;
        else near = distance;
      }
      distance = far;
      const box = seenFrom(distance);
      target.addScaledVector(right, ((box[0] + box[2]) / 2) * tangent * this.camera.aspect * distance);
      target.addScaledVector(north, (((box[1] + box[3] - low - high) / 2) * tangent * distance) / back.z);
    }
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(back, distance);
    this.slanted = slanted;
    this.controls.minDistance = this.size * 1e-3;
    this.controls.maxDistance = Math.max(extent * 15, distance);
    this.controls.update();
  }

  /** Centres the view on a robot without changing its direction. */
  follow(robot) {
    const at = 4 * robot;
    if (this.poses[at + 3] > 1e8) return;
    const shift = new Vector3(this.poses[at], this.poses[at + 1], 0).sub(this.controls.target);
    shift.z = 0;
    this.controls.target.add(shift);
    this.camera.position.add(shift);
  }

  /** Metres per CSS pixel at the target of the camera. */
  metresPerPixel() {
    return this.camera.position.distanceTo(this.controls.target) / this.focal;
  }

  /** The robot under or nearest to a point of the screen (CSS pixels); null if none is near. */
  robotAt(clientX, clientY) {
    const place = new Vector3();
    let best = null;
    let nearest = Infinity;
    this.camera.updateMatrixWorld();
    for (let r = 0; r < this.recording.robots; r++) {
      const at = 4 * r;
      if (this.poses[at + 3] > 1e8) continue;
      place.set(this.poses[at], this.poses[at + 1], this.poses[at + 2]);
      const depth = place.distanceTo(this.camera.position);
      place.project(this.camera);
      if (Math.abs(place.z) > 1) continue;
      const dx = ((place.x + 1) / 2) * window.innerWidth - clientX;
      const dy = ((1 - place.y) / 2) * window.innerHeight - clientY;
      const radius = (this.recording.header.types[this.typeOf[r]].radius_m * this.focal) / depth;
      const miss = Math.hypot(dx, dy);
      if (miss < Math.max(radius, REACH) && miss < nearest) {
        nearest = miss;
        best = r;
      }
    }
    return best;
  }

  /** The robots whose centres are in a box of the screen (CSS pixels). */
  robotsIn(x0, y0, x1, y1) {
    const place = new Vector3();
    const inside = [];
    this.camera.updateMatrixWorld();
    for (let r = 0; r < this.recording.robots; r++) {
      const at = 4 * r;
      if (this.poses[at + 3] > 1e8) continue;
      place.set(this.poses[at], this.poses[at + 1], this.poses[at + 2]).project(this.camera);
      const x = ((place.x + 1) / 2) * window.innerWidth;
      const y = ((1 - place.y) / 2) * window.innerHeight;
      if (Math.abs(place.z) <= 1 && x >= x0 && x <= x1 && y >= y0 && y <= y1) inside.push(r);
    }
    return inside;
  }

  /** A PNG of the canvas, as a Blob. */
  picture() {
    this.renderer.render(this.scene, this.camera); // the browser keeps the pixels only until this task ends
    return new Promise((done) => this.canvas.toBlob(done, "image/png"));
  }

  /** The point under a point of the screen (CSS pixels), on the floor or at another height, m: x and y, m; null if there is none. */
  floorAt(clientX, clientY, height = 0) {
    this.camera.updateMatrixWorld();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * clientX) / window.innerWidth - 1, 1 - (2 * clientY) / window.innerHeight), this.camera);
    const place = ray.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -height), new Vector3());
    return place && [place.x, place.y];
  }

  /** The position on the screen, in CSS pixels, of a robot, or of a point shifted from it by so many metres. */
  screenPlace(robot, shift) {
    const place = new Vector3(...this.poses.subarray(4 * robot, 4 * robot + 3)).add(new Vector3(...shift));
    this.camera.updateMatrixWorld();
    place.project(this.camera);
    return [((place.x + 1) / 2) * window.innerWidth, ((1 - place.y) / 2) * window.innerHeight];
  }

  /** An upper bound of the height of the robots that are present, m, world frame. */
  top() {
    let highest = 0;
    for (let at = 0; at < this.poses.length; at += 4)
      if (this.poses[at + 3] < 1e8) highest = Math.max(highest, this.poses[at + 2]);
    return highest + this.tallest;
  }

  /** Draws the robots at `poses`; `frame` is the recorded frame before, `selected` a robot or null. */
  draw(frame, selected) {
    // Everything on the screen is at most about 35 degrees off its centre.
    const above = this.camera.position.z - this.top();
    const nearest = above > 0 ? this.focal / (0.8 * above) : Infinity;
    for (const bodies of this.swarms) {
      bodies.posesChanged();
      bodies.simplify(nearest);
    }
    this.trails.update(frame);
    this.scan.update(frame, this);
    this.placeRing(selected);
    this.controls.update();
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = distance / 50;
    this.camera.far = distance * 20 + this.size;
    this.camera.updateProjectionMatrix();
    this.floor.material.uniforms.pitch.value = roundLength(2.5 * GRID_PIXELS * this.metresPerPixel());
    this.renderer.render(this.scene, this.camera);
  }

  placeRing(robot) {
    this.ring.visible = robot !== null && this.poses[4 * robot + 3] < 1e8;
    if (!this.ring.visible) return;
    const at = 4 * robot;
    const { radius, top } = this.trunks[this.typeOf[robot]];
    this.ring.position.set(this.poses[at], this.poses[at + 1], this.poses[at + 2] + top);
    const pixel = this.ring.position.distanceTo(this.camera.position) / this.focal;
    const inner = Math.max(1.3 * radius, 8 * pixel);
    this.ring.scale.setScalar(inner);
    const outer = 1 + (RING_PIXELS * pixel) / inner;
    if (Math.abs(outer - this.outer) < 1e-3) return;
    this.outer = outer;
    const { position } = this.ring.geometry.attributes; // RingGeometry stores the inner corners first
    for (let i = 0; i < position.count; i++) {
      const side = i <= RING_SIDES ? 1 : outer;
      const turn = (2 * Math.PI * (i % (RING_SIDES + 1))) / RING_SIDES;
      position.setXY(i, side * Math.cos(turn), side * Math.sin(turn));
    }
    position.needsUpdate = true;
  }
}

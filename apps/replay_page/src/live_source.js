// A running world, in the form of the latest pictures from the program, with the interface of Recording.
// docs/live-protocol.md specifies the protocol.

import { bytesOf } from "./palette.js";
import { fieldRows, GONE, shownParts } from "./recording.js";
import { ABSENT } from "./series.js";

const MOST_FRAMES = 900; // most frames kept, for trails and speeds
const MOST_BYTES = 200e6; // their most memory
const RECENT_FRAMES = 90; // frames, of about 3 s, whose mean distance in time is measured
const AXES = 4; // x, y, heading and z

export class LiveSource {
  /** `hello` is the first message of the program; `send` sends a message to it. */
  constructor(hello, send) {
    this.hello = hello;
    this.send = send;
    this.header = hello.header;
    this.header.block_frames = 1;
    this.mayActs = hello.may_steer;
    this.namesakes = new Set(hello.namesakes);
    this.robots = this.header.robots.id.length;
    this.own = new Uint8Array(3 * this.robots);
    this.header.robots.color.forEach((color, r) => this.own.set(bytesOf(color), 3 * r));
    this.mobile = new Uint8Array(this.robots);
    this.addFields();
    this.movers = this.mobile.reduce((sum, one) => sum + one, 0);
    this.present = this.movers;
    this.fieldRows = this.header.fields.map((field) => fieldRows(field, this.robots));
    this.shown = hello.colors ? [-1] : []; // not empty: Coloring then updates colours with every frame
    const parts = shownParts(this.header);
    const shades = parts.reduce((sum, { count }) => sum + count, this.robots);
    this.colors = new Uint8Array(3 * shades); // of the robots, then of their parts
    this.colors.set(this.own);
    let end = this.robots;
    this.parts = parts.map((part) => ({ ...part, tints: this.colors.subarray(3 * end, 3 * (end += part.count)) }));
    for (const { tints, first, count } of this.parts) tints.set(this.own.subarray(3 * first, 3 * (first + count)));
    this.base = new Int32Array(AXES * this.robots);
    this.ring = [];
    this.kept = Math.max(2, Math.min(MOST_FRAMES, Math.floor(MOST_BYTES / (16 * Math.max(this.robots, 1)))));
    this.newest = -1; // frame number: received pictures less 1
    this.state = null;
    this.inspected = null;
    this.override = null; // {robot, x, y, heading}: the robot that the user is dragging
    this.lookTime = null; // the past time that is shown, s; null: now
    this.colored = "null"; // the value by which robots are coloured, as JSON
    this.shades = new Uint8Array(this.robots); // of this value: 1 to 255; 0: none
    this.undrawn = []; // numbers of received pictures that are not drawn yet
  }

  /** Adds a field per ranger, so that scans can be drawn; its values come with the inspected robot. */
  addFields() {
    let first = 0;
    for (const [type, count] of this.header.robots.types) {
      const look = this.header.types[type];
      this.mobile.fill(look.mobile ? 1 : 0, first, first + count);
      for (const [name, { fans }] of Object.entries(look.eyes)) {
        const beams = fans.reduce((sum, fan) => sum + fan.beams, 0);
        this.header.fields.push({ component: `sensors/${type}/${name}`, name: "ranges", columns: beams, rows: [[first, count]], hidden: true, min: 0, max: 1, step: 0.001 });
      }
      first += count;
    }
  }

  get frames() {
    return Math.max(this.newest + 1, 2);
  }
  get start() {
    return 0;
  }
  get end() {
    return (this.frames - 1) * (this.spacing || this.hello.tick_s);
  }
  /** Mean world time between the latest pictures, s. */
  get spacing() {
    const recent = this.ring.slice(-RECENT_FRAMES);
    return recent.length < 2 ? 0 : (recent[recent.length - 1].time - recent[0].time) / (recent.length - 1);
  }
  /** Times of the frames, s; Coloring needs them for speeds. */
  get times() {
    const source = this;
    return new Proxy({}, { get: (_, frame) => source.frame(Number(frame))?.time });
  }

  frame(number) {
    return this.ring[this.ring.length - 1 - (this.newest - number)] ?? null;
  }
  frameAt() {
    let back = 0;
    if (this.lookTime !== null) while (back < this.ring.length - 1 && this.ring[this.ring.length - 1 - back].time > this.lookTime) back++;
    return { frame: this.newest - back, mix: 0 };
  }
  /** Times of the oldest and the newest picture that are kept, s. */
  get span() {
    return this.ring.length === 0 ? [0, 0] : [this.ring[0].time, this.ring[this.ring.length - 1].time];
  }
  /** Takes the state of the program, which arrives before the picture of the same tick. */
  takeState(state) {
    if (this.state && state.run !== this.state.run) {
      this.ring = []; // these pictures are of the run before the restart
      this.lookTime = null;
    }
    this.state = state;
  }
  /** Asks for the values by which robots are coloured, {component, field, column}; null: none. */
  colorBy(value) {
    const text = JSON.stringify(value);
    if (text === this.colored) return;
    this.colored = text;
    this.send({ do: "color", ...(value ?? { component: null }) });
  }
  poses(frame) {
    return this.frame(Math.min(frame, this.newest));
  }
  field() {
    return null;
  }
  value(index, frame, robot, column = 0) {
    if (this.lookTime !== null || this.inspected?.robot !== this.header.robots.name[robot]) return null; // known only for the present
    const name = this.header.fields[index].component.split("/").slice(2).join("/");
    const ranges = this.inspected.eyes?.[name];
    return ranges ? (ranges[column] ?? NaN) : null;
  }
  colorsInto(frame, out) {
    out.set(this.colors.subarray(0, 3 * this.robots)); // the colours of parts are views of `colors`
    return true;
  }
  prefetch() {}
  pump() {}

  posesInto(frame, mix, out) {
    const now = this.frame(frame);
    if (!now) return false;
    const { step_m: step, turn } = this.header.pose;
    const radians = (2 * Math.PI) / turn;
    let present = 0;
    for (let r = 0, to = 0; r < this.robots; r++, to += 4) {
      if (now.x[r] === ABSENT) {
        out[to + 3] = GONE;
        continue;
      }
      present += this.mobile[r];
      out[to] = now.x[r] * step;
      out[to + 1] = now.y[r] * step;
      out[to + 2] = now.z[r] * step;
      out[to + 3] = now.heading[r] * radians;
    }
    this.present = present;
    if (this.override) {
      const { robot, x, y, heading } = this.override;
      out.set([x, y], 4 * robot);
      out[4 * robot + 3] = heading;
    }
    return true;
  }

  /** Takes the binary frame of a picture; its state has arrived before it. */
  takePicture(buffer) {
    const bytes = new Uint8Array(buffer);
    let at = 0;
    const number = () => {
      let value = 0;
      for (let scale = 1; ; scale *= 128) {
        const byte = bytes[at++];
        value += (byte & 127) * scale;
        if (byte < 128) return value;
      }
    };
    const signed = () => {
      const code = number();
      return code % 2 === 0 ? code / 2 : -(code + 1) / 2;
    };
    const { base, robots } = this;
    this.undrawn.push(number());
    for (let r = -1, skip = number(); skip > 0; skip = number()) {
      r += skip;
      for (let axis = 0; axis < AXES; axis++) base[axis * robots + r] += signed();
    }
    for (let r = -1, skip = number(); skip > 0; skip = number()) {
      r += skip;
      for (let c = 0; c < 3; c++) this.colors[3 * r + c] = bytes[at++];
    }
    if (at < bytes.length) for (let r = -1, skip = number(); skip > 0; skip = number()) this.shades[(r += skip)] = bytes[at++];
    const [x, y, heading, z] = Array.from({ length: AXES }, (_, axis) => base.slice(axis * robots, (axis + 1) * robots));
    const frame = { at: 0, time: this.state.time_s, x, y, heading, z };
    for (let r = 0; r < robots; r++) if (frame.heading[r] < 0) frame.x[r] = ABSENT;
    this.ring.push(frame);
    if (this.ring.length > this.kept) this.ring.shift();
    this.newest++;
  }

  /** Tells the program which pictures have been drawn. */
  drawn() {
    for (const picture of this.undrawn) this.send({ do: "drawn", picture });
    this.undrawn = [];
  }
}

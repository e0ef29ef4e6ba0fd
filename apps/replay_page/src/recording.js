// The recording, unpacked block by block on request.

import { inflate } from "./container.js";
import { bytesOf } from "./palette.js";
import { ABSENT, unpackSeries } from "./series.js";

const CACHE_BYTES = 400e6;
const AXES = 4; // numbers per pose of the scene: x, y, z (m), heading (rad)

/** The heading that marks a robot as not in the world, in the poses of the scene. */
export const GONE = 1e9;

export class Recording {
  constructor({ header, blocks }) {
    this.header = header;
    this.blocks = blocks;
    this.times = Float64Array.from(header.times_s);
    this.robots = header.robots.id.length;
    this.units = new Map(); // unpacked streams of blocks, the least recently used first
    this.bytes = 0;
    this.work = []; // units being unpacked
    this.requests = 0; // number of calls of unit() so far
    this.requestsPumped = 0; // and of those before the end of the last pump()
    this.own = new Uint8Array(3 * this.robots); // colours of the world, three bytes each
    header.robots.color.forEach((color, r) => this.own.set(bytesOf(color), 3 * r));
    this.mobile = new Uint8Array(this.robots); // 1: the body drives
    let first = 0;
    for (const [type, count] of header.robots.types) {
      this.mobile.fill(header.types[type].mobile ? 1 : 0, first, first + count);
      first += count;
    }
    this.movers = this.mobile.reduce((sum, one) => sum + one, 0);
    this.present = this.movers; // movers in the world, in the last frame of posesInto()
    this.fieldRows = header.fields.map((field) => fieldRows(field, this.robots));
    const fieldOf = (component) => header.fields.findIndex((field) => field.component === component && field.name === "shown_color");
    // Fields with the colours that bodies show, one per type.
    this.bodyFields = header.types.filter((type) => type.shown_color).map((type) => fieldOf(type.shown_color));
    this.parts = shownParts(header).map((part) => ({
      ...part,
      field: fieldOf(part.component),
      tints: this.own.slice(3 * part.first, 3 * (part.first + part.count)),
    }));
    this.shown = [...this.bodyFields, ...this.parts.map((part) => part.field)];
  }

  get frames() {
    return this.times.length;
  }
  get start() {
    return this.times[0];
  }
  get end() {
    return this.times[this.frames - 1];
  }

  /** The frame at or before a time, and the fraction of the way to the next frame, 0 to 1. */
  frameAt(time) {
    let low = 0;
    let high = this.frames - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    if (low === this.frames - 1) return { frame: low, mix: 0 };
    const mix = (time - this.times[low]) / (this.times[low + 1] - this.times[low]);
    return { frame: low, mix: Math.min(Math.max(mix, 0), 1) };
  }

  /** The poses of a frame: the arrays of its block and the index of its first value; null if not unpacked yet. */
  poses(frame) {
    const unit = this.unit(0, frame);
    return unit && { ...unit, at: (frame % this.header.block_frames) * this.robots };
  }

  /** A field in a frame: values[at + i] for entry i, one entry per robot and column; 0: absent, else 1 + steps. Null if not unpacked yet. */
  field(index, frame) {
    const unit = this.unit(1 + index, frame);
    if (!unit) return null;
    const width = this.fieldRows[index].count * this.header.fields[index].columns;
    return { values: unit.values, at: (frame % this.header.block_frames) * width };
  }

  /** One value of a robot: NaN if it has none, null if it is not unpacked yet. */
  value(index, frame, robot, column = 0) {
    const row = this.fieldRows[index].of[robot];
    if (row < 0) return NaN;
    const found = this.field(index, frame);
    if (!found) return null;
    const field = this.header.fields[index];
    const steps = found.values[found.at + row * field.columns + column];
    return steps === 0 ? NaN : field.min + (steps - 1) * field.step;
  }

  /** Writes the colour of every robot, three bytes each: the colour it shows, else that of the world file. Also updates the
   *  colours of parts (`parts`). False if not unpacked yet. */
  colorsInto(frame, out) {
    const found = this.shown.map((index) => this.field(index, frame)); // requests all fields
    if (!found.every(Boolean)) return false;
    out.set(this.own);
    for (const index of this.bodyFields) this.fieldInto(index, frame, 0, this.robots, out);
    for (const { field, first, count, tints } of this.parts) this.fieldInto(field, frame, first, count, tints);
    return true;
  }

  /** Writes the colours that a field has in a frame for the robots [first, first + count), three bytes each. */
  fieldInto(index, frame, first, count, out) {
    const { min, step } = this.header.fields[index];
    const { of } = this.fieldRows[index];
    const { values, at } = this.field(index, frame);
    for (let i = 0; i < count; i++) {
      const row = of[first + i];
      if (row < 0) continue;
      const from = at + 3 * row;
      if (values[from] === 0) continue; // not in the world
      for (let c = 0; c < 3; c++) out[3 * i + c] = Math.round(255 * (min + (values[from + c] - 1) * step));
    }
  }

  /** Writes x, y, z, heading of every robot, interpolated between two frames; false if not unpacked yet. */
  posesInto(frame, mix, out) {
    const a = this.poses(frame);
    const b = mix > 0 ? this.poses(frame + 1) : a;
    if (!a || !b) return false;
    const { step_m: step, turn, has_z: hasZ, z_m: heights } = this.header.pose;
    const radians = (2 * Math.PI) / turn;
    let present = 0;
    const { x: ax, y: ay, heading: ah, z: az } = a;
    const { x: bx, y: by, heading: bh, z: bz } = b;
    for (let r = 0, to = 0, i = a.at, j = b.at; r < this.robots; r++, i++, j++, to += AXES) {
      if (ax[i] === ABSENT) {
        out[to + 3] = GONE;
        continue;
      }
      present += this.mobile[r];
      const share = bx[j] === ABSENT ? 0 : mix; // the robot may be missing in the next frame
      let turned = share > 0 ? bh[j] - ah[i] : 0;
      turned -= Math.round(turned / turn) * turn;
      out[to] = (ax[i] + share * (bx[j] - ax[i])) * step;
      out[to + 1] = (ay[i] + share * (by[j] - ay[i])) * step;
      out[to + 2] = hasZ ? (az[i] + share * (bz[j] - az[i])) * step : heights[r];
      out[to + 3] = (ah[i] + share * turned) * radians;
    }
    this.present = present;
    return true;
  }

  /** Requests the unpacking of a frame that will be needed soon. */
  prefetch(frame, fields = []) {
    if (frame >= this.frames) return;
    this.unit(0, frame);
    for (const field of fields) this.unit(1 + field, frame);
  }

  /** Unpacks requested streams for at most this time, those first that were requested since the last call: the picture does not
   *  wait for streams that were requested while the user moved through the time. */
  pump(milliseconds) {
    const until = performance.now() + milliseconds;
    const isOld = (unit) => unit.request <= this.requestsPumped;
    this.work.sort((a, b) => isOld(a) - isOld(b) || a.request - b.request);
    this.requestsPumped = this.requests;
    while (this.work.length > 0 && performance.now() < until) {
      const unit = this.work[0];
      if (unit.steps.next().done) {
        unit.ready = true;
        this.work.shift();
      }
    }
  }

  /** The unpacked stream that contains a frame; if it is not unpacked yet, requests it and returns null. */
  unit(stream, frame) {
    const block = Math.floor(frame / this.header.block_frames);
    const key = `${stream} ${block}`;
    let unit = this.units.get(key);
    if (unit) {
      this.units.delete(key); // and inserted again below, as the most recently used
    } else {
      unit = { ready: false, bytes: 0 };
      this.load(unit, stream, block);
    }
    unit.request = ++this.requests;
    this.units.set(key, unit);
    return unit.ready ? unit : null;
  }

  async load(unit, stream, block) {
    const packed = await inflate(this.blocks[block][stream]);
    const first = block * this.header.block_frames;
    const frames = Math.min(this.header.block_frames, this.frames - first);
    unit.steps = stream === 0 ? this.unpackPoses(unit, packed, frames) : this.unpackField(unit, packed, frames, stream - 1);
    this.bytes += unit.bytes;
    this.work.push(unit);
    for (const [key, old] of this.units) {
      if (this.bytes <= CACHE_BYTES) break;
      if (!old.ready) continue;
      this.bytes -= old.bytes;
      this.units.delete(key);
    }
  }

  unpackPoses(unit, packed, frames) {
    const axes = this.header.pose.has_z ? ["x", "y", "heading", "z"] : ["x", "y", "heading"];
    for (const axis of axes) unit[axis] = new Int32Array(frames * this.robots);
    unit.bytes = axes.length * 4 * frames * this.robots;
    const layout = { frames, count: this.robots, line: true, absent: ABSENT, bias: 0 };
    return (function* () {
      let at = 0;
      for (const axis of axes) at = yield* unpackSeries(packed, at, layout, unit[axis]);
    })();
  }

  unpackField(unit, packed, frames, index) {
    const { columns, steps } = this.header.fields[index];
    const width = this.fieldRows[index].count * columns;
    const Values = steps < 0xff ? Uint8Array : steps < 0xffff ? Uint16Array : Uint32Array;
    unit.values = new Values(frames * width);
    unit.bytes = unit.values.byteLength;
    const layout = { frames, count: width, line: false, absent: 0, bias: 1 };
    return unpackSeries(packed, 0, layout, unit.values);
  }
}

/** The parts of which devices set the colour: for each type and part, the robots [first, first + count) that have it, the
 *  index `shown` of the part in the list `shown_parts` of the type, and its entry in this list. */
export function shownParts({ robots, types }) {
  const parts = [];
  let first = 0;
  for (const [type, count] of robots.types) {
    (types[type].shown_parts ?? []).forEach((component, shown) => parts.push({ component, shown, first, count }));
    first += count;
  }
  return parts;
}

/** The number of robots that have a field, and the row of each robot in it; -1: none. */
export function fieldRows(field, robots) {
  const of = new Int32Array(robots).fill(-1);
  let count = 0;
  for (const [first, length] of field.rows) for (let i = 0; i < length; i++) of[first + i] = count++;
  return { of, count };
}

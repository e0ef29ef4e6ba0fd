// Poses of the parts that joints move, for all robots of a type. A pose is x, y, z (m) and heading (rad).

import { GONE } from "./recording.js";

const AXES = ["x", "y", "z", "heading"];

/** Composes poses: writes `b`, given in the frame `a`, in the frame in which `a` is given. Each is an array and an index. */
function compose(a, from, b, other, out, at) {
  const c = Math.cos(a[from + 3]);
  const s = Math.sin(a[from + 3]);
  const [x, y] = [b[other], b[other + 1]];
  out[at] = a[from] + c * x - s * y;
  out[at + 1] = a[from + 1] + s * x + c * y;
  out[at + 2] = a[from + 2] + b[other + 2];
  out[at + 3] = a[from + 3] + b[other + 3];
}

/** The inverse of a pose. */
function inverse([x, y, z, heading]) {
  const c = Math.cos(heading);
  const s = Math.sin(heading);
  return [-c * x - s * y, s * x - c * y, -z, -heading];
}

export class Limbs {
  /** For the robots [first, first + count), which are of one type. */
  constructor(recording, type, first, count) {
    this.recording = recording;
    this.first = first;
    this.count = count;
    const { fields } = recording.header;
    this.joints = type.joints.map(({ component, parent, pose }) => ({
      parent,
      rest: pose,
      back: inverse(pose),
      fields: AXES.map((axis) => fields.findIndex((field) => field.component === component && field.name === axis)),
      moved: new Float64Array(4 * count), // per robot, the pose to which the joint moves the body's frame
      places: new Float32Array(4 * count), // the same pose in the world
    }));
    this.fields = this.joints.flatMap((joint) => joint.fields).filter((field) => field >= 0);
  }

  /** Whether the fields for a picture between a frame and the next are unpacked. */
  ready(frame, mix) {
    const { recording } = this;
    const all = (at) => this.fields.map((field) => recording.field(field, at)).every(Boolean); // map() before every(): requests all fields
    return all(frame) && (mix === 0 || all(frame + 1));
  }

  /** Updates the poses of all parts. `poses` are those of all robots of the recording. */
  update(frame, mix, poses) {
    const { recording, count, first } = this;
    const still = [0, 0, 0, 0];
    const shift = [0, 0, 0, 0];
    const turned = [0, 0, 0, 0];
    for (const { parent, rest, back, fields, moved, places } of this.joints) {
      const axes = fields.map((index) => {
        if (index < 0) return null;
        const { min, step } = recording.header.fields[index];
        const a = recording.field(index, frame);
        const b = mix > 0 ? recording.field(index, frame + 1) : a;
        return { min, step, a, b, rows: recording.fieldRows[index].of };
      });
      const above = parent === undefined ? still : this.joints[parent].moved;
      for (let i = 0, at = 0; i < count; i++, at += 4) {
        let any = false;
        for (let axis = 0; axis < 4; axis++) {
          shift[axis] = 0;
          const said = axes[axis];
          const row = said ? said.rows[first + i] : -1;
          const was = row < 0 ? 0 : said.a.values[said.a.at + row]; // 0: absent
          if (was === 0) continue;
          const next = said.b.values[said.b.at + row] || was;
          shift[axis] = said.min + (was - 1 + mix * (next - was)) * said.step;
          any ||= shift[axis] !== 0;
        }
        const from = above === still ? 0 : at;
        if (any) {
          compose(above, from, rest, 0, turned, 0);
          compose(turned, 0, shift, 0, turned, 0);
          compose(turned, 0, back, 0, moved, at);
        } else {
          for (let k = 0; k < 4; k++) moved[at + k] = above[from + k];
        }
        const robot = 4 * (first + i);
        if (poses[robot + 3] === GONE) places[at + 3] = GONE;
        else compose(poses, robot, moved, at, places, at);
      }
    }
  }

  /** The pose in the world to which a joint has moved the frame of a robot. */
  place(joint, robot) {
    const at = 4 * (robot - this.first);
    return this.joints[joint].places.subarray(at, at + 4);
  }
}

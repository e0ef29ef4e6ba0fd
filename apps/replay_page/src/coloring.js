// Colours robots by speed or by any recorded number.

import { shadeInto } from "./palette.js";
import { ABSENT } from "./series.js";

const plain = (name) => {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
};

/** "stall", or "minibot, ranger:0" for a sensor of a type. */
export function componentText(component) {
  const steps = component.split("/").map(plain);
  return steps[0] === "sensors" ? steps.slice(1).join(", ") : steps.filter((step) => step !== "0").join(" ");
}

/** The name of a value, as --color-by accepts it: "stall.stalled", "wander.turn", "lamp.shown_color.2"; for a sensor of a
 *  recording also its type: "eye.ranges (minibot)". column: undefined for a field with one column. */
export function valueText(component, field, column) {
  const steps = component.split("/").map(plain);
  const isSensor = steps[0] === "sensors" && steps.length > 2;
  const rest = steps.slice(isSensor ? 2 : 1).join("/");
  const name = rest === "" || rest === "0" ? steps[0] : /^\d+$/.test(rest) ? steps.join("/") : rest;
  const text = `${name}.${plain(field)}${column === undefined ? "" : `.${column}`}`;
  return isSensor ? `${text} (${steps[1]})` : text;
}

/** A number with as many decimals as the rounding step justifies, or with eight digits if the step is very small or 0. */
export function numberText(value, step) {
  if (!Number.isFinite(value)) return "–";
  const digits = Math.max(-Math.floor(Math.log10(step) + 1e-9), 0);
  return digits <= 6 ? value.toFixed(digits) : String(Number(value.toPrecision(8)));
}

/** The choices of a colouring: {text, unit}, and {field, column} for those by a field (column -1: the minimum). */
export function coloringsOf(header) {
  const all = [
    { text: "own colours", unit: "" },
    { text: "speed", unit: "m/s", speed: true },
  ];
  header.fields.forEach((field, index) => {
    if (field.hidden) return;
    const text = (column) => valueText(field.component, field.name, column);
    const common = { unit: field.unit, field: index };
    if (field.columns === 1) all.push({ ...common, text: text(), column: 0 });
    else if (field.columns <= 4)
      for (let c = 0; c < field.columns; c++) all.push({ ...common, text: text(c), column: c });
    else all.push({ ...common, text: `minimum of ${text()}`, column: -1 });
  });
  return all;
}

export class Coloring {
  constructor(recording) {
    this.recording = recording;
    this.choices = coloringsOf(recording.header);
    this.choice = this.choices[0];
    this.tints = new Uint8Array(3 * recording.robots);
    this.fastest = 0;
  }

  choose(index) {
    if (this.choices[index] !== this.choice) this.fastest = 0; // not after a change of the theme
    this.choice = this.choices[index];
    this.done = null;
  }

  /** Indices of the fields that it needs in addition to poses. */
  get fields() {
    const { field } = this.choice;
    return field === undefined ? this.recording.shown : [...this.recording.shown, field];
  }

  get range() {
    if (this.choice.speed) return [0, this.fastest];
    const field = this.recording.header.fields[this.choice.field];
    return [field.min, field.max];
  }

  get step() {
    if (this.choice.speed) return 0.01;
    return this.recording.header.fields[this.choice.field].step;
  }

  /** The colours of a frame, three bytes per robot. Undefined if they have not changed or are not unpacked yet. */
  tintsOf(frame) {
    const isOwn = this.choice.field === undefined && !this.choice.speed;
    const wanted = isOwn && this.recording.shown.length === 0 ? "own" : frame; // "own" colours never change
    if (this.done === wanted) return undefined;
    if (!this.recording.colorsInto(frame, this.tints)) return undefined;
    if (!isOwn && !(this.choice.speed ? this.bySpeed(frame) : this.byField(frame))) return undefined;
    this.done = wanted;
    return this.tints;
  }

  byField(frame) {
    const { field: index, column } = this.choice;
    const found = this.recording.field(index, frame);
    if (!found) return false;
    const { columns, min, max, step } = this.recording.header.fields[index];
    const rows = this.recording.fieldRows[index].of;
    const scale = max > min ? step / (max - min) : 0;
    for (let r = 0; r < rows.length; r++) {
      let share = NaN;
      if (rows[r] >= 0) {
        const at = found.at + rows[r] * columns;
        let value = 0; // 0: absent
        if (column >= 0) value = found.values[at + column];
        else
          for (let c = 0; c < columns; c++) {
            const other = found.values[at + c];
            if (other > 0 && (value === 0 || other < value)) value = other;
          }
        if (value > 0) share = (value - 1) * scale;
      }
      this.shade(r, share);
    }
    return true;
  }

  /** Sets the colour of a robot. Without a value (NaN) robots are grey and other bodies keep their colour. */
  shade(r, share) {
    if (share === share || this.recording.mobile[r]) shadeInto(share, this.tints, 3 * r);
  }

  bySpeed(frame) {
    const { recording } = this;
    let first = Math.min(frame, Math.max(recording.frames - 2, 0));
    const second = Math.min(first + 1, recording.frames - 1);
    // A paused program sends several pictures of the same time.
    while (first > 0 && recording.times[first] === recording.times[second] && recording.poses(first - 1)) first--;
    const a = recording.poses(first);
    const b = recording.poses(second);
    if (!a || !b) return false;
    const seconds = recording.times[second] - recording.times[first] || 1;
    const perStep = recording.header.pose.step_m / seconds;
    const speeds = (this.speeds ??= new Float32Array(recording.robots));
    let fastest = 0;
    for (let r = 0, i = a.at, j = b.at; r < recording.robots; r++, i++, j++) {
      const there = recording.mobile[r] && a.x[i] !== ABSENT && b.x[j] !== ABSENT;
      speeds[r] = there ? Math.hypot(b.x[j] - a.x[i], b.y[j] - a.y[i]) * perStep : NaN;
      if (speeds[r] > fastest) fastest = speeds[r];
    }
    // The scale grows with the highest speed since it was chosen, in steps of a tenth of a power of ten.
    if (fastest > this.fastest) {
      const grain = 10 ** Math.floor(Math.log10(fastest)) / 10;
      this.fastest = Math.ceil(fastest / grain - 1e-6) * grain;
    }
    for (let r = 0; r < recording.robots; r++) this.shade(r, this.fastest > 0 ? speeds[r] / this.fastest : 0 * speeds[r]);
    return true;
  }
}

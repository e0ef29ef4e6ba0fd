// The panel of the selected robot.

import { componentText, numberText } from "./coloring.js";

export const MOST_NUMBERS = 4; // fields with more columns are drawn as bars

export const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

export function row(name, title = "") {
  const value = element("span");
  return { object: element("div", { className: "row", title }, element("span", { textContent: name }), value), value };
}

/** Rows of a pose: name, unit, number of decimals, and the value of a pose [x, y, z, heading]. */
export const POSE = [
  ["x", "m", 3, (pose) => pose[0]],
  ["y", "m", 3, (pose) => pose[1]],
  ["z", "m", 3, (pose) => pose[2]],
  ["heading", "°", 1, (pose) => (((pose[3] * 180) / Math.PI + 540) % 360) - 180],
];

export const unitText = (unit) => (unit ? ` ${unit}` : "");

/** Draws numbers as bars between `min` and `max`. */
export function bars(object, numbers, min, max) {
  const high = 40;
  const span = max - min || 1;
  const path = numbers
    .map((number, i) => (Number.isFinite(number) ? `M${i + 0.1} ${high}v${-Math.max(((number - min) / span) * high, 0.5)}h.8V${high}z` : ""))
    .join("");
  object.firstChild.setAttribute("d", path);
}

export function chart(columns) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 0 ${columns} 40`);
  svg.setAttribute("preserveAspectRatio", "none");
  svg.append(document.createElementNS("http://www.w3.org/2000/svg", "path"));
  return svg;
}

export class Panel {
  constructor(recording, root) {
    this.recording = recording;
    this.root = root;
    this.values = root.querySelector("#values");
    this.robot = null;
    this.parts = [];
  }

  /** Indices of the fields that the panel shows. */
  get fields() {
    return this.parts.flatMap(({ field }) => (field === undefined ? [] : [field]));
  }

  show(robot, type) {
    this.robot = robot;
    this.parts = [];
    this.poseRows = new Map();
    this.root.hidden = robot === null;
    if (robot === null) return;
    const { header, fieldRows } = this.recording;
    this.root.querySelector("h2").textContent = header.robots.name[robot];
    this.root.querySelector("p").textContent = `id ${header.robots.id[robot]}, ${header.types[type].name}`;
    this.values.replaceChildren();
    this.addPose();
    let component = null;
    header.fields.forEach((field, index) => {
      if (field.hidden || fieldRows[index].of[robot] < 0) return;
      if (field.component !== component) {
        component = field.component;
        this.values.append(element("h3", { textContent: componentText(component).replace(/^[^,]*, /, "") }));
      }
      this.addField(field, index);
    });
  }

  addPose() {
    for (const [name, unit, digits, of] of POSE) {
      const made = row(name);
      this.values.append(made.object);
      this.poseRows.set(name, made.object);
      this.parts.push({
        update: (pose) => (made.value.textContent = pose[3] > 1e8 ? "not in the world" : `${of(pose).toFixed(digits)} ${unit}`),
      });
    }
  }

  addField(field, index) {
    const made = row(field.name, field.text);
    this.values.append(made.object);
    const drawn = field.columns > MOST_NUMBERS ? chart(field.columns) : null;
    if (drawn) this.values.append(drawn);
    made.value.textContent = "…";
    const text = (number) => numberText(number, field.step);
    this.parts.push({
      field: index,
      update: (pose, frame) => {
        const numbers = [];
        for (let c = 0; c < field.columns; c++) {
          const number = this.recording.value(index, frame, this.robot, c);
          if (number === null) return; // not unpacked yet
          numbers.push(number);
        }
        const known = numbers.filter(Number.isFinite);
        if (known.length === 0) made.value.textContent = field.component.startsWith("sensors/") ? "no reading" : "–";
        else if (drawn) made.value.textContent = `${text(Math.min(...known))} to ${text(Math.max(...known))}${unitText(field.unit)}`;
        else made.value.textContent = `${numbers.map(text).join(", ")}${unitText(field.unit)}`;
        if (drawn) bars(drawn, numbers, Math.min(0, field.min), field.max);
      },
    });
  }

  update(frame, poses) {
    if (this.robot === null) return;
    const pose = poses.subarray(4 * this.robot, 4 * this.robot + 4);
    for (const part of this.parts) part.update(pose, frame);
  }
}

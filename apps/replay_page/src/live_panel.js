// The panel of the selected robot on the live page: its whole state, sent by the program.

import { bars, chart, element, MOST_NUMBERS, Panel, row, unitText } from "./panel.js";

const text = (number) => (number === null ? "–" : Number.isInteger(number) ? String(number) : Number(number.toPrecision(5)).toString());

export class LivePanel extends Panel {
  /** Shows a robot and asks the program for its state. */
  show(robot, type) {
    super.show(robot, type);
    this.state = element("div");
    this.values.append(this.state);
    this.shown = null;
    this.rows = null;
    const name = robot === null ? null : this.recording.header.robots.name[robot];
    this.recording.inspected = null;
    this.recording.send({ do: "inspect", robot: name });
  }

  update(frame, poses) {
    super.update(frame, poses);
    const { inspected } = this.recording;
    if (this.robot === null || !inspected || inspected === this.shown) return;
    if (inspected.robot !== this.recording.header.robots.name[this.robot]) return;
    this.shown = inspected;
    if (!this.rows) this.build(inspected);
    inspected.components.forEach(({ fields }, c) => fields.forEach((field, f) => this.rows[c]?.[f]?.(field)));
  }

  /** Builds one row per field. */
  build({ components }) {
    this.state.replaceChildren();
    this.rows = components.map(({ name, fields }) => {
      this.state.append(element("h3", { textContent: name }));
      return fields.map((field) => {
        const made = row(field.name, field.text);
        this.state.append(made.object);
        const drawn = field.values.length > MOST_NUMBERS ? chart(field.values.length) : null;
        if (drawn) this.state.append(drawn);
        return ({ values, unit }) => {
          const known = values.filter(Number.isFinite);
          if (drawn) {
            made.value.textContent = known.length > 0 ? `${text(Math.min(...known))} to ${text(Math.max(...known))}${unitText(unit)}` : "–";
            bars(drawn, values, Math.min(0, ...known), Math.max(...known));
          } else made.value.textContent = `${values.map(text).join(", ")}${unitText(unit)}`;
        };
      });
    });
  }
}

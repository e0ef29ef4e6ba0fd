// The panel of the selected robot on the live page: its whole state, sent by the program.

import { Commands } from "./commands.js";
import { bars, chart, element, MOST_NUMBERS, Panel, POSE, row, unitText } from "./panel.js";
import { Parameters } from "./parameters.js";
import { Plot, plotCard } from "./plot.js";

const text = (number) => (number === null ? "–" : Number.isInteger(number) ? String(number) : Number(number.toPrecision(5)).toString());

/** Returns a function that reads the smallest column of a field from the state of a robot. */
const leastOf = (component, name) => ({ components }) => {
  const values = components.find((one) => one.component === component)?.fields.find((field) => field.name === name)?.values ?? [];
  const known = values.filter((value) => value !== null);
  return known.length > 0 ? Math.min(...known) : null;
};

export class LivePanel extends Panel {
  /** Shows a robot and asks the program for its state. */
  show(robot, type) {
    super.show(robot, type);
    this.state = element("div");
    this.unplot();
    this.parameters ??= new Parameters((message) => this.ask(message), this.recording.mayActs);
    this.commands ??= new Commands((message) => this.act(message), this.recording.mayActs);
    this.commands.clear();
    this.present = element("div", {}, this.commands.object, this.state); // known only for the present, unlike the pose above it
    this.values.append(this.parameters.object, this.present);
    if (robot !== null) this.parameters.show(this.recording.header.types[type].name);
    this.shown = null;
    this.rows = null;
    const name = robot === null ? null : this.recording.header.robots.name[robot];
    this.recording.inspected = null;
    this.recording.send({ do: "inspect", robot: name });
  }

  update(frame, poses) {
    super.update(frame, poses);
    const { inspected, lookTime } = this.recording;
    if (this.present) this.present.hidden = lookTime !== null;
    if (this.robot === null || !inspected || inspected === this.shown) return;
    if (inspected.robot !== this.recording.header.robots.name[this.robot]) return;
    this.shown = inspected;
    if (!this.rows) this.build(inspected);
    this.commands.update(inspected.commands ?? {});
    this.blockedBy.value.textContent = inspected.blocked_by || "nothing";
    inspected.components.forEach(({ fields }, c) => fields.forEach((field, f) => this.rows[c]?.[f]?.(field)));
    for (const { plot, read, label, unit } of this.plots.values())
      plot.add(this.recording.state.time_s, { column: label, value: read(inspected) ?? null, unit });
  }

  addPose() {
    super.addPose();
    for (const [name, unit, , of] of POSE)
      this.makePlottable(this.poseRows.get(name), `pose ${name}`, unit, ({ pose }) => (pose ? of(pose) : null));
  }

  /** A click on the row begins or ends the plot of a value over time, as do Enter and the space bar (Bar.key()) if the row has the
   *  focus. `read` returns the value from the state of the robot. */
  makePlottable(object, label, unit, read) {
    object.classList.add("plottable");
    object.title = [object.title, "a click plots the value over time"].filter(Boolean).join("; ");
    object.tabIndex = 0;
    object.setAttribute("role", "button");
    object.onclick = () => this.togglePlot(label, unit, read);
    object.onkeydown = ({ key }) => key === "Enter" && object.onclick();
  }

  togglePlot(label, unit, read) {
    if (this.plots.has(label)) {
      this.plots.get(label).card.remove();
      this.plots.delete(label);
      return;
    }
    const card = plotCard(() => this.togglePlot(label, unit, read));
    document.getElementById("plots").append(card);
    this.plots.set(label, { plot: new Plot(card), card, read, label, unit });
  }

  /** Begins the plots again, because the run was restarted. */
  restarted() {
    for (const { plot } of this.plots?.values() ?? []) plot.clear();
  }

  /** Removes the plots of the robot that was shown. */
  unplot() {
    for (const { card } of this.plots?.values() ?? []) card.remove();
    this.plots = new Map();
  }

  /** Builds one row per field. */
  build({ components }) {
    this.blockedBy = row("blocked by", "what blocked the motion of the robot, or one of its joints, in the last tick");
    this.state.replaceChildren(this.blockedBy.object);
    this.rows = components.map(({ component, name, runs, fields }) => {
      this.state.append(element("h3", { textContent: runs ? name : `${name} (does not run)` }));
      return fields.map((field) => {
        const made = row(field.name, field.text);
        this.makePlottable(made.object, `${name} ${field.name}`, field.unit, leastOf(component, field.name));
        this.state.append(made.object);
        const drawn = field.values.length > MOST_NUMBERS ? chart(field.values.length) : null;
        if (drawn) this.state.append(drawn);
        return ({ values, unit }) => {
          const known = values.filter(Number.isFinite);
          if (!runs) made.value.textContent = "no reading";
          else if (drawn) {
            made.value.textContent = known.length > 0 ? `${text(Math.min(...known))} to ${text(Math.max(...known))}${unitText(unit)}` : "–";
            bars(drawn, values, Math.min(0, ...known), Math.max(...known));
          } else made.value.textContent = `${values.map(text).join(", ")}${unitText(unit)}`;
        };
      });
    });
  }
}

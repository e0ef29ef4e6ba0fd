// The commands to the devices of the selected robot, as fields that the user can change.

import { element } from "./panel.js";
import { tell } from "./told.js";

const NONE = "–"; // shown for a number that is not finite, which the program sends as null

const textOf = (number) => (number === null ? NONE : String(Number(number.toPrecision(6))));

/** The number that a user has typed; NaN if the text is not a number. */
const numberOf = (text) => (text.trim() === "" ? NaN : Number(text));

export class Commands {
  /** `act` sends an action on the selected robot to the program; `mayActs`: whether the user may change commands. */
  constructor(act, mayActs) {
    this.act = act;
    this.mayActs = mayActs;
    this.object = element("details", {}, element("summary", { textContent: "commands to devices" }));
    this.list = element("div");
    this.object.append(this.list);
    this.clear();
  }

  clear() {
    this.inputs = new Map();
    this.list.replaceChildren();
    this.object.hidden = true;
  }

  /** Shows the commands of a robot: {device: {field: [numbers]}}. */
  update(commands) {
    if (this.list.childElementCount === 0) this.build(commands);
    for (const [device, fields] of Object.entries(commands))
      for (const [field, values] of Object.entries(fields)) {
        const input = this.inputs.get(`${device} ${field}`);
        if (input && input !== document.activeElement) input.value = values.map(textOf).join(", ");
      }
  }

  build(commands) {
    for (const [device, fields] of Object.entries(commands)) {
      this.list.append(element("h3", { textContent: device }));
      for (const field of Object.keys(fields)) {
        const input = element("input", { disabled: !this.mayActs, spellcheck: false });
        input.dataset.command = field;
        input.onchange = () => {
          input.blur();
          const numbers = input.value.split(",").map(numberOf);
          if (!numbers.every(Number.isFinite)) return tell(`The command "${field}" must be numbers, separated by commas; found "${input.value}".`);
          this.act({ do: "command", device, values: { [field]: numbers } });
        };
        this.inputs.set(`${device} ${field}`, input);
        this.list.append(element("label", { className: "row" }, element("span", { textContent: field }), input));
      }
    }
    this.object.hidden = this.inputs.size === 0;
  }
}

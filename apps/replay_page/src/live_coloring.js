// Colours robots of a running world by any value of its state, which the program sends on request.

import { Coloring, valueText } from "./coloring.js";

/** The choices for the values that the program offers; column -1: the minimum of all columns. */
function choicesOf({ component, field, unit, columns }) {
  const choice = (name, column) => ({ text: name, unit, value: { component, field }, field, column });
  if (columns === 0) return [choice(`minimum of ${valueText(component, field)}`, -1)];
  if (columns === 1) return [choice(valueText(component, field), 0)];
  return Array.from({ length: columns }, (_, column) => choice(valueText(component, field, column), column));
}

export class LiveColoring extends Coloring {
  constructor(recording) {
    super(recording);
    this.choices = [...this.choices, ...recording.hello.values.flatMap(choicesOf)];
  }

  choose(index) {
    super.choose(index);
    const { value, column } = this.choice;
    this.recording.colorBy(value ? { ...value, ...(column >= 0 ? { column } : {}) } : null);
  }

  get fields() {
    return this.recording.shown;
  }

  get range() {
    if (this.choice.speed) return super.range;
    const { least, most } = this.recording.state?.shades ?? {};
    return [least ?? NaN, most ?? NaN];
  }

  get step() {
    if (this.choice.speed) return super.step;
    const [least, most] = this.range;
    return (most - least) / 100;
  }

  byField() {
    const { shades, state } = this.recording;
    if (!state?.shades) return false;
    for (let r = 0; r < shades.length; r++) this.shade(r, shades[r] === 0 ? NaN : (shades[r] - 1) / 254);
    return true;
  }
}

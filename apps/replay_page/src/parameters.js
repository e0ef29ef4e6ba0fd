// The parameters of a type of robots, as fields that the user can change while the world runs.

import { element } from "./panel.js";

const KEYS = { drive: null, device: "name", controller: "kind" }; // the key that names the owner of parameters

/** The value that a user has typed: a number, true, false, a list, or else a text. */
function valueOf(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

export class Parameters {
  /** `ask` sends a request to the program and returns its answer; `mayActs`: whether the user may change parameters. */
  constructor(ask, mayActs) {
    this.ask = ask;
    this.mayActs = mayActs;
    this.object = element("details", {}, element("summary", { textContent: "parameters" }));
    this.list = element("div");
    this.object.append(this.list);
    this.object.ontoggle = () => this.object.open && this.load();
  }

  /** Shows the parameters of a type of robots. */
  show(type) {
    this.type = type;
    this.list.replaceChildren();
    this.object.querySelector("summary").textContent = `parameters of ${type}`;
    if (this.object.open) this.load();
  }

  async load() {
    const { type } = this;
    const { parameters } = await this.ask({ do: "parameters", type });
    if (parameters && type === this.type) this.list.replaceChildren(...parameters.flatMap((setting) => this.rowsOf(setting)));
  }

  rowsOf(setting) {
    const [[of, { ...values }]] = Object.entries(setting);
    const key = KEYS[of];
    const owner = key ? { [key]: values[key] } : {};
    if (key) delete values[key];
    const title = element("h3", { textContent: [of, ...Object.values(owner)].join(" ") });
    return [title, ...Object.entries(values).map(([name, value]) => this.rowOf(of, owner, name, value))];
  }

  rowOf(of, owner, name, value) {
    const text = typeof value === "string" ? value : JSON.stringify(value);
    const input = element("input", { value: text, disabled: !this.mayActs, spellcheck: false });
    input.dataset.parameter = name;
    input.onchange = async () => {
      await this.ask({ do: "set", type: this.type, [of]: { ...owner, [name]: valueOf(input.value) } });
      this.load(); // shows the value that the program now has
    };
    return element("label", { className: "row" }, element("span", { textContent: name }), input);
  }
}

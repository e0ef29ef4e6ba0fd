// Controls that only the live page has: single steps, the rate, the hash, the plot, and acts on the selected robot.

import { Bar, byId, fill } from "./bar.js";
import { Plot } from "./plot.js";
import { tell } from "./told.js";

export const RATES = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 0]; // times real time; 0: as fast as possible
const LAYERS = { radio: "radio links", sights: "fiducials", grips: "grippers", carries: "carried bodies" };
const MOST_NAMES = 1000; // names that the page suggests; more would make it slow
const TURN = Math.PI / 12; // rad per key press
const DRIVEN = ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"];
const MOST_SEED = 2n ** 64n - 1n;

/** "0.981×", or "7821×": three digits or, of large numbers, all digits before the point. */
const speedText = (speed) => `${speed < 999.5 ? speed.toPrecision(3) : speed.toFixed(0)}×`;

/** Whether a control uses the arrow keys itself: a menu, a slider or a field for text or numbers. */
const usesArrows = (target) => target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && target.type !== "checkbox");

export class LiveBar extends Bar {
  constructor(page) {
    super(page);
    const { player, recording } = page;
    this.plot = new Plot(byId("plot"));
    this.pressed = new Set();
    fill(byId("rate"), RATES.map((rate) => (rate > 0 ? `${rate}×` : "fastest")));
    byId("measures").replaceChildren(...recording.hello.measures.map((name) => new Option(name)));
    byId("measure").onchange = (event) => this.choose(event.target.value.trim());
    this.layers = [[], ...recording.hello.layers.map((layer) => [layer]), recording.hello.layers];
    fill(byId("layers"), ["none", ...recording.hello.layers.map((layer) => LAYERS[layer] ?? layer), "all"]);
    byId("layers").parentElement.hidden = recording.hello.layers.length === 0;
    byId("layers").onchange = (event) => page.act({ do: "layers", layers: this.layers[event.target.value] });
    byId("back").oninput = (event) => this.lookAt(Number(event.target.value));
    byId("now").onclick = () => this.lookAt(Infinity);
    const { name: names } = recording.header.robots;
    byId("names").replaceChildren(...names.slice(0, MOST_NAMES).map((name) => new Option(name)));
    byId("find").onchange = ({ target }) => {
      if (target.value.trim() !== "") page.selectByName(target.value.trim());
      target.value = "";
      target.blur(); // keys are commands again
    };
    byId("follow-all").onchange = (event) => page.followAll(event.target.checked);
    byId("picture").onclick = () => page.save();
    byId("ungroup").onclick = () => page.choose([]);
    if (!recording.mayActs) {
      document.body.classList.add("looking");
      return;
    }
    const { populations, heights_m: heights } = recording.hello;
    byId("adds").hidden = populations.length === 0;
    fill(byId("add"), ["–", ...populations]);
    byId("add").onchange = (event) => {
      const at = event.target.value - 1;
      page.adding = at < 0 ? null : { population: populations[at], height: heights[at] };
    };
    byId("step").onclick = () => player.step(Math.max(1, Math.round(Number(byId("ticks").value)) || 1));
    byId("rate").onchange = (event) => page.act({ do: "rate", rate: RATES[event.target.value] });
    byId("drive").onchange = (event) => this.drive(event.target.checked);
    byId("disable").onclick = () => page.actOn({ do: page.isDisabled() ? "enable" : "disable" });
    byId("remove").onclick = () => page.actOn({ do: "remove" });
    for (const what of ["disable", "enable", "remove"]) byId(`group-${what}`).onclick = () => page.actOnGroup({ do: what });
    byId("until").onchange = (event) => event.target.value !== "" && page.act({ do: "until", time_s: Number(event.target.value) });
    byId("restart").onclick = () => this.restart();
    byId("checkpoint").onclick = () => page.actOnFile({ do: "checkpoint" });
    byId("record").onclick = () => page.actOnFile({ do: page.recording.state?.recording ? "stop_recording" : "record" });
    window.addEventListener("keydown", (event) => this.steer(event, true), { capture: true });
    window.addEventListener("keyup", (event) => this.steer(event, false), { capture: true });
    window.addEventListener("blur", () => this.release());
  }

  actions(event) {
    const { page } = this;
    const all = super.actions(event);
    const select = byId("layers");
    const layers = () => {
      select.selectedIndex = (select.selectedIndex + 1) % select.length;
      select.onchange({ target: select });
    };
    const looks = {
      ...all,
      l: layers,
      p: () => page.save(),
      a: () => page.followAll(!page.followingAll),
      "/": () => byId("find").focus(),
    };
    if (!page.recording.mayActs) return { ...looks, " ": () => {} };
    return {
      ...looks,
      ".": () => page.player.step(),
      q: () => page.turn(TURN),
      e: () => page.turn(-TURN),
      m: () => this.drive(!byId("drive").checked),
    };
  }

  /** Shows a past time, s; from the newest picture on, the present. */
  lookAt(time) {
    const { recording } = this.page;
    recording.lookTime = time < recording.span[1] ? time : null;
  }

  /** Shows the controls of a group of so many robots. */
  showGroup(count) {
    byId("group").hidden = count === 0;
    byId("group").querySelector("h2").textContent = `${count} ${count === 1 ? "robot" : "robots"}`;
  }

  /** Restarts the run with the seed of the field, or with the same seed if the field is empty. */
  restart() {
    const { value, validity } = byId("seed");
    if (value === "" && !validity.badInput) return this.page.act({ do: "restart" });
    // BigInt, because a Number cannot represent every seed above 2^53.
    const seed = /^\d+$/.test(value) ? BigInt(value) : -1n;
    if (seed < 0n || seed > MOST_SEED) return tell(`The seed must be a whole number from 0 to 2^64 - 1${value === "" ? "" : `, found ${value}`}.`);
    return this.page.act({ do: "restart", seed });
  }

  /** Called when the run was restarted, which has released all robots. */
  restarted() {
    this.plot.clear();
    this.driven = null;
    byId("drive").checked = false;
  }

  choose(measure) {
    this.plot.clear();
    this.measure = measure;
    this.page.act({ do: "plot", measure });
  }

  /** Drives the selected robot with the arrow keys in place of its controller. */
  drive(on) {
    byId("drive").checked = on && this.page.selected !== null;
    this.pressed.clear();
    if (byId("drive").checked) this.hold();
    else if (this.driven) this.page.act({ do: "release", robot: this.driven });
    this.driven = byId("drive").checked ? this.page.nameOf(this.page.selected) : null;
  }

  /** Starts to drive when an arrow key is pressed, unless a control with the focus uses this key. The release of the key always
   *  stops, because the focus may have moved to such a control meanwhile. */
  steer(event, down) {
    if (!this.driven || !DRIVEN.includes(event.key)) return;
    const isPressed = this.pressed.has(event.key);
    if (down ? usesArrows(event.target) : !isPressed) return;
    event.preventDefault();
    event.stopPropagation();
    if (isPressed === down) return;
    if (down) this.pressed.add(event.key);
    else this.pressed.delete(event.key);
    this.hold();
  }

  release() {
    if (!this.driven || this.pressed.size === 0) return;
    this.pressed.clear();
    this.hold();
  }

  hold() {
    const speed = Number(byId("drive-speed").value) || 0;
    const axis = (plus, minus) => (this.pressed.has(plus) ? 1 : 0) - (this.pressed.has(minus) ? 1 : 0);
    this.page.actOn({ do: "hold", speed: [speed * axis("ArrowUp", "ArrowDown"), 0, 1.2 * axis("ArrowLeft", "ArrowRight")] });
  }

  update() {
    super.update();
    const { state } = this.page.recording;
    if (!state) return;
    this.set("rate", RATES.indexOf(state.rate), (at) => (byId("rate").selectedIndex = at));
    this.set("reached", state.playing && state.reached > 0 ? speedText(state.reached) : "", (text) => (byId("reached").value = text));
    this.set("line", state.line, (text) => (byId("line").textContent = text));
    const { lookTime, span } = this.page.recording;
    if (state.playing || lookTime !== null || this.shown.back !== span[1])
      this.set("back", lookTime === null ? span[1] : lookTime, (time) => Object.assign(byId("back"), { min: span[0], max: span[1], value: time }));
    this.set("ago", lookTime === null ? "" : `${(state.time_s - lookTime).toFixed(1)} s ago`, (text) => (byId("now").textContent = text || "now"));
    this.set("record", state.recording, (file) => {
      byId("record").textContent = file ? "stop recording" : "record";
      byId("record").title = file ? `Ends the recording ${file}` : "Records the run in a new file in the folder of the session file";
    });
    this.set("followingAll", this.page.followingAll, (on) => (byId("follow-all").checked = on));
    this.set("disabled", this.page.isDisabled(), (on) => (byId("disable").textContent = on ? "enable" : "disable"));
    // Pictures that were sent before the program has read the choice still have the value of the measure before.
    if (state.plot && state.plot.measure === this.measure && state !== this.plotted) this.plot.add(state.time_s, state.plot);
    this.plotted = state;
  }
}

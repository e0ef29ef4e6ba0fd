// The controls common to both pages: the bar at the bottom, the keys, the legend and the scale.

import { numberText } from "./coloring.js";
import { DARK, LIGHT, scaleGradient } from "./palette.js";
import { roundLength } from "./view.js";

export const TRAILS = [0, 2, 5, 10, 30, 60, 300]; // s
const SCALE_PIXELS = 150; // at most
const REPEATED = ["ArrowLeft", "ArrowRight", ",", ".", "+", "=", "-", "q", "e"]; // keys that act again while they are held
const PRESSED_BY_SPACE = 'button, select, summary, [type="checkbox"], [role="button"]';

export const byId = (id) => document.getElementById(id);

/** "1:02.5", or "1:02:03.5" from one hour on. */
export function timeText(seconds) {
  const tenths = Math.round(Math.abs(seconds) * 10);
  const [hours, minutes, rest] = [Math.floor(tenths / 36000), Math.floor(tenths / 600) % 60, tenths % 600];
  const tail = (rest / 10).toFixed(1).padStart(4, "0");
  return `${seconds < 0 ? "-" : ""}${hours > 0 ? `${hours}:${String(minutes).padStart(2, "0")}` : minutes}:${tail}`;
}

export function fill(select, texts) {
  select.replaceChildren(...texts.map((text, i) => new Option(text, i)));
}

/** `page` is a Page. */
export class Bar {
  constructor(page) {
    this.page = page;
    this.shown = {};
    const { player, coloring } = page;
    fill(byId("color"), coloring.choices.map(({ text }) => text));
    fill(byId("trails"), TRAILS.map((seconds) => (seconds > 0 ? `${seconds} s` : "none")));

    byId("play").onclick = () => player.play(!player.playing);
    byId("color").onchange = (event) => page.color(Number(event.target.value));
    byId("trails").onchange = (event) => page.trails(TRAILS[event.target.value]);
    byId("slant").onclick = () => page.slant();
    byId("theme").onclick = () => page.theme(page.themed === DARK ? LIGHT : DARK);
    byId("help").onclick = () => byId("keys").showModal();
    byId("close").onclick = () => page.select(null);
    byId("follow").onchange = (event) => page.follow(event.target.checked);
    window.addEventListener("keydown", (event) => this.key(event));
    // Whether the user has moved the focus with a pointer, not with the keyboard. (:focus-visible does not tell, because a
    // browser may set it when any key is pressed.)
    this.isPointed = false;
    window.addEventListener("pointerdown", () => (this.isPointed = true), { capture: true });
    // The bars wrap in a narrow window. The sizes of the panel and of the corner (style.css) follow from their height.
    const measure = () => {
      const height = window.innerHeight - byId("scale").getBoundingClientRect().bottom;
      document.documentElement.style.setProperty("--controls", `${Math.round(height)}px`);
    };
    measure();
    new ResizeObserver(measure).observe(document.querySelector("footer"));
  }

  /** Functions of the keys, by letter or name of the key. */
  actions(event) {
    const { page } = this;
    const { player } = page;
    const next = (id) => {
      const select = byId(id);
      select.selectedIndex = (select.selectedIndex + 1) % select.length;
      select.onchange({ target: select });
    };
    return {
      " ": () => player.play(!player.playing),
      c: () => next("color"),
      t: () => next("trails"),
      v: () => page.slant(),
      d: () => byId("theme").onclick(),
      f: () => page.follow(!page.following),
      "?": () => byId("keys").showModal(),
      Escape: () => page.select(null),
    };
  }

  key(event) {
    const { target } = event;
    if (event.key === "Tab") this.isPointed = false;
    if (target instanceof HTMLInputElement && target.type !== "range" && target.type !== "checkbox") return;
    const isMenu = target instanceof HTMLSelectElement;
    if (event.ctrlKey || event.altKey || event.metaKey || byId("keys").open) return;
    // After a click, the space bar plays and pauses; it does not press the clicked button again.
    if (event.key === " " && !this.isPointed && target.matches?.(PRESSED_BY_SPACE)) {
      if (target.getAttribute("role") !== "button") return; // the browser operates the control
      event.preventDefault(); // otherwise the panel would be scrolled
      return target.click();
    }
    const actions = this.actions(event);
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action || (isMenu && event.key.length > 1)) return;
    event.preventDefault(); // otherwise a focused button would be pressed too
    if (!event.repeat || REPEATED.includes(event.key) || REPEATED.includes(event.key.toLowerCase())) action();
  }

  /** Writes the description below the title: robots, seed, frames. */
  describe() {
    const { header, frames, robots, movers, present } = this.page.recording;
    const count = (n) => n.toLocaleString("en");
    const others = robots - movers; // bodies that do not drive
    const swarm = `${count(movers)} ${movers === 1 ? "robot" : "robots"}`;
    const about = [present < movers ? `${count(present)} of ${swarm}` : swarm];
    if (others > 0) about[0] += ` and ${count(others)} other ${others === 1 ? "body" : "bodies"}`;
    about.push(`seed ${header.about.seed}`);
    if (frames < header.recorded_frames) about.push(`${count(frames)} of ${count(header.recorded_frames)} recorded frames`);
    document.querySelector("#about p").textContent = about.join(", ");
  }

  /** Calls `write` only if the value of `key` has changed, because every write causes a layout. */
  set(key, value, write) {
    if (this.shown[key] === value) return;
    this.shown[key] = value;
    write(value);
  }

  update() {
    const { page } = this;
    const { player, coloring, view } = page;
    this.set("playing", player.playing, (on) => {
      document.body.classList.toggle("playing", on);
      byId("play").setAttribute("aria-label", on ? "Pause" : "Play");
    });
    this.set("time", timeText(player.time), (text) => (byId("time").value = text));
    this.set("slant", view.slanted, (on) => (byId("slant").textContent = on ? "top" : "3D"));
    this.set("theme", page.themed, () => (byId("legend").querySelector(".shades").style.background = scaleGradient()));
    this.set("present", page.recording.present, () => this.describe());
    this.set("following", page.following, (on) => (byId("follow").checked = on));

    const { choice } = coloring;
    const isOwn = choice.field === undefined && !choice.speed;
    this.set("legend", isOwn ? "" : choice.text + choice.unit, (text) => {
      byId("legend").hidden = text === "";
      byId("legend").querySelector("p").textContent = choice.unit ? `${choice.text}, ${choice.unit}` : choice.text;
    });
    if (!isOwn) {
      const [low, high] = coloring.range.map((end) => numberText(end, coloring.step));
      const [left, right] = byId("legend").querySelectorAll(".ends span");
      this.set("low", low, (text) => (left.textContent = text));
      this.set("high", high, (text) => (right.textContent = text));
    }

    const metres = roundLength(SCALE_PIXELS * view.metresPerPixel());
    this.set("scale", metres, () => (byId("scale").firstChild.textContent = metres >= 1000 ? `${metres / 1000} km` : metres >= 0.01 ? `${Number(metres.toPrecision(2))} m` : `${Number((1000 * metres).toPrecision(2))} mm`));
    this.set("width", Math.round(metres / view.metresPerPixel()), (width) => (byId("scale").lastChild.style.width = `${width}px`));
  }
}

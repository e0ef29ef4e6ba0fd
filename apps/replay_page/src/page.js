// The common part of the replay page and the live page: draws a picture whenever the browser requests a frame.

import { TRAILS } from "./bar.js";
import { Coloring } from "./coloring.js";
import { DARK, LIGHT, useTheme } from "./palette.js";
import { View } from "./view.js";

const UNPACK_MS = 3; // time per picture for unpacking later frames
const UNPACK_NOW_MS = 7; // time per picture if the current frame is not unpacked yet
const CLICK_PIXELS = 5; // most movement of a pointer between press and release

export function problem(text) {
  const shown = document.getElementById("problem");
  shown.textContent = text;
  shown.hidden = false;
}

export class Page {
  /** `recording` is a Recording or a LiveSource, `player` a Player or a LivePlayer; Bar, Panel and Colors are classes. */
  constructor(recording, player, { Bar, Panel, Colors = Coloring, name }) {
    this.recording = recording;
    this.player = player;
    this.name = name;
    this.coloring = new Colors(recording);
    this.view = new View(document.getElementById("world"), recording);
    this.panel = new Panel(recording, document.getElementById("panel"));
    this.selected = null;
    this.following = false;
    this.drawn = -1; // frame on the screen
    this.last = null;
    this.scriptTimes = []; // ms of script per picture, of the latest pictures
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    this.theme(dark.matches ? DARK : LIGHT);
    dark.addEventListener("change", () => this.theme(dark.matches ? DARK : LIGHT));
    this.bar = new Bar(this);
    this.describe();
    this.bar.update();
    this.view.fit(); // after the bar, because it needs the sizes of the controls
    this.listen();
  }

  describe() {
    const { header } = this.recording;
    const title = header.title || header.about.world || "Troupe";
    document.title = `${title}: ${this.name}`;
    document.querySelector("#about h1").textContent = title;
  }

  listen() {
    window.addEventListener("resize", () => this.resize());
    const { canvas } = this.view;
    let pressed = null;
    canvas.addEventListener("pointerdown", (event) => {
      pressed = event.isPrimary && event.button === 0 ? [event.clientX, event.clientY] : null;
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > CLICK_PIXELS) return;
      this.click(event.clientX, event.clientY);
    });
    canvas.addEventListener("webglcontextlost", () => problem("The browser has lost the WebGL context: reload the page."));
  }

  resize() {
    this.view.resize();
  }

  // Functions of the controls.

  click(clientX, clientY) {
    this.select(this.view.robotAt(clientX, clientY));
  }

  color(index) {
    this.coloring.choose(index);
  }

  trails(seconds) {
    this.view.trails.setLength(seconds);
  }

  /** `theme` is LIGHT or DARK. */
  theme(theme) {
    this.themed = theme;
    document.documentElement.dataset.theme = theme === DARK ? "dark" : "light";
    useTheme(theme);
    this.view.theme(theme);
    this.coloring.choose(this.coloring.choices.indexOf(this.coloring.choice)); // recomputes the colours
  }

  slant() {
    this.view.fit(!this.view.slanted);
  }

  select(robot) {
    this.selected = robot;
    const type = robot === null ? null : this.view.typeOf[robot];
    this.panel.show(robot, type);
    this.view.scan.show(robot, type);
    if (robot === null) this.follow(false);
  }

  follow(on) {
    this.following = on && this.selected !== null;
  }

  // Drawing.

  /** Called when the poses of a picture are known, before it is drawn. */
  posed() {}

  draw(now) {
    const begin = performance.now();
    const seconds = this.last === null ? 0 : (now - this.last) / 1000;
    this.player.advance(seconds);
    this.last = now;
    const { frame, mix } = this.recording.frameAt(this.player.time);
    const fields = [...new Set([...this.view.fields, ...this.coloring.fields, ...this.panel.fields])];
    if (this.view.pose(frame, mix)) this.drawn = frame;
    if (this.drawn >= 0) {
      const tints = this.coloring.tintsOf(this.drawn);
      if (tints !== undefined) this.view.useTints(tints);
      if (this.following) this.view.follow(this.selected);
      this.panel.update(this.drawn, this.view.poses);
      this.posed();
      this.view.draw(this.drawn, this.selected);
    }
    this.bar.update();
    const ahead = frame + Math.max(1, Math.round(0.5 * this.recording.header.block_frames));
    this.recording.prefetch(ahead, fields);
    // On a machine that draws slowly, unpack for a fraction of the frame time: a stalled recording is worse than a lost picture.
    const [least, share] = this.drawn === frame ? [UNPACK_MS, 0.1] : [UNPACK_NOW_MS, 0.3];
    this.recording.pump(Math.max(least, share * 1000 * Math.min(seconds, 1)));
    this.scriptTimes.push(performance.now() - begin);
    if (this.scriptTimes.length > 240) this.scriptTimes.shift();
  }
}

/** For scripts: the state of the page and the controls common to both pages. */
export function remote(page) {
  const { recording, player, view } = page;
  return {
    state: () => ({
      time: player.time,
      playing: player.playing,
      speed: player.speed,
      robots: recording.robots,
      frame: page.drawn,
      selected: page.selected === null ? null : recording.header.robots.name[page.selected],
      scanned: view.scan.isDrawn,
      scriptMs: [...page.scriptTimes],
    }),
    play: (on = true) => player.play(on),
    select: (name) => page.select(name === null ? null : recording.header.robots.name.indexOf(name)),
    pose: (name) => {
      const robot = recording.header.robots.name.indexOf(name);
      return [...view.poses.subarray(4 * robot, 4 * robot + 4)];
    },
    screenPlace: (name, shift = [0, 0, 0]) => view.screenPlace(recording.header.robots.name.indexOf(name), shift),
    trails: (seconds) => {
      document.getElementById("trails").selectedIndex = TRAILS.indexOf(seconds);
      page.trails(seconds);
    },
    slant: () => page.slant(),
    theme: (name) => page.theme(name === "dark" ? DARK : LIGHT),
    color: (text) => {
      const index = page.coloring.choices.findIndex((choice) => choice.text === text);
      document.getElementById("color").selectedIndex = index;
      page.color(index);
    },
    colors: () => page.coloring.choices.map((choice) => choice.text),
    header: recording.header,
  };
}

/** Throws if the browser lacks a required feature. */
export function checkBrowser() {
  if (!window.DecompressionStream || !document.createElement("canvas").getContext("webgl2"))
    throw new Error("it needs a browser of 2023 or later with WebGL 2.");
}

/** Draws a picture whenever the browser requests one. If an error prevents a picture, the page shows the error, once, and
 *  still tries to draw the next pictures. */
export function show(page) {
  const known = new Set();
  const draw = (time) => {
    requestAnimationFrame(draw);
    try {
      page.draw(time);
    } catch (error) {
      if (known.has(error.message)) return;
      known.add(error.message);
      console.error(error);
      fail(error);
    }
  };
  requestAnimationFrame((time) => {
    document.getElementById("problem").hidden = true;
    draw(time);
  });
}

const fail = (error) => problem(`Error in this page, which may now show wrong things: ${error.message ?? error}. Reload the page.`);

window.addEventListener("error", ({ error }) => error && fail(error)); // null: not an error of the script of this page
window.addEventListener("unhandledrejection", (event) => problem(`This page cannot be shown: ${event.reason?.message ?? event.reason}`));

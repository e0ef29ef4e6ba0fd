// The page of `troupe view`: shows a running world and sends the user's commands.

import { listenToBoxes, Marks } from "./group.js";
import { Lines } from "./lines.js";
import { LiveBar } from "./live_bar.js";
import { LiveColoring } from "./live_coloring.js";
import { LivePanel } from "./live_panel.js";
import { LiveSource } from "./live_source.js";
import { checkBrowser, Page, problem, remote, show } from "./page.js";
import { DARK } from "./palette.js";
import { tell } from "./told.js";

const REVOKE_MS = 2000; // time after which the memory of a downloaded picture is freed
const RETRY_MS = 2000; // time until the page tries to connect again
const LEAST_LIFE_MS = 10000; // a page that loses its connection sooner is not reloaded, because that might never end
const TRY_AGAIN_LATER = 1013; // code with which the program closes the connection of one viewer too many
const DRAG_PIXELS = 4; // distance that a pointer moves before it drags a robot
const ADDRESS = `${window.location.protocol === "https:" ? "wss" : "ws"}://${window.location.host}/live`;
const KEY = "troupe-token";
const NO_LINES = {};

/** Returns the access token in the address of the page. Hides it from the visible address and stores it for a reload. */
function token() {
  const given = window.location.hash.slice(1);
  if (given) {
    window.sessionStorage.setItem(KEY, given);
    window.history.replaceState(null, "", "/");
  }
  return window.sessionStorage.getItem(KEY) ?? "";
}

/** A Player (player.js) that shows the clock of the program. */
class LivePlayer {
  constructor(page) {
    this.page = page;
    this.speed = 1;
  }
  get state() {
    return this.page().recording.state;
  }
  /** The time that is shown, s: a past one if the user looks back. */
  get time() {
    const { recording } = this.page();
    return recording.lookTime ?? this.state?.time_s ?? 0;
  }
  get playing() {
    return this.state?.playing ?? false;
  }
  play(on = true) {
    return this.page().act({ do: on ? "play" : "pause" });
  }
  step(ticks = 1) {
    return this.page().act({ do: "step", ticks });
  }
  advance() {}
}

class LivePage extends Page {
  constructor(recording, link) {
    let page = null;
    super(recording, new LivePlayer(() => page ?? { recording, act: () => {} }), { Bar: LiveBar, Panel: LivePanel, Colors: LiveColoring, name: "live" });
    page = this;
    this.link = link;
    this.lines = new Lines();
    this.marks = new Marks();
    this.followingAll = false;
    this.group = []; // robots that were selected with a box
    this.view.scene.add(this.lines.object, this.marks.object);
    this.theme(this.themed);
    this.panel.ask = (message) => this.act(message);
    this.panel.act = (message) => this.actOn(message);
    const mayBegin = ({ clientX, clientY }) => this.selected === null || this.view.robotAt(clientX, clientY) !== this.selected;
    listenToBoxes(this.view.canvas, mayBegin, this.view.controls, (...corners) => this.selectIn(...corners));
    if (recording.mayActs) this.listenToDrags();
  }

  theme(theme) {
    super.theme(theme);
    this.lines?.theme(theme === DARK);
    this.marks?.theme(theme);
  }

  nameOf(robot) {
    return this.recording.header.robots.name[robot];
  }

  /** Sends a command and returns the answer; shows a refusal, {type, reason}. */
  async act(message) {
    const answer = await this.link.ask(message);
    if (answer.type === "refused") tell(answer.reason);
    return answer;
  }
  actOn(message) {
    return this.selected === null ? null : this.act({ ...message, robot: this.nameOf(this.selected) });
  }
  isDisabled() {
    const condition = this.recording.inspected?.components.find(({ name }) => name === "condition");
    return ((condition?.fields.find(({ name }) => name === "out")?.values[0] ?? 0) & 1) === 1;
  }

  /** Selects the robot of this name, and moves the view to the robot if it is outside of the picture. */
  selectByName(name) {
    const robot = this.recording.header.robots.name.lastIndexOf(name);
    if (robot < 0) return tell(`There is no robot "${name}".`);
    this.select(robot);
    const [x, y] = this.view.screenPlace(robot, [0, 0, 0]);
    if (x < 0 || y < 0 || x > window.innerWidth || y > window.innerHeight) this.view.follow(robot);
  }

  follow(on) {
    super.follow(on);
    if (this.following) this.followAll(false);
  }
  /** Keeps all robots in the picture. */
  followAll(on) {
    this.followingAll = on;
    this.view.fitted = null;
    if (on) this.follow(false);
  }

  slant() {
    super.slant();
    this.view.fitted = null;
  }

  resize() {
    super.resize();
    this.view.fitted = null; // a narrower window shows a smaller part of the floor
  }

  /** Whether the program takes the name of a robot for that of a later body. */
  isNamesake(robot) {
    return this.recording.namesakes.has(robot);
  }

  select(robot) {
    if (this.isNamesake(robot)) {
      tell(`Several bodies have the name "${this.nameOf(robot)}"; only the last of them can be selected.`);
      robot = null;
    }
    if (robot !== this.selected && this.bar?.driven) this.bar.drive(false);
    if (this.group.length > 0) this.choose([]);
    super.select(robot);
  }

  /** Selects the robots in a box of the screen. */
  selectIn(...corners) {
    this.select(null);
    this.choose(this.view.robotsIn(...corners).filter((robot) => this.recording.mobile[robot] && !this.isNamesake(robot)));
  }
  /** Makes a list of robots the group. */
  choose(robots) {
    this.group = robots;
    this.marks.show(robots);
    this.bar.showGroup(robots.length);
  }
  /** Sends a command for each robot of the group, one after another. */
  async actOnGroup(message) {
    const { group } = this;
    const refused = [];
    let reason = "";
    for (const robot of group) {
      const answer = await this.link.ask({ ...message, robot: this.nameOf(robot) });
      if (answer.type !== "refused") continue;
      refused.push(robot);
      reason ||= answer.reason;
    }
    if (refused.length > 0) tell(`Refused for ${refused.length} of ${group.length} robots: ${reason}`);
    if (message.do === "remove" && this.group === group) this.choose(refused); // the others have left the world
  }

  /** Sends a command that writes a file, and shows its name. */
  async actOnFile(message) {
    const answer = await this.act(message);
    if (answer.file) tell(`${answer.file} is written`);
    return answer;
  }

  /** Saves a picture of the canvas as a download. */
  async save() {
    const picture = await this.view.picture();
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(picture), download: `${this.recording.header.title || "troupe"}-${this.recording.state?.tick ?? 0}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), REVOKE_MS);
  }

  /** Called when the run was restarted. */
  restarted() {
    this.trails(this.view.trails.seconds);
    this.panel.restarted();
    this.bar.restarted();
  }

  /** Adds a robot at the click if a population is chosen, else selects. */
  click(clientX, clientY) {
    const place = this.adding && this.view.floorAt(clientX, clientY, this.adding.height);
    if (!place) {
      // Selecting the selected robot again would remove its plots.
      if (this.selected === null || this.view.robotAt(clientX, clientY) !== this.selected) super.click(clientX, clientY);
      return;
    }
    const { population, height } = this.adding;
    this.act({ do: "add", population, pose: [...place, height, 0] });
    this.adding = null;
    document.getElementById("add").selectedIndex = 0;
  }

  /** The present pose of a robot, if the user does not look back: where a drag has put the robot, else exact if the program has
   *  sent the state of the robot, else rounded as in pictures. */
  poseOf(robot) {
    const { inspected, override } = this.recording;
    if (override?.robot !== robot && inspected?.robot === this.nameOf(robot) && inspected.pose) return inspected.pose;
    return [...this.view.poses.subarray(4 * robot, 4 * robot + 4)];
  }
  async turn(by) {
    if (this.selected === null) return;
    if (this.recording.lookTime !== null) return tell("The page shows the past: press now, then turn the robot.");
    const [x, y, z, heading] = this.poseOf(this.selected);
    await this.actOn({ do: "move", pose: [x, y, z, heading + by] });
  }

  /** Dragging the selected robot moves it; with Shift it turns towards the pointer. */
  listenToDrags() {
    const { canvas, controls } = this.view;
    let drag = null;
    window.addEventListener(
      "pointerdown",
      (event) => {
        if (event.target !== canvas || !event.isPrimary || event.button !== 0 || this.selected === null || this.recording.lookTime !== null) return;
        if (this.view.robotAt(event.clientX, event.clientY) !== this.selected) return;
        controls.enabled = false; // the drag must not move the view
        drag = { robot: this.selected, from: [event.clientX, event.clientY], pose: this.poseOf(this.selected), moved: false, wanted: null };
      },
      { capture: true },
    );
    window.addEventListener("pointermove", (event) => {
      if (!drag) return;
      drag.moved ||= Math.hypot(event.clientX - drag.from[0], event.clientY - drag.from[1]) > DRAG_PIXELS;
      const place = this.view.floorAt(event.clientX, event.clientY, drag.pose[2]);
      if (!drag.moved || !place) return;
      const [x, y, , heading] = drag.pose;
      drag.wanted = { robot: drag.robot };
      if (event.shiftKey) Object.assign(drag.wanted, { x, y, heading: Math.atan2(place[1] - y, place[0] - x) });
      else Object.assign(drag.wanted, { x: place[0], y: place[1], heading });
      this.recording.override = drag.wanted;
    });
    const end = async (event) => {
      if (!drag) return;
      const { pose, robot, wanted } = drag;
      drag = null;
      controls.enabled = true;
      if (wanted && event.type === "pointerup")
        await this.act({ do: "move", robot: this.nameOf(robot), pose: [wanted.x, wanted.y, pose[2], wanted.heading] });
      // A next drag may have begun while the answer was on its way.
      if (this.recording.override === wanted) this.recording.override = null;
    };
    window.addEventListener("pointerup", end);
    window.addEventListener("pointercancel", end);
  }

  posed() {
    if (this.followingAll) this.view.followAll();
    this.marks.update(this.view);
  }

  draw(now) {
    const { state, lookTime } = this.recording;
    const run = state?.run;
    if (this.run !== undefined && run !== this.run) this.restarted();
    this.run = run;
    this.lines.update(lookTime === null && state?.lines ? state.lines : NO_LINES); // known only for the present
    try {
      super.draw(now);
    } finally {
      this.recording.drawn(); // also after an error: without confirmations, the program sends no further pictures
    }
  }
}

/** The JSON text of a request. Its members may be BigInt numbers, which JSON.stringify() rejects. */
function textOf(request) {
  const members = Object.entries(request).map(([key, value]) => `${JSON.stringify(key)}:${typeof value === "bigint" ? value : JSON.stringify(value)}`);
  return `{${members.join(",")}}`;
}

/** The connection to the program. */
class Link {
  constructor(onHello) {
    this.onHello = onHello;
    this.asked = new Map();
    this.last = 0;
    this.source = null;
    this.open();
  }

  open() {
    this.socket = new WebSocket(ADDRESS);
    this.socket.binaryType = "arraybuffer";
    this.isOpened = false;
    this.isGreeted = false; // whether the program has accepted the token of this connection
    this.socket.onopen = () => {
      this.isOpened = true;
      this.socket.send(token());
    };
    this.socket.onmessage = ({ data }) => (typeof data === "string" ? this.text(JSON.parse(data)) : this.source.takePicture(data));
    this.socket.onclose = ({ code, reason }) => this.closed(code, reason);
  }

  /** Says why there is no connection, and tries again, except after a wrong token. */
  closed(code, reason) {
    if (code === TRY_AGAIN_LATER) problem(`The program refuses the connection: ${reason}. The page tries again every ${RETRY_MS / 1000} s.`);
    else if (this.isOpened && !this.isGreeted) return problem("This address has no valid token. Open the address that the program has printed.");
    else problem(reason ? `The program has ended: ${reason}.` : "The program has ended or cannot be reached.");
    setTimeout(() => this.open(), RETRY_MS);
  }

  /** Called when the program has accepted a new connection after an earlier one was lost. */
  reconnected() {
    if (performance.now() > LEAST_LIFE_MS) return window.location.reload(); // the program may show another world now
    this.socket.onclose = null;
    this.socket.close();
    problem("The connection to the program was lost soon after it began. Reload the page to try again.");
  }

  text(message) {
    if (message.type === "hello" && this.source) {
      if (!this.isGreeted) return this.reconnected();
      window.location.reload(); // a restart with another seed has placed the bodies elsewhere
    } else if (message.type === "hello") {
      this.isGreeted = true;
      this.source = new LiveSource(message, (what) => this.send(what));
      this.onHello(this.source, this);
    } else if (message.type === "state") {
      this.source.takeState(message);
      if (message.inspected) this.source.inspected = message.inspected;
    } else if (this.asked.has(message.id)) {
      this.asked.get(message.id)(message);
      this.asked.delete(message.id);
    } else if (message.type === "refused") {
      tell(message.reason); // what the program has begun cannot go on: a recording, for example, because the disk is full
    }
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(textOf(message));
  }

  ask(message) {
    const id = ++this.last;
    return new Promise((done) => {
      this.asked.set(id, done);
      this.send({ ...message, id });
    });
  }
}

/** For scripts: remote(), and functions that only a live page has. */
function liveRemote(page) {
  const common = remote(page);
  return {
    ...common,
    state: () => ({ ...common.state(), ...page.recording.state, frame: page.drawn }),
    act: (message) => page.act(message),
    step: (ticks) => page.player.step(ticks),
    follow: (on) => page.follow(on),
    following: () => [page.following, page.followingAll],
    inspected: () => page.recording.inspected,
    floorAt: (x, y) => page.view.floorAt(x, y),
    group: () => page.group.map((robot) => page.nameOf(robot)),
    lines: () => page.lines.count,
    trail: () => page.view.trails.shown,
    legend: () => page.coloring.range,
    /** The bytes of a picture, in base 64. */
    picture: async () => {
      const bytes = new Uint8Array(await (await page.view.picture()).arrayBuffer());
      return btoa(bytes.reduce((text, byte) => text + String.fromCharCode(byte), ""));
    },
  };
}

async function begin() {
  checkBrowser();
  // The address of another run at the same port differs only after the #, so the browser does not load the page again.
  window.addEventListener("hashchange", () => window.location.reload());
  new Link((source, link) => {
    const page = new LivePage(source, link);
    window.troupe = liveRemote(page);
    show(page);
  });
}

begin();

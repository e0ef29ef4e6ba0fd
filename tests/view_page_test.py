#!/usr/bin/env python3
"""Tests the page of `troupe view`: operates it in a headless Chromium with mouse and keyboard.

    view_page_test.py TROUPE [PICTURES]    PICTURES: folder for screenshots, with a "/"
"""

import base64
import contextlib
import json
import math
import struct
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from tests.support.chromium import Page, Picture, find  # noqa: E402
from tests.support.view import HAS_IPV6, WORLD, YARD, View  # noqa: E402
from tests.support.websocket import WAIT_S  # noqa: E402

PICTURES = None
PROGRAM = find()
SIZE = (1280, 720)

# Scripts that change the WebSockets of a page. A test passes them to InABrowser.opened().
REFUSED_ONCE = """
    const Real = WebSocket;
    let refusals = 1;
    window.WebSocket = function (address) {
      if (refusals-- <= 0) return new Real(address);
      const refused = { send() {} };
      setTimeout(() => (refused.onopen(), refused.onclose({ code: 1013, reason: "at most 16 viewers can be connected" })));
      return refused;
    };
    window.WebSocket.OPEN = Real.OPEN;
"""
KEPT_SOCKETS = """
    const Real = WebSocket;
    window.sockets = [];
    window.WebSocket = function (address) { return sockets[sockets.push(new Real(address)) - 1]; };
    window.WebSocket.OPEN = Real.OPEN;
"""
SLOW_ANSWERS = """
    const { set } = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage");
    Object.defineProperty(WebSocket.prototype, "onmessage", { set(take) {
      const isAnswer = ({ data }) => typeof data === "string" && JSON.parse(data).type === "done";
      set.call(this, (event) => (isAnswer(event) ? setTimeout(() => take(event), 3000) : take(event)));
    } });
"""
# Commands to a device that have no field to show.
EMPTY_COMMANDS = """
    const { parse } = JSON;
    JSON.parse = (text) => {
      const message = parse(text);
      if (message?.inspected) message.inspected.commands = { lamp: {} };
      return message;
    };
"""
# A command that is not finite: the program sends such numbers as null.
NULL_COMMANDS = """
    const { parse } = JSON;
    JSON.parse = (text) => {
      const message = parse(text);
      if (message?.inspected?.commands?.lamp) message.inspected.commands.lamp.red = [null];
      return message;
    };
"""

# A run that is much faster than real time.
FAST = """
    const { parse } = JSON;
    JSON.parse = (text) => {
      const message = parse(text);
      if (message?.reached) message.reached = 7821.4;
      return message;
    };
"""


@unittest.skipIf(PROGRAM is None, "no Chromium (scripts/setup --checks installs it)")
class InABrowser(unittest.TestCase):
    @contextlib.contextmanager
    def opened(self, *arguments, world=WORLD, script=None, size=SIZE, touch=False):
        """A view and its page, which runs `script` before its own script."""
        with View(*arguments, world=world) as view, Page(PROGRAM, size, touch) as self.page:
            if script:
                self.page.call("Page.addScriptToEvaluateOnNewDocument", source=f"{{{script}}}")
            self.page.open_address(view.address)
            self.page.wait("window.troupe && troupe.state().tick > 2")
            yield view, self.page

    def keep(self, name):
        if PICTURES:
            (PICTURES / f"{name}.png").write_bytes(self.page.screenshot())

    def place(self, name):
        return self.page.run(f"troupe.screenPlace('{name}', [0, 0, 0])")

    def center(self, selector):
        return self.page.run("(({x, y, width, height}) => [x + width / 2, y + height / 2])"
                             f"(document.querySelector('{selector}').getBoundingClientRect())")

    def press_button(self, selector):
        self.page.click(*self.center(selector))

    def pause(self):
        self.press_button("#play")
        return self.paused()

    def paused(self):
        self.page.wait("!troupe.state().playing && troupe.state().line")
        return self.page.run("(({scriptMs, ...rest}) => rest)(troupe.state())")

    def key(self, kind, key):
        self.page.call("Input.dispatchKeyEvent", type=kind, key=key, code=key)

    def told(self):
        return self.page.run("document.getElementById('told').textContent")

    def pixel(self, name, shift=(0, 0, 0)):
        """The colour on the screen of a robot, or of a point shifted from it by some metres."""
        x, y = (round(at) for at in self.page.run(f"troupe.screenPlace('{name}', {list(shift)})"))
        return Picture(self.page.screenshot((x - 2, y - 2, x + 2, y + 2))).at(2, 2)

    def drag_to(self, name, x, y):
        """Drags the selected robot to a point of the floor; returns the message of the page."""
        start = self.place(name)
        here = self.page.run(f"troupe.pose('{name}')")
        end = self.page.run(f"troupe.screenPlace('{name}', [{x - here[0]}, {y - here[1]}, 0])")
        self.page.run("document.getElementById('told').hidden = true")
        self.page.drag(start, end)

    def test_a_person_uses_it(self):
        with self.opened("--rate", 1) as (view, page):
            self.assertEqual(page.run("location.hash"), "", "the token is out of sight")
            x = page.run("troupe.pose('red')")
            page.wait(f"troupe.pose('red')[0] !== {x[0]}")
            self.keep("running")

            before = self.pause()
            page.wait("document.getElementById('line').textContent === troupe.state().line")
            self.press_button("#step")
            page.wait(f"troupe.state().tick > {before['tick']} && !troupe.state().playing")
            after = self.paused()
            self.assertEqual(after["tick"], before["tick"] + 1)

            page.run("troupe.select('red')")
            page.wait("troupe.inspected() && troupe.state().scanned")
            self.assertIn("condition", page.run("document.getElementById('panel').innerText"))
            self.keep("inspected")

            self.drag_to("red", 3, -2)  # into the other room
            page.wait("Math.abs(troupe.pose('red')[0] - 3) < 0.05 && Math.abs(troupe.pose('red')[1] + 2) < 0.05")
            self.drag_to("red", 0, 2)  # into the wall
            page.wait("!document.getElementById('told').hidden")
            self.assertIn("a wall or another body is there", page.run("document.getElementById('told').textContent"))
            self.keep("refused")
            page.wait("Math.abs(troupe.pose('red')[0] - 3) < 0.05")
            heading = page.run("troupe.pose('red')[3]")
            page.press("q", "KeyQ")
            page.wait(f"Math.abs(troupe.pose('red')[3] - {heading}) > 0.2")

            page.run("document.querySelector('#values details').open = true")
            page.wait("document.querySelector('[data-parameter=cruise_speed_mps]') !== null")
            page.run("(input => { input.value = '0.9'; input.onchange(); })(document.querySelector('[data-parameter=cruise_speed_mps]'))")
            page.run("troupe.step(25)")  # it may be turning away from the wall for 20 ticks
            page.wait("troupe.inspected().components.find(c => c.name === 'velocity').fields[0].values[0] === 0.9")
            self.paused()
            self.keep("parameters")
            page.run("document.querySelector('#values details').open = false")

            page.run("troupe.follow(true)")
            page.run("(rate => { rate.selectedIndex = 5; rate.onchange({target: rate}); })(document.getElementById('rate'))")
            page.wait("troupe.state().rate === 5")
            page.run("(measure => { measure.value = 'displacement'; measure.onchange({target: measure}); })"
                     "(document.getElementById('measure'))")
            self.press_button("#play")
            page.wait("document.querySelector('#plot path').getAttribute('d').split('L').length > 10")
            for name in ("x", "heading"):
                page.run(f"[...document.querySelectorAll('#values > .plottable')].find(row => row.firstChild.innerText === '{name}').click()")
            page.wait("document.querySelectorAll('#plots path').length === 2 && "
                      "[...document.querySelectorAll('#plots path')].every(path => path.getAttribute('d').split('L').length > 10)")
            plotted = page.run("[...document.querySelectorAll('#plots .now')].map(line => line.textContent)")
            self.assertRegex(plotted[0], r"^pose x -?[0-9.]+ m$")
            self.assertRegex(plotted[1], r"^pose heading -?[0-9.]+ °$")
            self.keep("plotted")

            page.press("m", "KeyM")
            page.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowLeft", code="ArrowLeft")
            page.wait("troupe.inspected()?.components.find(c => c.name === 'velocity').fields.at(-1).values[0] === 1.2")
            page.call("Input.dispatchKeyEvent", type="keyUp", key="ArrowLeft", code="ArrowLeft")
            self.keep("driven")
            page.press("m", "KeyM")
            self.press_button("#disable")
            page.wait("document.getElementById('disable').textContent === 'enable'")
            page.run("troupe.theme('dark')")
            self.keep("dark")
            page.run("troupe.theme('light')")

            page.run("troupe.select(null)")
            for _ in range(2):  # the camera has followed red; V shows the whole world again
                page.press("v", "KeyV")
            red = self.place("red")
            page.drag([at - 10 for at in red], [at + 10 for at in red], shift=True)
            page.wait("troupe.group().length > 0")
            self.assertEqual(page.run("troupe.group()"), ["red"])
            page.drag((20, 20), (SIZE[0] - 20, SIZE[1] - 120), shift=True)  # everything between the title and the bars
            page.wait("troupe.group().length === 2")
            self.keep("group")
            self.press_button("#group-enable")
            page.wait("document.getElementById('told').textContent.startsWith('Refused for 1 of 2 robots')")
            self.press_button("#ungroup")
            page.wait("troupe.group().length === 0")

            page.run("troupe.color('pose.x')")
            page.wait("troupe.legend()[1] > troupe.legend()[0]")  # the two robots are in different places
            self.keep("coloured")
            page.run("troupe.color('own colours')")

            picture = base64.b64decode(page.run("troupe.picture()"))
            self.assertEqual(struct.unpack(">II", picture[16:24]), SIZE)

            shown = self.pause()
            newest = page.run("troupe.pose('blue')")
            page.run("(back => { back.value = Number(back.max) - 3; back.oninput({target: back}); })(document.getElementById('back'))")
            page.wait("document.getElementById('now').textContent.endsWith(' s ago')")
            self.keep("past")
            self.press_button("#now")
            page.wait("document.getElementById('now').textContent === 'now'")
            self.assertEqual(page.run("troupe.pose('blue')"), newest)

            self.press_button("#checkpoint")
            page.wait("document.getElementById('told').textContent === 'rooms.checkpoint.h5 is written'")
            shown = self.paused()
            page.drag((20, 20), (SIZE[0] - 20, SIZE[1] - 120), shift=True)
            page.wait("troupe.group().length === 2")
            self.press_button("#group-remove")
            page.wait("troupe.group().length === 0 && troupe.state().robots === 0")
            self.press_button("#restart")
            page.wait("troupe.state().run === 2")
            restarted = self.paused()
            self.assertEqual(restarted["tick"], 0)
            page.wait("troupe.pose('red')[3] === 0 && Math.abs(troupe.pose('red')[0] + 3) < 1e-3")  # it is drawn again
            self.keep("restarted")
            self.assertEqual(page.problems, [])
            view.end()
            page.wait("document.getElementById('problem').innerText.startsWith('The program has ended')")
            log = view.replayed()
            for state in (before, after, shown):
                self.assertEqual(log[state["tick"]], state["line"])

    def test_robots_are_found_and_followed(self):
        with self.opened() as (_, page):
            tick = self.pause()["tick"]
            page.run("document.getElementById('ticks').value = '7'")
            self.press_button("#step")
            page.wait(f"troupe.state().tick === {tick + 7} && !troupe.state().playing")

            page.press("/", "Slash")
            page.call("Input.insertText", text="blue")
            page.call("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter", windowsVirtualKeyCode=13, text="\r")
            page.wait("troupe.inspected()?.robot === 'blue'")
            self.assertEqual(page.run("document.getElementById('find').value"), "")
            page.run("(input => { input.value = 'green'; input.onchange({target: input}); })(document.getElementById('find'))")
            self.assertEqual(page.run("document.getElementById('told').textContent"), 'There is no robot "green".')
            self.assertEqual(page.run("troupe.state().selected"), "blue")

            page.press("f", "KeyF")
            page.wait("troupe.following()[0]")
            page.run("document.getElementById('follow-all').click()")
            page.wait("troupe.following()[1] && !troupe.following()[0]")
            spread = "Math.hypot(...['red', 'blue'].map(name => troupe.screenPlace(name)).reduce(([a, b], [c, d]) => [a - c, b - d]))"
            # blue moves to red: the picture of both is enlarged. Then red moves to the other end: it stays in the picture.
            for robot, (x, y) in (("blue", (-3, -2.2)), ("red", (5, 3)), ("blue", (-5.5, -3.5))):
                page.run(f"troupe.act({{do: 'move', robot: '{robot}', pose: [{x}, {y}, 0, 0]}})")
                page.wait(f"Math.abs(troupe.pose('{robot}')[0] - {x}) < 1e-2")
                page.wait(f"{spread} > 200")
                for name in ("red", "blue"):
                    x, y = page.run(f"troupe.screenPlace('{name}')")
                    self.assertTrue(0 < x < SIZE[0] and 0 < y < SIZE[1], (robot, name, x, y))
            page.press("a", "KeyA")
            page.wait("!troupe.following()[1]")
            # Without following, the picture stays; a robot that is found outside of it is moved into its middle.
            before = page.run("troupe.screenPlace('blue')")
            page.run("troupe.act({do: 'move', robot: 'red', pose: [-4, -3, 0, 0]})")
            page.wait("Math.abs(troupe.pose('red')[0] + 4) < 1e-2")
            for now, then in zip(page.run("troupe.screenPlace('blue')"), before):
                self.assertAlmostEqual(now, then, places=2)
            page.run("troupe.act({do: 'move', robot: 'red', pose: [4, 3, 0, 0]})")
            page.wait("Math.abs(troupe.pose('red')[0] - 4) < 1e-2")
            for _ in range(5):  # zoom in at blue
                page.mouse("mouseWheel", *before, deltaX=0, deltaY=-400)
            page.wait(f"troupe.screenPlace('red')[0] > {SIZE[0]}")
            page.run("(input => { input.value = 'red'; input.onchange({target: input}); })(document.getElementById('find'))")
            page.wait(f"Math.abs(troupe.screenPlace('red')[0] - {SIZE[0] / 2}) < 30")
            self.assertEqual(page.problems, [])

    def test_readings_are_those_of_the_type_of_the_robot(self):
        world = json.loads(json.dumps(WORLD))
        world["types"]["watcher"] = {**world["types"]["runner"], "color": "gold"}
        world["models"][1]["type"] = "watcher"  # both types have a ranger "eye"
        with self.opened(world=world) as (_, page):
            for name in ("red", "blue", "red"):
                page.run(f"troupe.select('{name}')")
                page.wait("troupe.state().scanned")
            self.assertEqual(page.problems, [])

    def test_a_turn_keeps_the_position(self):
        with self.opened() as (_, page):
            page.wait("troupe.state().time > 2")
            self.pause()
            page.run("troupe.select('red')")
            place = [-3.0004321, -2.0001234]
            page.run(f"troupe.act({{do: 'move', robot: 'red', pose: [{place[0]}, {place[1]}, 0, 1]}})")
            page.wait("troupe.inspected()?.pose[3] === 1")
            self.assertEqual(page.run("troupe.inspected().pose.slice(0, 2)"), place)
            page.press("q", "KeyQ")
            page.wait("troupe.inspected().pose[3] > 1.2")
            self.assertEqual(page.run("troupe.inspected().pose.slice(0, 2)"), place, "it was not rounded to 1 mm")

            page.run("(back => { back.value = Number(back.max) - 1; back.oninput({target: back}); })(document.getElementById('back'))")
            page.wait("document.getElementById('now').textContent.endsWith(' s ago')")
            page.press("e", "KeyE")
            page.wait("!document.getElementById('told').hidden")
            self.assertIn("The page shows the past", self.told())
            self.press_button("#now")
            page.run("troupe.act({do: 'disable', robot: 'blue'})")  # its answer comes after those of all earlier acts
            self.assertEqual(page.run("troupe.inspected().pose.slice(0, 2)"), place)
            self.assertGreater(page.run("troupe.inspected().pose[3]"), 1.2)
            self.assertEqual(page.problems, [])

    def test_bodies_above_the_floor_are_added_and_moved_at_their_height(self):
        world = json.loads(json.dumps(YARD))
        del world["types"]["bot"]["controller"]
        region = [[-4, -4], [4, 4]]
        world["populations"][0] |= {"count": 4, "reserve": 1, "place": {"rule": "grid", "region_m": region, "pitch_m": 4, "z_m": 0.7}}
        with self.opened(world=world) as (_, page):
            self.pause()
            page.run("(add => { add.selectedIndex = 1; add.onchange({target: add}); })(document.getElementById('add'))")
            x, y = page.run("troupe.pose('b0')")[:2]
            page.click(*page.run(f"troupe.screenPlace('b0', [{-x}, {-y}, 0])"))
            page.wait("troupe.state().robots === 5 && troupe.pose('b4')[3] === 0")
            for found, expected in zip(page.run("troupe.pose('b4')"), (0, 0, 0.7)):
                self.assertAlmostEqual(found, expected, delta=0.05)

            page.run("troupe.slant()")
            page.run("troupe.select('b4')")
            page.wait("troupe.inspected()?.robot === 'b4'")
            start, end = (page.run(f"troupe.screenPlace('b4', {shift})") for shift in ([0, 0, 0], [1, -0.5, 0]))
            page.drag(start, end)
            page.wait("Math.abs(troupe.pose('b4')[0]) > 0.5 && troupe.inspected().pose[0] > 0.5")
            for found, expected in zip(page.run("troupe.inspected().pose"), (1, -0.5, 0.7)):
                self.assertAlmostEqual(found, expected, delta=0.05)
            self.assertEqual(page.problems, [])

    def test_of_bodies_with_one_name_only_the_last_is_selected(self):
        world = json.loads(json.dumps({**WORLD, "same_names": "warn"}))
        world["models"][0]["name"] = "blue"
        with self.opened(world=world) as (_, page):
            self.pause()
            self.assertEqual(page.run("troupe.header.robots.name"), ["blue", "blue"])
            page.run("troupe.select('blue')")  # the first
            self.assertEqual(self.told(), 'Several bodies have the name "blue"; only the last of them can be selected.')
            self.assertIsNone(page.run("troupe.state().selected"))
            page.drag((20, 20), (SIZE[0] - 20, SIZE[1] - 120), shift=True)
            page.wait("troupe.group().length === 1")
            page.run("(find => { find.value = 'blue'; find.onchange({target: find}); })(document.getElementById('find'))")
            page.wait("troupe.inspected()?.pose[0] > 0")
            self.assertEqual(page.run("troupe.state().selected"), "blue")
            self.assertEqual(page.problems, [])

    def test_a_world_without_robots_is_shown(self):
        with self.opened(world={"troupe": 1}) as (_, page):
            page.run("troupe.trails(10)")
            frame = page.run("troupe.state().frame")
            page.wait(f"troupe.state().frame > {frame + 5}")
            self.assertEqual(page.run("document.getElementById('scale').innerText"), "2 m")
            self.assertEqual(page.problems, [])

    def test_cards_end_above_the_bars(self):
        long = "n" * 200
        world = json.loads(json.dumps(WORLD).replace("runner", long).replace('"red"', f'"{long}"'))
        world["title"] = long
        with self.opened(world=world) as (_, page):
            edge = "(id, side) => document.getElementById(id).getBoundingClientRect()[side]"
            for width, height in (SIZE, (390, 844), (844, 390), (320, 568)):
                page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
                page.run(f"troupe.select('{long}')")
                page.wait(f"innerWidth === {width} && troupe.inspected()")
                page.run("document.querySelectorAll('#values .plottable').forEach((row, i) => i < 6 && row.click())")
                page.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
                least = "scale" if width < 500 else "tools"  # the panel is as wide as a narrow window
                self.assertLessEqual(page.run(f"({edge})('panel', 'bottom')"), page.run(f"({edge})('{least}', 'top')"), width)
                self.assertEqual(page.run("(({scrollWidth, clientWidth}) => scrollWidth - clientWidth)(document.getElementById('panel'))"), 0)
                self.assertLessEqual(page.run(f"({edge})('corner', 'bottom')"), page.run(f"({edge})('scale', 'top')"), width)
                page.run("troupe.select(null)")
                self.assertLessEqual(page.run(f"({edge})('corner', 'bottom')"), page.run(f"({edge})('scale', 'top')"), width)
                self.assertEqual(page.run("(({scrollWidth, clientWidth}) => scrollWidth - clientWidth)(document.getElementById('corner'))"), 0)
                page.run("document.getElementById('find').value = 'no robot '.repeat(100)")
                page.run("document.getElementById('find').onchange({target: document.getElementById('find')})")
                self.assertGreaterEqual(page.run(f"({edge})('told', 'top')"), 0)
                self.assertLessEqual(page.run(f"({edge})('told', 'bottom')"), page.run(f"({edge})('tools', 'top')"), width)
            self.assertEqual(page.problems, [])

    def test_a_key_drives_only_while_it_is_pressed(self):
        turn = "troupe.inspected()?.components.find(c => c.name === 'velocity').fields.at(-1).values[0]"
        with self.opened("--rate", 5) as (view, page):
            page.run("troupe.select('red')")
            page.press("m", "KeyM")
            page.wait("document.getElementById('drive').checked")
            self.key("keyDown", "ArrowLeft")
            page.wait(f"{turn} === 1.2")
            page.run("document.getElementById('color').focus()")
            self.key("keyUp", "ArrowLeft")
            page.wait(f"{turn} === 0")
            for control in ("color", "drive-speed", "find", "back"):
                page.run(f"document.getElementById('{control}').focus()")
                self.key("keyDown", "ArrowLeft")
                self.key("keyUp", "ArrowLeft")
            page.run("document.getElementById('drive').focus()")  # a checkbox uses no arrow keys
            self.key("keyDown", "ArrowRight")
            page.wait(f"{turn} === -1.2")
            page.run("window.dispatchEvent(new Event('blur'))")
            page.wait(f"{turn} === 0")
            holds = [json.loads(line)["speed"][2] for line in view.session.read_text().split("\n") if '"hold"' in line]
            self.assertEqual(holds, [0, 1.2, 0, -1.2, 0])
            self.assertEqual(page.problems, [])

    def test_an_error_does_not_stop_the_page(self):
        with self.opened("--rate", 0) as (_, page):
            page.run("document.getElementById('time').remove()")
            page.wait("!document.getElementById('problem').hidden")
            self.assertIn("Error in this page", page.run("document.getElementById('problem').textContent"))
            frame, tick = page.run("[troupe.state().frame, troupe.state().tick]")
            page.wait(f"troupe.state().frame > {frame + 5} && troupe.state().tick > {tick + 5}")
            self.assertEqual(len(page.problems), 1, page.problems)

    def test_commands_that_are_not_finite_are_shown(self):
        red = "document.querySelector('[data-command=red]')"
        with self.opened(world=YARD, script=NULL_COMMANDS) as (_, page):
            page.run("troupe.select('b0')")
            page.wait(f"{red}?.value === '–'")
            frame = page.run("troupe.state().frame")
            page.wait(f"troupe.state().frame > {frame + 5}")
            for text in ("–", "", "x", "1,"):
                page.run(f"(input => {{ input.value = '{text}'; input.onchange(); }})({red})")
                self.assertEqual(self.told(), f'The command "red" must be numbers, separated by commas; found "{text}".')
            self.assertEqual(page.problems, [])

    def test_the_past_has_no_commands(self):
        is_shown = "document.querySelector('[data-command=red]')?.closest('details').getClientRects().length > 0"
        with self.opened(world=YARD) as (_, page):
            page.run("troupe.select('b0')")
            page.wait(f"troupe.state().time > 2 && {is_shown}")
            self.pause()
            page.run("(back => { back.value = Number(back.max) - 1; back.oninput({target: back}); })(document.getElementById('back'))")
            page.wait("document.getElementById('now').textContent.endsWith(' s ago')")
            self.assertFalse(page.run(is_shown))
            self.press_button("#now")
            page.wait("document.getElementById('now').textContent === 'now'")
            self.assertTrue(page.run(is_shown))
            self.assertEqual(page.problems, [])

    def test_a_device_without_commands_to_show_is_listed_once(self):
        with self.opened(world=YARD, script=EMPTY_COMMANDS) as (_, page):
            page.run("troupe.select('b0')")
            page.wait("troupe.inspected()")
            frame = page.run("troupe.state().frame")
            page.wait(f"troupe.state().frame > {frame + 5}")
            self.assertEqual(page.run("[...document.querySelectorAll('#values details h3')].length"), 1)

    def test_messages_that_no_request_waits_for(self):
        with self.opened(script=KEPT_SOCKETS) as (_, page):
            self.pause()
            page.run("sockets.at(-1).onmessage({data: JSON.stringify({type: 'refused', id: 7000, reason: 'the recording ends'})})")
            self.assertEqual(self.told(), "the recording ends")
            # A picture that was sent before the program has read that the user plots nothing.
            late = "{...troupe.state(), type: 'state', plot: {measure: 'displacement', column: 'displacement', value: 1}}"
            page.run(f"sockets.at(-1).onmessage({{data: JSON.stringify({late})}})")
            page.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            self.assertEqual(page.run("document.querySelector('#plot .now').textContent"), "")

    def test_the_marks_of_a_group_are_at_the_height_of_the_robots(self):
        world = json.loads(json.dumps(WORLD))
        world["models"][1]["pose"] |= {"y_m": -2, "z_m": 1.5}
        with self.opened(world=world) as (_, page):
            self.pause()
            page.run("troupe.slant()")
            page.drag((20, 20), (SIZE[0] - 20, SIZE[1] - 120), shift=True)
            page.wait("troupe.group().length === 2")
            side = 1.4 * 0.5 * 0.41 ** 0.5  # half a side of the square around the robot, m
            x, y = (round(at) for at in page.run(f"troupe.screenPlace('blue', [{side}, 0.2, 0.3])"))
            picture = Picture(page.screenshot((x - 3, y - 3, x + 4, y + 4)))
            colors = [picture.at(column, row) for column in range(7) for row in range(7)]
            self.assertTrue(any(red > 180 and green < 130 for red, green, _ in colors), colors)

    def test_the_speeds_of_a_paused_world_stay(self):
        with self.opened("--rate", 5) as (_, page):
            # Until the page was open, the robots may have driven anywhere. From here, blue drives in a circle without end.
            page.run("troupe.act({do: 'disable', robot: 'red'})")
            page.run("troupe.act({do: 'move', robot: 'blue', pose: [3, 0, 0, 0]})")
            page.run("troupe.act({do: 'hold', robot: 'blue', speed: [0.3, 0, 0.6]})")
            time_s = page.run("troupe.state().time")
            page.wait(f"troupe.state().time > {time_s + 1}")
            page.run("troupe.color('speed')")
            page.wait("troupe.legend()[1] > 0.2")
            self.pause()
            for robot in ("red", None):  # each makes the program send a picture of the same time
                frame = page.run("troupe.state().frame")
                page.run(f"troupe.select({json.dumps(robot)})")
                page.wait(f"troupe.state().frame > {frame}")
            page.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            heading = page.run("troupe.pose('blue')[3]")
            behind = (-0.15 * math.cos(heading), -0.15 * math.sin(heading), 0.3)  # the mark is at the front
            red, green, blue = self.pixel("blue", behind)
            self.assertGreater(green, 60, (red, green, blue))  # (68, 1, 84): a robot that stands still

    def test_the_scale_of_a_quantity_that_is_the_same_everywhere(self):
        with self.opened() as (_, page):
            page.run("troupe.color('pose.z')")
            page.wait("troupe.legend()[1] === 0")
            page.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            ends = page.run("[...document.querySelectorAll('#legend .ends span')].map(end => end.textContent)")
            self.assertEqual(ends, ["0", "0"])

    def test_messages_have_enough_contrast(self):
        # WCAG 2, success criterion 1.4.3: at least 4.5 for text of this size.
        contrast = """(id) => {
          const luminance = (color) => color.match(/\\d+/g).slice(0, 3).map((byte) => byte / 255)
            .map((share) => (share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4))
            .reduce((sum, share, i) => sum + share * [0.2126, 0.7152, 0.0722][i], 0);
          const { color, backgroundColor } = getComputedStyle(document.getElementById(id));
          const [dark, light] = [luminance(color), luminance(backgroundColor)].sort((a, b) => a - b);
          return (light + 0.05) / (dark + 0.05);
        }"""
        with self.opened() as (_, page):
            for theme in ("light", "dark"):
                page.run(f"troupe.theme('{theme}')")
                for message in ("told", "problem"):
                    self.assertGreater(page.run(f"({contrast})('{message}')"), 4.5, (theme, message))

    def test_large_speeds_have_no_exponent(self):
        with self.opened(script=FAST) as (_, page):
            page.wait("document.getElementById('reached').value !== ''")
            self.assertEqual(page.run("document.getElementById('reached').value"), "7821×")

    def test_the_scale_of_speeds_begins_again(self):
        with self.opened() as (_, page):
            page.run("troupe.color('speed')")
            page.wait("troupe.legend()[1] > 0")
            for attempt in range(100):  # a move of 8 m is seen as a speed of more than 10 m/s, unless pictures come slowly
                page.run(f"troupe.act({{do: 'move', robot: 'red', pose: [{4 - 8 * (attempt % 2)}, -3, 0, 0]}})")
                time_s = page.run("troupe.state().time")
                page.wait(f"troupe.state().time > {time_s + 0.5}")
                if page.run("troupe.legend()[1] > 10"):
                    break
            self.assertGreater(page.run("troupe.legend()[1]"), 10)
            time_s = page.run("troupe.state().time")
            page.wait(f"troupe.state().time > {time_s + 1}")
            page.run("troupe.color('own colours')")
            page.run("troupe.color('speed')")
            page.wait("(([_, most]) => most > 0 && most < 3)(troupe.legend())", 30)

    def test_a_click_on_the_selected_robot_keeps_its_plots(self):
        with self.opened() as (_, page):
            self.pause()
            page.click(*page.run("troupe.screenPlace('red')"))
            page.wait("troupe.inspected()?.robot === 'red'")
            page.run("document.querySelector('#values > .plottable').click()")
            page.click(*page.run("troupe.screenPlace('red')"))
            self.assertEqual(page.run("document.querySelectorAll('#plots .plot').length"), 1)
            page.click(*page.run("troupe.screenPlace('blue')"))
            self.assertEqual(page.run("document.querySelectorAll('#plots .plot').length"), 0)

    def test_the_past_has_no_readings_and_no_links(self):
        world = json.loads(json.dumps(YARD))
        world["populations"][0]["reserve"] = 0
        with self.opened("--rate", 0, world=world) as (_, page):
            page.run("troupe.act({do: 'layers', layers: ['radio']})")
            page.run("troupe.select('b0')")
            page.wait("troupe.lines() > 0 && troupe.state().scanned && troupe.state().time > 2")
            self.pause()
            page.wait("troupe.lines() > 0 && troupe.state().scanned")
            page.run("(back => { back.value = Number(back.max) - 1; back.oninput({target: back}); })(document.getElementById('back'))")
            page.wait("troupe.lines() === 0 && !troupe.state().scanned", 30)
            text = "document.getElementById('panel').innerText"
            self.assertNotIn("velocity", page.run(text))
            self.press_button("#now")
            page.wait("troupe.lines() > 0 && troupe.state().scanned", 30)
            self.assertIn("velocity", page.run(text))

    def test_trails_keep_their_length_at_another_rate(self):
        with self.opened("--rate", 1) as (_, page):
            page.run("troupe.trails(2)")
            # At most 30 pictures per second, so at these rates there is a picture for each 0.1, 1, 0.3, 0.2 and 0.1 s.
            for rate in (1, 30, 8, 5, 3, 1):
                page.run(f"troupe.act({{do: 'rate', rate: {rate}}})")
                begin, first = page.run("[troupe.state().time, troupe.state().frame]")
                page.wait(f"troupe.state().time > {begin + 4 * rate}")
                time_s, frame = page.run("[troupe.state().time, troupe.state().frame]")
                # On a busy machine pictures may come so slowly that a trail of 2 s has fewer than three marks.
                between = (time_s - begin) / (frame - first)
                least, most = (1.6, 2.6) if between < 1.2 else (2 - between, 2 + between)
                page.wait(f"(trail => trail > {least} && trail < {most})(troupe.trail())", 30)
                self.assertLess(page.run("troupe.trail()"), max(4, most), rate)

    def test_all_robots_stay_in_a_window_that_becomes_narrower(self):
        with self.opened() as (_, page):
            self.pause()
            # Until the page was open, the robots may have driven anywhere.
            for robot, x, y in (("red", -4, -1), ("blue", 4, 1)):
                page.run(f"troupe.act({{do: 'move', robot: '{robot}', pose: [{x}, {y}, 0, 0]}})")
                page.wait(f"Math.abs(troupe.pose('{robot}')[0] - {x}) < 1e-2")
            page.run("document.getElementById('follow-all').click()")
            page.wait("troupe.screenPlace('blue')[0] - troupe.screenPlace('red')[0] > 500")
            page.call("Emulation.setDeviceMetricsOverride", width=420, height=SIZE[1], deviceScaleFactor=1, mobile=False)
            page.wait("innerWidth === 420")
            page.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            for name in ("red", "blue"):
                page.wait(f"(([x]) => x > 0 && x < 420)(troupe.screenPlace('{name}'))", 30)

    def test_screen_readers_do_not_read_running_numbers(self):
        with self.opened() as (_, page):
            live = page.run("[...document.querySelectorAll('#time, #reached')].map(output => output.ariaLive)")
            self.assertEqual(live, ["off", "off"])

    def test_robots_far_outside_the_bounds_are_followed(self):
        world = {key: value for key, value in WORLD.items() if key != "bounds_m"}
        with self.opened(world=world) as (_, page):
            self.pause()
            page.run("document.getElementById('follow-all').click()")
            for slanted, x in ((False, 200), (True, 2000)):
                if slanted:
                    page.run("troupe.slant()")
                page.run(f"troupe.act({{do: 'move', robot: 'red', pose: [{x}, 30, 0, 0]}})")
                page.wait(f"Math.abs(troupe.pose('red')[0] - {x}) < 1e-2")
                for name in ("red", "blue"):
                    inside = f"(([x, y]) => x > 0 && y > 0 && x < {SIZE[0]} && y < {SIZE[1]})(troupe.screenPlace('{name}'))"
                    page.wait(inside, 30)
                page.wait("(([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]) > 200)"
                          "(['red', 'blue'].map(name => troupe.screenPlace(name)))", 30)
            self.assertEqual(page.problems, [])

    def test_a_click_while_a_drag_is_unanswered_moves_no_robot(self):
        with self.opened(script=SLOW_ANSWERS) as (view, page):
            self.pause()
            page.run("troupe.select('red')")
            page.wait("troupe.inspected()?.robot === 'red'")
            x, y = page.run("troupe.pose('red')")[:2]
            start, end = (page.run(f"troupe.screenPlace('red', {shift})") for shift in ([0, 0, 0], [-3 - x, -2 - y, 0]))
            page.drag(start, end)
            page.wait("Math.abs(troupe.pose('red')[1] + 2) < 0.05")
            page.click(*end)
            self.assertEqual(page.run("troupe.state().selected"), "red")
            page.run("troupe.step(1)")
            moves = [line for line in view.session.read_text().split("\n") if '"move"' in line]
            self.assertEqual(len(moves), 1, moves)

    def test_a_seed_is_a_whole_number(self):
        with self.opened() as (_, page):
            enter = "(text => { document.getElementById('seed').value = text; document.getElementById('restart').click(); })"
            for text in ("1.5", "-1", "1e3", "18446744073709551616"):
                page.run(f"{enter}('{text}')")
                self.assertEqual(self.told(), f"The seed must be a whole number from 0 to 2^64 - 1, found {text}.")
            for text in ("9007199254740993", "18446744073709551615"):
                page.run(f"{enter}('{text}')")
                page.wait(f"window.troupe?.header.about.seed === '{text}'")
            self.assertEqual(page.problems, [])

    def test_controls_are_operated_by_keyboard(self):
        with self.opened() as (_, page):
            self.pause()
            page.press("Tab")
            page.run("document.getElementById('follow-all').focus()")
            page.press(" ", "Space")
            page.wait("troupe.following()[1]")
            self.assertFalse(page.run("troupe.state().playing"))
            page.run("troupe.select('red')")
            page.wait("document.querySelectorAll('#values .plottable[role=button]').length > 4")
            for count, key in ((1, "Enter"), (0, " ")):
                page.run("document.querySelector('#values > .plottable').focus()")
                page.press(key, "Space" if key == " " else key)
                self.assertEqual(page.run("document.querySelectorAll('#plots .plot').length"), count)
            self.assertFalse(page.run("troupe.state().playing"))
            self.assertEqual(page.problems, [])

    @unittest.skipUnless(HAS_IPV6, "the machine has no IPv6")
    def test_the_page_works_at_an_ipv6_address(self):
        with self.opened("--bind", "::1") as (view, page):
            self.assertTrue(view.address.startswith("http://[::1]:"))
            self.assertEqual(page.problems, [])

    def test_a_page_that_is_refused_says_why_and_tries_again(self):
        with View() as view, Page(PROGRAM, SIZE) as page:
            page.call("Page.addScriptToEvaluateOnNewDocument", source=f"{{{REFUSED_ONCE}}}")
            page.open_address(view.address)
            page.wait("document.getElementById('problem')?.textContent === "
                      "'The program refuses the connection: at most 16 viewers can be connected. The page tries again every 2 s.'")
            page.wait("window.troupe && troupe.state().tick > 2 && document.getElementById('problem').hidden")

    def test_the_address_of_the_next_run_can_be_opened_in_the_same_page(self):
        with Page(PROGRAM, SIZE) as page:
            with View() as view:
                page.open_address(view.address)
                page.wait("window.troupe && troupe.state().tick > 2")
            with View("--port", view.port) as view:
                page.wait("document.getElementById('problem').textContent.startsWith('This address has no valid token')")
                page.open_address(view.address)
                page.wait("window.troupe && troupe.state().tick > 2 && document.getElementById('problem').hidden")

    def test_a_page_that_loses_its_connection_is_reloaded_once(self):
        with self.opened(script=KEPT_SOCKETS) as (_, page):
            page.run("window.isOld = true, performance.now = () => 1e6, sockets.at(-1).close()")
            page.wait("document.getElementById('problem')?.textContent.startsWith('The program has ended')")
            page.wait("!window.isOld && window.troupe && troupe.state().tick > 2")
            page.run("window.isOld = true, performance.now = () => 1e3, sockets.at(-1).close()")
            page.wait("document.getElementById('problem').textContent.startsWith('The connection to the program was lost soon')")
            self.assertTrue(page.run("window.isOld"))

    def test_layers_and_colours_are_drawn(self):
        with self.opened("--rate", 0, world=YARD) as (_, page):
            self.pause()
            self.assertEqual(page.run("troupe.lines()"), 0)
            page.run("(select => { select.selectedIndex = 1; select.onchange({target: select}); })(document.getElementById('layers'))")
            page.wait("troupe.lines() > 0")
            page.wait("troupe.state().lines.radio.length > 0")
            line = page.run("troupe.state().lines.radio.slice(0, 6)")
            names = page.run("troupe.header.robots.name")
            x, y, z = page.run(f"troupe.pose('{names[0]}')")[:3]
            middle = [(line[0] + line[3]) / 2 - x, (line[1] + line[4]) / 2 - y, (line[2] + line[5]) / 2 - z]
            drawn = self.pixel(names[0], middle)
            page.press("l", "KeyL")  # all lines; there are no others
            page.press("l", "KeyL")  # none
            page.wait("troupe.lines() === 0")
            until = time.monotonic() + WAIT_S
            while self.pixel(names[0], middle) == drawn and time.monotonic() < until:
                pass
            self.assertNotEqual(self.pixel(names[0], middle), drawn, "a link was drawn between two robots")

            left, right = sorted(names, key=lambda name: page.run(f"troupe.pose('{name}')[0]"))[::len(names) - 1]
            own = self.pixel(left)
            page.run(f"troupe.act({{do: 'command', robot: '{left}', device: 'lamp', values: {{red: 1, green: 0, blue: 0, shows: 1}}}})")
            page.run("troupe.step(1)")
            self.paused()
            until = time.monotonic() + WAIT_S
            while self.pixel(left) == own and time.monotonic() < until:
                pass
            red, green, blue = self.pixel(left)
            self.assertTrue(red > 150 and green < 90 and blue < 90, (red, green, blue))

            page.run("troupe.color('pose.x')")
            page.wait("troupe.legend()[1] > troupe.legend()[0]")
            until = time.monotonic() + WAIT_S
            while self.pixel(left)[0] > 150 and time.monotonic() < until:
                pass
            ends = [self.pixel(left), self.pixel(right)]
            self.assertGreater(sum(abs(a - b) for a, b in zip(*ends)), 100, ends)
            self.assertEqual(page.problems, [])

    def test_parts_have_the_colours_that_they_show(self):
        mast = {"name": "mast", "size_m": [0.5, 0.5, 0.1], "pose": {"z_m": 0.2},
                "devices": [{"name": "lamp", "kind": "led", "shows": [0, 0.6, 0.2]}]}
        spot = {"name": "spot", "size_m": [0.015, 0.015, 0.01], "pose": {"x_m": 0.4, "z_m": 0.2},
                "devices": [{"name": "spot", "kind": "led", "shows": [0, 1, 0]}]}
        world = {"troupe": 1, "bounds_m": [[-2, -2], [2, 2]],
                 "types": {"bot": {"size_m": [1, 1, 0.2], "color": [0.1, 0.2, 0.8], "drive": {"kind": "diff"}, "parts": [mast, spot]},
                           "plain": {"size_m": [0.5, 0.5, 0.2], "color": [0.1, 0.2, 0.8], "drive": {"kind": "diff"}}},
                 "models": [{"name": "b", "type": "bot", "pose": {"x_m": 1}}, {"name": "p", "type": "plain", "pose": {"x_m": -1}},
                            {"name": "a", "type": "bot", "pose": {"x_m": -1, "y_m": 1}}]}
        with self.opened("--rate", 0, world=world) as (_, page):
            self.pause()

            def wait_for(name, shift, expected):
                until = time.monotonic() + WAIT_S
                while (found := self.pixel(name, shift)) != expected and time.monotonic() < until:
                    pass
                self.assertEqual(found, expected, name)

            top = (-0.12, -0.12, 0.3)
            wait_for("a", top, (0, 153, 51))
            wait_for("b", top, (0, 153, 51))
            page.run("troupe.act({do: 'command', robot: 'b', device: 'lamp', values: {red: 1, green: 0, blue: 0, shows: 1}})")
            page.run("troupe.step(1)")
            self.paused()
            wait_for("b", top, (255, 0, 0))
            wait_for("a", top, (0, 153, 51))
            x, y = (round(at) for at in page.run("troupe.screenPlace('a', [0.4, 0, 0.21])"))
            picture = Picture(page.screenshot((x - 5, y - 5, x + 5, y + 5)))
            near = [picture.at(column, row) for column in range(10) for row in range(10)]
            self.assertIn((0, 255, 0), near, "the small part has its colour")
            self.assertNotIn((0, 153, 0), near, "no edges, which are darker, hide the colour of the small part")
            for name, shift in (("a", (-0.4, -0.4, 0.2)), ("b", (-0.4, -0.4, 0.2)), ("p", (-0.12, -0.12, 0.2))):
                self.assertEqual(self.pixel(name, shift), (26, 51, 204), name)
            self.assertEqual(page.problems, [])

    def test_a_tablet_is_touched(self):
        with self.opened(size=(1024, 768), touch=True) as (_, page):
            page.touch(self.center("#play"))
            self.paused()
            page.touch(page.run("troupe.screenPlace('red')"))
            page.wait("troupe.inspected()?.robot === 'red'")
            x, y = page.run("troupe.pose('red')")[:2]
            begin, end = (page.run(f"troupe.screenPlace('red', {shift})") for shift in ([0, 0, 0], [-3 - x, -2.5 - y, 0]))
            page.touch(*([a + (b - a) * i / 6 for a, b in zip(begin, end)] for i in range(7)))
            page.wait("Math.abs(troupe.pose('red')[0] + 3) < 0.05 && Math.abs(troupe.pose('red')[1] + 2.5) < 0.05")
            self.assertEqual(page.problems, [])

    def test_one_may_only_look(self):
        with View() as view, Page(PROGRAM, SIZE) as page:
            page.open_address(view.looking)
            page.wait("window.troupe")
            self.assertEqual(page.run("getComputedStyle(document.getElementById('play')).display"), "none")
            with view.open():
                page.wait("troupe.state().tick > 3")


if __name__ == "__main__":
    View.program = str(Path(sys.argv.pop(1)).resolve())
    if len(sys.argv) > 1 and "/" in sys.argv[1]:
        PICTURES = Path(sys.argv.pop(1)).resolve()
        PICTURES.mkdir(parents=True, exist_ok=True)
    unittest.main()

"""Tests of physical statements: symmetries of sensors and motions, energy, and statistics of noise, losses and failures."""

import math
import unittest

import numpy as np
import troupe

SPREAD = 4.5  # standard errors within which a mean must be; the seeds are fixed, so that a test always has the same result


class Frame:
    """A change of the world: a reflection in the x axis if `mirror` is -1, then a rotation by `turn` about the origin, then a
    translation by `shift`."""

    def __init__(self, mirror=1, turn=0.0, shift=(0.0, 0.0)):
        self.mirror, self.turn, self.shift = mirror, turn, shift

    def pose(self, x, y, heading):
        c, s = math.cos(self.turn), math.sin(self.turn)
        y, heading = self.mirror * y, self.mirror * heading
        return x * c - y * s + self.shift[0], x * s + y * c + self.shift[1], heading + self.turn

    def model(self, name, kind, x, y, degrees=0.0, **keys):
        x, y, heading = self.pose(x, y, math.radians(degrees))
        return {"name": name, "type": kind, "pose": {"x_m": x, "y_m": y, "heading_rad": heading}, **keys}


SAME = Frame()
MOVED = Frame(turn=math.radians(37), shift=(3.1, -2.7))
QUARTER = Frame(turn=math.pi / 2, shift=(-1.3, 0.4))
MIRRORED = Frame(mirror=-1)


def wrapped(angle):
    return np.arctan2(np.sin(angle), np.cos(angle))


# ---- symmetries of sensors

COLUMNS, ROWS, BLOB_COLUMNS, DIRECTIONS, SONARS = 24, 16, 61, 7, 8


def observer(m):
    """A type of robots with every kind of sensor. m: -1 mirrors the sensors."""

    def pose(x=0.0, y=0.0, degrees=0.0, z=0.1):
        return {"x_m": x, "y_m": m * y, "z_m": z, "heading_deg": m * degrees}

    fan = {"pose": pose(degrees=10, z=0), "range_max_m": 4, "fov_deg": 200, "samples": 41}
    sonar = {"ring": {"count": SONARS, "radius_m": 0.1}, "range_max_m": 3, "beam_width_deg": 30}
    return {
        "size_m": [0.3, 0.2, 0.3],
        "drive": {"kind": "omni"},
        "sensors": [
            {"name": "scan", "kind": "ranger", "pose": pose(0.05, 0.02), "transducers": [fan], "intensity": True},
            {"name": "sonars", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [sonar]},
            {"name": "finder", "kind": "fiducial", "pose": pose(0.1, -0.03, 25), "fov_deg": 240, "range_max_m": 4},
            {"name": "blobs", "kind": "blobfinder", "pose": pose(0.1, 0.01), "image_width": BLOB_COLUMNS, "fov_deg": 200,
             "pan_deg": 20 * m, "range_m": 5},
            {"name": "lights", "kind": "light_sensor", "pose": pose(-0.02, 0.04, 15, 0.3), "directions": DIRECTIONS},
            {"name": "floor", "kind": "ground", "pose": pose(0.01, 0.02, 5),
             "points_m": [0, 0, 0.3, 0.15 * m, -0.2, 0.4 * m, -0.4, -0.3 * m]},
            {"name": "skin", "kind": "bumper", "thickness_m": 0.5,
             "bumpers": [{"pose": pose(0.15, 0.05, 20, 0), "length_m": 0.2},
                         {"pose": pose(0.0, -0.1, -90, 0), "length_m": 0.3},
                         {"pose": pose(-0.15, 0.0, 180, 0), "length_m": 0.2}]},
            {"name": "level", "kind": "camera", "pose": pose(0.1, -0.01, -20, 0.3), "width": COLUMNS, "height": ROWS},
            # The parameter `pan` of a camera is positive to the right.
            {"name": "tilted", "kind": "camera", "pose": pose(0.1, 0.02, 30, 0.3), "width": COLUMNS, "height": ROWS,
             "pan_deg": 15 * m, "tilt_deg": -5},
            {"name": "north", "kind": "compass", "pose": pose(degrees=50), "declination_deg": 3 * m},
            {"name": "radio", "kind": "radio", "pose": pose(0.03, 0.04, 40, 0.2), "range_m": 2.5, "bodies": "block"},
        ],
    }


def seen(frame, has_zones):
    """Returns all readings of a robot in a world that `frame` changes, by sensor and field."""
    post = {"size_m": [0.3, 0.2, 1], "fiducial_return": 1}
    beacon = {
        "size_m": [0.2, 0.16, 0.3],
        "drive": {"kind": "diff"},
        "sensors": [{"name": "radio", "kind": "radio", "pose": {"z_m": 0.2}, "beacon": True}],
        "devices": [{"name": "lamp", "kind": "blinkenlight", "pose": {"z_m": 0.4}, "intensity": 2}],
    }
    places = [(1.1, 0.3, 10), (0.9, 1.2, 30), (1.7, -0.9, -20), (-0.8, 0.75, 70), (0.2, -0.55, 15), (-1.2, -0.7, 40)]
    colors = ["red", "blue", "yellow", "cyan", "orange", "purple"]
    models = [frame.model(f"post{i}", "post", *place, color=color, fiducial_return=i + 3)
              for i, (place, color) in enumerate(zip(places, colors))]
    models += [frame.model(f"beacon{i}", "beacon", *place)
               for i, place in enumerate([(0.6, 0.7, 20), (-1.5, 0.4, -30), (0.8, -1.1, 80), (2.3, 0.45, 5)])]
    if has_zones:
        models += [frame.model(f"zone{i}", "zone", *place, color=color)
                   for i, (place, color) in enumerate([((0.3, 0.2, 25), "green"), ((-0.1, 0.3, 50), "brown")])]
    world = {
        "troupe": 1,
        "types": {
            "post": post,
            "beacon": beacon,
            "zone": {"size_m": [0.5, 0.3, 0.002], "obstacle": False, "ranger_return": -1},
            "robot": observer(frame.mirror),
        },
        "models": [*models, frame.model("robot", "robot", 0.1, 0.05, 25)],
    }
    simulation = troupe.Simulation(world, threads=1)
    simulation.step(3)
    robot = simulation.find("robot")
    return {(sensor["name"], field.name): robot.readings(field.name, sensor["name"]).copy()
            for sensor in world["types"]["robot"]["sensors"] for field in robot.fields(sensor["name"])}


def mirror_image(readings):
    """The readings of the mirrored robot in the mirrored world."""
    image = dict(readings)
    for field in ("ranges", "intensities"):
        image["scan", field] = readings["scan", field][::-1]
    image["sonars", "ranges"] = readings["sonars", "ranges"][-np.arange(SONARS) % SONARS]
    image["lights", "brightness"] = readings["lights", "brightness"][-np.arange(DIRECTIONS) % DIRECTIONS]
    for sensor, field in (("finder", "bearing"), ("finder", "heading"), ("north", "heading"), ("radio", "bearing")):
        image[sensor, field] = -readings[sensor, field]
    for camera in ("level", "tilted"):
        for field, values in (("color", 4), ("depth", 1)):
            image[camera, field] = readings[camera, field].reshape(ROWS, COLUMNS, values)[:, ::-1].ravel()
    blobs = int(readings["blobs", "count"][0])
    for field in ("left", "right", "top", "bottom", "range", "color"):
        mirrored = {"left": "right", "right": "left"}.get(field, field)
        values = readings["blobs", mirrored].reshape(len(readings["blobs", "range"]), -1).copy()
        values[:blobs] = values[:blobs][::-1]
        if mirrored != field:
            values[:blobs] = BLOB_COLUMNS - 1 - values[:blobs]
        image["blobs", field] = values.ravel()
    return image


class SymmetryOfSensors(unittest.TestCase):
    def check(self, found, expected, but=()):
        for key, values in expected.items():
            if key in but:
                continue
            tolerance = 1e-5 if values.dtype.kind == "f" else 0
            np.testing.assert_allclose(found[key], values, rtol=0, atol=tolerance, err_msg=str(key))

    def test_every_sensor_reads_something(self):
        readings = seen(SAME, has_zones=True)
        self.assertGreater(readings["finder", "count"][0], 2)
        without_zones = seen(SAME, has_zones=False)
        self.assertGreater(without_zones["blobs", "count"][0], 3)
        self.assertEqual(without_zones["skin", "hit"].tolist(), [0, 1, 1])
        self.assertGreater(readings["radio", "count"][0], 1)
        self.assertLess(readings["radio", "count"][0], 4)  # others are hidden or out of range
        self.assertGreater(readings["lights", "sources"][0], 1)
        self.assertEqual(len(set(readings["floor", "body"].tolist())), 3)
        for camera in ("level", "tilted"):
            self.assertGreater(len(np.unique(readings[camera, "depth"])), 10)
        self.assertTrue(np.any(readings["scan", "ranges"] < 4) and np.any(readings["sonars", "ranges"] < 3))

    def test_a_rotation_of_the_world_changes_no_reading(self):
        for has_zones in (False, True):
            expected = seen(SAME, has_zones)
            for frame in (MOVED, QUARTER):
                found = seen(frame, has_zones)
                self.check(found, expected, but=[("finder", "pose"), ("north", "heading")])
                turned = found["north", "heading"] - expected["north", "heading"]
                np.testing.assert_allclose(wrapped(turned), frame.turn, atol=1e-9)
                poses = [found["finder", "pose"].reshape(-1, 4), expected["finder", "pose"].reshape(-1, 4)]
                for one, other in zip(*poses) if expected["finder", "count"][0] else ():
                    if not other.any():
                        continue  # an entry without a target
                    x, y, heading = frame.pose(other[0], other[1], other[3])
                    np.testing.assert_allclose(one[:2], (x, y), atol=1e-9)
                    self.assertAlmostEqual(wrapped(one[3] - heading), 0, places=9)

    def test_a_mirror_image_of_the_world_gives_the_mirror_image_of_the_readings(self):
        for has_zones in (False, True):
            self.check(seen(MIRRORED, has_zones), mirror_image(seen(SAME, has_zones)), but=[("finder", "pose")])


# ---- symmetries of motions


def driven(frame, kind, mode, localization="gps"):
    """Returns the poses and the estimated poses of a robot that follows one command for 8 s in a world that `frame` changes."""
    m = frame.mirror
    world = {
        "troupe": 1,
        "types": {
            "wall": {"size_m": [0.2, 3, 1]},
            "robot": {
                "size_m": [0.3, 0.2, 0.3],
                "drive": {"kind": kind, "localization": localization, "odom_error": [0.1, -0.05, 0.02],
                          **({"wheelbase_m": 0.4} if kind == "car" else {})},
            },
        },
        "models": [frame.model("wall", "wall", 1.4, 0.3, 25), frame.model("robot", "robot", 0.1, -0.2, 20)],
    }
    simulation = troupe.Simulation(world, threads=1)
    robot = simulation.find("robot")
    if mode == "velocity":
        robot.set_speed(0.31, 0.23 * m, left=0.11 * m)
    elif mode == "acceleration":
        robot.accelerate(0.13, 0.17 * m, left=-0.07 * m)
    else:
        goal = (-0.7, 1.1, 2.3)
        # Odometry without an origin has a frame of its own, which starts at the robot.
        robot.go_to(frame.pose(*goal) if localization == "gps" else (goal[0], m * goal[1], m * goal[2]))
    tracks = [], []
    for _ in range(80):
        simulation.step()
        for track, pose in zip(tracks, (robot.pose(), robot.estimate())):
            track.append((pose.x, pose.y, pose.heading))
    return np.array(tracks[0]), np.array(tracks[1])


class SymmetryOfMotions(unittest.TestCase):
    def assert_same_path(self, found, path, frame):
        expected = np.array([frame.pose(*pose) for pose in path])
        np.testing.assert_allclose(found[:, :2], expected[:, :2], atol=1e-9)
        np.testing.assert_allclose(wrapped(found[:, 2] - expected[:, 2]), 0, atol=1e-9)

    def test_drives_have_no_preferred_direction_and_no_preferred_side(self):
        for kind in ("diff", "omni", "car"):
            for mode in ("velocity", "acceleration", "position"):
                for localization in ("gps", "odom"):
                    path, estimates = driven(SAME, kind, mode, localization)
                    self.assertGreater(np.ptp(path[:, 2]), 0.1)
                    # Whether a robot has arrived is decided along the axes of the frame of the estimate.
                    is_square = mode == "position" and localization == "gps"
                    for frame in (QUARTER, MIRRORED) if is_square else (MOVED, QUARTER, MIRRORED):
                        with self.subTest(kind=kind, mode=mode, localization=localization, frame=vars(frame)):
                            moved, estimated = driven(frame, kind, mode, localization)
                            self.assert_same_path(moved, path, frame)
                            own = frame if localization == "gps" else Frame(mirror=frame.mirror)
                            self.assert_same_path(estimated, estimates, own)

    def test_pushed_bodies_have_no_preferred_direction_and_no_preferred_side(self):
        def pushed(frame):
            world = {
                "troupe": 1,
                "types": {
                    "puck": {"disc": {"radius_m": 0.06, "height_m": 0.1}, "pushable": True},
                    "robot": {"size_m": [0.3, 0.24, 0.2], "drive": {"kind": "diff"}},
                },
                "models": [frame.model(f"puck{i}", "puck", *place)
                           for i, place in enumerate([(0.35, 0.05, 5), (0.5, 0.11, 40), (0.75, 0.22, 17)])]
                + [frame.model("robot", "robot", 0, 0, 4)],
            }
            simulation = troupe.Simulation(world, threads=1)
            simulation.find("robot").set_speed(0.2, 0.1 * frame.mirror)
            simulation.step(60)
            poses = [simulation.find(name).pose() for name in ("puck0", "puck1", "puck2", "robot")]
            return np.array([(pose.x, pose.y, pose.heading) for pose in poses])

        places = pushed(SAME)
        self.assertGreater(np.ptp(places[:3, 0]), 0.1)
        self.assertTrue(np.all(places[:3, 0] > 0.9), "every puck is pushed")
        for frame in (MOVED, QUARTER, MIRRORED):
            self.assert_same_path(pushed(frame), places, frame)

    def test_a_gripper_has_no_preferred_direction_and_no_preferred_side(self):
        def gripped(frame):
            world = {
                "troupe": 1,
                "types": {
                    "puck": {"disc": {"radius_m": 0.04, "height_m": 0.1}, "gripper_return": True},
                    "robot": {"size_m": [0.3, 0.24, 0.2], "drive": {"kind": "diff"}, "devices": [
                        {"name": "hand", "kind": "gripper", "pose": {"x_m": 0.3}, "autosnatch": True}]},
                },
                "models": [frame.model("puck", "puck", 0.55, 0.03, 10), frame.model("robot", "robot", 0, 0, 4)],
            }
            simulation = troupe.Simulation(world, threads=1)
            simulation.find("robot").set_speed(0.1, 0.05 * frame.mirror)
            simulation.step(80)
            self.assertEqual(simulation.find("robot").readings("held", "hand")[0], simulation.find("puck").id + 1)
            poses = [simulation.find(name).pose() for name in ("puck", "robot")]
            return np.array([(pose.x, pose.y, pose.heading) for pose in poses])

        places = gripped(SAME)
        self.assertGreater(places[0, 0], 0.7)
        for frame in (MOVED, QUARTER, MIRRORED):
            self.assert_same_path(gripped(frame), places, frame)


class Kinematics(unittest.TestCase):
    """docs/driving.md, Motion within a tick."""

    SPEED, TURN, SECONDS = 0.5, 1.0, 20.0

    def path(self, tick_s, side):
        world = {
            "troupe": 1,
            "tick_s": tick_s,
            "types": {"robot": {"size_m": [0.3, 0.2, 0.3], "drive": {"kind": "diff"}}},
            "models": [{"name": "robot", "type": "robot"}],
        }
        simulation = troupe.Simulation(world, threads=1)
        robot = simulation.find("robot")
        robot.set_speed(self.SPEED, side * self.TURN)
        places = []
        for _ in range(round(self.SECONDS / tick_s)):
            simulation.step()
            places.append((robot.pose().x, robot.pose().y))
        return np.array(places)

    def test_a_circle_is_a_polygon_that_deviates_by_the_way_of_a_tick(self):
        for side in (1, -1):
            deviations = []
            for tick_s in (0.1, 0.05):
                places = self.path(tick_s, side)
                half = self.TURN * tick_s / 2
                radius = self.SPEED * tick_s / (2 * math.sin(half))
                centre = radius * np.array([math.sin(half), side * math.cos(half)])
                np.testing.assert_allclose(np.hypot(*(places - centre).T), radius, atol=1e-9)
                angle = self.TURN * tick_s * np.arange(1, len(places) + 1)
                exact = self.SPEED / self.TURN * np.array([np.sin(angle), side * (1 - np.cos(angle))]).T
                deviations.append(np.hypot(*(places - exact).T).max())
                self.assertLess(deviations[-1], 1.01 * self.SPEED * tick_s)
            self.assertAlmostEqual(deviations[0] / deviations[1], 2, delta=0.05)
        self.assertAlmostEqual(radius / (self.SPEED / self.TURN), 1 + half**2 / 6, places=6)


# ---- energy


class Energy(unittest.TestCase):
    def test_what_a_pack_loses_is_drawn_or_given_and_what_it_gains_was_given(self):
        for tick_s in (0.1, 0.025):
            world = {
                "troupe": 1,
                "tick_s": tick_s,
                "types": {
                    "dock": {"size_m": [0.2, 0.2, 0.2], "devices": [
                        {"name": "pack", "kind": "power_pack", "capacity_J": 25},
                        {"name": "contact", "kind": "power_contact", "give_W": 4}]},
                    "robot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "omni"}, "devices": [
                        {"name": "pack", "kind": "power_pack", "capacity_J": 10, "stored_J": 4, "mass_kg": 0.1, "draw_W": 0.2},
                        {"name": "contact", "kind": "power_contact", "give_W": 3, "take_W": 2}]},
                },
                "models": [
                    {"name": "dock", "type": "dock", "pose": {"x_m": -0.21}},
                    *({"name": f"r{i}", "type": "robot", "pose": {"x_m": 0.21 * i}} for i in range(5)),
                ],
            }
            simulation = troupe.Simulation(world, threads=1)
            names = ["dock", *(f"r{i}" for i in range(5))]
            models = [simulation.find(name) for name in names]
            starts = [model.energy()["stored_j"] for model in models]
            self.assertEqual(starts, [25, 4, 4, 4, 4, 4])
            models[-1].set_speed(0.02, 0.1)  # the last robot leaves the others
            is_empty = False
            for _ in range(round(40 / tick_s)):
                simulation.step()
                energies = [model.energy() for model in models]
                for start, energy in zip(starts, energies):
                    balance = start + energy["received_j"] - energy["given_j"] - energy["dissipated_j"]
                    self.assertAlmostEqual(energy["stored_j"], balance, places=9)
                    self.assertGreaterEqual(energy["stored_j"], 0)
                    self.assertLessEqual(energy["stored_j"], energy["capacity_j"])
                    is_empty = is_empty or energy["stored_j"] == 0
                given, received = (sum(energy[key] for energy in energies) for key in ("given_j", "received_j"))
                self.assertAlmostEqual(given, received, places=9)
            self.assertTrue(is_empty and given > 20)


# ---- statistics


def uncorrelated(test, a, b, what):
    """Fails if the mean product of two arrays of standardised numbers is not 0 within SPREAD standard errors."""
    test.assertLess(abs(np.mean(a * b)), SPREAD / math.sqrt(a.size), what)


class Noise(unittest.TestCase):
    ROBOTS, TICKS, DISTANCE = 30, 200, 4.0

    def simulation(self, transducer, compass_rad=0.1):
        sensors = [{"name": name, "kind": "ranger", "pose": {"z_m": 0.1},
                    "transducers": [{"range_max_m": 30, "fov_deg": 0, "samples": 2, **transducer}]} for name in ("a", "b")]
        sensors += [{"name": name, "kind": "compass", "noise_stddev_rad": compass_rad} for name in ("n", "m")]
        return troupe.Simulation({
            "troupe": 1,
            "types": {"wall": {"size_m": [0.2, 80, 1]},
                      "robot": {"size_m": [0.1, 0.1, 0.2], "drive": {"kind": "diff"}, "sensors": sensors}},
            "models": [{"name": "wall", "type": "wall", "pose": {"x_m": self.DISTANCE + 0.1}}],
            "populations": [{"name": "r", "type": "robot", "count": self.ROBOTS,
                             "place": {"rule": "grid", "region_m": [[0, -6], [0, 6]], "pitch_m": 0.4}}],
        }, threads=1)

    def readings(self, simulation):
        """Arrays [tick, robot, reading] of the ranges of both rangers, and arrays [tick, robot] of the headings."""
        swarm = simulation.swarm("r")
        out = {name: [] for name in "abnm"}
        for _ in range(self.TICKS):
            simulation.step()
            for name in "ab":
                out[name].append(swarm.ranges(name))
            for name in "nm":
                out[name].append(swarm.readings("heading", name))
        return {name: np.array(values, dtype=float) for name, values in out.items()}

    def check_normal(self, errors, deviation):
        n = errors.size
        self.assertLess(abs(errors.mean()), SPREAD * deviation / math.sqrt(n))
        self.assertLess(abs((errors**2).mean() / deviation**2 - 1), SPREAD * math.sqrt(2 / n))
        self.assertLess(abs((errors**4).mean() / deviation**4 - 3), SPREAD * math.sqrt(96 / n))

    def test_noise_is_independent_of_that_of_other_sensors_beams_robots_ticks_and_seeds(self):
        simulation = self.simulation({"noise_stddev_m": 0.1})
        errors = self.readings(simulation)
        for name in "ab":
            errors[name] = (errors[name] - self.DISTANCE) / 0.1
        for name in "nm":
            errors[name] = errors[name].reshape(self.TICKS, self.ROBOTS, 1) / 0.1
        for values in errors.values():
            self.check_normal(values, 1)
        for one, other in ("ab", "nm", "an", "bm"):
            beams = min(errors[one].shape[2], errors[other].shape[2])
            uncorrelated(self, errors[one][:, :, :beams], errors[other][:, :, :beams], f"sensors {one} and {other}")
        uncorrelated(self, errors["a"][:, :, 0], errors["a"][:, :, 1], "beams of one ranger")
        for name, values in errors.items():
            uncorrelated(self, values[:, 1:], values[:, :-1], f"robots, {name}")
            uncorrelated(self, values[1:], values[:-1], f"ticks, {name}")
        simulation.reset(2)
        again = self.readings(simulation)
        uncorrelated(self, (again["a"] - self.DISTANCE) / 0.1, errors["a"], "seeds, a")
        uncorrelated(self, again["n"] / 0.1, errors["n"][:, :, 0], "seeds, n")
        simulation.reset(1)
        np.testing.assert_array_equal((self.readings(simulation)["a"] - self.DISTANCE) / 0.1, errors["a"])

    def test_the_three_errors_of_a_reading_are_independent(self):
        noise = {"noise_stddev_m": 0.05, "noise_relative": 0.02, "noise_proportional": 0.03}
        errors = self.readings(self.simulation(noise))["a"] - self.DISTANCE
        r = self.DISTANCE
        variance = 0.05**2 + (0.02 * r) ** 2 + (0.03 * r) ** 2 / 3
        self.assertLess(abs(errors.mean()), SPREAD * math.sqrt(variance / errors.size))
        self.assertLess(abs((errors**2).mean() / variance - 1), SPREAD * math.sqrt(2 / errors.size))
        only = self.readings(self.simulation({"noise_relative": 0.02}))["a"] - self.DISTANCE
        self.check_normal(only, 0.02 * r)

    def test_angular_noise_is_uniform_and_turns_as_often_to_the_left_as_to_the_right(self):
        bound, heading = 0.3, math.radians(45)
        simulation = self.simulation({"noise_angular_rad": bound, "pose": {"heading_rad": heading}})
        errors = {name: np.arccos(self.DISTANCE / values) - heading
                  for name, values in self.readings(simulation).items() if name in "ab"}
        deviation = bound / math.sqrt(3)
        for values in errors.values():
            self.assertLessEqual(np.abs(values).max(), bound + 1e-6)
            quarters = np.histogram(values, bins=4, range=(-bound - 1e-6, bound + 1e-6))[0] / values.size
            self.assertLess(np.abs(quarters - 0.25).max(), SPREAD * math.sqrt(0.25 * 0.75 / values.size))
            values /= deviation
            uncorrelated(self, values[:, :, 0], values[:, :, 1], "beams")
            uncorrelated(self, values[:, 1:], values[:, :-1], "robots")
            uncorrelated(self, values[1:], values[:-1], "ticks")
        uncorrelated(self, errors["a"], errors["b"], "sensors")


class Losses(unittest.TestCase):
    def test_messages_are_dropped_independently_of_one_another(self):
        robots, ticks, rate = 12, 300, 0.3
        radios = [{"name": name, "kind": "radio", "range_m": 50, "channel": name, "beacon": True, "drop_rate": rate,
                   "most_heard": robots} for name in ("a", "b")]
        simulation = troupe.Simulation({
            "troupe": 1,
            "types": {"robot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "sensors": radios}},
            "populations": [{"name": "r", "type": "robot", "count": robots,
                             "place": {"rule": "grid", "region_m": [[0, 0], [0, 10]], "pitch_m": 0.5}}],
        }, threads=1)
        swarm = simulation.swarm("r")
        simulation.step()
        index = {int(body): i for i, body in enumerate(swarm.ids)}
        arrived = {name: np.zeros((ticks, robots, robots)) for name in "ab"}  # tick, listener, sender
        for tick in range(ticks):
            simulation.step()
            for name, table in arrived.items():
                senders, counts = swarm.readings("sender", name), swarm.readings("count", name)
                for i in range(robots):
                    for body in senders[i][:counts[i]]:
                        table[tick, i, index[int(body)]] = 1
        pairs = ~np.eye(robots, dtype=bool)
        scale = math.sqrt(rate * (1 - rate))
        a, b = ((table - (1 - rate)) / scale for table in arrived.values())
        for table in (a, b):
            self.assertLess(abs(table[:, pairs].mean()), SPREAD / math.sqrt(ticks * pairs.sum()))
        upper = np.triu(pairs)
        uncorrelated(self, a[:, upper], a.transpose(0, 2, 1)[:, upper], "the two directions of a link")
        uncorrelated(self, a[1:, pairs], a[:-1, pairs], "ticks")
        uncorrelated(self, a[:, pairs], b[:, pairs], "radios of a robot")
        others = upper[1:, 2:] & pairs[:-1, 2:]
        uncorrelated(self, a[:, 1:, 2:][:, others], a[:, :-1, 2:][:, others], "listeners of one sender")
        uncorrelated(self, a.transpose(0, 2, 1)[:, 1:, 2:][:, others], a.transpose(0, 2, 1)[:, :-1, 2:][:, others],
                     "senders that one radio hears")


class Failures(unittest.TestCase):
    ROBOTS = 2000

    def out(self, tick_s, seconds, fault):
        """The fraction of the robots that a fault drop_out has stopped after a time."""
        simulation = troupe.Simulation({
            "troupe": 1,
            "tick_s": tick_s,
            "types": {"robot": {"size_m": [0.1, 0.1, 0.1], "drive": {"kind": "diff"}}},
            "populations": [{"name": "r", "type": "robot", "count": self.ROBOTS,
                             "place": {"rule": "grid", "region_m": [[0, 0], [10, 10]], "pitch_m": 0.2}}],
            "faults": [{"population": "r", "drop_out": fault}],
        }, threads=1)
        simulation.run_for(seconds)
        return np.count_nonzero(simulation.table("condition")["out"]) / self.ROBOTS

    def test_a_rate_is_per_second_whatever_the_length_of_a_tick(self):
        for tick_s in (0.5, 0.1, 0.05):
            expected = 1 - math.exp(-0.1 * 10)
            margin = SPREAD * math.sqrt(expected * (1 - expected) / self.ROBOTS)
            # A failure occurs in the first tick that begins at its time or later.
            self.assertAlmostEqual(self.out(tick_s, 10 + tick_s, {"rate_per_s": 0.1}), expected, delta=margin)
            works_s = tick_s / (1 - math.exp(-0.5 * tick_s))  # 2 s on average, rounded up to whole ticks
            expected = 1 / (1 + works_s)
            margin = SPREAD * math.sqrt(expected * (1 - expected) / self.ROBOTS)
            self.assertAlmostEqual(self.out(tick_s, 30, {"rate_per_s": 0.5, "for_s": 1}), expected, delta=margin)


class OdometryErrors(unittest.TestCase):
    ROBOTS = 2000

    def errors(self, simulation):
        """The relative errors [robot, (forward, left, turn)] of the odometry of each robot."""
        swarm = simulation.swarm("r")
        swarm.set_speeds(0.1, 0, left=0.1)
        simulation.step(10)
        ways = swarm.estimates()[:, :2] / 0.1
        swarm.set_speeds(0, 0.1)
        simulation.step(10)
        return np.column_stack([ways, swarm.estimates()[:, 3] / 0.1]) - 1

    def test_are_uniform_constant_and_independent(self):
        simulation = troupe.Simulation({
            "troupe": 1,
            "types": {"robot": {"size_m": [0.1, 0.1, 0.1], "drive": {"kind": "omni", "localization": "odom"}}},
            "populations": [{"name": "r", "type": "robot", "count": self.ROBOTS,
                             "place": {"rule": "grid", "region_m": [[0, 0], [20, 20]], "pitch_m": 0.4}}],
        }, threads=1)
        errors = self.errors(simulation)
        bounds = np.array([0.015, 0.015, 0.025])
        self.assertTrue(np.all(np.abs(errors) <= bounds + 1e-9))
        for k, bound in enumerate(bounds):
            quarters = np.histogram(errors[:, k], bins=4, range=(-bound - 1e-9, bound + 1e-9))[0] / self.ROBOTS
            self.assertLess(np.abs(quarters - 0.25).max(), SPREAD * math.sqrt(0.25 * 0.75 / self.ROBOTS))
        standard = errors / (bounds / math.sqrt(3))
        for i, j in ((0, 1), (0, 2), (1, 2)):
            uncorrelated(self, standard[:, i], standard[:, j], "axes")
        uncorrelated(self, standard[1:], standard[:-1], "robots")
        simulation.reset(2)
        uncorrelated(self, self.errors(simulation) / (bounds / math.sqrt(3)), standard, "seeds")
        simulation.reset(1)
        np.testing.assert_array_equal(self.errors(simulation), errors)


if __name__ == "__main__":
    unittest.main()

"""Tests that troupe.sweep() makes the same runs as `troupe sweep`, and that troupe.plot draws their results."""

import importlib.util
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import traceback
import unittest
import unittest.mock
import warnings

import numpy as np
import troupe
import troupe.plot
from support import output_when_interrupted

try:
    import pandas
except ImportError:
    print("skipped: there is no pandas")
    sys.exit(77)

PLUGINS = pathlib.Path(os.environ["PYTHONPATH"].split(":")[0]).parents[2] / "plugins" / "plugins"

WORLD = {
    "troupe": 1,
    "bounds_m": [[-5, -5], [5, 5]],
    "types": {"bot": {
        "size_m": [0.3, 0.3, 0.3], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
        "sensors": [{"name": "s", "kind": "ranger",
                     "transducers": [{"range_max_m": 2, "fov_deg": 180, "samples": 9}]}]}},
    "populations": [{"name": "r", "type": "bot", "count": 3, "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 4]]}}],
}
STUDY = {
    "troupe_study": 1, "world": WORLD, "for_s": 2, "measure_every_s": 0.5,
    "parameters": [{"set": "/populations/0/count", "name": "robots", "values": [2, 4]}],
    "seeds": {"from": 1, "count": 3}, "measures": ["path_length", {"kind": "coverage", "cell_m": 0.5}],
    "statistics": ["last", "mean"],
}
TABLE = """run,robots,seed,ticks,time_s,order,stopped_by,state_hash,error
0,2,1,10,1,1,,0,
1,2,2,10,1,3,,0,
2,10,1,10,1,5,,0,
3,10,2,10,1,nan,,0,
"""
SERIES = "run,time_s,order\n0,0,0\n0,1,1\n1,0,2\n1,1,3\n2,0,4\n2,1,5\n3,0,nan\n3,1,nan\n"


class Sweep(unittest.TestCase):
    def test_parameters_vary_together(self):
        speed = {"set": "/types/bot/drive/velocity_max_x_mps", "name": "speed", "values": [0.2, 0.4], "with": "robots"}
        study = {**STUDY, "parameters": [*STUDY["parameters"], speed]}
        table = troupe.sweep(study, threads=1)
        self.assertEqual(list(zip(table["robots"], table["speed"])), 3 * [(2, 0.2)] + 3 * [(4, 0.4)])
        with self.assertRaisesRegex(troupe.InputError, '/parameters/1/with: the number of values is 1, but "robots" has 2'):
            troupe.sweep({**study, "parameters": [*STUDY["parameters"], {**speed, "values": [0.2]}]})

    def test_a_row_is_a_run(self):
        table = troupe.sweep(STUDY, threads=2)
        self.assertEqual(list(table.columns), ["run", "robots", "seed", "ticks", "time_s", "path_length_m",
                                               "path_length_m_mean", "coverage", "coverage_mean", "stopped_by",
                                               "state_hash", "error"])
        self.assertEqual(list(table["robots"]), [2, 2, 2, 4, 4, 4])
        self.assertEqual(list(table["seed"]), [1, 2, 3] * 2)
        alone = troupe.Simulation(WORLD, seed=3, set={"/populations/0/count": 4}, threads=1)
        alone.run_for(2)
        self.assertEqual(table["state_hash"][5], f"{alone.state_hash():016x}")
        pandas.testing.assert_frame_equal(table, troupe.sweep(STUDY, threads=1))

    def test_a_series_has_every_look(self):
        series = troupe.sweep(STUDY, series=True)
        self.assertEqual(list(series.columns), ["run", "robots", "seed", "time_s", "path_length_m", "coverage"])
        self.assertEqual(len(series), 6 * 5)
        means = series.groupby(["robots", "time_s"])["coverage"].agg(["mean", "std"])
        self.assertEqual(len(means), 2 * 5)
        last = series.groupby("run")["coverage"].last()
        self.assertEqual(list(last), list(troupe.sweep(STUDY)["coverage"]))

    def test_times_are_rounded(self):
        study = {**STUDY, "world": {**WORLD, "tick_s": 0.1}, "for_s": 0.7, "measure_every_s": 0.1}
        self.assertNotEqual(3 * 0.1, 0.3)
        self.assertEqual(sorted(set(troupe.sweep(study, series=True)["time_s"])), [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
        self.assertEqual(set(troupe.sweep(study)["time_s"]), {0.7})

    def test_a_study_may_contain_numpy_values(self):
        values = STUDY["parameters"][0]["values"]
        numpy = {**STUDY, "for_s": np.float64(STUDY["for_s"]), "parameters": [{**STUDY["parameters"][0], "values": np.array(values)}]}
        self.assertEqual(list(troupe.sweep(numpy)["state_hash"]), list(troupe.sweep(STUDY)["state_hash"]))

    def test_what_is_wrong_is_an_error_and_a_run_that_fails_a_row(self):
        with self.assertRaisesRegex(troupe.InputError, "^dict.json: error: "):
            troupe.sweep({"troupe_study": 1})
        with self.assertRaisesRegex(troupe.InputError, '^dict.json: error: unknown key "sed"'):
            troupe.sweep({**STUDY, "sed": 1})
        with self.assertRaisesRegex(troupe.InputError, '^dict.json: error: /world: unknown key "sed"') as caught:
            troupe.sweep({**STUDY, "world": {**WORLD, "sed": 1}})
        self.assertEqual(caught.exception.findings, [str(caught.exception)])
        with self.assertRaisesRegex(troupe.InputError, "there is no such file"):
            troupe.sweep("no-such-study.json")
        with self.assertRaisesRegex(ValueError, "^/parameters/0/values/1 is inf: give a finite number$"):
            troupe.sweep({**STUDY, "parameters": [{"set": "/seed", "values": [1, math.inf]}]})
        crowded = {**STUDY, "parameters": [{"set": "/populations/0/count", "name": "robots", "values": [2, 100000]}],
                   "seeds": [1]}
        table = troupe.sweep(crowded)
        self.assertEqual(table["error"][0], "")
        self.assertNotEqual(table["error"][1], "")
        self.assertTrue(math.isnan(table["coverage"][1]))

    def test_a_series_reports_failed_runs(self):
        study = {**STUDY, "for_s": 0.5, "seeds": [1, 2], "parameters": [
            {"set": "/populations/0/count", "name": "robots", "values": [100000, 2, 100001]}]}
        with self.assertWarns(RuntimeWarning) as caught:
            series = troupe.sweep(study, series=True)
        self.assertEqual(sorted(set(series["run"])), [2, 3])
        self.assertRegex(
            str(caught.warning),
            r"^4 of 6 runs failed and have no rows in this series: runs 0 to 1, 4 to 5\. Run 0: .*placed [0-9]+ of 100000 bodies")
        self.assertEqual(caught.filename, __file__)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            troupe.sweep(study)  # a table has a column `error`
            troupe.sweep(STUDY, series=True)

        class Stop(troupe.Controller):
            robots = "r"

            def decide(self, robots):
                raise ZeroDivisionError("out of range")

        bot = {key: value for key, value in WORLD["types"]["bot"].items() if key != "controller"}
        study = {**STUDY, "world": {**WORLD, "types": {"bot": bot}}}
        with self.assertRaisesRegex(troupe.StepError, "ZeroDivisionError: out of range"):
            troupe.sweep(study, series=True, controllers=Stop)
        self.assertEqual(["out of range" in error for error in troupe.sweep(study, controllers=Stop)["error"]], [True] * 6)
        try:  # not assertRaises(), which clears the frames of the exception itself
            troupe.sweep(study, series=True, controllers=Stop)
        except troupe.StepError as error:
            kept = {name for frame, _ in traceback.walk_tb(error.__traceback__) for name in frame.f_locals}
        self.assertNotIn("simulation", kept, "a failed run frees its world at once")

    def test_a_study_has_an_end_time(self):
        study = {key: value for key, value in STUDY.items() if key != "for_s"}
        text = '^dict.json: error: no end time: give "for_s" in the study, or set quit_time_s in the world'
        for series in (True, False):
            with self.assertRaisesRegex(troupe.InputError, text):
                troupe.sweep(study, series=series)
        study["parameters"] = [{"set": "/quit_time_s", "name": "end_s", "values": [0.5, 1]}]
        self.assertEqual(list(troupe.sweep(study)["time_s"]), [0.5] * 3 + [1] * 3)
        with tempfile.TemporaryDirectory() as folder:  # the same error as that of `troupe sweep`
            file = pathlib.Path(folder) / "endless.json"
            (file.parent / "world.json").write_text(json.dumps(WORLD))
            file.write_text(json.dumps({"troupe_study": 1, "world": "world.json"}))
            with self.assertRaisesRegex(troupe.InputError, "world.json: error: no end time: "):
                troupe.sweep(file)

    def test_measures_of_the_world_may_be_named(self):
        world = {**WORLD, "measures": [{"kind": "coverage", "cell_m": 0.5, "name": "fine"}]}
        study = {**STUDY, "world": world, "seeds": [1], "measures": ["fine"], "statistics": ["last"]}
        self.assertIn("fine", troupe.sweep(study).columns)
        with self.assertRaisesRegex(troupe.InputError, '^dict.json: error: /measures/0: unknown measure "finer"'):
            troupe.sweep({**study, "measures": ["finer"]})

    def test_the_study_may_name_measures_of_plugins_and_scripts(self):
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder) / "my.py"
            script.write_text("import troupe\n\n\n@troupe.measure\ndef count(robots):\n    return len(robots)\n")
            file = pathlib.Path(folder) / "study.json"
            (file.parent / "world.json").write_text(json.dumps(WORLD))
            study = {**STUDY, "measures": ["my:count", "crowd", {"kind": "crowd:beyond", "x_m": -9}], "statistics": ["last"]}
            file.write_text(json.dumps({**study, "world": "world.json"}))
            for given in study, file:
                table = troupe.sweep(given, plugin_path=PLUGINS, controllers=script)
                self.assertEqual(list(table["my:count"]), [2] * 3 + [4] * 3)
                self.assertGreater(table["crowd_m"].min(), 0)
                self.assertEqual(list(table["crowd:beyond"]), [21] * 6)  # tick 0 and 20 ticks
                with self.assertRaisesRegex(troupe.InputError, 'unknown measure "my"; .* give --controller my.py'):
                    troupe.sweep(given, plugin_path=[PLUGINS])

    def test_a_wrong_study_or_number_of_threads_is_named(self):
        for wrong, error, text in (
            ((None, {}), TypeError, "study: found None: give a dict or a path"),
            (([STUDY], {}), TypeError, "study: found .* give a dict or a path"),
            ((STUDY, {"threads": -1}), ValueError, "threads: found -1: give a whole number from 0, or None"),
            ((STUDY, {"threads": "2"}), TypeError, "threads: found '2': give a whole number from 0, or None"),
            ((STUDY, {"threads": 1.5}), TypeError, "threads: found 1.5: give a whole number from 0, or None"),
        ):
            with self.assertRaisesRegex(error, f"^{text}$"):
                troupe.sweep(wrong[0], **wrong[1])
        self.assertEqual(len(troupe.sweep(STUDY, threads=np.int64(2))), 6)

    def test_the_files_of_a_study_may_be_paths(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "world.json"
            file.write_text(json.dumps(WORLD))
            expected = list(troupe.sweep(STUDY)["state_hash"])
            self.assertEqual(list(troupe.sweep({**STUDY, "world": file})["state_hash"]), expected)
            named = troupe.sweep({**STUDY, "world": pathlib.Path("world.json")}, name=pathlib.Path(folder) / "study.json")
            self.assertEqual(list(named["state_hash"]), expected)
            with self.assertRaisesRegex(troupe.InputError, "^my/study.json: error: /world: unknown key"):
                troupe.sweep({**STUDY, "world": {**WORLD, "sed": 1}}, name=pathlib.Path("my/study.json"))

    def test_an_unknown_keyword_argument_is_named(self):
        for wrong in ({"thread": 1}, {"seed": 1}, {"set": {}}):
            with self.assertRaises(TypeError) as raised:
                troupe.sweep(STUDY, **wrong)
            self.assertEqual(
                str(raised.exception),
                f'sweep() has no keyword argument "{next(iter(wrong))}"; known: series, threads, name, robots, ranging, '
                "search_path, plugin_path, controllers, tile_size_m, ranks")

    def test_control_c_ends_the_running_runs(self):
        code = f"""
import troupe
try:
    print("begun", flush=True)
    troupe.sweep({ {**STUDY, "for_s": 1e7, "measure_every_s": 1e5}!r}, threads=2)
except KeyboardInterrupt:
    print("interrupted")
"""
        self.assertEqual(output_when_interrupted(code, 3), "interrupted\n")  # when the runs are running

    def test_only_the_worlds_of_runs_need_be_loadable(self):
        crowded = {**WORLD, "populations": [{**WORLD["populations"][0], "count": 100000}]}
        study = {**STUDY, "world": crowded, "seeds": [1], "for_s": 0.2, "parameters": [
            {"set": "/populations/0/count", "name": "robots", "values": [100000, 2, 4]}]}
        table = troupe.sweep(study)
        self.assertEqual([error == "" for error in table["error"]], [False, True, True])
        self.assertEqual(list(table.columns), list(troupe.sweep(STUDY).columns))
        self.assertEqual(list(table["ticks"]), [0, 2, 2])
        study["parameters"] = [{"set": "/populations/0/count", "name": "robots", "values": [100000, 100001]}]
        with self.assertRaisesRegex(troupe.InputError, "placed [0-9]+ of 100000 bodies"):
            troupe.sweep(study)

    def test_the_first_world_determines_the_measures(self):
        study = {**STUDY, "for_s": 0.2, "seeds": [1], "statistics": ["last"], "parameters": [
            {"set": "/measures", "name": "which", "values": [["alive"], ["alive", "stalls"], ["order"]]}]}
        del study["measures"]
        table = troupe.sweep(study)
        self.assertEqual(list(table.columns),
                         ["run", "which", "seed", "ticks", "time_s", "alive", "stopped_by", "state_hash", "error"])
        self.assertEqual(list(table["alive"].fillna(-1)), [3, 3, -1])
        self.assertEqual(list(troupe.sweep(study, series=True).columns), ["run", "which", "seed", "time_s", "alive"])

    def test_parameters_may_append_to_the_same_list(self):
        def robot(name, x):
            return {"name": name, "type": "bot", "pose": {"x_m": x}}

        world = {"troupe": 1, "types": {"bot": {"size_m": [0.3, 0.3, 0.3], "drive": {"kind": "diff"}}}, "models": []}
        study = {**STUDY, "world": world, "seeds": [1], "measures": ["alive"], "parameters": [
            {"set": "/models/-", "name": "one", "values": [robot("a", 0)]},
            {"set": "/models/-", "name": "two", "values": [robot("b", 2), robot("c", 4)]}]}
        table = troupe.sweep(study)
        self.assertEqual(list(table["alive"]), [2, 2])
        settings = [("/models/-", robot("a", 0)), ("/models/-", robot("c", 4))]
        alone = troupe.Simulation(world, seed=1, threads=1, set=settings)
        self.assertEqual(alone.robot_names, ["a", "c"])
        alone.run_for(2)
        self.assertEqual(table["state_hash"][1], f"{alone.state_hash():016x}")

    def test_without_seeds_the_seed_is_that_of_the_world(self):
        study = {**STUDY, "world": {**WORLD, "seed": 7}, "for_s": 0.5}
        del study["seeds"]
        self.assertEqual(list(troupe.sweep(study)["seed"]), [7, 7])
        self.assertEqual(set(troupe.sweep(study, series=True)["seed"]), {7})
        study["parameters"] = [{**STUDY["parameters"][0], "values": [2, 100000]}]
        table = troupe.sweep(study)
        self.assertEqual(list(table["seed"]), [7, 7])
        self.assertEqual(table["seed"].dtype.kind, "i")
        self.assertEqual(list(table["error"] == ""), [True, False])
        study["parameters"].append({"set": "/seed", "name": "first", "values": [9, -1]})
        self.assertEqual(list(troupe.sweep(study)["seed"].fillna(0)), [9, 0, 9, 0])

    def test_columns_have_different_names(self):
        def study(parameter, *measures):
            return {**STUDY, "measures": measures,
                    "parameters": [{"set": "/populations/0/count", "name": parameter, "values": [2]}]}

        for wrong, text in (
            (study("displacement_m", "displacement"), '/parameters/0: the table of results already has a column "displacement_m", that of a measure'),
            (study("stalls_mean", "stalls"), '/parameters/0: the table of results already has a column "stalls_mean", that of a measure'),
            (study("robots", {"kind": "stalls", "name": "run"}), 'already has a column "run": give the measure'),
            (study("robots", "stalls", {"kind": "alive", "name": "stalls_mean"}), 'already has a column "stalls_mean": give the measure'),
        ):
            with self.subTest(text), self.assertRaisesRegex(troupe.InputError, text):
                troupe.sweep(wrong)

        # As for `troupe sweep`, the error names the line of the study.
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "columns.json"
            (file.parent / "world.json").write_text(json.dumps(WORLD))
            file.write_text(json.dumps({**study("stalls_mean", "stalls"), "world": "world.json"}, indent=1))
            line = file.read_text().splitlines().index('   "set": "/populations/0/count",')
            with self.assertRaisesRegex(troupe.InputError, f"columns.json:{line}: error: /parameters/0: the table of results"):
                troupe.sweep(file)


class Plot(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "table.csv").write_text(TABLE)
        (self.folder / "series.csv").write_text(SERIES)

    def test_lines_are_means_and_bands_deviations(self):
        measure, names, lines = troupe.plot.series_by(self.folder)
        self.assertEqual((measure, names), ("order", ["robots"]))
        self.assertEqual(list(lines), [("2",), ("10",)])  # sorted as numbers, not as texts
        self.assertEqual(lines[("2",)], [(0.0, 1.0, math.sqrt(2), 2), (1.0, 2.0, math.sqrt(2), 2)])
        self.assertEqual(lines[("10",)], [(0.0, 4.0, 0.0, 1), (1.0, 5.0, 0.0, 1)])  # runs without values at a time are not counted
        self.assertEqual(troupe.plot.series_by(self.folder, "order", "robots")[2], lines)

    def test_times_of_earlier_versions_are_rounded(self):
        (self.folder / "series.csv").write_text("run,time_s,order\n0,0.30000000000000004,1\n1,0.3,3\n")
        self.assertEqual(troupe.plot.series_by(self.folder)[2], {("2",): [(0.3, 2, math.sqrt(2), 2)]})

    def test_names_of_parameters_may_contain_commas(self):
        (self.folder / "table.csv").write_text(
            'run,"rule, near","a ""b""",seed,ticks,time_s,order,stopped_by,state_hash,error\n'
            "0,1,x,1,10,1,5,,0,\n1,2,x,1,10,1,6,,0,\n2,2,y,1,10,1,7,,0,\n")
        for by, names in (("rule, near", ["rule, near"]), ('"rule, near"', ["rule, near"]), ('a "b"', ['a "b"']),
                          ('"rule, near","a ""b"""', ["rule, near", 'a "b"'])):
            self.assertEqual(troupe.plot._Table(self.folder).varying(by), names)
        self.assertEqual(troupe.plot._Table(self.folder).varying(""), [])
        for by in ("rule, near,x", "rule"):
            with self.assertRaisesRegex(troupe.plot.PlotError, "unknown parameter "):
                troupe.plot._Table(self.folder).varying(by)

    def test_results_are_averaged_over_a_parameter(self):
        (self.folder / "series.csv").unlink()
        table = ("run,robots,rule,seed,ticks,time_s,order_m,order_m_mean,stopped_by,state_hash,error\n"
                 "0,10,near,1,10,4,1,6,,0,\n1,10,near,2,10,2,3,6,,0,\n2,2,near,1,10,1,5,6,,0,\n3,2,far,1,10,1,nan,7,,0,\n"
                 "4,10,far,1,10,1,8,7,,0,\n5,10,far,2,0,0,nan,nan,,,no room\n")
        (self.folder / "table.csv").write_text(table)
        measure, names, lines = troupe.plot.final_by(self.folder, "robots")
        self.assertEqual((measure, names), ("order_m", ["rule"]))
        self.assertEqual(lines, {("near",): [("2", 5.0, 0.0, 1), ("10", 2.0, math.sqrt(2), 2)], ("far",): [("10", 8.0, 0.0, 1)]})
        self.assertEqual(list(lines), [("far",), ("near",)])
        measure, names, lines = troupe.plot.final_by(self.folder, "rule", "order_m_mean", by="robots")
        self.assertEqual((measure, names), ("order_m_mean", ["robots"]))
        self.assertEqual(lines[("10",)], [("far", 7.0, 0.0, 1), ("near", 6.0, 0.0, 2)])
        self.assertEqual(troupe.plot.final_by(self.folder, "robots", "time_s", by="rule")[2][("near",)][1][1], 3)
        self.assertEqual(troupe.plot.final_by(self.folder, "robots", "order")[0], "order_m")

        # A parameter that varies together with that of the axis does not distinguish lines.
        (self.folder / "table.csv").write_text(
            "run,robots,size_m,rule,seed,ticks,time_s,order_m,stopped_by,state_hash,error\n" + "".join(
                f"{run},{robots},{size_m},{rule},1,10,1,{run},,0,\n"
                for run, (robots, size_m, rule) in enumerate(((2, 5, "far"), (2, 5, "near"), (8, 5, "near"), (9, 6, "near")))))
        self.assertEqual(troupe.plot.final_by(self.folder, "robots")[1], ["rule"])
        self.assertEqual(list(troupe.plot.final_by(self.folder, "size_m")[2]), [("2", "far"), ("2", "near"), ("8", "near"), ("9", "near")])
        self.assertEqual(troupe.plot.final_by(self.folder, "robots", by="size_m")[1], ["size_m"])
        (self.folder / "table.csv").write_text(table)

        for arguments, text in ((("size",), 'unknown parameter "size"; known: robots, rule'),
                                (("robots", "seed"), 'unknown measure "seed"; known: order_m, order_m_mean, time_s'),
                                (("robots", None, "robots"), "on the x axis, so it cannot distinguish lines")):
            with self.assertRaisesRegex(troupe.plot.PlotError, text):
                troupe.plot.final_by(self.folder, *arguments)

    def axes_of(self, **named):
        """Draws a plot, and returns its axes."""
        from matplotlib import pyplot

        with unittest.mock.patch.object(pyplot, "close"):
            troupe.plot.draw(self.folder, **named)
        self.addCleanup(pyplot.close, pyplot.gcf())
        return pyplot.gcf().axes[0]

    @staticmethod
    def bars_of(axes):
        """Returns the x and the lower and upper end of each bar."""
        from matplotlib import collections

        bars = [bar for bar in axes.collections if isinstance(bar, collections.LineCollection)]
        return [(segment[0][0], segment[0][1], segment[1][1]) for bar in bars for segment in bar.get_segments() if len(segment)]

    def test_the_quantiles_of_a_t_distribution_are_those_of_tables(self):
        for degrees, quantile in ((1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (7, 2.365), (9, 2.262), (19, 2.093), (120, 1.980)):
            self.assertAlmostEqual(troupe.plot._t_quantile(degrees), quantile, delta=0.0005)
        self.assertEqual(troupe.plot._interval([1, 3]), (2, troupe.plot._t_quantile(1), troupe.plot._t_quantile(1)))
        # Many runs: nearly the quantile of the normal distribution.
        half = troupe.plot._interval([-1, 1] * 50_000)[1]
        self.assertAlmostEqual(half * math.sqrt(100_000), 1.96, delta=0.003)

    def test_quartiles_are_those_of_numpy(self):
        for count in range(2, 12):
            numbers = np.random.default_rng(count).normal(size=count)
            median, below, above = troupe.plot._quartiles(list(numbers))
            np.testing.assert_allclose([median - below, median, median + above], np.percentile(numbers, [25, 50, 75]), rtol=1e-12)
        self.assertEqual(troupe.plot._quartiles([math.inf, 1, 2, 3, 4]), (3, 1, 1))
        self.assertEqual(repr(troupe.plot._quartiles([math.inf, 1, 2])), "(2, nan, nan)")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_bars_may_be_confidence_intervals_and_quartiles(self):
        t = troupe.plot._t_quantile(1)
        for bars, words, low, high in (("deviation", "mean and standard deviation", 2 - math.sqrt(2), 2 + math.sqrt(2)),
                                       ("interval", "mean and 95 % confidence interval", 2 - t, 2 + t),
                                       ("quartiles", "median and quartiles", 1.5, 2.5)):
            axes = self.axes_of(over="robots", bars=bars)
            np.testing.assert_allclose(self.bars_of(axes), [(2, low, high)])  # the other point has only one run
            self.assertEqual(axes.get_ylabel().replace("\n", " "), f"order, {words}")
            band = self.axes_of(bars=bars).collections[0].get_paths()[0].get_extents()
            np.testing.assert_allclose([band.y0, band.y1], [low - 1, high])  # at 0 s the mean is 1, and at 1 s it is 2
        with self.assertRaises(troupe.plot.PlotError) as raised:
            troupe.plot.draw(self.folder, bars="quartile")
        self.assertEqual(str(raised.exception), 'error: unknown kind of bars "quartile"; known: deviation, interval, quartiles '
                         '(did you mean "quartiles"?)')

    STOPPED = ("run,robots,seed,ticks,time_s,order,stopped_by,state_hash,error\n"
               "0,2,1,1,3,1,a > 1,,\n1,2,2,1,10,1,,,\n2,2,3,1,5,1,a > 1,,\n3,2,4,1,10,1,,,\n4,2,5,0,nan,nan,,,no room\n"
               "5,10,1,1,9,1,a > 1,,\n6,10,2,1,4,1,lost,,\n7,10,3,1,8,1,,,\n8,10,4,1,6,1,a > 1,,\n")

    def test_a_fraction_has_the_score_interval(self):
        fraction, below, above = troupe.plot._fraction(8, 10)
        self.assertEqual(fraction, 0.8)
        np.testing.assert_allclose([fraction - below, fraction + above], [0.4901625, 0.9433178], atol=1e-7)
        np.testing.assert_allclose(troupe.plot._fraction(0, 10), (0, 0, 0.2775328), atol=1e-7)
        np.testing.assert_allclose(troupe.plot._fraction(1, 1), (1, 0.7934507, 0), atol=1e-7)

    def test_runs_that_a_condition_ended_are_counted(self):
        (self.folder / "table.csv").write_text(self.STOPPED)
        (self.folder / "series.csv").unlink()
        measure, names, lines = troupe.plot.final_by(self.folder, "robots", "stopped_by")
        self.assertEqual((measure, names), ("stopped_by", []))
        self.assertEqual([(value, mean, count) for value, mean, _, count in lines[()]], [("2", 0.5, 4), ("10", 0.75, 4)])

        def steps(measure, robots):
            return [(time_s, fraction) for time_s, fraction, *_ in troupe.plot._stops(self.folder, measure, None)[2][(robots,)]]

        self.assertEqual(steps("stopped_by", "2"), [(0, 0), (3, 0.25), (5, 0.5), (10, 0.5)])
        # Run 7 ended at 8 s without a condition: what would have become of it later is unknown.
        self.assertEqual(steps("stopped_by", "10"), [(0, 0), (4, 0.25), (6, 0.5), (8, 0.5)])
        self.assertEqual(steps("stopped_by:a > 1", "10"), [(0, 0), (6, 0.25), (8, 0.25)])
        (self.folder / "table.csv").write_text(self.STOPPED.replace("8,1,,,", "8,1,lost,,"))
        self.assertEqual(steps("stopped_by:a > 1", "10"), [(0, 0), (6, 0.25), (9, 0.5), (10, 0.5)])  # known until the last end
        (self.folder / "table.csv").write_text(self.STOPPED)
        for named, text in (({"measure": "stopped_by:a"}, 'unknown condition "a"; known: a > 1, lost'),
                            ({"measure": "stopped_by", "bars": "quartiles"},
                             'the bars of the measure "stopped_by" cannot be "quartiles", because a fraction of runs is drawn '
                             "with its confidence interval: leave out --bars (in Python: bars)")):
            with self.assertRaises(troupe.plot.PlotError) as raised:
                troupe.plot.draw(self.folder, **named)
            self.assertEqual(str(raised.exception), f"error: {text}")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_fractions_of_runs_are_drawn(self):
        (self.folder / "table.csv").write_text(self.STOPPED)
        with self.assertWarnsRegex(RuntimeWarning, "1 of 9 runs failed"):
            axes = self.axes_of(measure="stopped_by", over="robots")
        _, below, above = troupe.plot._fraction(2, 4)
        np.testing.assert_allclose(self.bars_of(axes)[0], (2, 0.5 - below, 0.5 + above))
        self.assertEqual(axes.get_ylabel().replace("\n", " "), "fraction of runs ended by stop_when, with 95 % confidence interval")
        self.assertEqual(axes.get_legend().get_title().get_text(), "4 runs per point")
        with self.assertWarns(RuntimeWarning):
            axes = self.axes_of(measure="stopped_by:a > 1")
        self.assertEqual(axes.get_ylabel().replace("\n", " "), "fraction of runs ended by a > 1, with 95 % confidence interval")
        self.assertEqual([line.get_drawstyle() for line in axes.lines], ["steps-post"] * 2)
        self.assertTrue((self.folder / "stopped_by:a > 1.png").exists())

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_one_line_may_be_of_all_runs(self):
        axes = self.axes_of(by="")
        self.assertEqual([list(line.get_ydata()) for line in axes.lines], [[2, 3]])
        legend = axes.get_legend()
        self.assertEqual((legend.get_title().get_text(), legend.get_texts()), ("3 runs per line", []))

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_values_in_the_legend_have_no_rounding_errors(self):
        (self.folder / "table.csv").write_text(TABLE.replace(",2,1,10", ",0.30000000000000004,1,10").replace(",2,2,10", ",v1.0,2,10"))
        texts = [text.get_text() for text in self.axes_of().get_legend().get_texts()]
        self.assertEqual(texts, ["robots = 0.3", "robots = 10", "robots = v1.0"])

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_the_x_axis_has_the_values_of_a_parameter(self):
        from matplotlib import pyplot

        def axes(**named):
            with unittest.mock.patch.object(pyplot, "close"):
                file = troupe.plot.draw(self.folder, **named)
            self.addCleanup(pyplot.close, pyplot.gcf())
            return file, pyplot.gcf().axes[0]

        file, numbers = axes(over="robots")
        self.assertEqual(pathlib.Path(file).name, "order-over-robots.png")
        self.assertEqual(numbers.get_xlabel(), "robots")
        self.assertEqual([list(line.get_xdata()) for line in numbers.lines[:1]], [[2, 10]])
        (self.folder / "table.csv").write_text(TABLE.replace(",10,1,10,", ",ten,1,10,").replace("robots", "rule/0"))
        file, texts = axes(over="rule/0")
        self.assertEqual(pathlib.Path(file).name, "order-over-rule-0.png")
        self.assertEqual([label.get_text() for label in texts.get_xticklabels()], ["2", "ten"])

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_logarithmic_axes_have_the_points_above_zero(self):
        from matplotlib import pyplot

        def axes(**named):
            with unittest.mock.patch.object(pyplot, "close"), warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                troupe.plot.draw(self.folder, out=self.folder / "p.png", **named)
            self.addCleanup(pyplot.close, pyplot.gcf())
            return pyplot.gcf().axes[0], [str(warning.message) for warning in caught]

        linear, told = axes(over="robots")
        self.assertEqual((linear.get_xscale(), linear.get_yscale(), told), ("linear", "linear", []))
        both, told = axes(over="robots", log_x=True, log_y=True)
        self.assertEqual((both.get_xscale(), both.get_yscale(), told), ("log", "log", []))
        self.assertEqual(list(both.lines[0].get_xdata()), [2, 10])

        # Time 0 is left out without a warning, a mean of 0 with one; the band of the other means reaches below 0.
        (self.folder / "series.csv").write_text("run,time_s,order\n0,0,1\n0,1,0.1\n0,2,0\n1,0,1\n1,1,9\n1,2,0\n")
        series, told = axes(log_x=True)
        self.assertEqual((series.get_xscale(), series.get_yscale(), told), ("log", "linear", []))
        self.assertEqual(list(series.lines[0].get_xdata()), [1, 2])
        series, told = axes(log_y=True)
        self.assertEqual(list(series.lines[0].get_xdata()), [0, 1])
        self.assertEqual(told, [f'{self.folder / "series.csv"}: warning: 1 of 3 points are not in the plot, because their values of '
                                '"order" are 0 or negative and the axis is logarithmic'])
        self.assertGreater(series.get_ylim()[0], 0)
        (self.folder / "table.csv").write_text(TABLE.replace(",2,1,", ",0,1,").replace(",2,2,", ",0,2,"))
        numbers, told = axes(over="robots", log_x=True)
        self.assertEqual(list(numbers.lines[0].get_xdata()), [10])
        self.assertIn('1 of 2 points are not in the plot, because their values of "robots" are 0', told[0])

        (self.folder / "table.csv").write_text(TABLE.replace(",10,1,10,", ",ten,1,10,"))
        with self.assertRaisesRegex(troupe.plot.PlotError, '"robots" has values that are not numbers.*leave out --log-x'):
            troupe.plot.draw(self.folder, over="robots", log_x=True)
        (self.folder / "series.csv").write_text("run,time_s,order\n0,0,0\n0,1,-1\n")
        with self.assertRaisesRegex(troupe.plot.PlotError, 'all values of "order" are 0 or negative.*leave out --log-y .in Python: log_y'):
            troupe.plot.draw(self.folder, log_y=True)
        (self.folder / "series.csv").write_text("run,time_s,order\n0,0,1\n")
        with self.assertRaisesRegex(troupe.plot.PlotError, "all times are 0 or negative.*leave out --log-x"):
            troupe.plot.draw(self.folder, log_x=True)

    def test_the_end_of_a_stopped_run_is_no_point_between_samples(self):
        def points(*runs):  # of a line with two runs, whose values are always 10 and 11
            rows = [f"{run},{time_s},{10 + run}" for run, times in enumerate(runs) for time_s in times]
            (self.folder / "series.csv").write_text("\n".join(["run,time_s,order", *rows]) + "\n")
            _, _, lines = troupe.plot.series_by(self.folder)
            return [(time_s, mean, n) for time_s, mean, _, n in lines[("2",)]]

        self.assertEqual(points([0, 1, 2], [0, 0.7]), [(0, 10.5, 2), (1, 10, 1), (2, 10, 1)])
        self.assertEqual(points([0, 0.3], [0, 0.7]), [(0, 10.5, 2), (0.7, 11, 1)])  # the longest run keeps its end
        self.assertEqual(points([0, 1, 2], [0, 1]), [(0, 10.5, 2), (1, 10.5, 2), (2, 10, 1)])
        # Runs with other periods keep all samples except the last one.
        self.assertEqual(points([0, 0.4, 0.8], [0, 0.5, 1]), [(0, 10.5, 2), (0.4, 10, 1), (0.5, 11, 1), (1, 11, 1)])

    def test_ends_of_thousands_of_stopped_runs_are_found_quickly(self):
        # If each end were sought in all runs, this would take minutes.
        runs = 50_000
        table = "".join(f"{run},2,{run},1,1,1,,0,\n" for run in range(runs))
        (self.folder / "table.csv").write_text(TABLE.splitlines(keepends=True)[0] + table)
        series = "".join(f"{run},0,1\n{run},{run + 1},2\n" for run in range(runs))  # each run ends later than the one before
        (self.folder / "series.csv").write_text("run,time_s,order\n" + series)
        _, _, lines = troupe.plot.series_by(self.folder, by="robots")
        self.assertEqual(lines, {("2",): [(0, 1, 0, runs), (runs, 2, 0, 1)]})

    def test_the_name_of_a_measure_needs_no_unit(self):
        columns = ["displacement_m", "displacement_m:leaders", "stalls:leaders", "my:reach_m", "path_length_m"]
        (self.folder / "series.csv").write_text(",".join(["run,time_s", *columns]) + "\n0,0,1,2,3,4,5\n")
        for name, column in (("displacement", 0), ("displacement:leaders", 1), ("stalls:leaders", 2), ("my:reach", 3),
                             ("path_length", 4), ("path_length_m", 4)):
            measure, _, lines = troupe.plot.series_by(self.folder, name)
            self.assertEqual(measure, columns[column])
            self.assertEqual(next(iter(lines.values()))[0][1], column + 1)
        with self.assertRaisesRegex(troupe.plot.PlotError, 'unknown measure "path"'):
            troupe.plot.series_by(self.folder, "path")

    def test_large_and_infinite_values_are_averaged(self):
        def point(*values):
            rows = [f"{run},0,{value}\n" for run, value in enumerate(values)]
            (self.folder / "series.csv").write_text("run,time_s,order\n" + "".join(rows))
            return troupe.plot.series_by(self.folder)[2][("2",)][0][1:]

        self.assertEqual(point(1e200, -1e200), (0, math.hypot(1e200, 1e200), 2))
        self.assertEqual(point(1.5e308, 1.5e308), (1.5e308, 0, 2))
        self.assertEqual(repr(point("inf", 1)), "(inf, nan, 2)")
        self.assertEqual(repr(point("inf", "-inf")), "(nan, nan, 2)")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_infinite_values_are_left_out_of_a_picture(self):
        (self.folder / "series.csv").write_text("run,time_s,order\n0,0,inf\n1,0,-inf\n0,1,inf\n1,1,1\n0,2,1e200\n1,2,3\n")
        self.assertTrue(pathlib.Path(troupe.plot.draw(self.folder)).exists())
        for value, text in (("inf", "only infinite values"), ("-1.5e308", "values above 1e\\+300")):
            (self.folder / "table.csv").write_text(TABLE.replace(",1,1,,", f",1,{value},,").replace("1,3,,", f"1,{value},,")
                                                   .replace("1,5,,", f"1,{value},,"))
            (self.folder / "series.csv").write_text(f"run,time_s,order\n0,0,{value}\n1,0,{value}\n")
            for over in (None, "robots"):
                with self.assertRaisesRegex(troupe.plot.PlotError, f'the measure "order" has {text}'):
                    troupe.plot.draw(self.folder, over=over)

    def test_a_long_error_of_a_run_is_read(self):
        (self.folder / "table.csv").write_text(TABLE + f"4,10,3,0,nan,nan,,,{'x' * 200000}\n")
        limit = troupe.plot.csv.field_size_limit()
        self.assertEqual(len(troupe.plot.series_by(self.folder)[2]), 2)
        self.assertEqual(troupe.plot.csv.field_size_limit(), limit)

    def test_the_results_are_those_in_a_folder(self):
        frame = pandas.DataFrame({"run": [0]})
        for read in (lambda: troupe.plot.draw(frame), lambda: troupe.plot.final_by(frame, "run"), lambda: troupe.plot.series_by(frame)):
            with self.assertRaisesRegex(TypeError, "^folder: found a DataFrame: give the name of the folder of a completed sweep$"):
                read()

    def test_what_is_wrong_is_one_message(self):
        def message(*arguments, **named):
            with self.assertRaises(troupe.plot.PlotError) as raised:
                troupe.plot.draw(self.folder, *arguments, **named)
            return str(raised.exception)

        nowhere = self.folder / "nowhere"
        with self.assertRaises(troupe.plot.PlotError) as raised:
            troupe.plot.draw(nowhere)
        self.assertEqual(str(raised.exception), f"{nowhere}: error: there is no such folder: give the folder of a "
                         "completed sweep")
        table = self.folder / "table.csv"
        with self.assertRaises(troupe.plot.PlotError) as raised:
            troupe.plot.draw(table)
        self.assertEqual(str(raised.exception), f"{table}: error: this is a file: give the folder of a completed sweep")
        self.assertIn('unknown measure "ordr"; known: order (did you mean "order"?)', message("ordr"))
        self.assertIn('unknown parameter "size"; known: robots', message(by="size"))
        self.assertIn("must end in .png, .svg or .pdf", message(out="x.gif"))
        (self.folder / "series.csv").unlink()
        self.assertIn('set "series": true in the study', message())
        (self.folder / "series.csv").write_text("run,time_s,order\n0,1\n")
        self.assertIn("its lines have different numbers of columns", message())
        (self.folder / "series.csv").write_text("run,time_s,order\n0,1,0.2")  # of 0.25
        self.assertIn("series.csv: error: the file was cut off: its last line has no end", message())
        (self.folder / "series.csv").write_text("run,time_s,order\n7,1,2\n")
        self.assertIn("this is not the series of the sweep", message())
        with unittest.mock.patch.object(troupe.plot.csv, "reader", side_effect=troupe.plot.csv.Error("line contains NUL")):
            self.assertIn("table.csv: error: cannot be read: line contains NUL", message())
        table.unlink()
        os.mkfifo(table)
        self.assertIn("table.csv: error: cannot be read: this is not a regular file", message())

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_the_command_does_not_depend_on_variables_of_python(self):
        folder = self.folder / os.fsdecode(b"results\xff")
        folder.mkdir()
        (folder / "table.csv").write_text(TABLE + "4,10,3,0,nan,nan,,,failed\n")
        (folder / "series.csv").write_text(SERIES)
        for variables in ({}, {"PYTHONOPTIMIZE": "2"}, {"PYTHONWARNINGS": "error::RuntimeWarning"},
                          {"PYTHONWARNINGS": "ignore"}, {"MPLBACKEND": "none"}):
            with self.subTest(variables):
                done = subprocess.run([sys.executable, troupe.plot.__file__, folder], env={**os.environ, **variables},
                                      capture_output=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(done.stdout, os.fsencode(folder / "order.png") + b"\n")
                self.assertIn(b"table.csv: warning: 1 of 5 runs failed and are not in the plot; run 4: failed\n", done.stderr)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_messages_that_cannot_be_printed_are_lost(self):
        (self.folder / "table.csv").write_text(TABLE + "4,10,3,0,nan,nan,,,failed\n")
        (self.folder / "series.csv").write_text(SERIES)
        none = self.folder / "none"
        lost = b"troupe plot: error: cannot write to standard output: "
        for redirected, folder, code, out, err in (
            ("2>/dev/full", self.folder, 0, os.fsencode(self.folder / "order.png") + b"\n", b""),
            ("2>/dev/full", none, 2, b"", b""),
            ("2>&-", none, 2, b"", b""),
            (">/dev/full", self.folder, 1, b"", lost + b"No space left on device\n"),
            (">&-", self.folder, 1, b"", lost + b"Bad file descriptor\n"),
        ):
            with self.subTest(redirected, code=code):
                done = subprocess.run(["sh", "-c", f'exec "$@" {redirected}', "sh", sys.executable, troupe.plot.__file__, folder],
                                      capture_output=True)
                self.assertEqual((done.returncode, done.stdout), (code, out), done.stderr)
                self.assertTrue(done.stderr.endswith(err), done.stderr)
                self.assertNotIn(b"Traceback", done.stderr)

    def test_a_link_to_a_table_is_not_replaced(self):
        (self.folder / "link.png").symlink_to("table.csv")
        with self.assertRaisesRegex(troupe.plot.PlotError, "link.png: error: cannot be written: it is a table of the sweep"):
            troupe.plot.draw(self.folder, out=self.folder / "link.png")
        self.assertEqual((self.folder / "table.csv").read_text(), TABLE)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_a_picture_is_drawn(self):
        out = troupe.plot.draw(self.folder, by="robots", title="Order")
        self.assertEqual(pathlib.Path(out).read_bytes()[:4], b"\x89PNG")
        nowhere = self.folder / "nowhere"
        with self.assertRaises(troupe.plot.PlotError) as raised:
            troupe.plot.draw(self.folder, out=nowhere / "o.svg")
        self.assertEqual(str(raised.exception), f"{nowhere}/o.svg: error: cannot be written: there is no folder {nowhere}")
        svg = troupe.plot.draw(self.folder, out=self.folder / "o.svg")
        self.assertIn("<svg", pathlib.Path(svg).read_text())

        def drawn(name, now):
            with unittest.mock.patch.dict(os.environ, SOURCE_DATE_EPOCH=now):
                return pathlib.Path(troupe.plot.draw(self.folder, out=self.folder / name)).read_bytes()

        for name in "o.svg", "o.pdf", "o.png":
            self.assertEqual(drawn(name, "100"), drawn(name, "200"), name)
        done = subprocess.run([sys.executable, "-c", pathlib.Path(troupe.plot.__file__).read_text(), "--measure=x", "--",
                               str(self.folder)], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (2, 'troupe plot: error: unknown measure "x"; known: order\n'))

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_a_picture_that_cannot_be_written_leaves_the_old_one(self):
        link = self.folder / "link.pdf"
        link.symlink_to("order.pdf")
        order = self.folder / "order.pdf"
        order.write_text("old")
        order.chmod(0o640)
        before = sorted(self.folder.iterdir())
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))  # as on a full disk
        try:
            with self.assertRaises(troupe.plot.PlotError) as raised:
                troupe.plot.draw(self.folder, out=link)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        self.assertEqual(str(raised.exception), f"{link}: error: cannot be written: File too large")
        with self.assertRaisesRegex(troupe.plot.PlotError, "dollar signs"):
            troupe.plot.draw(self.folder, title=r"$\nothing$", out=link)
        self.assertEqual(order.read_text(), "old")
        troupe.plot.draw(self.folder, out=link)
        self.assertEqual(order.read_bytes()[:4], b"%PDF")
        self.assertEqual(order.stat().st_mode & 0o777, 0o640)
        self.assertTrue(link.is_symlink())
        with unittest.mock.patch("os.replace", side_effect=KeyboardInterrupt), self.assertRaises(KeyboardInterrupt):
            troupe.plot.draw(self.folder, out=link)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_a_picture_is_written_into_a_pipe(self):
        pipe = self.folder / "pipe.svg"
        os.mkfifo(pipe)
        with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE) as reader:
            troupe.plot.draw(self.folder, out=pipe)
            self.assertIn(b"<svg", reader.communicate()[0])
        self.assertTrue(pipe.is_fifo())

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_a_point_of_one_run_has_no_deviation(self):
        from matplotlib import collections

        # The line robots = 2 averages two runs, and the line robots = 10 has a value of one run only.
        over_time = self.axes_of()
        bands = [band for band in over_time.collections if isinstance(band, collections.PolyCollection)]
        self.assertEqual([len(band.get_paths()) for band in bands], [1, 0])
        self.assertEqual(over_time.get_legend().get_title().get_text(), "1 to 2 runs per point")
        (self.folder / "table.csv").write_text(
            "run,robots,rule,seed,ticks,time_s,order,stopped_by,state_hash,error\n"
            "0,2,near,1,10,1,1,,0,\n1,2,near,2,10,1,3,,0,\n2,10,near,1,10,1,5,,0,\n3,10,far,1,10,1,nan,,0,\n4,10,far,2,10,1,7,,0,\n")
        over_robots = self.axes_of(over="robots")
        self.assertEqual(self.bars_of(over_robots), [(2, 2 - math.sqrt(2), 2 + math.sqrt(2))])
        self.assertEqual(over_robots.get_legend().get_title().get_text(), "1 to 2 runs per point")

        (self.folder / "series.csv").write_text("run,time_s,order\n0,0,1\n1,0,3\n2,0,4\n3,0,6\n")
        (self.folder / "table.csv").write_text(
            "run,robots,seed,ticks,time_s,order,stopped_by,state_hash,error\n"
            "0,2,1,10,1,1,,0,\n1,2,2,10,1,3,,0,\n2,10,1,10,1,4,,0,\n3,10,2,10,1,6,,0,\n")
        self.assertEqual(self.axes_of().get_legend().get_title().get_text(), "2 runs per line")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_names_are_no_formulas(self):
        from matplotlib import pyplot

        for name in (r"$\bad$", "_robots"):
            (self.folder / "table.csv").write_text(TABLE.replace("robots", name).replace(",10,1,10,", ",$ten$,1,10,"))
            for over in (None, name):
                with self.subTest(name, over=over), unittest.mock.patch.object(pyplot, "close"):
                    troupe.plot.draw(self.folder, over=over, out=self.folder / "p.png")
                    figure = pyplot.gcf()
                    self.addCleanup(pyplot.close, figure)
                    if over is None:
                        self.assertEqual(len(figure.axes[0].get_legend().get_texts()), 2)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_a_line_of_one_point_is_a_dot(self):
        from matplotlib import pyplot

        (self.folder / "series.csv").write_text("run,time_s,order\n0,0,1\n0,1,2\n1,0,3\n2,0,4\n")
        with unittest.mock.patch.object(pyplot, "close"):
            troupe.plot.draw(self.folder, by="robots")
        self.addCleanup(pyplot.close, pyplot.gcf())
        self.assertEqual([(len(line.get_xdata()), line.get_marker()) for line in pyplot.gcf().axes[0].lines], [(2, "None"), (1, "o")])

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_long_names_of_parameters_fit_and_do_not_overlap(self):
        from matplotlib import pyplot

        def figure(table, **named):
            (self.folder / "table.csv").write_text(table)
            with unittest.mock.patch.object(pyplot, "close"):
                troupe.plot.draw(self.folder, out=self.folder / "p.png", **named)
            self.addCleanup(pyplot.close, pyplot.gcf())
            pyplot.gcf().canvas.draw()
            return pyplot.gcf()

        long = "speed of the robots " * 4
        whole = figure(TABLE.replace("robots", long), by=long)
        for text in whole.axes[0].get_legend().get_texts():
            self.assertLess(text.get_window_extent().width, whole.axes[0].bbox.width)
        self.assertEqual(text.get_text(), "speed of the robots spe…ots speed of the robots  = 10")
        head = "run,world,seed,ticks,time_s,order,stopped_by,state_hash,error\n"
        rows = [f"{run},worlds/{'very-' * 20}long-name-{run}.json,1,10,1,{run},,0,\n" for run in range(8)]
        whole = figure(head + "".join(rows), over="world")
        ticks = whole.axes[0].get_xticklabels()
        self.assertEqual(len(ticks), 8)
        boxes = [tick.get_window_extent() for tick in ticks]
        self.assertTrue(all(a.x1 < b.x0 for a, b in zip(boxes, boxes[1:])), boxes)
        label = figure(TABLE.replace("robots", long), over=long).axes[0].xaxis.label.get_window_extent()
        self.assertTrue(whole.bbox.x0 <= label.x0 and label.x1 <= whole.bbox.x1, label)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_a_title_may_be_long_and_have_formulas(self):
        from matplotlib import pyplot

        with unittest.mock.patch.object(pyplot, "close"):
            troupe.plot.draw(self.folder, title="Order of $x^2$ " + 20 * "in words ")
        figure = pyplot.gcf()
        self.addCleanup(pyplot.close, figure)
        figure.canvas.draw()
        title = figure.axes[0].title.get_window_extent()
        self.assertTrue(figure.bbox.x0 <= title.x0 and title.x1 <= figure.bbox.x1 and title.y1 <= figure.bbox.y1, title)

        with self.assertRaises(troupe.plot.PlotError) as raised:
            troupe.plot.draw(self.folder, title=r"in $\bad$")
        self.assertEqual(str(raised.exception), r'error: the title "in $\bad$" has dollar signs, but matplotlib cannot draw '
                         r"the text between them as a formula: write \$ for a dollar sign")
        troupe.plot.draw(self.folder, title=r"5 \$ and 6 \$")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_failed_runs_are_named_in_a_warning(self):
        table = self.folder / "table.csv"
        runs = len(TABLE.splitlines()) - 1
        table.write_text(TABLE + "8,10,3,0,0,nan,,,no room\n")
        text = f"{table}: warning: 1 of {runs + 1} runs failed and are not in the plot; run 8: no room"
        for named in ({}, {"over": "robots"}):
            with self.assertWarns(RuntimeWarning) as warned:
                troupe.plot.draw(self.folder, **named)
            self.assertEqual(str(warned.warning), text)
        done = subprocess.run([sys.executable, troupe.plot.__file__, str(self.folder)], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, text + "\n"))

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib")
    def test_a_long_label_is_not_cut_off(self):
        from matplotlib import pyplot

        for name in ("mean_nearest_distance_m:sheep", 2 * "a_very_long_name_of_a_measure_" + "m:sheep"):
            (self.folder / "series.csv").write_text(SERIES.replace("order", name))
            with unittest.mock.patch.object(pyplot, "close"):
                troupe.plot.draw(self.folder)
            figure = pyplot.gcf()
            self.addCleanup(pyplot.close, figure)
            figure.canvas.draw()
            label = figure.axes[0].yaxis.label.get_window_extent()
            inside = figure.bbox
            self.assertTrue(inside.x0 <= label.x0 and inside.y0 <= label.y0 and label.y1 <= inside.y1, f"{name}: {label}")


if __name__ == "__main__":
    unittest.main()

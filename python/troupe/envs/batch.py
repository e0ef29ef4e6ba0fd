"""The classes Task, which defines what robots learn in a world, and Batch: many copies of the world of a task, which
step together. All environments of this package use a Batch."""

from __future__ import annotations

import copy
import dataclasses
import numbers
import os
import secrets
import sys
import warnings
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from .._core import BatchEnv, Simulation, _seed_of
from .._script import misspelt_members
from .team import Team, action_space, check_team, commands_of, is_whole

World = Union[str, "os.PathLike[str]", Dict[str, Any]]
Flags = npt.NDArray[np.bool_]
FlagsLike = Union[Flags, Sequence[bool]]
_ONLY = "observation"  # name of the array of a team whose observation is a single Box
_OF_SPACE = ("low", "high", "shape")  # members of a part that define its observation space
_BOOLS, _NUMBERS = "b", "biuf"  # kinds of NumPy's types
_OWN_INFOS = ("finished", "alive", "final_obs", "final_info")  # names that VectorEnv uses
_KINDS = {_BOOLS: "bools", _NUMBERS: "real numbers"}


class Task:
    """A world, the robots that learn in it, and the length of an episode.

    To define a task, set these members, or derive a class that overrides some of the functions below. The functions are
    called with the whole Batch: one call is for all copies of the world, and arrays have the shape copies x robots x
    columns. The parameter `team` is the index of a team in `teams`.
    """

    world: World = {}
    teams: List[Team] = []
    ticks = 1  #: ticks of the world per step
    seconds = 60.0  #: simulated time after which an episode is truncated, s
    measures: List[str] = []  #: names of measures that are computed for each copy, and that rewards and ends may use
    #: Names of models, populations and types whose bodies place() may place.
    starts: List[str] = []
    max_return: Optional[float] = None  #: the largest possible sum of rewards of an episode, if known

    def place(self, batch: Batch, copies: npt.NDArray[np.bool_], seeds: npt.NDArray[np.uint64]) -> None:
        """Called before some copies begin an episode, to choose where bodies begin it: writes x, y (m) and the heading
        (rad) of these bodies to batch.starts(name), for an entry `name` of the member `starts`. Rows that it does not
        write keep the poses of the previous episode; NaN means the place that the world gives. copies: one bool per
        copy, True for the copies that begin an episode. seeds: one seed per copy, that of the episode that it begins
        next; if poses are drawn from numpy.random.default_rng(seed), episodes with equal seeds are equal. batch.options
        has the options that reset() of the environment was given. Placed bodies may overlap others. A pose outside the
        bounds of the world makes the reset or step raise ValueError. By default it does nothing."""

    def begin(self, batch: Batch, copies: npt.NDArray[np.bool_]) -> None:
        """Called after some copies have begun an episode. copies: one bool per copy, True for the copies that have
        begun one. batch.options has the options that reset() of the environment was given; it is empty if a step has
        begun the episodes. By default the function does nothing."""

    def act(self, batch: Batch, team: int, actions: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Converts the actions of the policies to commands. Actions and commands are numbers from -1 to 1, copies x
        robots x commands; the index of a discrete action has already been replaced by the numbers of Team.choices or
        Team.levels. By default the actions are the commands. The function may change the array `actions`, which is a
        copy. A result of another shape makes the step raise ValueError."""
        return actions

    def reward(self, batch: Batch, team: int) -> Optional[npt.NDArray[np.float64]]:
        """Returns rewards that are added to those of Team.rewards, copies x robots, or None for no rewards. Called once
        per step, after the step. Rewards for robots that were finished before the step or are not in the world are
        ignored. A result of another shape, and any other reward that is not finite, makes the step raise ValueError."""
        return None

    def terminated(self, batch: Batch, team: int) -> Optional[npt.NDArray[np.bool_]]:
        """Returns which robots are finished in addition to those of Team.ends: bools, copies x robots, or None for no
        robots. Called once per step, after reward(). True for a robot that is not in the world has no effect. A result
        of another shape, or of another type than bool, makes the step raise ValueError."""
        return None

    def observe(self, batch: Batch, team: int, name: str) -> Optional[npt.NDArray[np.float32]]:
        """Returns columns to append to the observed array `name` (a key of Team.observation, or "observation" if that
        is a list), copies x robots x columns, or None for no columns. In the observation space, these columns have the
        bounds -1 and 1. In the rows of robots that are not in the world, the columns are replaced by 0. Also called
        before the first episode, to find the number of columns, which must not change later. A result of another shape,
        and any result but None for an array whose part has a "shape", raises ValueError."""
        return None

    def info(self, batch: Batch, team: int) -> Optional[Dict[str, npt.NDArray[Any]]]:
        """Returns values that the environments return in their infos, such as the terms of a reward: a dict from names
        to arrays of numbers or bools, copies x robots or copies x robots x further axes, or None for no values. Called
        by each reset, after begin(), and by each step, after terminated(). Robots that are not in the world also have
        elements. A result of another shape or type makes the reset or the step raise ValueError or TypeError, and so
        does a name that the environments use themselves: `finished`, `alive`, `final_obs`, `final_info` and names that
        begin with an underscore."""
        return None

    def baseline(self, observations: Any, team: int = 0) -> npt.NDArray[np.float64]:
        """Returns the actions of a hand-written policy, with which learned policies can be compared: one row of actions
        per row of the observations. Raises NotImplementedError if the task defines no such policy."""
        raise NotImplementedError(f"{type(self).__name__} has no baseline: define the method baseline()")


def require_task(task: Any) -> None:
    """Raises TypeError if the argument `task` of an environment is not a Task, or if its teams are not a list of
    Teams."""
    if not isinstance(task, Task):
        raise TypeError(f"task: must be a troupe.envs.Task, found {task!r}")
    if task.teams and not (isinstance(task.teams, (list, tuple)) and all(isinstance(team, Team) for team in task.teams)):
        raise TypeError(f"{type(task).__name__}.teams: must be a list of troupe.envs.Team, found {task.teams!r}")


def require_one_team(task: Any, environment: str) -> None:
    """Raises TypeError if the argument `task` of an environment is not a Task, and ValueError if the task has several
    teams. environment: the class, for the error text."""
    require_task(task)
    if task.teams and len(task.teams) != 1:
        raise ValueError(
            f"{environment} needs a task with one team, but {type(task).__name__} has {len(task.teams)}: "
            "set its member `teams` to a list of one Team, or use ParallelEnv for several teams"
        )


def check_task(task: Task) -> None:
    """Raises TypeError if Task.seconds is not a number, or if Task.measures is not a list of texts. Warns of attributes
    of a task that Task does not have but whose names are similar to those of its members, such as `second`."""
    if not isinstance(task.seconds, numbers.Real):
        raise TypeError(f"{type(task).__name__}.seconds: must be a number of seconds, found {task.seconds!r}")
    if not isinstance(task.measures, (list, tuple)) or not all(isinstance(name, str) for name in task.measures):
        raise TypeError(f"{type(task).__name__}.measures: must be a list of names of measures, found {task.measures!r}")
    own = {name for cls in type(task).__mro__ if issubclass(cls, Task) for name in vars(cls)} | set(vars(task))
    for name, near in misspelt_members(Task, own):
        warnings.warn(f'{type(task).__name__} has the attribute "{name}", which Task does not use: did you mean "{near}"?',
                      stacklevel=_level_of_the_program())


def _level_of_the_program() -> int:
    """Returns the stack level, for warnings of the function that calls this one, of the code that called this
    package."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("troupe."):
        level, frame = level + 1, frame.f_back
    return level


class Batch:
    """Copies of the world of a task (a troupe.BatchEnv), with the observations, actions and rewards of the task.

    copies   number of copies of the world
    threads  number of threads; 0: one per processor that the process may use. The number changes no result
    robot    name of a robot: only this robot learns, and the others run the controllers of the world file. None: all
             robots of the teams learn
    max_episode_steps
             number of steps after which an episode is truncated, if it has not reached task.seconds before
    options  keyword arguments of troupe.Simulation, except threads
    errors   TypeError or ValueError for an invalid task or number of copies or steps; LookupError for an unknown robot
             and for unknown names in the task; InputError for an invalid world
    """

    def __init__(
        self,
        task: Task,
        copies: int,
        *,
        threads: int = 0,
        robot: Optional[str] = None,
        max_episode_steps: Optional[int] = None,
        **options: Any,
    ) -> None:
        require_task(task)
        check_task(task)
        if max_episode_steps is not None and not is_whole(max_episode_steps):
            raise ValueError(f"max_episode_steps={max_episode_steps!r}: give a whole number above 0, or None")
        self.task = task
        if not task.teams:
            raise ValueError(f"{type(task).__name__} has no teams: set its member `teams` to a list of Teams")
        self.teams = [dataclasses.replace(team) for team in task.teams]
        if robot is not None:
            if not isinstance(robot, str) or not robot:
                raise TypeError(f'robot: found {robot!r}: give the name of a robot, such as "r0"')
            if len(self.teams) != 1:
                raise ValueError(
                    f"robot={robot!r} needs a task with one team, but {type(task).__name__} has {len(self.teams)}: "
                    "give the task one team, or use ParallelEnv without robot"
                )
            self.teams[0].robots = robot
        for index, team in enumerate(self.teams):
            check_team(team)
            team.name = team.name or f"team{index}"
        if isinstance(task.world, dict):
            options.setdefault("name", f"{type(task).__name__}.json")
        simulation = Simulation(copy.deepcopy(task.world), threads=1, **options)
        seconds = float(task.seconds)
        if max_episode_steps is not None:
            seconds = min(seconds, int(max_episode_steps) * task.ticks * simulation.tick_s)
        spec = {
            "copies": copies,
            "threads": threads,
            "ticks": task.ticks,
            "seconds": seconds,
            "measures": list(task.measures),
            "starts": list(task.starts),
            "teams": [_team_spec(team, robot or "") for team in self.teams],
        }
        self.core = BatchEnv(simulation, spec)
        self.copies = copies
        self.step_s = task.ticks * simulation.tick_s  #: simulated time of a step, s
        #: Data that a task stores about the copies, such as which robots have a load. State hashes do not cover them.
        self.memory: Dict[str, Any] = {}
        #: Options for Task.place() and Task.begin(): those that the last reset() was given; empty in a step that begins
        #: episodes, and after it.
        self.options: Dict[str, Any] = {}
        self.names = [self.core.names(index) for index in range(len(self.teams))]
        self._columns_added: Dict[Tuple[int, str], int] = {}  # by Task.observe(), for each team and observed array
        self.observation_spaces: List[spaces.Space[Any]] = [
            self._observation_space(index, simulation) for index in range(len(self.teams))
        ]
        self.action_spaces = [action_space(team) for team in self.teams]
        # One bool per copy: True before the first reset, and after a reset or a step that an exception has ended: the
        # task may then not have seen the last step of the simulation.
        self._needs_reset = np.ones(copies, np.bool_)

    def array(self, name: str, team: int = 0) -> npt.NDArray[Any]:
        """Returns the values of an array of a team after the last step: copies x robots x columns, read-only. Its
        content changes with the next step. name: a key of Team.arrays or of Team.observation; "observation" if
        Team.observation is a list. Raises LookupError for an unknown name."""
        return self.core.array(name, team)

    def starts(self, name: str) -> npt.NDArray[np.float64]:
        """Returns the array into which Task.place() writes the poses at which the bodies of an entry of Task.starts
        begin the next episodes: copies x bodies x 3: x, y (m) and heading (rad) in the world frame. NaN in a row (at
        first, in all rows): the body begins where the world places it. Raises LookupError for an unknown name."""
        return self.core.starts(name)

    def reset(
        self,
        which: Optional[FlagsLike] = None,
        seeds: Sequence[Optional[int]] = (),
        options: Optional[Dict[str, Any]] = None,
    ) -> None:
        """Begins an episode in some copies. which: one bool per copy, True for copies that begin one; None: all copies.
        seeds: one seed per copy. A copy without a seed (None, or an empty list) begins its next episode, whose seed is
        derived from the last seed that the copy was given (at first: the seed of the world plus the index of the copy).
        options: a dict that Task.place() and Task.begin() find as batch.options. Raises TypeError for options that are
        not a dict and for a seed that is not a whole number, and ValueError for one that is not from 0 to 2^64 - 1 and
        for a list of another length than the number of copies; the copies then remain as they are."""
        if isinstance(seeds, str) or not hasattr(seeds, "__iter__"):
            raise TypeError(f"seeds: found {seeds!r}: give a list with one seed or None per copy")
        own_seeds = [None if seed is None else _seed_of(seed) for seed in seeds]
        if own_seeds and len(own_seeds) != self.copies:
            raise ValueError(f"seeds: found a list of {len(own_seeds)} seeds: give {self.copies}, one per copy")
        if options is not None and not isinstance(options, dict):
            raise TypeError(f"options: found {options!r}: give a dict")
        begins = np.ones(self.copies, np.bool_) if which is None else self._flags_of("which", which)
        self._needs_reset |= begins
        self.options = dict(options or {})
        seeds_to_come = self.core.next_seeds
        for index, seed in enumerate(own_seeds):
            if seed is not None:
                seeds_to_come[index] = seed
        self.task.place(self, begins, seeds_to_come)
        self.core.reset(begins, own_seeds)
        self.task.begin(self, begins)
        self._needs_reset &= ~begins

    def _flags_of(self, name: str, given: Any) -> Flags:
        """Returns an argument with one bool per copy as an array. Raises ValueError for any other value."""
        flags = np.array(given)
        if flags.dtype.kind != "b" or flags.shape != (self.copies,):
            raise ValueError(f"{name}: found {given!r}: give one bool for each of the {self.copies} copies")
        return flags

    def require_reset(self) -> None:
        """Raises RuntimeError if the copies cannot make a step, because they have not begun an episode, because an
        exception, such as KeyboardInterrupt, has ended a step, or because another thread steps them."""
        if self._needs_reset.any():
            self.core.tick(0)  # raises RuntimeError if another thread steps the copies
            raise RuntimeError(
                "step(): call reset() before the first step, and after a step or reset that an exception has ended "
                f"({self._needs_reset.sum()} of {self.copies} copies need a reset)"
            )

    def step(self, actions: Sequence[Any], begins: Optional[FlagsLike] = None) -> None:
        """Advances all copies by one step. actions: one array per team, copies x robots x the shape of an action.
        begins: one bool per copy; copies with True begin their next episode instead of making a step. Raises ValueError
        for actions of another number or shape, if Task.act() returns commands of another shape than copies x robots x
        commands, and if Task.reward() or Task.terminated() returns an array of another shape than copies x robots,
        or if Task.reward() returns a number that is not finite. Raises StepError if the step of a copy fails, also
        because a reward of Team.rewards is not finite. Raises RuntimeError before the first reset(). After an exception
        that was raised when copies had already made their step, such as KeyboardInterrupt, all copies need a reset()
        before the next step; until then, step() raises RuntimeError."""
        self.require_reset()
        marks = None if begins is None else self._flags_of("begins", begins)
        if len(actions) != len(self.teams):
            raise ValueError(f"actions: found {len(actions)}: give {len(self.teams)}, one array per team")
        finished = [self.core.terminated(index).copy() for index in range(len(self.teams))]
        for index, team in enumerate(self.teams):
            # NumPy would broadcast an array of another shape, so that robots would get wrong commands.
            target = self.core.actions(index)
            shape, found = target.shape[:2] + (self.action_spaces[index].shape or ()), np.shape(actions[index])
            if found != shape:
                raise ValueError(f'actions of team "{team.name}": must have the shape {shape}, found {found}')
            commands = self.task.act(self, index, commands_of(team, actions[index]))
            self._check_result("act", team, commands, target.shape, "copies, robots, commands", _NUMBERS)
            target[...] = commands
        if marks is not None and marks.any():
            self.options = {}
            self.task.place(self, marks, self.core.next_seeds)
        self._needs_reset[:] = True
        try:
            self.core.step(marks)
        except ValueError:
            # An action that is not finite, of a copy that makes a step, is reported before any copy has made one.
            steps = np.ones(self.copies, np.bool_) if marks is None else ~marks
            self._needs_reset[:] = all(np.isfinite(self.core.actions(index)[steps]).all() for index in range(len(self.teams)))
            raise
        for index, team in enumerate(self.teams):
            # As with Team.rewards and Team.ends, a robot that is finished or not in the world gets no reward and no end.
            counts = ~finished[index] & self.core.alive(index)
            if marks is not None:
                counts &= ~marks[:, np.newaxis]
            more = self.task.reward(self, index)
            if more is not None:
                self._check_result("reward", team, more, counts.shape, "copies, robots", _NUMBERS)
                gained = np.where(counts, more, 0.0)
                self._check_finite(team, index, gained)
                self.core.rewards(index)[...] += gained
            ends = self.task.terminated(self, index)
            if ends is not None:
                self._check_result("terminated", team, ends, counts.shape, "copies, robots", _BOOLS)
                self.core.terminated(index)[...] |= ends & counts
        if marks is not None and marks.any():
            self.task.begin(self, marks)
        self._needs_reset[:] = False

    def _check_result(self, function: str, team: Team, result: Any, shape: Sequence[Optional[int]], axes: str, kinds: str) -> None:
        """Raises ValueError if a function of the task returned an array of another shape, which NumPy would broadcast,
        or of another kind of elements. shape: a number per axis; None: any number."""
        found = np.asarray(result)
        of = f'{type(self.task).__name__}.{function}(), team "{team.name}"'
        if found.ndim != len(shape) or any(size not in (None, own) for size, own in zip(shape, found.shape)):
            wanted = ", ".join("any" if size is None else str(size) for size in shape)
            raise ValueError(
                f"{of}: must return an array of the shape ({wanted}) ({axes}), found {found.shape if result is not None else None}"
            )
        if found.dtype.kind not in kinds:
            raise ValueError(f"{of}: must return {_KINDS[kinds]}, found elements of the type {found.dtype}")

    def _check_finite(self, team: Team, index: int, rewards: npt.NDArray[np.float64]) -> None:
        """Raises ValueError if a reward, copies x robots, is infinite or NaN."""
        wrong = np.argwhere(~np.isfinite(rewards))
        if wrong.size:
            of_copy, robot = (int(number) for number in wrong[0])
            raise ValueError(
                f'{type(self.task).__name__}.reward(), team "{team.name}": returned {rewards[of_copy, robot]} for robot '
                f'"{self.names[index][robot]}" in copy {of_copy} (counted from 0) at tick {self.core.tick(of_copy)}: '
                "return finite rewards"
            )

    def observations(self, team: int = 0) -> Any:
        """Returns the observations of a team as new arrays: an array, or a dict of arrays if Team.observation is a
        dict, of copies x robots x columns (of copies x robots x shape for a part with the member "shape")."""
        observation = self.teams[team].observation
        if isinstance(observation, dict):
            return {name: self._observed(name, parts, team) for name, parts in observation.items()}
        return self._observed(_ONLY, observation, team)

    def infos(self, team: int = 0) -> Dict[str, npt.NDArray[Any]]:
        """Returns the values of Task.info() after the last step, as new arrays; an empty dict if it returns None."""
        given = self.task.info(self, team)
        if given is None:
            return {}
        of = f'{type(self.task).__name__}.info(), team "{self.teams[team].name}"'
        if not isinstance(given, dict):
            raise TypeError(f"{of}: must return a dict from names to arrays, found {given!r}")
        infos = {}
        for name, values in given.items():
            if not isinstance(name, str) or name.startswith("_") or name in _OWN_INFOS:
                raise ValueError(
                    f"{of}: found the name {name!r}: give a text that does not begin with an underscore and is none of "
                    f"{', '.join(_OWN_INFOS)}"
                )
            shape = (self.copies, len(self.names[team])) + (None,) * (np.ndim(values) - 2)
            self._check_result("info", self.teams[team], values, shape, f'copies, robots of "{name}"', _NUMBERS)
            infos[name] = np.array(values)
        return infos

    def _observed(self, name: str, parts: List[Dict[str, Any]], team: int) -> npt.NDArray[Any]:
        own = self.core.array(name, team)
        more = self._added(name, parts, team, self._columns_added[team, name])
        if more is not None:
            there = self.core.alive(team)[..., np.newaxis]
            return np.concatenate([own, np.where(there, more, 0.0).astype(np.float32)], axis=-1)
        shape = _shape_of(parts)
        return own.copy() if shape is None else own.reshape(own.shape[:2] + shape).copy()

    def _added(self, name: str, parts: List[Dict[str, Any]], team: int, columns: Optional[int]) -> Any:
        """Returns the columns that Task.observe() adds to an observed array, copies x robots x columns, or None if
        there are none. columns: their number; None: any number. Raises ValueError if the function returns anything
        else."""
        more = self.task.observe(self, team, name)
        if more is None and not columns:
            return None
        if _shape_of(parts) is not None:
            raise ValueError(
                f'{type(self.task).__name__}.observe(), team "{self.teams[team].name}": must return None for the array "{name}", '
                'which has a part with a "shape" and can have no other columns'
            )
        axes = f'copies, robots, columns of "{name}"'
        self._check_result("observe", self.teams[team], more, (self.copies, len(self.names[team]), columns), axes, _NUMBERS)
        return more

    def _observation_space(self, team: int, simulation: Simulation) -> "spaces.Space[Any]":
        observation = self.teams[team].observation
        if isinstance(observation, dict):
            return spaces.Dict({name: self._box(name, parts, team, simulation) for name, parts in observation.items()})
        return self._box(_ONLY, observation, team, simulation)

    def _box(self, name: str, parts: List[Dict[str, Any]], team: int, simulation: Simulation) -> spaces.Box:
        array = self.core.array(name, team)
        more = self._added(name, parts, team, None)
        columns = self._columns_added[team, name] = 0 if more is None else np.shape(more)[-1]
        shape = _shape_of(parts)
        if shape is not None:
            if np.prod(shape) != array.shape[-1]:
                raise ValueError(
                    f'array "{name}" of team "{self.teams[team].name}": the field "{parts[0]["field"]}" has {array.shape[-1]} '
                    f"elements, which do not fill the shape {shape}"
                )
            info: Any = np.iinfo(array.dtype) if array.dtype.kind in "iu" else np.finfo(array.dtype)
            low, high = parts[0].get("low", info.min), parts[0].get("high", info.max)
            return spaces.Box(low, high, shape, array.dtype.type)
        lows: List[float] = []
        highs: List[float] = []
        for part in parts:
            low, high = _bounds(part, simulation, self.names[team])
            lows += low
            highs += high
        low, high = -_rounded_up(-np.array(lows + [-1.0] * columns)), _rounded_up(np.array(highs + [1.0] * columns))
        return spaces.Box(low, high, dtype=np.float32)


def one_copy(task: Task, **options: Any) -> Batch:
    """Returns a Batch with one copy of the world and one thread, because a copy uses only one. options: those of Batch,
    except threads, which raises TypeError. Without the option seed, the seed of the world is random, as Gymnasium
    requires for the first reset() without a seed: several environments must differ."""
    if "threads" in options:
        raise TypeError("threads: an environment with one copy of the world uses one thread: omit threads, or use VectorEnv")
    if options.get("seed") is None:
        options["seed"] = secrets.randbits(64)
    return Batch(task, 1, threads=1, **options)


def _shape_of(parts: List[Dict[str, Any]]) -> Any:
    return tuple(map(int, parts[0]["shape"])) if len(parts) == 1 and "shape" in parts[0] else None


def _team_spec(team: Team, robot: str) -> Dict[str, Any]:
    observation = team.observation if isinstance(team.observation, dict) else {_ONLY: team.observation}
    return {
        "name": team.name,
        "robots": team.robots,
        "robot": robot,
        "arrays": [
            {
                "name": name,
                "raw": _shape_of(parts) is not None,
                "parts": [{key: part[key] for key in part if key not in _OF_SPACE} for part in parts],
            }
            for name, parts in {**observation, **team.arrays}.items()
        ],
        "actions": team.actions,
        "rewards": team.rewards,
        "ends": team.ends,
    }


def _rounded_up(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """Returns the values as float32, rounded towards infinity: no number up to a value is above the result, also if the
    number has been rounded to float32."""
    near = values.astype(np.float32)
    return np.where(near < values, np.nextafter(near, np.float32(np.inf)), near)


def _range_bound(simulation: Simulation, robots: List[str], device: str) -> float:
    """Returns an upper bound of the ranges, float32, that the robots measure with a ranger, m."""
    swarms = [simulation.swarm(simulation.find(robot)) for robot in robots]
    return float(_rounded_up(np.array(max(swarm.range_bound(device) for swarm in swarms))))


def _bounds(part: Dict[str, Any], simulation: Simulation, robots: List[str]) -> Any:
    """Returns the lower and upper bounds of the columns of a part of an observation (Team.observation): the members low
    and high of the part if given, or else the bounds that the kind of the part implies for all robots of the team."""
    of = part.get("of", "reading")
    scale = part.get("scale", 1.0)
    infinity = float("inf")
    reach = part.get("range_m", infinity) * abs(scale)
    if of == "nearest":
        low, high = [-reach, -reach, -1.0, -1.0, 0.0], [reach, reach, 1.0, 1.0, 1.0]
        low, high = low * part.get("count", 1), high * part.get("count", 1)
    elif of in ("pose", "estimate"):
        low, high = [-infinity, -infinity, -1.0, -1.0], [infinity, infinity, 1.0, 1.0]
    elif of in ("stalled", "time_left"):
        low, high = [0.0], [1.0]
    elif of in ("speed", "target"):
        low, high = [-infinity] * 3, [infinity] * 3
    else:
        device, field = part.get("device", ""), part["field"]
        first = simulation.find(robots[0])  # all robots of a team have as many readings
        simulation.swarm(first).subscribe()
        count = len(np.atleast_1d(first.readings(field, *([device] if device else []))))
        is_range = field == "ranges"
        bound = _range_bound(simulation, robots, device) * scale if is_range else infinity
        low, high = [min(bound, 0.0) if is_range else -infinity] * count, [max(bound, 0.0)] * count
    if "low" in part:
        low = [float(part["low"])] * len(low)
    if "high" in part:
        high = [float(part["high"])] * len(high)
    return low, high

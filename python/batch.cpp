#include "apps/messages.hpp"
#include "base/scoped_flag.hpp"
#include "live/view.hpp"
#include "partition/job_thread.hpp"
#include "python/bindings.hpp"
#include "python/whole_numbers.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

/// A batch owned by Python. Arrays that refer to its memory keep it alive. The batch steps without the
/// interpreter's lock, so that other Python threads can run. During a step, use() throws.
///
/// A step may wait in a live view, on any thread of the batch. Only Python's main thread can notice Ctrl-C.
/// If the batch has a view, a step of the main thread therefore runs on another thread, while the main thread
/// handles signals.
class HeldBatch {
 public:
  explicit HeldBatch(BatchEnv&& batch) : batch_(std::move(batch)) {}

  BatchEnv& use() {
    if (is_busy_)
      throw std::logic_error(
          "this batch is being stepped by another thread: only one thread at a time may use a batch");
    return batch_;
  }
  template <class Work>
  void work(Work&& what) {
    BatchEnv& batch = use();
    // Another thread could otherwise destroy a view while the step waits in it.
    std::vector<std::shared_ptr<void>> views;
    for (const std::weak_ptr<void>& view : views_) views.push_back(view.lock());
    const ScopedFlag busy(is_busy_);
    is_cancelled_ = false;
    const bool has_view = std::ranges::any_of(views, [](const auto& view) { return view != nullptr; });
    if (has_view && is_main_thread()) return work_elsewhere([&] { what(batch); });
    const InterruptDelay delay;
    const Unlocked unlocked;
    what(batch);
  }
  /// Whether steps must no longer wait in a view, because a signal handler of Python has raised an exception.
  /// May be called on any thread.
  bool is_cancelled() const { return is_cancelled_; }
  /// Keeps `view`, a live view of a copy, alive during each later call of work(), and not between two calls.
  void keep_while_stepping(const std::shared_ptr<void>& view) {
    std::erase_if(views_, [](const std::weak_ptr<void>& each) { return each.expired(); });
    views_.emplace_back(view);
  }

 private:
  void work_elsewhere(const std::function<void()>& task);

  BatchEnv batch_;
  bool is_busy_ = false;  // read and written only with the interpreter's lock
  std::atomic<bool> is_cancelled_ = false;
  std::vector<std::weak_ptr<void>> views_;
};

/// Runs a task on another thread and waits for its end. Meanwhile, the calling thread, which must be the main
/// thread and hold the interpreter's lock, calls the signal handlers of Python. If one of them raises an
/// exception, as that of Ctrl-C does, is_cancelled() becomes true, and the exception is thrown after the end
/// of the task. Otherwise throws the exception of the task. Throws the error of partition::throw_no_thread()
/// if the system allows no further thread.
void HeldBatch::work_elsewhere(const std::function<void()>& task) {
  constexpr std::chrono::milliseconds k_patience(50);
  std::mutex mutex;
  std::condition_variable ended;
  bool is_done = false;
  std::exception_ptr failed;
  std::exception_ptr raised;
  std::thread worker;
  try {
    worker = std::thread([&] {
      try {
        task();
      } catch (...) {
        failed = std::current_exception();
      }
      const std::scoped_lock lock(mutex);
      is_done = true;
      ended.notify_one();
    });
  } catch (const std::system_error& error) {
    partition::throw_no_thread(error);
  }
  for (bool goes_on = true; goes_on;) {
    {
      const Unlocked unlocked;
      std::unique_lock lock(mutex);
      goes_on = !ended.wait_for(lock, k_patience, [&] { return is_done; });
      lock.unlock();
      if (!goes_on) worker.join();
    }
    if (PyErr_CheckSignals() == 0) continue;
    raised = std::make_exception_ptr(py::error_already_set());
    is_cancelled_ = true;
  }
  if (raised) std::rethrow_exception(raised);
  if (failed) std::rethrow_exception(failed);
}

using BatchHolder = std::shared_ptr<HeldBatch>;

/// The live view of one of the copies of a world in a batch. Python owns the view, which keeps the batch
/// alive.
class HeldBatchView {
 public:
  HeldBatchView(BatchHolder held, std::size_t copy, live::View::Options options)
      : held_(std::move(held)), state_(std::make_shared<State>()) {
    BatchEnv& batch = held_->use();
    if (copy >= batch.copies())
      throw py::index_error(
          fmt::format("copy {} does not exist: give a number from 0 to {}", copy, batch.copies() - 1));
    options.is_over = [held = held_.get(), state = state_.get()] {
      return state->is_closed || held->is_cancelled() || is_interrupted();
    };
    options.report = [](const std::string& text) { apps::print_message(fmt::format("view: {}\n", text)); };
    state_->view.emplace(batch.simulation(copy), options);
    held_->keep_while_stepping(state_);
  }
  HeldBatchView(const HeldBatchView&) = delete;
  HeldBatchView& operator=(const HeldBatchView&) = delete;
  ~HeldBatchView() {
    if (state_) state_->is_closed = true;
  }

  const live::View& open() const {
    if (!state_) throw std::logic_error("the view is closed: open another one");
    return *state_->view;
  }
  void close() {
    held_->use();  // throws while another thread steps the batch
    state_.reset();
  }

 private:
  /// Owned by this object and, while the batch steps, by `held_`.
  struct State {
    std::atomic<bool> is_closed = false;  // Python has released the view
    std::optional<live::View> view;       // last, because it uses the member above
  };

  BatchHolder held_;
  std::shared_ptr<State> state_;  // null: closed
};

/// Describes, for error messages, what a member of type T must be, such as "a list".
template <class T>
constexpr std::string_view expected() {
  if constexpr (std::is_same_v<T, py::list>)
    return "a list";
  else if constexpr (std::is_same_v<T, bool>)
    return "a bool";
  else if constexpr (std::is_same_v<T, std::string>)
    return "a string";
  else if constexpr (std::is_integral_v<T>)
    return std::is_unsigned_v<T> ? "a whole number from 0" : "a whole number";
  else if constexpr (std::is_floating_point_v<T> || std::is_same_v<T, std::optional<double>>)
    return "a number";
  else
    return "a list of strings";
}

/// Reads the members of a dict into variables. A variable keeps its value if the dict lacks its member.
/// finish() throws if the dict has members that were not read.
class Members {
 public:
  Members(std::string what, const py::handle& given) : what_(std::move(what)) {
    if (!py::isinstance<py::dict>(given))
      throw py::type_error(fmt::format("{}: must be a dict, found {}", what_, std::string(py::repr(given))));
    members_ = py::reinterpret_steal<py::dict>(PyDict_Copy(given.ptr()));
  }
  /// Adds a name to those that the error of finish() lists.
  void know(const char* name) { known_.emplace_back(name); }
  template <class T>
  void read(const char* name, T& into) {
    know(name);
    if (!members_.contains(name)) return;
    const py::object value = members_.attr("pop")(name);
    try {
      // cast<py::list>() would make a list of a text, too, and raise Python's TypeError for None.
      if (std::is_same_v<T, py::list> && !py::isinstance<py::list>(value) &&
          !py::isinstance<py::tuple>(value))
        throw py::cast_error();
      // cast<bool>() would take the truth of any object, such as None or 0.5.
      if (std::is_same_v<T, bool> && !py::detail::make_caster<bool>().load(value, false))
        throw py::cast_error();
      into = value.cast<T>();
    } catch (const py::cast_error&) {
      throw py::type_error(fmt::format("{}: the value {} of the member \"{}\" must be {}", what_,
                                       std::string(py::repr(value)), name, expected<T>()));
    }
  }
  template <class Visit>
  void each(const char* name, Visit&& visit) {
    py::list list;
    read(name, list);
    for (std::size_t i = 0; i < list.size(); ++i) visit(fmt::format("{}/{}/{}", what_, name, i), list[i]);
  }
  void finish() const {
    for (const auto& [name, value] : members_)
      throw py::value_error(
          fmt::format("{}: {}", what_,
                      unknown_name("member", std::string(py::str(name)), {known_.begin(), known_.end()})));
  }

 private:
  std::string what_;
  py::dict members_;
  std::vector<std::string> known_;
};

BatchPart part_of(const std::string& what, const py::handle& given) {
  constexpr std::array<std::string_view, 8> k_names{"reading", "pose",    "estimate", "speed",
                                                    "stalled", "nearest", "target",   "time_left"};
  BatchPart part;
  std::string of = "reading";
  Members members(what, given);
  members.read("of", of);
  members.read("device", part.device);
  members.read("field", part.field);
  members.read("name", part.name);
  members.read("count", part.count);
  members.read("range_m", part.range_m);
  members.read("scale", part.scale);
  for (const char* name : {"low", "high", "shape"}) members.know(name);  // troupe.envs uses and removes these
  members.finish();
  const auto found = std::ranges::find(k_names, of);
  if (found == k_names.end())
    throw py::value_error(
        fmt::format("{}: {}", what, unknown_name("kind of part", of, {k_names.begin(), k_names.end()})));
  part.of = static_cast<BatchPart::Of>(found - k_names.begin());
  return part;
}

BatchTeam team_of(const std::string& what, const py::handle& given) {
  BatchTeam team;
  Members members(what, given);
  members.read("name", team.name);
  members.read("robots", team.robots);
  members.read("robot", team.robot);
  members.each("arrays", [&](const std::string& at, const py::handle& each) {
    BatchArraySpec& array = team.arrays.emplace_back();
    Members of(at, each);
    of.read("name", array.name);
    of.read("raw", array.raw);
    of.each("parts", [&](const std::string& where, const py::handle& part) {
      array.parts.push_back(part_of(where, part));
    });
    of.finish();
  });
  members.each("actions", [&](const std::string& at, const py::handle& each) {
    BatchAction& action = team.actions.emplace_back();
    Members of(at, each);
    of.read("device", action.device);
    of.read("command", action.command);
    of.read("low", action.low);
    of.read("high", action.high);
    of.finish();
  });
  const auto read_column = [](Members& of, BatchColumn& column) {
    of.read("array", column.array);
    of.read("column", column.column);
    of.read("measure", column.measure);
  };
  members.each("rewards", [&](const std::string& at, const py::handle& each) {
    BatchReward& reward = team.rewards.emplace_back();
    Members of(at, each);
    read_column(of, reward.of);
    of.read("weight", reward.weight);
    of.read("change", reward.change);
    of.finish();
  });
  members.each("ends", [&](const std::string& at, const py::handle& each) {
    BatchEnd& end = team.ends.emplace_back();
    std::optional<double> below;
    std::optional<double> above;
    Members of(at, each);
    read_column(of, end.of);
    of.read("below", below);
    of.read("above", above);
    of.read("reward", end.reward);
    of.finish();
    if (below.has_value() == above.has_value())
      throw py::value_error(
          fmt::format("{}: must have exactly one of the members \"below\" and \"above\", found {}", at,
                      below ? "both" : "neither"));
    end.is_above = above.has_value();
    end.below = end.is_above ? *above : *below;
  });
  members.finish();
  return team;
}

BatchHolder make_batch(const Holder& world, const py::dict& given) {
  BatchSpec spec;
  Members members("batch", given);
  members.read("copies", spec.copies);
  members.read("threads", spec.threads);
  members.read("ticks", spec.ticks);
  members.read("seconds", spec.seconds);
  members.read("measures", spec.measures);
  members.read("starts", spec.starts);
  members.each("teams", [&](const std::string& at, const py::handle& each) {
    spec.teams.push_back(team_of(at, each));
  });
  members.finish();
  BatchHolder batch;
  world->work(
      [&](Simulation& simulation) { batch = std::make_shared<HeldBatch>(BatchEnv(simulation, spec)); });
  return batch;
}

/// Shows memory of a batch as an array. Python can write to it unless its elements are const.
template <class T>
py::array shown(const py::dtype& type, std::vector<py::ssize_t> shape, std::span<T> values,
                const BatchHolder& owner) {
  py::array array(type, std::move(shape), values.data(), py::cast(owner));
  if (std::is_const_v<T>)
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::ssize_t extent(std::size_t size) { return static_cast<py::ssize_t>(size); }

/// An array with one element per copy.
template <class Element, class T>
py::array per_copy(std::span<T> values, const BatchHolder& owner) {
  return shown(py::dtype::of<Element>(), {extent(values.size())}, values, owner);
}

/// An array with one element per robot of a team: copies x robots.
template <class Element, class T>
py::array per_robot(std::span<T> values, const BatchHolder& owner) {
  const std::size_t copies = owner->use().copies();
  return shown(py::dtype::of<Element>(), {extent(copies), extent(values.size() / copies)}, values, owner);
}

std::vector<std::uint8_t> marks_of(const std::optional<py::array>& given, const BatchEnv& batch,
                                   std::string_view name) {
  if (!given) return {};
  if (given->dtype().kind() != 'b' || given->ndim() != 1 ||
      static_cast<std::size_t>(given->size()) != batch.copies())
    throw py::value_error(fmt::format(
        "{}: give an array of one bool for each of the {} copies, not of {} with shape {}", name,
        batch.copies(), std::string(py::str(given->dtype())), std::string(py::str(given->attr("shape")))));
  const py::array_t<bool, py::array::c_style | py::array::forcecast> marks(*given);
  return {marks.data(), marks.data() + marks.size()};
}

/// Returns the argument `seeds` of BatchEnv.reset(): a list with one seed or None per copy.
std::vector<std::optional<std::uint64_t>> seeds_of(const py::object& given) {
  if (!py::isinstance<py::iterable>(given) || py::isinstance<py::str>(given))
    throw py::type_error(fmt::format("seeds: found {}: give a list with one seed or None per copy",
                                     std::string(py::repr(given))));
  std::vector<std::optional<std::uint64_t>> seeds;
  for (const py::handle each : given)
    seeds.push_back(optional_seed_of(py::reinterpret_borrow<py::object>(each)));
  return seeds;
}

using BatchClass = py::class_<HeldBatch, BatchHolder>;

void bind_view(py::module_& module) {
  py::class_<HeldBatchView>(
      module, "BatchView",
      "A copy of the world of a BatchEnv, shown in a browser (docs/live.md); made by BatchEnv.view().")
      .def_property_readonly(
          "address", [](const HeldBatchView& v) { return v.open().address(); },
          "Address of the page for full control.")
      .def_property_readonly(
          "read_only_address", [](const HeldBatchView& v) { return v.open().look_address(); },
          "Address of the page for read-only access.")
      .def("close", &HeldBatchView::close, "Disconnects all users.");
}

void bind_team_arrays(BatchClass& type) {
  type.def(
          "robots", [](const BatchHolder& b, std::size_t team) { return b->use().robots(team); },
          py::arg("team") = 0,
          "Number of robots of a team in each copy, including robots that are not in the world.")
      .def(
          "names", [](const BatchHolder& b, std::size_t team) { return b->use().names(team); },
          py::arg("team") = 0, "Names of the robots of a team, in the order of their ids.")
      .def(
          "array",
          [](const BatchHolder& b, const std::string& name, std::size_t team) {
            BatchEnv& batch = b->use();
            const BatchEnv::Array found = batch.array(team, name);
            return shown(dtype_of(found.element),
                         {extent(batch.copies()), extent(batch.robots(team)), extent(found.columns)},
                         std::span<const std::byte>(found.bytes), b);
          },
          py::arg("name"), py::arg("team") = 0,
          "Returns the array that the spec of a team calls `name`: the values after the last step, copies x "
          "robots x columns,\nread-only. The columns of a robot that is not in the world are 0. Raises "
          "LookupError if the team has no such array.")
      .def(
          "actions",
          [](const BatchHolder& b, std::size_t team) {
            BatchEnv& batch = b->use();
            const std::span<double> actions = batch.actions(team);
            const std::size_t robots = batch.copies() * batch.robots(team);
            return shown(
                py::dtype::of<double>(),
                {extent(batch.copies()), extent(batch.robots(team)), extent(actions.size() / robots)},
                actions, b);
          },
          py::arg("team") = 0,
          "Returns the array into which the caller writes the actions of the next step: copies x robots x "
          "actions, numbers from -1\nto 1. Numbers outside this range are clipped; a number that is not "
          "finite makes step() raise ValueError.")
      .def(
          "rewards",
          [](const BatchHolder& b, std::size_t team) { return per_robot<double>(b->use().rewards(team), b); },
          py::arg("team") = 0, "The rewards of the last step: copies x robots. The caller may change them.")
      .def(
          "terminated",
          [](const BatchHolder& b, std::size_t team) {
            return per_robot<bool>(b->use().terminated(team), b);
          },
          py::arg("team") = 0,
          "copies x robots, bool: True for robots that are finished, that is, whose episode has ended. The "
          "caller may set elements\nto True between two steps, to end the episodes of further robots.")
      .def(
          "alive",
          [](const BatchHolder& b, std::size_t team) { return per_robot<bool>(b->use().alive(team), b); },
          py::arg("team") = 0,
          "copies x robots, bool: True for robots that are in the world (born, and not dead) after the last "
          "step.");
}

void bind_copy_arrays(BatchClass& type) {
  type.def_property_readonly(
          "truncated", [](const BatchHolder& b) { return per_copy<bool>(b->use().truncated(), b); },
          "One bool per copy: whether the episode has reached its largest length, `seconds` of the spec.")
      .def(
          "over", [](const BatchHolder& b) { return per_copy<bool>(b->use().over(), b); },
          "One bool per copy: whether the episode of the copy is over. It is over if it is truncated, or if "
          "at least one robot of\nthe teams is finished and every robot that belongs to a team and is in the "
          "world is finished.")
      .def_property_readonly(
          "measure_columns", [](const BatchHolder& b) { return b->use().measure_columns(); },
          "Names of the columns of the array `measures`, with their units.")
      .def_property_readonly(
          "measures",
          [](const BatchHolder& b) {
            BatchEnv& batch = b->use();
            return shown(py::dtype::of<double>(),
                         {extent(batch.copies()), extent(batch.measure_columns().size())}, batch.measures(),
                         b);
          },
          "The measures (numbers computed from the state of a world) of each copy after the last step: "
          "copies x columns, read-only.")
      .def_property_readonly(
          "seeds", [](const BatchHolder& b) { return per_copy<std::uint64_t>(b->use().seeds(), b); },
          "One seed per copy: the seed of its current episode.");
}

void bind_episodes(BatchClass& type) {
  using Marks = std::optional<py::array>;
  type.def(
          "starts",
          [](const BatchHolder& b, const std::string& name) {
            BatchEnv& batch = b->use();
            const std::span<double> poses = batch.starts(name);
            const std::size_t rows = batch.copies() * BatchEnv::k_start_columns;
            return shown(
                py::dtype::of<double>(),
                {extent(batch.copies()), extent(poses.size() / rows), extent(BatchEnv::k_start_columns)},
                poses, b);
          },
          py::arg("name"),
          "Returns the array into which the caller writes the poses at which the bodies of an entry of "
          "`starts` in the spec begin\nthe next episodes: copies x bodies x 3: x, y (m) and heading (rad) in "
          "the world frame. NaN in a row (at first, in all\nrows): the body begins where the world places "
          "it. "
          "Raises LookupError for another name.")
      .def_property_readonly(
          "next_seeds",
          [](const BatchHolder& b) {
            const std::vector<std::uint64_t> seeds = b->use().next_seeds();
            return py::array_t<std::uint64_t>(extent(seeds.size()), seeds.data());
          },
          "One seed per copy: that of the episode that the copy begins next, unless reset() gives it another "
          "seed.")
      .def(
          "reset",
          [](const BatchHolder& b, const Marks& which, const py::object& seeds) {
            const std::vector<std::uint8_t> marks = marks_of(which, b->use(), "which");
            const std::vector<std::optional<std::uint64_t>> own_seeds = seeds_of(seeds);
            b->work([&](BatchEnv& batch) { batch.reset(marks, own_seeds); });
          },
          py::arg("which") = py::none(), py::arg("seeds") = py::tuple(),
          "Begins an episode in some copies. which: one bool per copy; None: all copies. seeds: one seed or "
          "None per copy; an\nempty list: None for all copies. A copy with None begins its next "
          "episode. The seed of that episode is derived from the\nnumber of the episode and from the last "
          "seed that reset() got for this copy (or, if the copy never got one, from the\nseed of the world "
          "plus the index of the copy). Raises RuntimeError if `which` leaves out a copy that has not begun "
          "an\nepisode.")
      .def(
          "step",
          [](const BatchHolder& b, const Marks& begins) {
            const std::vector<std::uint8_t> marks = marks_of(begins, b->use(), "begins");
            b->work([&](BatchEnv& batch) { batch.step(marks); });
          },
          py::arg("begins") = py::none(),
          "Advances all copies by one step. begins: one bool per copy; copies with True begin their next "
          "episode instead of\n"
          "making a step. None: all copies make a step. Raises RuntimeError before the first reset() and if "
          "the last step or\n"
          "reset of a copy failed, and StepError if the step of a copy fails or gives a reward that is not "
          "finite. Ctrl-C raises\n"
          "KeyboardInterrupt after the step; a step that waits for a view then stops waiting.");
}

py::array_t<std::uint8_t> picture_of(const BatchHolder& b, std::size_t copy, const PictureOptions& options) {
  std::vector<std::uint8_t> bytes;
  b->work([&](BatchEnv& batch) { bytes = batch.simulation(copy).picture(options); });
  return picture_array(bytes, options);
}

void bind_one_copy(BatchClass& type) {
  type.def(
          "tick", [](const BatchHolder& b, std::size_t copy) { return b->use().simulation(copy).tick(); },
          py::arg("copy") = 0, "Number of completed ticks of a copy in its current episode.")
      .def(
          "state_hash",
          [](const BatchHolder& b, std::size_t copy) { return b->use().simulation(copy).state_hash(); },
          py::arg("copy") = 0,
          "Hash of the state of a copy, an integer of 64 bits, as Simulation.state_hash().")
      .def("__repr__",
           [](const BatchHolder& b) { return fmt::format("<BatchEnv of {} copies>", b->use().copies()); });
  with_look([&](const auto&... look) {
    type.def(
        "picture", drawing<const BatchHolder&, std::size_t>(&picture_of), py::arg("copy") = 0,
        py::arg("width") = 480, py::arg("height") = 480, look...,
        "Returns a picture of a copy: height x width x 3, uint8, RGB, row 0 on top. The other options and "
        "errors are those of\nSimulation.picture(). Also raises LookupError if there is no such copy.");
  });
}

}  // namespace

void bind_batch(py::module_& module) {
  bind_view(module);
  BatchClass type(
      module, "BatchEnv",
      "Many copies of one world that step together, each with its own seed: a vectorised environment for "
      "reinforcement learning\n(docs/learning.md). A team is a group of robots that learn one policy; the "
      "parameter `team` of a function is the index\nof a team in the spec. The arrays that functions return "
      "refer to the memory of the batch: their content changes with\neach step and reset.");
  type.def(py::init(&make_batch), py::arg("world"), py::arg("spec"),
           "world: a Simulation, which is copied and not changed. spec: a dict that docs/learning.md "
           "describes. Raises ValueError,\nTypeError, LookupError or InputError for an invalid spec, and "
           "RuntimeError for a simulation that was resumed from a\ncheckpoint.")
      .def(
          "view",
          [](const BatchHolder& b, std::size_t copy, std::uint16_t port, double rate,
             const std::filesystem::path& out) {
            return std::make_unique<HeldBatchView>(
                b, copy, live::View::Options{.port = port, .rate = rate, .folder = out});
          },
          py::arg("copy") = 0, py::kw_only(), py::arg("port") = 0, py::arg("rate") = 1.0,
          py::arg("out") = std::filesystem::path(),
          "Shows the copy with the index `copy` in a browser and returns a BatchView with the address of the "
          "page. From then on,\nsteps of the batch wait while a user has paused the copy. `rate` limits the "
          "speed to a multiple of real time; 0 is no\nlimit. Each episode writes a session file, which lists "
          "the actions of the users, into the folder `out` (an empty path is\nthe current folder). port: TCP "
          "port; 0: any free port (docs/live.md).")
      .def_property_readonly(
          "copies", [](const BatchHolder& b) { return b->use().copies(); }, "Number of copies of the world.")
      .def_property_readonly(
          "threads", [](const BatchHolder& b) { return b->use().threads(); },
          "Number of threads that step the copies.");
  bind_team_arrays(type);
  bind_copy_arrays(type);
  bind_episodes(type);
  bind_one_copy(type);
}

}  // namespace troupe::python

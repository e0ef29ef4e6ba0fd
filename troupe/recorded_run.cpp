#include "troupe/recorded_run.hpp"

#include "base/diagnostics.hpp"
#include "engine/world.hpp"
#include "troupe/simulation.hpp"
#include "troupe/simulation_source.hpp"
#include "worldio/hdf5_file.hpp"
#include "worldio/recording_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace troupe {
namespace {

using worldio::RecordingReader;

constexpr std::array<std::string_view, 4> k_fields = {"x", "y", "z", "heading"};

std::string meta(const RecordingReader& reader, const std::string& key) {
  const auto found = reader.meta().find(key);
  return found == reader.meta().end() ? std::string() : found->second;
}

/// The options with which the run was loaded, as its header says.
SimulationOptions options_of(const RecordingReader& reader,
                             const std::vector<std::filesystem::path>& plugin_path) {
  constexpr std::string_view k_set = "set ";
  SimulationOptions options;
  options.plugin_path = plugin_path;
  std::uint64_t seed = 0;
  const std::string text = meta(reader, "seed");
  if (std::from_chars(text.data(), text.data() + text.size(), seed).ec == std::errc()) options.seed = seed;
  for (const auto& [key, value] : reader.meta())
    if (key.starts_with(k_set) && key.find(" at tick ") == key.npos)
      options.set.emplace_back(key.substr(k_set.size()), value);
  return options;
}

}  // namespace

struct RecordedRun::Impl {
  RecordingReader reader;
  Simulation simulation;
  std::array<const RecordingReader::Array*, 4> arrays{};
  std::size_t frame = 0;

  Impl(const std::filesystem::path& file, const std::vector<std::filesystem::path>& plugin_path)
      : reader(file), simulation(meta(reader, "world"), options_of(reader, plugin_path)) {
    if (reader.frames() == 0) refuse("the recording has no frame");
    for (const RecordingReader::Array& array : reader.arrays()) {
      const auto field = std::ranges::find(k_fields, array.field.name);
      const bool is_pose = array.component == "pose" && field != k_fields.end() &&
                           array.field.element == engine::Element::f64 && array.field.columns == 1;
      if (is_pose) arrays[static_cast<std::size_t>(field - k_fields.begin())] = &array;
    }
    if (std::ranges::any_of(arrays, [](const RecordingReader::Array* array) { return array == nullptr; }))
      refuse("the recording has no poses: --record-fields chooses what is recorded");
    check_bodies();
  }

  SimulationSource world() const { return SimulationSource(simulation); }

  [[noreturn]] void refuse(const std::string& message) const {
    throw InputError(fmt::format("{}: error: {}", reader.file().string(), message));
  }

  /// The world's file may have changed since.
  void check_bodies() const {
    const engine::World& world = simulation.world();
    bool is_same = reader.ids().size() == world.rows();
    for (std::size_t i = 0; is_same && i < reader.ids().size(); ++i) {
      const std::uint32_t id = reader.ids()[i];
      is_same = id < world.spec().bodies.size() && world.row(BodyId(std::size_t{id})).valid() &&
                world.spec().name(BodyId(std::size_t{id})) == reader.names()[i];
    }
    if (!is_same)
      refuse(fmt::format("the recording is of other robots than {} has now", meta(reader, "world")));
  }

  void show(std::size_t wanted) {
    frame = wanted;
    std::array<std::vector<double>, 4> values;
    for (std::size_t f = 0; f < arrays.size(); ++f) {
      values[f].resize(arrays[f]->bodies.size());
      reader.read(*arrays[f], frame, std::as_writable_bytes(std::span(values[f])));
    }
    engine::World& world = simulation.world();
    std::vector<engine::World::Placed> placed;
    for (std::size_t i = 0; i < arrays[0]->bodies.size(); ++i) {
      const Pose pose{values[0][i], values[1][i], values[2][i], values[3][i]};
      if (std::isnan(pose.x)) continue;  // it was not there then
      placed.push_back({world.row(BodyId(std::size_t{reader.ids()[arrays[0]->bodies[i]]})), pose});
    }
    try {
      world.set_poses(placed);
    } catch (const std::invalid_argument& fault) {
      refuse(fmt::format("frame {}: {}", frame, fault.what()));
    }
  }
};

RecordedRun::RecordedRun(const std::filesystem::path& recording,
                         const std::vector<std::filesystem::path>& plugin_path) {
  try {
    impl_ = std::make_unique<Impl>(recording, plugin_path);
    impl_->show(impl_->reader.frames() - 1);
  } catch (const worldio::Hdf5Error& fault) {
    throw InputError(fault.what());
  }
}

RecordedRun::~RecordedRun() = default;
RecordedRun::RecordedRun(RecordedRun&&) noexcept = default;
RecordedRun& RecordedRun::operator=(RecordedRun&&) noexcept = default;

void RecordedRun::go_to(double time_s) {
  const std::span<const double> times = impl_->reader.times_s();
  // 0.3 s of 0.1 s ticks may be a little later than 0.3.
  constexpr double k_same_s = 1e-9;
  if (times.front() > time_s + k_same_s || times.back() < time_s - k_same_s)
    impl_->refuse(fmt::format("{:g} s is not in it: it goes from {:g} s to {:g} s", time_s, times.front(),
                              times.back()));
  const auto later = std::ranges::upper_bound(times, time_s + k_same_s);
  try {
    impl_->show(static_cast<std::size_t>(later - times.begin()) - 1);
  } catch (const worldio::Hdf5Error& fault) {
    throw InputError(fault.what());
  }
}

double RecordedRun::last_s() const { return impl_->reader.times_s().back(); }

std::string RecordedRun::file() const { return impl_->reader.file().string(); }
std::uint64_t RecordedRun::seed() const { return impl_->world().seed(); }
double RecordedRun::tick_s() const { return impl_->world().tick_s(); }
const engine::Record* RecordedRun::window() const { return impl_->simulation.world().spec().window ? &*impl_->simulation.world().spec().window : nullptr; }
engine::FrameScene RecordedRun::scene() const { return impl_->world().scene(); }
std::optional<std::uint32_t> RecordedRun::find_body(std::string_view name) const { return impl_->world().find_body(name); }
std::optional<ChosenValue> RecordedRun::find_value(const std::string& name, std::string& fault) const { return impl_->world().find_value(name, fault); }

std::string RecordedRun::missing(const FrameWishes& wishes) const {
  std::string_view what;
  if (wishes.value) what = "values to colour by";
  if (wishes.scans) what = "scans";
  if (wishes.sights) what = "sights";
  if (wishes.charges) what = "energy";
  if (wishes.speed) what = "speed of the run";
  return what.empty() ? std::string() : fmt::format("a recording is drawn by its poses: it has no {}", what);
}

double RecordedRun::time_s() const { return impl_->reader.times_s()[impl_->frame]; }
std::uint64_t RecordedRun::state_hash() const { return impl_->reader.hashes()[impl_->frame]; }

engine::Frame RecordedRun::frame(const FrameWishes& wishes) const {
  engine::Frame frame = impl_->world().frame(wishes);
  frame.time_s = time_s();
  return frame;
}

}  // namespace troupe

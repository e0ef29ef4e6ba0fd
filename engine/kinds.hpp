#pragma once

#include "base/color.hpp"
#include "base/pose.hpp"
#include "base/random.hpp"
#include "engine/fields.hpp"
#include "engine/measure_kind.hpp"
#include "engine/state_table.hpp"

#include <any>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

class World;

/// The engine calls sensors, drives and controllers through tables of functions and includes none of them.
/// A kind turns its parameters once, when the world is built, into whatever it likes to run with
/// (`prepare`), and is then called for batches of rows. Those calls run on several threads at once: they
/// write what they are given and nothing else. An exception ends the step and comes out of World::step().

/// A model kind: what a Stage world file may create. Part of the registry so that loaders share the defaults.
struct ModelKind {
  std::string_view name;
  std::string_view text;
  Eigen::Vector3d size{0.4, 0.4, 1.0};
  Color color{1, 0, 0, 1};
  bool has_default_body = true;
  FieldTable params;
};

struct SensorKind {
  std::string_view name;
  std::string_view text;
  FieldTable params;
  /// Parameters -> what `sense` needs; also says how many float32 readings a row has.
  struct Prepared {
    std::any data;
    std::vector<StateField> percepts;  ///< element fields of the sensor's state table
    double reach_m = 0;                ///< radius of the declared query about the body's origin
    std::size_t beams = 0;             ///< rays cast each time it runs
    /// Heading of each reading in the sensor's frame, rad; empty for sensors that are no rangers.
    std::vector<double> bearings;
    /// First reading of each transducer, with the heading of the transducer itself.
    std::vector<std::size_t> transducers;
    std::vector<double> transducer_headings;
  };
  Prepared (*prepare)(const Record& params, const Pose& pose_body_sensor);
  /// Writes the percepts of every row it is given (all of one type); reads S(k) only. Returns the rays it
  /// cast.
  std::uint64_t (*sense)(const World& world, const std::any& data, std::span<const Row> rows,
                         StateTable& percepts);
};

/// What a controller asks of its drive: metres and radians a second, or a steering angle for `car`.
struct Command {
  double x = 0;
  double y = 0;
  double turn = 0;
};

struct Velocity {
  double x = 0;     ///< m/s, body frame, forward
  double y = 0;     ///< m/s, body frame, left
  double turn = 0;  ///< rad/s
};

struct DriveKind {
  std::string_view name;
  std::string_view text;
  FieldTable params;
  std::any (*prepare)(const Record& params);
  /// What is wrong with the parameters taken together; empty when nothing is.
  std::string (*fault)(const Record& params);
  /// Velocities of a batch from their commands, bounds applied. Sizes are equal.
  void (*drive)(const std::any& data, std::span<const Command> commands, std::span<Velocity> velocities);
};

/// Sensors that one controller can read.
inline constexpr std::size_t k_most_sensors_read = 16;

/// What one robot's controller sees in a tick.
struct Percept {
  std::uint64_t tick = 0;  ///< the tick being decided; 1 is the first
  double time_s = 0;       ///< world time at its end
  double tick_s = 0;
  std::uint32_t body = 0;
  /// Readings of the sensors it asked for in `prepare`, in that order (ranges, m).
  std::span<const std::span<const float>> ranges;
};

/// What it may do: slots of its own body, already holding the last values.
struct Actions {
  Command& command;
};

/// Robots of one type whose controller decides in a tick: where all that concerns robot i of the batch lies.
struct DecideBatch {
  std::uint64_t tick = 0;
  double time_s = 0;
  double tick_s = 0;
  std::uint64_t seed = 0;
  std::uint32_t stream = 0;     ///< of the controller's random numbers
  std::span<const Row> rows;    ///< of the batch
  std::span<const BodyId> ids;  ///< a row each, as are:
  std::span<const std::uint32_t> slots;
  std::span<Command> commands;

  /// A row of a table each slot, `stride` apart.
  template <class T>
  struct Column {
    T* first = nullptr;
    std::size_t stride = 0;
    std::size_t count = 0;
  };
  std::array<Column<const float>, k_most_sensors_read> ranges;
  std::size_t sensors = 0;
  Column<std::byte> memories;

  std::size_t size() const { return rows.size(); }
  std::uint32_t body(std::size_t i) const { return ids[rows[i].index()].value; }
  Command& command(std::size_t i) const { return commands[rows[i].index()]; }
  Random random(std::size_t i) const { return {seed, stream, body(i), static_cast<std::uint32_t>(tick)}; }
  std::byte* memory(std::size_t i) const { return memories.first + slots[rows[i].index()] * memories.stride; }
  std::span<const float> readings(std::size_t sensor, std::size_t i) const {
    const Column<const float>& column = ranges[sensor];
    return {column.first + slots[rows[i].index()] * column.stride, column.count};
  }
};

/// A sensor of a type, as a controller that looks for its inputs sees it.
struct SensorInfo {
  std::string_view name;
  std::string_view kind;
  const SensorKind::Prepared& prepared;
};

struct ControllerKind {
  std::string_view name;
  std::string_view text;
  FieldTable params;
  /// Fields of the per-robot memory; the struct's bytes are owned by the engine.
  std::vector<StateField> memory;
  std::size_t memory_bytes = 0;
  /// Starts a memory: sets every field, whatever the bytes held (`troupe check --controllers` tries two
  /// fills).
  void (*start)(std::byte* memory);

  struct Prepared {
    std::any data;
    /// Indices of the sensors it reads; the first is its trigger. None: it runs with its drive.
    std::vector<std::size_t> sensors;
  };
  /// Chooses among the sensors of the type those that no controller before it has `claimed`, and marks its
  /// own. Returns an error text in `fault` where the type lacks what the controller needs.
  Prepared (*prepare)(const Record& params, std::span<const SensorInfo> sensors, std::vector<bool>& claimed,
                      std::string& fault);
  /// For all robots of the batch. make_controller_kind makes it from what decides for one.
  void (*decide)(const std::any& data, const DecideBatch& batch);
};

/// Everything a world can be made of. Passed in, never global; assembled in troupe/registry.cpp.
struct Registry {
  std::vector<ModelKind> models;
  std::vector<SensorKind> sensors;
  std::vector<DriveKind> drives;
  std::vector<ControllerKind> controllers;
  std::vector<MeasureKind> measures;

  /// A controller with its parameters already chosen, under a name of its own (Stage's expand_swarm).
  struct Preset {
    std::string_view name;
    std::string_view kind;
    std::string_view text;
    std::vector<std::pair<std::string_view, Value>> params;
  };
  std::vector<Preset> presets;

  /// Controllers that stand in no list, nor among the presets: those of plug-ins (troupe/plugins.hpp). Null:
  /// there is none of this name; `fault` comes as what is said of an unknown name, and leaves with all that
  /// is known of it. Kinds live as long as the registry and its copies. Empty: there are no others.
  std::function<const ControllerKind*(std::string_view name, std::string& fault)> other_controllers;

  const ModelKind* model(std::string_view name) const;
  const SensorKind* sensor(std::string_view name) const;
  const DriveKind* drive(std::string_view name) const;
  const ControllerKind* controller(std::string_view name) const;
  /// The same; where there is none, `fault` says why: `unknown controller "hover"; known: expand, ...`.
  const ControllerKind* controller(std::string_view name, std::string& fault) const;
  /// Names of the controllers and presets that stand in the lists, sorted.
  std::vector<std::string_view> controller_names() const;
  const Preset* preset(std::string_view name) const;
  const MeasureKind* measure(std::string_view name) const;
};

}  // namespace troupe::engine

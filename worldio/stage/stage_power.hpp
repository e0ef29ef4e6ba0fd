#pragma once

#include "engine/kinds/energy.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Whether Troupe itself determines the power of models of this type, such as "position" or "ranger". Their
/// property `watts` is ignored.
bool has_own_draw(std::string_view model_type);
/// Returns the power pack that supplies a part, as an index into TypeSpec::devices: the part's own pack, or
/// else that of the nearest part on which it is mounted. Empty if there is none.
std::optional<std::size_t> pack_of(const engine::TypeSpec& type, std::uint32_t part);
/// Returns the parameters of a device of the type. In those of a power pack, the stored energy is at most the
/// capacity, and parameters without an effect are 0: the energy and the capacity of a pack that never runs
/// out, and the power of the drive if the pack does not supply a drive. `table` describes the parameters.
engine::Record effective_params(const engine::TypeSpec& type, const engine::DeviceSpec& device,
                                const engine::FieldTable& table);

/// Converts the energy properties (joules, watts, give_watts, ...) of models in `.world` files to Troupe's
/// devices. Such files belong to Stage, an older robot simulator. A model becomes a part (rigid piece) of a
/// body type; part 0 is the body itself. A part that stores energy gets a power pack. A part that gives or
/// takes energy gets a power contact.
///
/// For each type, the caller calls read() for all parts and then finish(), before it continues with the next
/// type.
class StagePower {
 public:
  StagePower(const StageDocument& document, const engine::Registry& registry, StageValues& values)
      : document_(document), registry_(registry), values_(values) {}

  /// Reads the energy properties of the model of one part, and adds the devices to `type`. `part` is the
  /// index of the part. Must be called for every part of a type, in the order of the indices. Wrong values
  /// are reported.
  void read(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  /// Completes the power packs of a type. Must be called after read() of the last part, when `type` has all
  /// its devices and controllers.
  ///
  /// A pack supplies its own part, and all parts inside this part that have no nearer pack. The function
  /// - removes power contacts that no pack supplies, with a warning,
  /// - gives packs and contacts of the same name different names ("bay.power", "bay.power#2"),
  /// - adds the constant power (Draw) of each supplied part that runs to the parameter `draw` of the pack,
  /// - sets the parameters `mass` and `idle` of the pack that supplies part 0, if the type has a drive:
  ///   `mass` is the mass of the body; `idle` is 1 W if the drive always runs or the type has a controller,
  ///   else 0.
  ///
  /// A part runs if Draw::runs is true. A part also runs if the type has a controller and the part has a
  /// device other than a power pack or a power contact.
  void finish(engine::TypeSpec& type);

 private:
  /// The constant power that the model of a part draws (property `watts`).
  struct Draw {
    std::uint32_t part;  ///< index of the part
    double watts;        ///< the power, W
    bool runs;           ///< whether the model of the part always runs: it has `alwayson 1` or a controller
  };

  /// Returns the energy that a model stores; nothing if the model stores none.
  std::optional<engine::Energy> read_energy(const StageModel& model);
  void read_pack(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  void read_contact(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  /// Reads the property `key`, a power in W from 0 to engine::k_most_watts. Returns 0 if the model does not
  /// have the property. If the value is wrong, reports an error and returns 0.
  double watts(const StageModel& model, std::string_view key);
  /// Whether the model always runs, which means that it has `alwayson 1` or a controller.
  bool is_on(const StageModel& model);

  const StageDocument& document_;
  const engine::Registry& registry_;
  StageValues& values_;
  std::vector<Draw> draws_;
  double mass_ = 0;
  bool drives_ = false;  ///< whether the drive always runs: the body has `alwayson 1` or a controller
};

}  // namespace troupe::worldio

#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <vector>

namespace troupe::worldio {

/// Turns the energy properties (joules, watts, give_watts, ...) of models in the `.world` files of Stage, an
/// older robot simulator, into Troupe's devices: a power pack on each part that stores energy, and a power
/// contact on each part that gives or takes energy. A model becomes a part (rigid piece) of a body type; part
/// 0 is the body itself. The caller must read and finish one type before it reads the next.
class StagePower {
 public:
  StagePower(const StageDocument& document, const engine::Registry& registry, StageValues& values)
      : document_(document), registry_(registry), values_(values) {}

  /// Reads the energy properties of the model of one part and adds the devices to `type`. `part` is the index
  /// of the part. Must be called for every part of a type, in their order, beginning with part 0. Wrong
  /// values are reported.
  void read(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  /// Must be called after read() of the last part of a type. Adds the constant power (`watts`) of each part
  /// to the draw of the power pack that supplies the part: its own pack, or that of the nearest enclosing
  /// part with a pack. A part that no pack supplies draws nothing. A part that does not run draws nothing
  /// either. A part runs if its model has `alwayson 1` or a controller (Draw::runs), or if the part has a
  /// device and the type has a controller. If the type has a drive, the pack that supplies part 0 gets the
  /// mass of the body as its parameter `mass`. The parameter `idle` of this pack becomes 1 W if the drive
  /// always runs or the type has a controller, else 0. Removes power contacts without a pack, with a warning.
  void finish(engine::TypeSpec& type);

 private:
  /// The constant power that the model of a part draws (`watts`).
  struct Draw {
    std::uint32_t part;  ///< index of the part
    double watts;        ///< the power, W
    bool runs;           ///< whether the model of the part always runs: it has `alwayson 1` or a controller
  };

  void read_pack(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  void read_contact(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  /// Reads a power, W, from 0 to engine::k_most_watts. Returns 0 if the model lacks the property and, with an
  /// error, if the value is wrong.
  double watts(const StageModel& model, std::string_view key);
  /// Whether the model always runs: it has `alwayson 1` or a controller.
  bool is_on(const StageModel& model);

  const StageDocument& document_;
  const engine::Registry& registry_;
  StageValues& values_;
  std::vector<Draw> draws_;
  double mass_ = 0;
  bool drives_ = false;  ///< whether the drive always runs: the body has `alwayson 1` or a controller
};

}  // namespace troupe::worldio

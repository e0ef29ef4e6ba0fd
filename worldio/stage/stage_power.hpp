#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_values.hpp"

#include <vector>

namespace troupe::worldio {

/// What Stage says of a model's energy (joules, watts, give_watts, ...), as devices of ours: a power pack on
/// the part that has any, and a contact where it gives or takes. One a type.
class StagePower {
 public:
  StagePower(const StageDocument& document, const engine::Registry& registry, StageValues& values)
      : document_(document), registry_(registry), values_(values) {}

  /// Reads one model, `part` of the type in the making; parts come in their order.
  void read(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  /// When all parts are there: what each draws goes to the pack of its own part or the nearest one below, and
  /// contacts without a pack are left out, with a warning.
  void finish(engine::TypeSpec& type);

 private:
  struct Draw {
    std::uint32_t part;
    double watts;
    bool runs;  ///< by itself, whether or not the body has a controller
  };

  void read_pack(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  void read_contact(const StageModel& model, std::uint32_t part, engine::TypeSpec& type);
  double watts(const StageModel& model, std::string_view key);
  bool is_on(const StageModel& model);

  const StageDocument& document_;
  const engine::Registry& registry_;
  StageValues& values_;
  std::vector<Draw> draws_;
  double mass_ = 0;
  bool drives_ = false;  ///< alwayson: the drive runs without a controller
};

}  // namespace troupe::worldio

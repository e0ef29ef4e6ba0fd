#pragma once

#include "troupe/picture_source.hpp"

namespace troupe {

class Simulation;

/// The current state of a simulation as a source of pictures. The functions are those of PictureSource
/// (troupe/picture_source.hpp). Keeps a reference to the simulation, which must outlive this object.
class SimulationSource : public PictureSource {
 public:
  explicit SimulationSource(const Simulation& simulation) : simulation_(simulation) {}

  std::string file() const override;
  std::uint64_t seed() const override;
  double tick_s() const override;
  const engine::Record* window() const override;
  engine::FrameScene scene() const override;
  std::optional<std::uint32_t> find_body(std::string_view name) const override;
  Result<ChosenValue> find_value(const std::string& name) const override;
  Result<> check(const FrameWishes& wishes) const override;
  double time_s() const override;
  std::uint64_t state_hash() const override;
  engine::Frame frame(const FrameWishes& wishes) const override;

 private:
  const Simulation& simulation_;
};

}  // namespace troupe

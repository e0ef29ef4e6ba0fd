#include "models/measures/rank_errors.hpp"

#include "engine/observing/robot_sums.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace troupe::models {
namespace {

using engine::Measure;
using engine::MeasuredWorld;
using engine::Unit;

class RankErrors : public Measure {
 public:
  struct Params {
    Vec2 center = Vec2::Zero();

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::center>("center", Unit::meters, required,
                                "point from which the distances of the robots are measured, [x, y]");
    }
  };

  RankErrors(const MeasuredWorld& world, const Params& params, std::vector<BodyId> robots)
      : robots_(std::move(robots)), center_(params.center), met_(world.spec().types.size(), 0) {
    ranked_.reserve(robots_.size());
  }

  double value(const MeasuredWorld& world) override {
    ranked_.clear();
    for (const BodyId id : robots_) {
      const Row row = world.row(id);
      if (!world.is_there(row)) continue;
      const std::size_t type = world.spec().bodies[id.index()].type.index();
      ranked_.push_back({(world.transform(row).position - center_).squaredNorm(), type});
    }
    // Of two robots at equal distances, the one of the earlier type comes first, so that the pair counts as
    // correct.
    std::ranges::sort(ranked_);
    std::ranges::fill(met_, 0);
    std::uint64_t pairs = 0;
    std::uint64_t wrong = 0;
    std::uint64_t all = 0;
    for (const auto& [distance, type] : ranked_) {
      pairs += all - met_[type];
      for (std::size_t later = type + 1; later < met_.size(); ++later) wrong += met_[later];
      ++met_[type];
      ++all;
    }
    if (pairs == 0) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(wrong) / static_cast<double>(pairs);
  }

 private:
  std::vector<BodyId> robots_;
  Vec2 center_;
  std::vector<std::pair<double, std::size_t>> ranked_;  // squared distance, type
  std::vector<std::uint64_t> met_;  // per type, number of robots counted so far, from the centre outwards
};

}  // namespace

engine::MeasureKind rank_errors_measure() {
  return engine::make_measure_kind<RankErrors>(
      "rank_errors", Unit::none,
      "fraction of the pairs of robots of different types whose distances from a centre are in the wrong "
      "order",
      "The fraction of the pairs of robots of different types that are in the wrong order. Types have the "
      "order in which the world file defines them, and a pair is in the wrong order if the robot of the "
      "later type is nearer to `center`. The value is 0 if the types form rings around `center` in their "
      "order, the first type innermost, about one half if they are mixed, and NaN if all robots are of one "
      "type. Source: Gross, Magnenat, Mondada, Segregation in swarms of mobile robots based on the Brazil "
      "nut effect, IROS 2009, where this measure is called the percentage of errors in rank.",
      "|{(i, j): type_i < type_j, |x_i - center| > |x_j - center|}| / |{(i, j): type_i < type_j}|");
}

}  // namespace troupe::models

// A sensor that is built outside of Troupe's tree (docs/extending.md): a ranger with a noise model of its
// own, the beam model of Thrun, Burgard and Fox, Probabilistic Robotics, 2005, section 6.3.
#include <troupe/plugin.hpp>

#include <algorithm>
#include <any>
#include <string>
#include <utility>
#include <vector>

namespace {

struct BeamRanger {
  /// Parameters of the built-in ranger, and fractions of beams that are cut short, lost or random.
  struct Params {
    troupe::Ranger::Params ranger;
    double short_share = 0.05;
    double short_rate = 1;
    double max_share = 0.02;
    double random_share = 0.01;

    static constexpr void describe(troupe::Description<Params>& d) {
      using namespace troupe::facts;
      d.part<&Params::ranger>();  // first the parameters of Troupe's ranger, then these
      d.member<&Params::short_share>("short_share", within(0, 1), "fraction of beams that are cut short");
      d.member<&Params::short_rate>(
          "short_rate", above(0),
          "1/m: the ranges of cut beams are exponentially distributed, with mean 1/short_rate");
      d.member<&Params::max_share>("max_share", within(0, 1), "fraction of beams without an echo");
      d.member<&Params::random_share>("random_share", within(0, 1), "fraction of readings that are random");
    }
  };

  Params params;
  troupe::Ranger ranger;        // computes the true ranges
  std::vector<float> farthest;  // range_max of each beam, m

  /// Called once per type that has the sensor. The parameters are checked and in SI units.
  static troupe::DeviceKind::Prepared prepare(const Params& params, const troupe::Pose& pose_body_sensor) {
    troupe::DeviceKind::Prepared prepared = troupe::Ranger::prepare(params.ranger, pose_body_sensor);
    BeamRanger made{params, std::any_cast<troupe::Ranger>(std::move(prepared.data)), {}};
    for (const troupe::Transducer& transducer : prepared.transducers)
      made.farthest.insert(made.farthest.end(), transducer.samples, static_cast<float>(transducer.range_max));
    prepared.data = std::move(made);
    return prepared;
  }

  /// Checks the parameters together. An error refers to the sensor's line of the world file.
  troupe::Result<> bind_part(const troupe::TypeSpec& type, std::uint32_t part) const {
    if (troupe::Result<> limits = ranger.bind_part(type, part); !limits) return limits;
    if (params.short_share + params.max_share + params.random_share <= 1) return {};
    return troupe::Error{"has short_share, max_share and random_share that add up to more than 1"};
  }

  /// Called in the sense phase, on several threads at once: it may write only the given rows.
  std::uint64_t sense(const troupe::DeviceBatch& batch) const {
    const std::uint64_t rays = ranger.sense(batch);
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      troupe::Random random = batch.random(i, "beam model");
      const std::span<float> ranges = batch.state.cell<float>(batch.slot(i), 0);
      for (std::size_t k = 0; k < ranges.size(); ++k) {
        const double short_m = random.exponential() / params.short_rate;
        const double any_m = random.uniform(0, farthest[k]);
        double chance = random.uniform();
        if ((chance -= params.short_share) < 0)
          ranges[k] = std::min(ranges[k], static_cast<float>(short_m));
        else if ((chance -= params.max_share) < 0)
          ranges[k] = farthest[k];
        else if ((chance -= params.random_share) < 0)
          ranges[k] = static_cast<float>(any_m);
      }
    }
    return rays;
  }
};

troupe::DeviceKind beam_ranger() {
  return troupe::make_device_kind<BeamRanger>("beam_ranger",
                                              "a ranger some of whose beams are cut short, lost or random");
}

}  // namespace

TROUPE_DEVICE("beam_ranger", beam_ranger)

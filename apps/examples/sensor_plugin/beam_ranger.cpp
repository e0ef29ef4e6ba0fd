// A sensor that is built outside of Troupe's tree (docs/extending.md): a ranger with a noise model of its
// own, the beam model of Thrun, Burgard and Fox, Probabilistic Robotics, 2005, section 6.3.
#include <troupe/plugin.hpp>

#include <algorithm>
#include <any>
#include <string>
#include <utility>
#include <vector>

namespace {

/// Troupe's ranger, which finds the true ranges.
const troupe::DeviceKind& ranger() {
  static const troupe::DeviceKind kind = troupe::ranger_kind();
  return kind;
}

/// Of the beams, these shares are cut short by what is in no map, come back from nowhere, or say anything.
struct BeamModel {
  double short_share, short_rate, max_share, random_share;
  std::any ranger;              // what the ranger prepared
  std::vector<float> farthest;  // range_max of each beam, m
};

/// Our parameters. Those of the ranger come before them.
std::vector<troupe::Field> fields() {
  return {
      {.name = "short_share", .fallback = 0.05, .min = 0, .max = 1, .text = "of beams that are cut short"},
      {.name = "short_rate",
       .fallback = 1.0,
       .min = 0,
       .text = "1/m: they end after an exponentially distributed way, 1/short_rate on average",
       .above_min = true},
      {.name = "max_share", .fallback = 0.02, .min = 0, .max = 1, .text = "of beams that do not come back"},
      {.name = "random_share", .fallback = 0.01, .min = 0, .max = 1, .text = "of readings that are anything"},
  };
}

/// Called once for each type that has the sensor. The parameters are checked, and in SI units.
troupe::DeviceKind::Prepared prepare(const troupe::Record& params, const troupe::Pose& pose_body_sensor) {
  troupe::DeviceKind::Prepared prepared = ranger().prepare(params, pose_body_sensor);
  const troupe::Value* own = &params[ranger().params.fields.size()];
  BeamModel model{own[0].number(), own[1].number(),          own[2].number(),
                  own[3].number(), std::move(prepared.data), {}};
  for (const troupe::Transducer& transducer : prepared.transducers)
    model.farthest.insert(model.farthest.end(), transducer.samples, static_cast<float>(transducer.range_max));
  prepared.data = std::move(model);
  return prepared;
}

/// Whether the parameters fit together; else an error at the sensor's line of the world file.
troupe::Result<> mount(std::any& data, const troupe::TypeSpec&, std::uint32_t) {
  const BeamModel& model = *std::any_cast<BeamModel>(&data);
  if (model.short_share + model.max_share + model.random_share <= 1) return {};
  return troupe::Error{"has short_share, max_share and random_share that add up to more than 1"};
}

/// Called in the sense phase, on several threads at once: writes the rows that it is given, and nothing else.
std::uint64_t sense(const troupe::DeviceBatch& batch) {
  const BeamModel& model = *std::any_cast<BeamModel>(&batch.data);
  const std::uint64_t rays = ranger().sense(batch.with(model.ranger));
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    troupe::Random random = batch.random(i, "beam model");
    const std::span<float> ranges = batch.state.cell<float>(batch.slot(i), 0);
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      const double short_m = random.exponential() / model.short_rate;
      const double any_m = random.uniform(0, model.farthest[k]);
      double chance = random.uniform();
      if ((chance -= model.short_share) < 0)
        ranges[k] = std::min(ranges[k], static_cast<float>(short_m));
      else if ((chance -= model.max_share) < 0)
        ranges[k] = model.farthest[k];
      else if ((chance -= model.random_share) < 0)
        ranges[k] = static_cast<float>(any_m);
    }
  }
  return rays;
}

troupe::DeviceKind beam_ranger() {
  troupe::DeviceKind kind = ranger();
  kind.text = "a ranger some of whose beams are cut short, lost, or anything";
  for (const troupe::Field& field : fields()) kind.params.fields.push_back(field);
  kind.prepare = prepare;
  kind.mount = mount;
  kind.sense = sense;
  return kind;
}

}  // namespace

TROUPE_DEVICE("beam_ranger", beam_ranger)

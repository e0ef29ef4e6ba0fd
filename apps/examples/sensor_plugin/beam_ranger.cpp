// A sensor that is built outside of Troupe's tree (docs/extending.md): a ranger with a noise model of its
// own, the beam model of Thrun, Burgard and Fox, Probabilistic Robotics, 2005, section 6.3.
#include <troupe/plugin.hpp>

#include <algorithm>
#include <any>

namespace {

/// Troupe's ranger, which finds the true ranges. Its parameters are the sensor's, and ours come behind them.
const troupe::DeviceKind& ranger() {
  static const troupe::DeviceKind kind = troupe::ranger_kind();
  return kind;
}

struct BeamModel {
  std::any ranger;              // what the ranger prepared
  std::vector<float> farthest;  // range_max of each beam, m
  double short_share, short_rate, max_share, random_share;
};

troupe::DeviceKind::Prepared prepare(const troupe::Record& params, const troupe::Pose& pose) {
  troupe::DeviceKind::Prepared prepared = ranger().prepare(params, pose);
  const std::size_t own = ranger().params.fields.size();
  BeamModel model{std::move(prepared.data), {},
                  params[own].number(),     params[own + 1].number(),
                  params[own + 2].number(), params[own + 3].number()};
  const troupe::Field& transducers = ranger().params.fields[0];
  for (const troupe::Record& transducer : params[0].records())
    model.farthest.insert(model.farthest.end(),
                          static_cast<std::size_t>(get(*transducers.record, transducer, "samples").integer()),
                          static_cast<float>(get(*transducers.record, transducer, "range_max").number()));
  prepared.data = std::move(model);
  return prepared;
}

/// Called in the sense phase, on several threads at once: writes the rows that it is given, and nothing else.
std::uint64_t sense(const troupe::DeviceBatch& batch) {
  const BeamModel& model = *std::any_cast<BeamModel>(&batch.data);
  const std::uint64_t rays = ranger().sense(batch.with(model.ranger));
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    troupe::Random random = batch.random(i, "beam model");
    const std::span<float> ranges = batch.state.cell<float>(batch.slot(i), 0);
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      double chance = random.uniform();
      if ((chance -= model.short_share) < 0)  // something unexpected stood in the way
        ranges[k] = std::min(ranges[k], static_cast<float>(random.exponential() / model.short_rate));
      else if ((chance -= model.max_share) < 0)  // no echo
        ranges[k] = model.farthest[k];
      else if ((chance -= model.random_share) < 0)  // cross-talk
        ranges[k] = static_cast<float>(random.uniform(0, model.farthest[k]));
    }
  }
  return rays;
}

troupe::DeviceKind beam_ranger() {
  troupe::DeviceKind kind = ranger();
  kind.text = "a ranger whose beams are sometimes cut short, lost, or anything";
  for (const troupe::Field& field :
       {troupe::Field{
            .name = "short_share", .fallback = 0.05, .min = 0, .max = 1, .text = "of beams cut short"},
        troupe::Field{.name = "short_rate",
        .fallback = 1.0,
        .min = 0,
        .text = "1/m, of their exponential lengths",
        .above_min = true},
        troupe::Field{.name = "max_share",
        .fallback = 0.02,
        .min = 0,
        .max = 1,
        .text = "of beams that come back from nowhere"},
        troupe::Field{.name = "random_share",
        .fallback = 0.01,
        .min = 0,
        .max = 1,
        .text = "of readings that are anything"}})
    kind.params.fields.push_back(field);
  kind.prepare = prepare;
  kind.sense = sense;
  return kind;
}

}  // namespace

TROUPE_DEVICE("beam_ranger", beam_ranger)

// Controllers, sensors and measures that throw exceptions, some of which are no std::exception.
#include <troupe/plugin.hpp>

#include <stdexcept>
#include <vector>

namespace {

/// Of one robot, in the third tick.
template <class Thrown>
void throw_in_time(const troupe::Percept& percept, Thrown thrown) {
  if (percept.tick == 3 && percept.body == 5) throw thrown;
}

struct Says {
  void operator()(const troupe::Percept& percept, troupe::Random&, troupe::Actions&) const {
    throw_in_time(percept, std::runtime_error("the map is missing"));
  }
};

struct SaysNothing {
  struct Memory {
    float unused = 0;
    TROUPE_FIELDS(unused)
  };
  void operator()(Memory&, const troupe::Percept& percept, troupe::Random&, troupe::Actions&) const {
    throw_in_time(percept, 42);
  }
};

struct ForMany {
  void operator()(const troupe::DecideBatch& batch) const {
    if (batch.tick == 3) throw std::runtime_error("the map is missing");
  }
};

struct WhenMade {
  struct Params {
    static constexpr void describe(troupe::Description<Params>&) {}
  };
  static WhenMade make(const Params&) { throw 42; }
  void operator()(const troupe::Percept&, troupe::Random&, troupe::Actions&) const {}
};

struct Reading {
  float value = 0;
  TROUPE_FIELDS(value)
};

troupe::DeviceKind sensor() {
  troupe::DeviceKind kind{.name = "", .text = "reads 1"};
  kind.prepare = [](const troupe::Record&, const troupe::Pose&) {
    return troupe::DeviceKind::Prepared{.percepts = troupe::memory_fields<Reading>(),
                                        .percept_bytes = sizeof(Reading)};
  };
  kind.sense = [](const troupe::SenseBatch& batch) -> std::uint64_t {
    if (batch.view.tick() == 3) throw 42;
    return 0;
  };
  return kind;
}

troupe::DeviceKind unpreparable() {
  troupe::DeviceKind kind = sensor();
  kind.prepare = [](const troupe::Record&, const troupe::Pose&) -> troupe::DeviceKind::Prepared {
    throw std::runtime_error("the map is missing");
  };
  return kind;
}

troupe::DeviceKind unstartable() {
  troupe::DeviceKind kind = sensor();
  kind.start = [](const std::any&, troupe::StateTable&, std::size_t) {
    throw std::runtime_error("the map is missing");
  };
  return kind;
}

troupe::DeviceKind unhaltable() {
  troupe::DeviceKind kind = sensor();
  kind.halt = [](troupe::StateTable&, std::size_t) { throw std::runtime_error("the brake is missing"); };
  return kind;
}

/// Throws a number when it is made, while it is updated in the third tick, or when it is read in the third
/// tick.
enum class Moment { made, seen, read };
template <Moment k_moment>
struct Counts : troupe::Measure {
  static constexpr std::string_view text = "counts nothing";
  Counts(const troupe::MeasuredWorld&, const std::vector<troupe::BodyId>&) {
    if (k_moment == Moment::made) throw 42;
  }
  void see(const troupe::MeasuredWorld& world) override {
    if (k_moment == Moment::seen && world.tick() == 3) throw std::runtime_error("the map is missing");
  }
  double value(const troupe::MeasuredWorld& world) override {
    if (k_moment == Moment::read && world.tick() == 3) throw 42;
    return 0;
  }
};

}  // namespace

TROUPE_MEASURE("measure_made", Counts<Moment::made>)
TROUPE_MEASURE("measure_seen", Counts<Moment::seen>)
TROUPE_MEASURE("measure_read", Counts<Moment::read>)
TROUPE_CONTROLLER("says", Says)
TROUPE_CONTROLLER("says_nothing", SaysNothing)
TROUPE_CONTROLLER("for_many", ForMany)
TROUPE_CONTROLLER("when_made", WhenMade)
TROUPE_DEVICE("sensor", sensor)
TROUPE_DEVICE("unpreparable", unpreparable)
TROUPE_DEVICE("unstartable", unstartable)
TROUPE_DEVICE("unhaltable", unhaltable)

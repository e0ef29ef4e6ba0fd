#pragma once

#include "base/hash.hpp"
#include "engine/kinds/controller.hpp"

#include <atomic>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Controllers for tests of `troupe check --controllers`. The command checks a rule: from the same inputs
/// (percepts, memory, commands and random numbers), a controller must always compute the same memory and
/// commands, and only those of its robot. Honest and Believer keep this rule. Each of the other controllers
/// breaks it, in the way that its name says.
namespace troupe::test {

struct Parameterless {
  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) const {
    return {};
  }
};

struct Honest : Parameterless {
  struct Memory {
    double sum = 0;
    std::uint8_t odd = 0;
    TROUPE_FIELDS(sum, odd)
  };
  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    memory.sum += random.uniform() + 0.001 * percept.body;
    memory.odd = percept.tick % 2 == 1;
    actions.command.x = 0.5 * actions.command.x + 0.01 * memory.sum;  // `actions` contains the last command
  }
};

/// Keeps the rule. Its commands depend on the estimated pose of the robot, which changes in each tick. The
/// check must therefore repeat a decision with the estimated pose that the first decision used.
struct Believer : Parameterless {
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    actions.set_speed(0.1 + 0.01 * percept.estimate.x, 0.02 * percept.estimate.y,
                      0.1 * percept.estimate.heading);
    if (percept.tick % 3 == 0) actions.go_to(percept.estimate.x + 1, percept.estimate.y, 0);
    if (percept.tick % 3 == 1) actions.accelerate(percept.estimate.x, 0, 0);
  }
};

struct CallsRand : Parameterless {
  void operator()(const engine::Percept&, Random&, engine::Actions& actions) const {
    actions.command.turn = static_cast<double>(std::rand()) / RAND_MAX;
  }
};

struct KeepsAStatic : Parameterless {
  struct Memory {
    std::uint32_t calls = 0;
    TROUPE_FIELDS(calls)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    static std::atomic<std::uint32_t> calls = 0;
    memory.calls = ++calls;
  }
};

struct KeepsAThreadLocal : Parameterless {
  struct Memory {
    std::uint32_t calls = 0;
    TROUPE_FIELDS(calls)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    static thread_local std::uint32_t calls = 0;
    memory.calls = ++calls;
  }
};

/// The first decision of each object of this class differs from all later decisions of the object.
struct ChangesAMember : Parameterless {
  mutable std::atomic<bool> asked = false;
  ChangesAMember() = default;
  ChangesAMember(const ChangesAMember& other) : Parameterless(), asked(other.asked.load()) {}
  void operator()(const engine::Percept&, Random&, engine::Actions& actions) const {
    actions.command.x = asked.exchange(true) ? 0.1 : 0.2;
  }
};

struct ReadsAFastClock : Parameterless {
  struct Memory {
    std::int64_t now = 0;
    TROUPE_FIELDS(now)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    memory.now = std::chrono::steady_clock::now().time_since_epoch().count();
  }
};

struct ReadsASlowClock : Parameterless {
  struct Memory {
    std::int64_t now = 0;
    TROUPE_FIELDS(now)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    memory.now = std::time(nullptr);
  }
};

/// Has a member, `gain`, that is never set. Its value is what the memory from `new` happens to contain.
struct LeavesAMemberUnset : Parameterless {
  std::uint64_t gain;
  double bias;
  static LeavesAMemberUnset make() {
    const auto controller = std::make_unique_for_overwrite<LeavesAMemberUnset>();
    controller->bias = 0.25;
    return *controller;
  }
  void operator()(const engine::Percept&, Random&, engine::Actions& actions) const {
    actions.command.x = bias + static_cast<double>(gain % 1009);
  }
};

/// Each object of this class has another value of `bias`. This imitates a member that is never set, but the
/// values always differ.
struct IsMadeUnlike : Parameterless {
  double bias = 0;
  static IsMadeUnlike make() {
    static std::atomic<int> made = 0;
    IsMadeUnlike controller;
    controller.bias = 0.1 * ++made;
    return controller;
  }
  void operator()(const engine::Percept&, Random&, engine::Actions& actions) const {
    actions.command.y = bias;
  }
};

struct LooksAtAnAddress : Parameterless {
  struct Memory {
    std::uint64_t place = 0;
    TROUPE_FIELDS(place)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    memory.place = std::bit_cast<std::uintptr_t>(&memory);
  }
};

/// Hashes its memory with the padding bytes between its fields.
struct LooksAtPadding : Parameterless {
  struct Memory {
    std::uint8_t odd = 1;
    std::uint64_t hash = 0;
    TROUPE_FIELDS(odd, hash)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    memory.hash = hash_bytes(std::as_bytes(std::span(&memory, 1)));
  }
};

/// Makes the decisions of a batch of robots in one call. Stores the index of each robot in the batch in the
/// memory of the robot. The index breaks the rule, because the engine may divide the robots into other
/// batches.
struct LooksAtItsBatch : Parameterless {
  struct Memory {
    std::uint32_t before = 0;
    TROUPE_FIELDS(before)
  };
  void operator()(const engine::DecideBatch& batch) const {
    for (std::size_t i = 0; i < batch.size(); ++i)
      reinterpret_cast<Memory*>(batch.memory(i))->before = static_cast<std::uint32_t>(i);
  }
};

/// Changes the command and the memory of another robot: the next one in the state tables. For a world in
/// which all robots have one type.
struct ChangesAnother : Parameterless {
  struct Memory {
    std::uint32_t told = 0;
    TROUPE_FIELDS(told)
  };
  void operator()(const engine::DecideBatch& batch) const {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      batch.commands[(batch.rows[i].index() + 1) % batch.commands.size()].turn = 0.5;
      const std::size_t next = (batch.slot(i) + 1) % batch.slots.size();
      reinterpret_cast<Memory*>(batch.memories.of(next))->told = 1;
    }
  }
};

/// Returns a controller kind that breaks the rule: its function `start`, which must initialise the memory of
/// a robot, leaves the field `unset` uninitialised.
inline engine::ControllerKind starts_half() {
  struct Half : Parameterless {
    struct Memory {
      float set = 0;
      std::int32_t unset = 0;
      TROUPE_FIELDS(set, unset)
    };
    void operator()(Memory&, const engine::Percept&, Random&, engine::Actions&) const {}
  };
  engine::ControllerKind kind = engine::make_controller_kind<Half>("starts_half", "");
  kind.start = [](std::byte* memory) { reinterpret_cast<Half::Memory*>(memory)->set = 1; };
  return kind;
}

/// Returns the kinds of all controllers above. A kind is the table of functions by which the engine uses a
/// controller.
inline std::vector<engine::ControllerKind> rogue_controllers() {
  using engine::make_controller_kind;
  return {make_controller_kind<Honest>("honest", ""),
          make_controller_kind<Believer>("believer", ""),
          make_controller_kind<CallsRand>("calls_rand", ""),
          make_controller_kind<KeepsAStatic>("keeps_a_static", ""),
          make_controller_kind<KeepsAThreadLocal>("keeps_a_thread_local", ""),
          make_controller_kind<ChangesAMember>("changes_a_member", ""),
          make_controller_kind<ReadsAFastClock>("reads_a_fast_clock", ""),
          make_controller_kind<ReadsASlowClock>("reads_a_slow_clock", ""),
          make_controller_kind<LeavesAMemberUnset>("leaves_a_member_unset", ""),
          make_controller_kind<IsMadeUnlike>("is_made_unlike", ""),
          make_controller_kind<LooksAtAnAddress>("looks_at_an_address", ""),
          make_controller_kind<LooksAtPadding>("looks_at_padding", ""),
          make_controller_kind<LooksAtItsBatch>("looks_at_its_batch", ""),
          make_controller_kind<ChangesAnother>("changes_another", ""),
          starts_half()};
}

}  // namespace troupe::test

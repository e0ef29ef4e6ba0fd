// Controllers whose results depend on more than their arguments.
#include <troupe/plugin.hpp>

#include <atomic>
#include <cstdlib>
#include <ctime>

namespace {

struct CallsRand {
  void operator()(const troupe::Percept&, troupe::Random&, troupe::Actions& actions) const {
    actions.command.turn = static_cast<double>(std::rand()) / RAND_MAX;
  }
};

struct KeepsAStatic {
  struct Memory {
    std::uint32_t calls = 0;
    TROUPE_FIELDS(calls)
  };
  void operator()(Memory& memory, const troupe::Percept&, troupe::Random&, troupe::Actions&) const {
    static std::atomic<std::uint32_t> calls = 0;
    memory.calls = ++calls;
  }
};

struct ReadsTheClock {
  struct Memory {
    std::int64_t now_s = 0;
    TROUPE_FIELDS(now_s)
  };
  void operator()(Memory& memory, const troupe::Percept&, troupe::Random&, troupe::Actions&) const {
    memory.now_s = std::time(nullptr);
  }
};

struct LeavesAMemberUnset {
  std::array<std::uint64_t, 8> gains;  // more than an std::any holds without `new`
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  LeavesAMemberUnset() {
    // As if the constructor stood in another file: a compiler that sees what is never set makes a 0 of it.
    asm volatile("" : : "r"(this) : "memory");
  }
  void operator()(const troupe::Percept&, troupe::Random&, troupe::Actions& actions) const {
    actions.command.x = 1e-3 * static_cast<double>(gains[3] % 1009);
  }
};

}  // namespace

TROUPE_CONTROLLER("calls_rand", CallsRand)
TROUPE_CONTROLLER("keeps_a_static", KeepsAStatic)
TROUPE_CONTROLLER("reads_the_clock", ReadsTheClock)
TROUPE_CONTROLLER("leaves_a_member_unset", LeavesAMemberUnset)

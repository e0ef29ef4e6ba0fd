#include "partition/mpi_transport.hpp"

#include "partition/mpi/mpi_module.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <limits>
#include <list>
#include <stdexcept>
#include <utility>

namespace troupe::partition {
namespace {

using Unit = std::array<std::byte, TROUPE_MPI_UNIT>;

/// A message as it is sent: its length in bytes, its bytes, and padding.
using Units = std::vector<Unit>;

Units units_of(const Message& message) {
  const std::uint64_t bytes = message.size();
  Units units((sizeof bytes + message.size() + sizeof(Unit) - 1) / sizeof(Unit));
  auto* to = reinterpret_cast<std::byte*>(units.data());
  std::memcpy(to, &bytes, sizeof bytes);
  if (bytes > 0) std::memcpy(to + sizeof bytes, message.data(), message.size());
  return units;
}

const troupe_mpi& load(const std::filesystem::path& module) {
  // RTLD_GLOBAL, because the MPI library loads further libraries that look for its symbols.
  void* library = dlopen(module.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  void* symbol = dlsym(library, "troupe_mpi_module");
  if (symbol == nullptr)
    throw std::runtime_error(module.string() +
                             ": not an MPI module of Troupe: it has no function troupe_mpi_module");
  const troupe_mpi& found = *reinterpret_cast<decltype(&troupe_mpi_module)>(symbol)();
  if (found.interface != TROUPE_MPI_INTERFACE)
    throw std::runtime_error(
        module.string() + ": this MPI module was compiled for another version of Troupe; compile it again");
  return found;
}

}  // namespace

struct MpiTransport::Impl {
  struct Sending {
    unsigned to;
    void* transfer;
    std::shared_ptr<const Units> units;
  };

  explicit Impl(const troupe_mpi& module) : mpi(module) {}

  std::string name(unsigned other) const {
    return fmt::format("rank {}{}", other, other < hosts.size() ? " on " + hosts[other] : "");
  }
  /// Throws RankError, and makes later calls of send(), receive() and complete_sending() throw it again. A
  /// rank that has failed must send no further message: another rank may be waiting for the failed rank's
  /// part of a tick, and would take the message for this part. The failed rank must not wait for another rank
  /// either.
  [[noreturn]] void fail(std::string text) {
    failure = std::move(text);
    throw RankError(failure);
  }
  void throw_if_failed() const {
    if (!failure.empty()) throw RankError(failure);
  }
  void check(bool works, const char* what, unsigned other) {
    if (!works) fail(fmt::format("MPI: {} {} failed", what, name(other)));
  }
  /// Frees the messages that have been sent.
  void progress() {
    for (auto each = sending.begin(); each != sending.end();) {
      const int done = mpi.is_done(each->transfer);
      check(done >= 0, "sending to", each->to);
      each = done == 1 ? sending.erase(each) : std::next(each);
    }
  }
  /// Calls is_over() until it returns true. other(): returns the rank for which this rank waits. Calls fail()
  /// if the wait takes longer than limit_s.
  ///
  /// A pass of the loop counts for at most k_longest_pass_s: it takes longer only if the process is
  /// suspended, for example with the whole job, and the other ranks then need time to answer.
  template <class IsOver, class Other>
  void wait(IsOver&& is_over, Other&& other) {
    constexpr double k_longest_pass_s = 1;
    if (is_over()) return;
    const double start = mpi.seconds();
    double before = start;
    double counted = 0;
    while (true) {
      progress();
      sched_yield();
      const double now = mpi.seconds();
      counted += std::min(now - before, k_longest_pass_s);
      before = now;
      if (is_over()) break;  // after the clock was read: an answer may have come meanwhile
      if (counted > limit_s)
        fail(fmt::format(
            "waited {:g} s for {}, which does not answer: see the output of that rank, or give a longer "
            "--rank-limit",
            limit_s, name(other())));
    }
    waited_s += mpi.seconds() - start;
  }

  const troupe_mpi& mpi;
  unsigned rank = 0;
  unsigned ranks = 1;
  std::string library;
  double limit_s = std::numeric_limits<double>::infinity();
  double waited_s = 0;
  std::vector<std::string> hosts;
  std::string failure;  // text of the first RankError; empty: none
  std::list<Sending> sending;
  Units receiving;  // to which MPI writes until the transfer is done, also after the wait for it has failed
  // The last message, and the same message as units, so that a message to all ranks is converted only once.
  std::shared_ptr<const Message> last;
  std::shared_ptr<const Units> last_units;
};

MpiTransport::MpiTransport(const std::filesystem::path& module)
    : impl_(std::make_unique<Impl>(load(module))) {
  std::array<char, 256> library{};
  if (impl_->mpi.start(&impl_->rank, &impl_->ranks, library.data(), library.size()) != 0)
    throw std::runtime_error(module.string() +
                             ": MPI cannot be initialised; set TROUPE_MPI to a module that was built with "
                             "the MPI library of the launcher (mpirun, srun, ...)");
  impl_->library = library.data();
  impl_->library.resize(std::min(impl_->library.size(), impl_->library.find_first_of(",\n")));
  std::ranges::replace(impl_->library, '\t', ' ');
}

MpiTransport::~MpiTransport() = default;

unsigned MpiTransport::rank() const { return impl_->rank; }
unsigned MpiTransport::ranks() const { return impl_->ranks; }
const std::string& MpiTransport::library() const { return impl_->library; }
void MpiTransport::set_limit(double seconds) { impl_->limit_s = seconds; }
void MpiTransport::set_hosts(std::vector<std::string> hosts) { impl_->hosts = std::move(hosts); }
double MpiTransport::seconds() const { return impl_->mpi.seconds(); }
double MpiTransport::waited_s() const { return impl_->waited_s; }

void MpiTransport::post(unsigned to, std::shared_ptr<const Message> message) {
  Impl& own = *impl_;
  own.throw_if_failed();
  own.progress();
  if (message != own.last) {
    own.last_units = std::make_shared<const Units>(units_of(*message));
    own.last = std::move(message);
  }
  void* transfer = own.mpi.send(to, own.last_units->data(), own.last_units->size());
  own.check(transfer != nullptr, "sending to", to);
  own.sending.push_back({to, transfer, own.last_units});
}

std::shared_ptr<const Message> MpiTransport::receive(unsigned from) {
  Impl& own = *impl_;
  own.throw_if_failed();
  const auto sender = [from] { return from; };
  void* found = nullptr;
  long count = 0;
  own.wait(
      [&] {
        count = own.mpi.probe(from, &found);
        own.check(count >= 0, "receiving from", from);
        return count > 0;
      },
      sender);
  own.receiving = Units(static_cast<std::size_t>(count));
  void* transfer = own.mpi.receive(found, own.receiving.data(), own.receiving.size());
  own.check(transfer != nullptr, "receiving from", from);
  own.wait(
      [&] {
        const int done = own.mpi.is_done(transfer);
        own.check(done >= 0, "receiving from", from);
        return done == 1;
      },
      sender);
  const Units units = std::exchange(own.receiving, {});
  std::uint64_t bytes = 0;
  const auto* first = reinterpret_cast<const std::byte*>(units.data());
  std::memcpy(&bytes, first, sizeof bytes);
  if (bytes > units.size() * sizeof(Unit) - sizeof bytes)
    throw std::logic_error(fmt::format(
        "internal error: a message from rank {} should have {} bytes, but only {} arrived; this is no error "
        "of your input: please report it, with the version of the MPI library",
        from, bytes, units.size() * sizeof(Unit) - sizeof bytes));
  first += sizeof bytes;
  return std::make_shared<const Message>(first, first + bytes);
}

void MpiTransport::complete_sending() {
  impl_->throw_if_failed();
  impl_->wait(
      [&] {
        impl_->progress();
        return impl_->sending.empty();
      },
      [&] { return impl_->sending.front().to; });
}

void MpiTransport::finish() {
  if (impl_->mpi.finish() != 0) throw RankError("MPI: finalising failed");
}

}  // namespace troupe::partition

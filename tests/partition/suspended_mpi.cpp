// An MPI module (partition/mpi/mpi_module.h) of rank 0 of two, whose process seems to be suspended for 1000 s
// between any two readings of the clock. A transfer is done, and a message has come, when this was tested
// eight times.

#include "partition/mpi/mpi_module.h"

#include <cstring>

namespace {

constexpr int k_tests = 8;

int sent_tests = 0;
int probes = 0;
double now = 0;
int outgoing = 0;  // its address is the handle of a transfer
int incoming = 0;

int start(unsigned* rank, unsigned* ranks, char* library, std::size_t /*bytes*/) {
  *rank = 0;
  *ranks = 2;
  *library = '\0';
  return 0;
}

void* send(unsigned /*to*/, const void* /*units*/, std::size_t /*count*/) {
  sent_tests = 0;
  return &outgoing;
}

long probe(unsigned /*from*/, void** found) {
  if (++probes < k_tests) return 0;
  probes = 0;
  *found = &incoming;
  return 1;
}

void* receive(void* found, void* units, std::size_t count) {
  std::memset(units, 0, count * TROUPE_MPI_UNIT);  // an empty message
  return found;
}

int is_done(void* transfer) { return transfer == &incoming || ++sent_tests == k_tests ? 1 : 0; }

double seconds() { return now += 1000; }

int finish() { return 0; }

}  // namespace

const troupe_mpi* troupe_mpi_module() {
  static const troupe_mpi module = {
      TROUPE_MPI_INTERFACE, start, send, probe, receive, is_done, seconds, finish};
  return &module;
}

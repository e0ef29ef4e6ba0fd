// An MPI module (partition/mpi/mpi_module.h) of rank 0 of two. A transfer completes at its eighth test. The
// process seems to be suspended for 1000 s between any two readings of the clock. Until a message has
// arrived, MPI writes it again whenever the clock is read.

#include "partition/mpi/mpi_module.h"

#include <cstring>

namespace {

constexpr int k_tests = 8;
// So large that the C library returns its memory to the operating system as soon as it is freed.
constexpr std::size_t k_units = 1 << 20;

void* message = nullptr;  // the message that MPI receives
int tests = 0;            // number of tests of the last transfer
double now = 0;
int transfer = 0;  // its address is the handle of the transfer

int start(unsigned* rank, unsigned* ranks, char* library, std::size_t /*bytes*/) {
  message = nullptr;
  *rank = 0;
  *ranks = 2;
  *library = '\0';
  return 0;
}

void* send(unsigned /*to*/, const void* /*units*/, std::size_t /*count*/) {
  tests = 0;
  return &transfer;
}

long probe(unsigned /*from*/, void** found) {
  *found = &transfer;
  return k_units;
}

void* receive(void* found, void* units, std::size_t /*count*/) {
  message = units;
  tests = 0;
  return found;
}

int is_done(void* /*transfer*/) {
  if (++tests < k_tests) return 0;
  message = nullptr;
  return 1;
}

double seconds() {
  if (message != nullptr) std::memset(message, 0, k_units * TROUPE_MPI_UNIT);  // an empty message
  return now += 1000;
}

int finish() { return 0; }

}  // namespace

const troupe_mpi* troupe_mpi_module() {
  static const troupe_mpi module = {
      TROUPE_MPI_INTERFACE, start, send, probe, receive, is_done, seconds, finish};
  return &module;
}

// An MPI module (partition/mpi/mpi_module.h) of rank 0 of two. Rank 1 sends it a message that never arrives
// completely: whenever the clock is read, MPI writes the message again.

#include "partition/mpi/mpi_module.h"

#include <cstring>

namespace {

// So large that the C library returns its memory to the operating system as soon as it is freed.
constexpr std::size_t k_units = 1 << 20;

void* message = nullptr;
double now = 0;

int start(unsigned* rank, unsigned* ranks, char* library, std::size_t /*bytes*/) {
  *rank = 0;
  *ranks = 2;
  *library = '\0';
  return 0;
}

void* send(unsigned /*to*/, const void* /*units*/, std::size_t /*count*/) { return nullptr; }

long probe(unsigned /*from*/, void** found) {
  *found = &message;
  return k_units;
}

void* receive(void* found, void* units, std::size_t /*count*/) {
  message = units;
  return found;
}

int is_done(void* /*transfer*/) { return 0; }

double seconds() {
  if (message != nullptr) std::memset(message, 1, k_units * TROUPE_MPI_UNIT);
  return ++now;
}

int finish() { return 0; }

}  // namespace

const troupe_mpi* troupe_mpi_module() {
  static const troupe_mpi module = {
      TROUPE_MPI_INTERFACE, start, send, probe, receive, is_done, seconds, finish};
  return &module;
}

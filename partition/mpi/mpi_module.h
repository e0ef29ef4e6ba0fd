#ifndef TROUPE_MPI_MODULE_H
#define TROUPE_MPI_MODULE_H

/* The interface between Troupe and an MPI library (docs/cluster.md). Troupe links no MPI. It loads a *module*, a
 * shared library that is compiled from mpi_module.c with the compiler wrapper of one MPI:
 *
 *     mpicc -shared -fPIC -O2 -o libtroupe_mpi_site.so mpi_module.c
 *
 * All functions are called on one thread. Functions that return an int return 0, or -1 after an error of MPI. */

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface, which is increased whenever the interface changes. */
#define TROUPE_MPI_INTERFACE 1

/* Messages consist of units of this many bytes, because MPI counts elements with an int. */
#define TROUPE_MPI_UNIT 64

struct troupe_mpi {
  int interface; /* TROUPE_MPI_INTERFACE */
  /* Initialises MPI. Sets the number of this process, the number of processes, and the name and version of the MPI
   * library, a text of at most `bytes` bytes with its final 0. */
  int (*start)(unsigned* rank, unsigned* ranks, char* library, size_t bytes);
  /* Starts to send units to a process. Returns a handle of the transfer for is_done(), or null after an error. The units
   * must stay as they are until is_done() returns 1 for the handle. */
  void* (*send)(unsigned to, const void* units, size_t count);
  /* Tests whether a message from a process has come. If so, returns its number of units and sets *message to a handle of
   * the message for receive(). Returns 0 if no message has come, and -1 after an error. */
  long (*probe)(unsigned from, void** message);
  /* Starts to receive a message that probe() found, and frees the handle of the message. Returns a handle of the transfer
   * for is_done(), or null after an error. MPI may write to the units until is_done() returns 1 for the handle. */
  void* (*receive)(void* message, void* units, size_t count);
  /* Returns 1 if a transfer is done, and then frees its handle; 0 if it is not done, and -1 after an error. */
  int (*is_done)(void* transfer);
  double (*seconds)(void); /* a clock that measures intervals, s */
  int (*finish)(void);     /* finalises MPI; all processes call it */
};

/* The only symbol that a module must have. The result lives as long as the module. */
const struct troupe_mpi* troupe_mpi_module(void);

#ifdef __cplusplus
}
#endif

#endif

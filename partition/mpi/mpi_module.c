/* See mpi_module.h. */

#include "mpi_module.h"

#include <limits.h>
#include <mpi.h>
#include <stdlib.h>
#include <string.h>

static MPI_Comm all = MPI_COMM_NULL; /* keeps Troupe's messages apart from others of this process */
static MPI_Datatype unit = MPI_DATATYPE_NULL;

static int start(unsigned* rank, unsigned* ranks, char* library, size_t bytes) {
  int provided = 0;
  int number = 0;
  int count = 0;
  int length = 0;
  char version[MPI_MAX_LIBRARY_VERSION_STRING];
  if (MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS) return -1;
  if (MPI_Comm_dup(MPI_COMM_WORLD, &all) != MPI_SUCCESS) return -1;
  MPI_Comm_set_errhandler(all, MPI_ERRORS_RETURN);
  if (MPI_Comm_rank(all, &number) != MPI_SUCCESS || MPI_Comm_size(all, &count) != MPI_SUCCESS) return -1;
  if (MPI_Type_contiguous(TROUPE_MPI_UNIT, MPI_BYTE, &unit) != MPI_SUCCESS) return -1;
  if (MPI_Type_commit(&unit) != MPI_SUCCESS) return -1;
  if (MPI_Get_library_version(version, &length) != MPI_SUCCESS || bytes == 0) return -1;
  *rank = (unsigned)number;
  *ranks = (unsigned)count;
  strncpy(library, version, bytes - 1);
  library[bytes - 1] = 0;
  return provided < MPI_THREAD_FUNNELED ? -1 : 0;
}

static void* new_transfer(void) { return malloc(sizeof(MPI_Request)); }

/* Returns the transfer, or null after an error. */
static void* checked(void* transfer, int result) {
  if (result == MPI_SUCCESS) return transfer;
  free(transfer);
  return NULL;
}

static void* send_units(unsigned to, const void* units, size_t count) {
  void* transfer = count <= INT_MAX ? new_transfer() : NULL;
  if (transfer == NULL) return NULL;
  return checked(transfer, MPI_Isend(units, (int)count, unit, (int)to, 0, all, transfer));
}

static long probe(unsigned from, void** message) {
  int has_come = 0;
  int count = 0;
  MPI_Message found;
  MPI_Status status;
  if (MPI_Improbe((int)from, 0, all, &has_come, &found, &status) != MPI_SUCCESS) return -1;
  if (!has_come) return 0;
  if (MPI_Get_count(&status, unit, &count) != MPI_SUCCESS || count < 1) return -1;
  *message = malloc(sizeof(MPI_Message));
  if (*message == NULL) return -1;
  memcpy(*message, &found, sizeof found);
  return count;
}

static void* receive_units(void* message, void* units, size_t count) {
  void* transfer = new_transfer();
  if (transfer != NULL) transfer = checked(transfer, MPI_Imrecv(units, (int)count, unit, message, transfer));
  free(message);
  return transfer;
}

static int is_done(void* transfer) {
  int done = 0;
  if (MPI_Test(transfer, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS) return -1;
  if (done) free(transfer);
  return done;
}

static double seconds(void) { return MPI_Wtime(); }

static int finish(void) {
  MPI_Type_free(&unit);
  MPI_Comm_free(&all);
  return MPI_Finalize() == MPI_SUCCESS ? 0 : -1;
}

const struct troupe_mpi* troupe_mpi_module(void) {
  static const struct troupe_mpi module = {
      TROUPE_MPI_INTERFACE, start, send_units, probe, receive_units, is_done, seconds, finish};
  return &module;
}

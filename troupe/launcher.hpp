#pragma once

#include <optional>
#include <string>

namespace troupe {

/// A program such as mpirun that started this process as one of several.
struct Launcher {
  std::string name;    ///< name for error messages: "mpirun of Open MPI"
  unsigned rank = 0;   ///< number of this process, from 0
  unsigned ranks = 2;  ///< number of processes, at least 2
  std::string mpi;     ///< the MPI implementation that the launcher belongs to: "openmpi" or "mpich"
  /// Whether this is the first of the processes that the launcher started on this computer. False if the
  /// launcher does not tell.
  bool is_first_here = false;
};

/// Returns the launcher that started this process; std::nullopt if no launcher did, or if this process is the
/// only one that the launcher started. Detects a launcher by the environment variables that it sets. Throws
/// InputError if Slurm's srun started several processes without MPI: such processes cannot connect to each
/// other.
std::optional<Launcher> find_launcher();

/// Whether the first of the processes that the launcher started on this computer is still running. False if
/// no launcher started this process, or if this cannot be found out, for example because another program
/// started the process for the launcher.
bool runs_first_here();

}  // namespace troupe

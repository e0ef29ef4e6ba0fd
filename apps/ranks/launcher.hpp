#pragma once

#include <optional>
#include <string>

namespace troupe::apps {

/// A program such as mpirun that started this process as one of several.
struct Launcher {
  std::string name;    ///< for errors: "mpirun of Open MPI"
  unsigned rank = 0;   ///< number of this process
  unsigned ranks = 1;  ///< number of processes
  std::string mpi;     ///< the MPI that the launcher belongs to: "openmpi" or "mpich"
};

/// Returns the launcher of this process, as its environment says; std::nullopt if there is none. Throws
/// InputError if Slurm's srun started several processes that cannot find one another.
std::optional<Launcher> find_launcher();

}  // namespace troupe::apps

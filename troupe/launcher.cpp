#include "troupe/launcher.hpp"

#include "base/diagnostics.hpp"
#include "base/number_text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ios>
#include <limits>
#include <string_view>
#include <system_error>

namespace troupe {
namespace fs = std::filesystem;
namespace {

std::optional<unsigned> number_in(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? std::nullopt : number_of<unsigned>(text);
}

/// Number of processes of the step of a Slurm job to which this process belongs.
constexpr const char* k_step_tasks = "SLURM_STEP_NUM_TASKS";

/// A launcher, and the names of the environment variables that it sets in each process. `rank` names the
/// variable with the index of the process, from 0; `local` names the one with the index among the processes
/// on the same computer; `ranks` names the one with the number of processes. name, mpi: as in Launcher.
struct Variables {
  const char* rank;
  const char* local;
  const char* ranks;
  const char* name;
  const char* mpi;
};
// Slurm's variables for a job (SLURM_NTASKS) are not used, because they are also set in a batch script, which
// no launcher started. Slurm's variables for a job step (SLURM_STEP_NUM_TASKS) are not set there.
constexpr std::array<Variables, 4> k_variables{{
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_LOCAL_RANK", "OMPI_COMM_WORLD_SIZE", "mpirun of Open MPI",
     "openmpi"},
    {"PMIX_RANK", "SLURM_LOCALID", k_step_tasks, "srun --mpi=pmix", "openmpi"},
    {"PMI_RANK", "MPI_LOCALRANKID", "PMI_SIZE", "mpirun of MPICH", "mpich"},
    {"PMI_RANK", "SLURM_LOCALID", k_step_tasks, "srun --mpi=pmi2", "mpich"},
}};

/// Whether a process is a child of the process `parent`. process: its folder in /proc
bool is_child_of(pid_t parent, const fs::path& process) {
  std::ifstream status(process / "status");
  for (std::string key; status >> key; status.ignore(std::numeric_limits<std::streamsize>::max(), '\n'))
    if (pid_t found = 0; key == "PPid:") return status >> found && found == parent;
  return false;
}

/// Whether a running process was started with the variable `name` set to `value`.
bool has_variable(const fs::path& process, const std::string& name, const std::string& value) {
  const std::string wanted = fmt::format("{}={}", name, value);
  std::ifstream variables(process / "environ", std::ios::binary);  // empty if the process has ended
  for (std::string each; std::getline(variables, each, '\0');)
    if (each == wanted) return true;
  return false;
}

}  // namespace

std::optional<Launcher> find_launcher() {
  for (const Variables& variables : k_variables) {
    const std::optional<unsigned> rank = number_in(variables.rank);
    const std::optional<unsigned> ranks = number_in(variables.ranks);
    if (!rank || !ranks || *rank >= *ranks) continue;
    // mpirun of MPICH may run in a step of one process, and passes the variables of the step on.
    if (*ranks == 1 && std::string_view(variables.ranks) == k_step_tasks) continue;
    if (*ranks == 1) return {};
    return Launcher{variables.name, *rank, *ranks, variables.mpi, number_in(variables.local) == 0u};
  }
  if (const auto tasks = number_in(k_step_tasks); tasks && *tasks > 1)
    throw InputError(
        fmt::format("troupe: error: srun started {} processes, but not for MPI: give srun the option "
                    "--mpi=pmix (srun --mpi=list shows the available values), or -n 1",
                    *tasks));
  return {};
}

bool runs_first_here() {
  const auto names_first = [](const fs::path& process) {
    return std::ranges::any_of(k_variables,
                               [&](const Variables& each) { return has_variable(process, each.local, "0"); });
  };
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end;
       process.increment(error))
    if (is_child_of(getppid(), *process) && names_first(*process)) return true;
  return false;
}

}  // namespace troupe

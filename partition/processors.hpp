#pragma once

#include <filesystem>
#include <optional>

namespace troupe::partition {

/// The number of processors that the calling thread may use, at least 1: those of its affinity mask (taskset,
/// SLURM, cpusets), but no more than processor_quota(), rounded up. It may be far below the number of
/// processors that the machine has. Costs a few reads of small files.
unsigned processors_allowed();

/// The processor time that Linux control groups grant this process, in processors: 1.5 is 150 ms of processor
/// time in every 100 ms. The least quota among its group and the groups above, in version 1 and version 2.
/// Nothing where no quota is set or none can be read. `root` stands for `/`: proc/self/cgroup and
/// sys/fs/cgroup are looked up below it.
std::optional<double> processor_quota(const std::filesystem::path& root = "/");

}  // namespace troupe::partition

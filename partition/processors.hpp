#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace troupe::partition {

/// The number of processors that the calling thread may use, at least 1. It is the smaller of two numbers:
/// the number of processors in the affinity mask of the thread (set by taskset, SLURM or cpusets), and
/// processor_quota(), rounded up. The result may be far below the number of processors of the machine. Reads
/// a few small files.
unsigned processors_allowed();

/// Lists the processors in the affinity mask of the calling thread: `0 1 6` for the processors 0, 1 and 6.
/// Empty if the system does not report the mask.
std::string affinity_list();

/// The processor time that Linux control groups (cgroups) grant this process, in processors: 1.5 means 150 ms
/// of processor time per 100 ms of wall time. The process's group and each ancestor of this group may set a
/// quota; the result is the smallest of these quotas. Reads quotas of cgroup versions 1 and 2. Empty if no
/// quota is set or none can be read. root: the folder that contains proc/self/cgroup and sys/fs/cgroup; tests
/// pass another folder.
std::optional<double> processor_quota(const std::filesystem::path& root = "/");

}  // namespace troupe::partition

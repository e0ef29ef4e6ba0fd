#include "partition/processors.hpp"

#include "base/number_text.hpp"
#include "base/split.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

namespace troupe::partition {
namespace fs = std::filesystem;
namespace {

/// Calls visit() with the affinity mask of the calling thread and its size in bytes, if the system reports
/// the mask.
template <class Visit>
void visit_affinity(Visit&& visit) {
  constexpr int k_most_processors = 1 << 20;
  // The kernel rejects a mask that is smaller than its own but does not report the size of its own, so larger
  // masks are tried.
  for (int bits = CPU_SETSIZE; bits <= k_most_processors; bits *= 2) {
    const std::unique_ptr<cpu_set_t, void (*)(cpu_set_t*)> mask(CPU_ALLOC(bits),
                                                                [](cpu_set_t* m) { CPU_FREE(m); });
    const std::size_t bytes = CPU_ALLOC_SIZE(bits);
    if (mask && sched_getaffinity(0, bytes, mask.get()) == 0) return visit(*mask, bytes);
  }
}

/// The number of processors in the affinity mask of the calling thread, or of all processors of the machine
/// if the system does not report the mask.
unsigned affine_processors() {
  unsigned count = std::thread::hardware_concurrency();
  visit_affinity([&](const cpu_set_t& mask, std::size_t bytes) {
    count = static_cast<unsigned>(CPU_COUNT_S(bytes, &mask));
  });
  return count;
}

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

std::optional<double> positive_number(std::string_view text) {
  const std::optional<double> value = finite_number_of(text);
  return value && *value > 0 ? value : std::nullopt;
}

std::optional<double> ratio(std::string_view quota, std::string_view period) {
  const std::optional<double> q = positive_number(quota);  // empty for "max" and "-1", which mean no quota
  const std::optional<double> p = positive_number(period);
  return q && p ? std::optional(*q / *p) : std::nullopt;
}

/// The quota of one group, in processors. Its file cpu.max contains for example `200000 100000` (quota and
/// period in microseconds), or `max 100000` if there is no quota.
std::optional<double> quota_v2(const fs::path& group) {
  const std::string line = first_line(group / "cpu.max");
  const std::size_t space = std::min(line.find(' '), line.size());
  return ratio(line.substr(0, space), std::string_view(line).substr(std::min(space + 1, line.size())));
}

std::optional<double> quota_v1(const fs::path& group) {
  return ratio(first_line(group / "cpu.cfs_quota_us"), first_line(group / "cpu.cfs_period_us"));
}

std::optional<double> lesser(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::min(*a, *b) : a ? a : b;
}

/// The least quota of the group `path` and its ancestors, up to the mount point. In a container `path` is
/// often a path on the host, of which only the mount point exists here; a group that does not exist has no
/// quota.
std::optional<double> least_quota(const fs::path& mount, std::string_view path,
                                  std::optional<double> (*quota)(const fs::path& group)) {
  std::optional<double> least = quota(mount);
  fs::path group = mount;
  for (const fs::path& name : (fs::path("/") / path).lexically_normal().relative_path()) {
    group /= name;
    least = lesser(least, quota(group));
  }
  return least;
}

bool lists_cpu(std::string_view controllers) {
  return std::ranges::count(split(controllers, ','), "cpu") > 0;
}

}  // namespace

std::optional<double> processor_quota(const fs::path& root) {
  const fs::path mounts = root / "sys/fs/cgroup";
  std::optional<double> least;
  std::ifstream groups(root / "proc/self/cgroup");
  // Lines are `0::/path` for version 2 and `4:cpu,cpuacct:/path` for version 1; a machine may have both.
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == line.npos ? line.npos : line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string_view path = std::string_view(line).substr(second + 1);
    if (controllers.empty()) {
      least = lesser(least, least_quota(mounts, path, quota_v2));
    } else if (lists_cpu(controllers)) {
      least = lesser(least, least_quota(mounts / controllers, path, quota_v1));
      if (controllers != "cpu") least = lesser(least, least_quota(mounts / "cpu", path, quota_v1));
    }
  }
  return least;
}

std::string affinity_list() {
  std::string list;
  visit_affinity([&](const cpu_set_t& mask, std::size_t bytes) {
    for (std::size_t processor = 0; processor < 8 * bytes; ++processor)
      if (CPU_ISSET_S(processor, bytes, &mask))
        list += fmt::format("{}{}", list.empty() ? "" : " ", processor);
  });
  return list;
}

unsigned processors_allowed() {
  const unsigned processors = std::max(1u, affine_processors());
  const std::optional<double> quota = processor_quota();
  if (!quota || *quota >= processors) return processors;
  return std::max(1u, static_cast<unsigned>(std::ceil(*quota)));
}

}  // namespace troupe::partition

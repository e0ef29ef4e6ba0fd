#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Functions that return the summary that `troupe info` prints, one function per type of file. All throw
/// InputError if the file cannot be read.
namespace troupe::apps {

/// A summary: names and values, in the order in which they are printed.
using Summary = std::vector<std::pair<std::string, std::string>>;

Summary summary_of_hash_log(const std::filesystem::path& file);
Summary summary_of_measures(const std::filesystem::path& file);
Summary summary_of_events(const std::filesystem::path& file);
Summary summary_of_profile(const std::filesystem::path& file);
Summary summary_of_recording(const std::filesystem::path& file);
Summary summary_of_checkpoint(const std::filesystem::path& file);
/// Returns the summary of a world file. text: content of the file. json: true if it is a JSON world, false if
/// it is a Stage world. plugins: folders that are searched for plug-ins (shared libraries) before those of
/// TROUPE_PLUGIN_PATH and STAGEPATH. Throws InputError if the world has errors.
Summary summary_of_world(const std::filesystem::path& file, const std::string& text, bool json,
                         const std::vector<std::filesystem::path>& plugins);

/// Returns a range of ticks (simulation steps) and the range of their simulated times, s, as text: "0 to 20,
/// 0 to 2 s".
std::string ticks_text(std::uint64_t first, std::uint64_t last, double first_s, double last_s);
/// Returns a count with the noun `what`, to which `s` is added unless the count is 1: "1 robot", "2 robots".
std::string counted(std::size_t count, std::string_view what);

}  // namespace troupe::apps

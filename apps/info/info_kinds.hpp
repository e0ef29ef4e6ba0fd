#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What `troupe info` tells of each kind of file. All throw InputError for what cannot be read.
namespace troupe::apps {

/// Names and values, in the order in which they are told.
using Summary = std::vector<std::pair<std::string, std::string>>;

Summary summary_of_hash_log(const std::filesystem::path& file);
Summary summary_of_measures(const std::filesystem::path& file);
Summary summary_of_events(const std::filesystem::path& file);
Summary summary_of_profile(const std::filesystem::path& file);
Summary summary_of_recording(const std::filesystem::path& file);
Summary summary_of_checkpoint(const std::filesystem::path& file);
/// json: ours, not Stage's. plugins: folders of plug-ins, beside those of the environment.
Summary summary_of_world(const std::filesystem::path& file, const std::string& text, bool json,
                         const std::vector<std::filesystem::path>& plugins);

/// "0 to 20, 0 to 2 s".
std::string ticks_text(std::uint64_t first, std::uint64_t last, double first_s, double last_s);
/// "1 robot", "2 robots".
std::string counted(std::size_t count, std::string_view what);

}  // namespace troupe::apps

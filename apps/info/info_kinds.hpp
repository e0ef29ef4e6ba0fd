#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The summaries that `troupe info` prints, by type of file. All throw InputError if the file cannot be read.
namespace troupe::apps {

/// Names and values, in the order in which they are printed.
using Summary = std::vector<std::pair<std::string, std::string>>;

Summary summary_of_hash_log(const std::filesystem::path& file);
Summary summary_of_measures(const std::filesystem::path& file);
Summary summary_of_events(const std::filesystem::path& file);
Summary summary_of_profile(const std::filesystem::path& file);
Summary summary_of_recording(const std::filesystem::path& file);
Summary summary_of_checkpoint(const std::filesystem::path& file);
/// The summary of a world file; `text` is its content. json: whether the text is JSON; otherwise it is a Stage
/// world. plugins: folders that are searched for plug-ins before those of TROUPE_PLUGIN_PATH and STAGEPATH.
/// Throws InputError if the world has errors.
Summary summary_of_world(const std::filesystem::path& file, const std::string& text, bool json,
                         const std::vector<std::filesystem::path>& plugins);

/// Ticks and times: "0 to 20, 0 to 2 s".
std::string ticks_text(std::uint64_t first, std::uint64_t last, double first_s, double last_s);
/// A count with its noun: "1 robot", "2 robots".
std::string counted(std::size_t count, std::string_view what);

}  // namespace troupe::apps

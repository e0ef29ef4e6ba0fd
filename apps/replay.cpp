#include "apps/replay.hpp"

#include "apps/messages.hpp"
#include "apps/numbers.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/replay_page.hpp"
#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "worldio/results/replay_codec.hpp"
#include "worldio/results/replay_data.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <string_view>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_replay_footer = R"(
Writes one self-contained HTML file that plays a recording (troupe run --record) in a browser, without a network. The
page has a time bar and playback speeds, can pan, zoom and orbit, and can show trails and colour robots by any recorded
field. A click on a robot shows its id, state and sensors. Press ? in the page for the keys.

Positions are rounded to 1 mm, headings to 0.18 degrees, other numbers that are not whole to steps of at most 1/1600 of
their range, or 0.001 m or rad. If the page would be larger than --max-mb, it contains only every second frame, or every
third, ...; the page and this command report which frames it contains.

The page shows poses and all other recorded fields (troupe run --record-fields pose,stall,ranges). --fields selects
some of the other fields: by component (stall), by field (ranges) or by both (stall.stalled).

Exit codes: 0 written; 1 writing failed; 2 nothing written, because RECORDING is not a recording or has no poses, FILE
exists, or the usage was wrong.

Examples:
  troupe run worlds/hospital.json --for 60 --record run.h5 --record-fields pose,stall
  troupe replay run.h5 -o swarm.html
  troupe replay run.h5 -o small.html --max-mb 5 --fields pose)";

constexpr std::string_view k_mark = "@RECORDING@";
constexpr double k_bytes_mb = 1e6;
constexpr double k_most_mb = 500;  // because browsers limit the length of a string

/// Returns an ordinal number as text: "2nd", "3rd", "11th".
std::string ordinal(std::size_t n) {
  const bool teen = n % 100 >= 11 && n % 100 <= 13;
  const char* const ending = teen          ? "th"
                             : n % 10 == 1 ? "st"
                             : n % 10 == 2 ? "nd"
                             : n % 10 == 3 ? "rd"
                                           : "th";
  return fmt::format("{}{}", n, ending);
}

/// Returns how many bytes of recorded data fit into a page of at most `max_mb` megabytes (10^6 bytes). The
/// page contains the data as Base64, which encodes 3 bytes as 4.
std::size_t room(double max_mb) {
  const double left = max_mb * k_bytes_mb - static_cast<double>(k_replay_page.size());
  return left > 0 ? static_cast<std::size_t>(left / 4 * 3) : 0;
}

/// Returns a description of a page of `mb` megabytes, for the user: robots, frames, and what was omitted.
std::string contents_of(const fs::path& page, double mb, double max_mb, const worldio::ReplayData& data) {
  std::string bodies = counted(data.robots, "robot");
  if (data.others > 0)
    bodies += fmt::format(" and {} other {}", data.others, data.others == 1 ? "body" : "bodies");
  std::string text =
      fmt::format("{}: {}, {}{}, {:.1f} MB\n", page.string(), bodies, counted(data.frames, "frame"),
                  data.frames > 1 ? fmt::format(" every {:.6g} s", data.every_s) : "", mb);
  if (data.stride > 1)
    text += fmt::format("{}: contains every {} of {} recorded frames, to stay under {:g} MB (--max-mb)\n",
                        page.string(), ordinal(data.stride), data.recorded, max_mb);
  if (data.at_rest)
    text +=
        fmt::format("{}: moving parts are drawn at rest, because the recording has no positions of joints\n",
                    page.string());
  return text;
}

/// Throws OutputError if the page cannot be written, has another ending than .html, or exists and --force is
/// not given.
void check(const ReplayOptions& options, const fs::path& page) {
  check_outputs({Input{options.recording, "the recording"}}, {page});
  if (page.extension() != ".html")
    throw OutputError(
        fmt::format("{}: error: the page would be in the format HTML: choose a name that ends in "
                    ".html, such as swarm.html",
                    page.string()));
  if (!options.force) refuse_existing(page);
}

}  // namespace

void add_replay_options(CLI::App& command, ReplayOptions& options) {
  command.footer(k_replay_footer);
  add_argument(command, "RECORDING", "A recording", options.recording);
  add_value(command, "-o,--output", "FILE.html",
            "Page to write (default: the name of the recording, ending in .html)",
            [&options](const std::string& text) { options.page = file_name("--output", text); });
  add_switch(command, "--force", options.force, "Replace an existing file");
  add_value(command, "--max-mb", "MB", "Largest size of the page, in megabytes (default: 25)",
            [&options](const std::string& text) {
              const auto mb = finite_number_of(text);
              if (!mb || *mb <= 0 || *mb > k_most_mb)
                refuse("--max-mb", text,
                       fmt::format("a size in megabytes, above 0 and at most {}", k_most_mb));
              options.max_mb = *mb;
            });
  add_value(command, "--fields", "A,B,...", "Fields to show in addition to poses (default: all recorded)",
            [&options](const std::string& text) {
              options.fields = names_in("--fields", text, "a list of names, as in --fields stall,ranges");
            });
}

std::string write_replay_page(const ReplayOptions& options) {
  const fs::path page =
      options.page.empty() ? fs::path(options.recording).replace_extension(".html") : options.page;
  const std::size_t mark = k_replay_page.find(k_mark);
  if (mark == k_replay_page.npos)
    throw std::runtime_error(
        "internal error: the embedded replay page has no @RECORDING@ marker; this is no error of your input: "
        "please report it");
  try {
    check(options, page);
  } catch (const OutputError& error) {
    throw InputError(error.what());
  }
  worldio::ReplayData data;
  try {
    const worldio::RecordingReader recording(options.recording);
    if (recording.unfinished())
      print_message(fmt::format(
          "{}: warning: the recording is unfinished (still being written, or its run was killed): {} "
          "complete frames\n",
          options.recording.string(), recording.frames()));
    for (const std::string& name : options.fields)
      if (const auto present = worldio::present_name(name, recording))
        print_message(fmt::format(
            "{}: warning: --fields: \"{}\" is a name of an earlier version of Troupe; the name is now "
            "\"{}\"\n",
            options.recording.string(), name, *present));
    data = worldio::replay_data(recording, {.most_bytes = room(options.max_mb), .fields = options.fields});
  } catch (const worldio::Hdf5Error& error) {
    throw InputError(error.what());
  }
  const std::string text = worldio::base64(data.bytes);
  write_output(page, {k_replay_page.substr(0, mark), text, k_replay_page.substr(mark + k_mark.size())});
  const double mb = static_cast<double>(k_replay_page.size() - k_mark.size() + text.size()) / k_bytes_mb;
  return contents_of(page, mb, options.max_mb, data);
}

ExitCode replay(const ReplayOptions& options) {
  try {
    fmt::print("{}", write_replay_page(options));
    return k_finished;
  } catch (const OutputError& error) {
    print_line(error.what());
    return k_failed;
  }
}

}  // namespace troupe::apps

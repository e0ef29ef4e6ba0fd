#include "apps/repair.hpp"

#include "apps/messages.hpp"
#include "apps/numbers.hpp"
#include "apps/options.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_repair.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>

namespace troupe::apps {
namespace {

constexpr const char* k_repair_footer = R"(
If a run is killed, its recording is left marked as open for writing, and its arrays may differ in length. Standard HDF5
tools cannot open such a file. This command closes the recording and cuts it to its complete frames; frames that
the run had not yet written to the disk are lost. The command changes a copy of the file in the same folder, and then
replaces the file by the copy, so the disk must have room for both. If much of the file is unused, because frames were
removed when the recording was continued, the command also removes this space. Any other closed recording is not
changed. A recording that a run is still writing is an error, and so is an incomplete copy of a recording: copy the
file again.

Exit codes: 0 the file is readable; 2 the file is not a recording or cannot be repaired, and was not changed.

Example:
  troupe repair run.h5)";

}  // namespace

void add_repair_options(CLI::App& command, std::filesystem::path& recording) {
  command.footer(k_repair_footer);
  add_argument(command, "FILE", "A recording", recording);
}

ExitCode repair(const std::filesystem::path& recording) {
  try {
    const worldio::Repair done = worldio::repair_recording(recording);
    print("{}: {}: {}\n", recording.string(), done.needed ? "repaired" : "nothing to repair",
          counted(done.frames, "frame"));
    return k_finished;
  } catch (const std::runtime_error& error) {
    print_line(error.what());
    return k_bad_input;
  }
}

}  // namespace troupe::apps

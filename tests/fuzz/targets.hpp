#pragma once

#include <string_view>

/// The targets of the fuzz tests. Each function gives one input to Troupe, and aborts the process if a check
/// fails. Both the programs of libFuzzer and the tests of the stored inputs call these functions.
///
/// For every input, Troupe must not crash, leak memory or have undefined behaviour, must end within seconds,
/// and must use little memory. It must either accept the input without errors, or reject it with an error. If
/// Troupe accepts a small world, the function also builds this world and computes some ticks (time steps)
/// with all its sensors running.
namespace troupe::fuzz {

/// Reads a world in Stage's syntax (the text of a `.world` file).
void read_stage(std::string_view text);
/// Reads a JSON world.
void read_json(std::string_view text);
/// Reads the content of an image file.
void read_bitmap(std::string_view bytes);
/// Reads the YAML file of a ROS map.
void read_map(std::string_view text);
/// Reads the recording (an HDF5 file) that make_hdf5() (tests/fuzz/hdf5_text.hpp) makes from the text.
/// Whatever the text is, the file is valid HDF5; only its contents may be wrong.
void read_recording(std::string_view text);

/// Reads a checkpoint (a file with the whole state of a run) whose content make_hdf5() makes from the text.
/// This function puts a valid header, with a hash of the content, before the content. With an invalid header,
/// Troupe would reject the file before it reads the content.
void read_checkpoint(std::string_view text);

/// Reads a checkpoint that Troupe wrote, with changes of its metadata (the structures of HDF5 itself) and a
/// header that fits. Each 10 bytes of the input are a change: which block and byte (2 + 2 bytes), how many
/// bytes, what becomes of them, and a number (1 + 1 + 4). Checks that the unchanged checkpoint is restored.
void read_sealed(std::string_view edits);

/// Reads a study: a JSON file that describes many runs of a world with different parameters (docs/sweeps.md).
/// If the study is valid, loads up to three of its runs. If their world is tests/fuzz/files/study_room.json,
/// also computes some ticks of each.
void read_study(std::string_view text);

/// Sends the input to a live view (`troupe view`, a web server that shows a running simulation) of a small
/// world. A browser opens a live view in two steps: the handshake of a WebSocket, then a message with a
/// secret token. The first byte of the input selects one of four ways to send the other bytes:
/// - at once, without a handshake
/// - after the handshake
/// - after the handshake and the token
/// - after the handshake and the token, each line as a WebSocket text frame
///
/// Checks that the view closes the connection, and that it accepts the connections of later inputs.
void talk_to_view(std::string_view input);

/// Parses and runs a command line of `troupe`; the input has one argument per line. The working folder is a
/// temporary folder that contains a world in each format, a study, and the output files of a run (`run.h5`,
/// `a.log`, ...). Arguments that could name a file outside this folder are left out. Runs are shortened to a
/// fraction of a second. The output of the program is not suppressed. Checks that
///
/// - the exit code is 0, 1, 2 or 3
/// - no file was written if the exit code is 2
/// - no partial file is left
void run_command(std::string_view arguments);

}  // namespace troupe::fuzz

#pragma once

#include <string_view>

/// One function per fuzz target. Both the programs of libFuzzer and the tests of the corpus call these
/// functions. Each function gives one input to Troupe, and aborts the process if a check fails. For every
/// input, Troupe must not crash, leak memory or have undefined behaviour, must end within seconds, and must
/// use little memory. Troupe must either accept an input without errors, or reject it with an error. A world
/// that was accepted is also built, if it is small, and makes some ticks with all its sensors running.
namespace troupe::fuzz {

/// Reads a world in Stage's syntax (the text of a `.world` file).
void read_stage(std::string_view text);
/// Reads a JSON world.
void read_json(std::string_view text);
/// Reads the content of an image file.
void read_bitmap(std::string_view bytes);
/// Reads the YAML file of a ROS map.
void read_map(std::string_view text);
/// Reads a recording that make_hdf5() (tests/fuzz/hdf5_text.hpp) makes from the text. Mutations therefore
/// change the contents of the recording, and the file is always valid HDF5.
void read_recording(std::string_view text);

/// Reads a checkpoint whose content make_hdf5() makes from the text. The header of the file, which contains
/// a hash of the content, is always valid: with an invalid header, the content would not be read at all.
void read_checkpoint(std::string_view text);

/// Reads a study of the world tests/fuzz/files/study_room.json. Loads some of its runs, and makes some ticks
/// of each.
void read_study(std::string_view text);

/// Sends the input to a live view (`troupe view`) of a small world, whose files are in a scratch folder of
/// the process. The first byte of the input determines whether the other bytes are sent before the handshake
/// of a WebSocket, after the handshake, or after the token, or whether each line is sent as a text frame
/// after the token. Checks that the view closes the connection and then accepts further connections.
void talk_to_view(std::string_view input);

/// Parses and runs a command line of `troupe`, with one argument per line. Runs are shortened to a fraction
/// of a second. The working folder is a scratch folder of the process with a world in each format and one or
/// two files of every other type (`run.h5`, `a.log`, ...). Arguments that could name a file outside this
/// folder are left out. Checks that the exit code is 0, 1, 2 or 3, that no file was written if the code is 2,
/// and that no partial file is left behind. Does not suppress the output of the program.
void run_command(std::string_view arguments);

}  // namespace troupe::fuzz

#pragma once

#include <string_view>

/// What the fuzz targets do with an input, and the tests with their corpus. Whatever the bytes are: no crash,
/// no undefined behaviour, no leak, an end within seconds and memory in proportion; a world that can be
/// loaded can be built and makes some ticks with all its sensors running. What is wrong must have been said:
/// an input is refused with an error, or taken.
namespace troupe::fuzz {

/// The text of a Stage world.
void read_stage(std::string_view text);
/// That of a JSON world.
void read_json(std::string_view text);
/// The content of an image.
void read_bitmap(std::string_view bytes);
/// The YAML of a map of ROS.
void read_map(std::string_view text);
/// A recording, as tests/fuzz/hdf5_text.hpp makes it of a text: what is mutated is what stands in it, not
/// HDF5.
void read_recording(std::string_view text);

/// A checkpoint, as make_hdf5() writes it from the text, behind a head that fits: what is damaged otherwise
/// never comes as far as HDF5.
void read_checkpoint(std::string_view text);

/// The text of a study of tests/fuzz/files/study_room.json: some of its runs are loaded and make some ticks.
void read_study(std::string_view text);

/// What a client sends to `troupe view`, which shows a small world in a scratch folder of the process: bytes
/// to its port, by the first byte of the input before or after the handshake of a WebSocket and the token, or
/// a text frame a line. Checked: the program listens afterwards, and closes the connection.
void talk_to_view(std::string_view input);

/// A command line of `troupe`, an argument a line: parsed, and run for a moment, in a scratch folder of the
/// process with a world of each format and one file of every other kind (`run.h5`, `a.log`, ...). Arguments
/// that could name a file elsewhere are left out. Checked: the exit code is one of the four; with 2 no file
/// was written; no partial file is left. Prints what the program prints.
void run_command(std::string_view arguments);

}  // namespace troupe::fuzz

#include "apps/command_line.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>

namespace {

/// Opens standard streams that the caller has closed, in a mode in which using them fails. Otherwise the
/// first file that the program opens for writing would get the file descriptor of standard output, and the
/// summary would be written into this file.
void fill_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0)
      static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

}  // namespace

int main(int argc, char** argv) {
  fill_closed_streams();
  // A file that exceeds the size limit then causes a write error, instead of ending the program.
  std::signal(SIGXFSZ, SIG_IGN);
  return troupe::apps::run_command_line(argc, argv);
}

#include "apps/command_line.hpp"

#include <csignal>

int main(int argc, char** argv) {
  // A file that exceeds the size limit then causes a write error, instead of ending the program.
  std::signal(SIGXFSZ, SIG_IGN);
  return troupe::apps::run_command_line(argc, argv);
}

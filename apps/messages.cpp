#include "apps/messages.hpp"

#include <cstdio>

namespace troupe::apps {

void print_message(std::string_view text) {
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
}

}  // namespace troupe::apps

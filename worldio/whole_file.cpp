#include "worldio/whole_file.hpp"

#include "worldio/partial_file.hpp"

#include <span>

namespace troupe::worldio {

void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces) {
  PartialFile out(file);
  for (const std::string_view piece : pieces) out.write(std::as_bytes(std::span(piece)));
  out.commit();
}

}  // namespace troupe::worldio

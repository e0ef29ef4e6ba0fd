#pragma once

#include "engine/kinds.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_document.hpp"

namespace troupe::worldio {

/// The node that reads back as a described struct: what is as by default is left out. Nodes stand where the
/// document says. object: of the table's struct. Of a kind that is not
/// registered, and so unknown to who reads it, only the name is written.
JsonNode write_described(const DocumentTable& table, const void* object, const engine::Registry& registry);

/// The same.
template <class T>
JsonNode write_document(const T& object, const engine::Registry& registry) {
  return write_described(document_table<T>(), &object, registry);
}

}  // namespace troupe::worldio

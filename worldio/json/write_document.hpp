#pragma once

#include "engine/kinds.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_document.hpp"

namespace troupe::worldio {

/// The node that reads back as a described struct of the table's type, without values at their defaults.
/// Nodes have the places of the document. For a kind that is not registered, only its name is written: its
/// parameters have no keys.
JsonNode write_described(const DocumentTable& table, const void* object, const engine::Registry& registry);

/// Writes a struct of type T with write_described().
template <class T>
JsonNode write_document(const T& object, const engine::Registry& registry) {
  return write_described(document_table<T>(), &object, registry);
}

}  // namespace troupe::worldio

#pragma once

#include "engine/kinds/kinds.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_document.hpp"

namespace troupe::worldio {

/// Returns the JSON node that reads back as the struct at `object`, such as a TypeDocument
/// (worldio/json/world_document.hpp). `table` lists the keys of the struct, and must be the table of the type
/// of `object`. Values at their defaults are omitted, except for keys with DocumentKey::always or of the
/// forms Form::seed and Form::version, which are always written. Each node gets the place in a file (Where)
/// that the struct has for its value; a node without such a place has Where::k_no_file. If a kind (sort of
/// drive, device, controller, ...) is not in `registry`, only its name is written, because the keys of its
/// parameters are unknown.
JsonNode write_described(const DocumentTable& table, const void* object, const engine::Registry& registry);

/// Writes a struct of type T with write_described().
template <class T>
JsonNode write_document(const T& object, const engine::Registry& registry) {
  return write_described(document_table<T>(), &object, registry);
}

}  // namespace troupe::worldio

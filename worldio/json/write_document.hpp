#pragma once

#include "engine/kinds/registry.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_document.hpp"

namespace troupe::worldio {

/// Returns a struct as a JSON node, from which read_described() makes an equal struct. `object` points to the
/// struct, such as a TypeDocument (worldio/json/world_document.hpp), and `table` must be the table of its
/// type.
/// - A member that has its default value is omitted. However, keys with DocumentKey::always and keys of
///   Form::seed and Form::version are always written.
/// - Each node gets the place in a file (Where) that the struct has for its value. If the struct has none,
///   the node gets the default Where(), which means no file.
/// - If the kind of the object (sort of drive, device, controller, ...) is not in `registry`, its parameters
///   are omitted, because their names are unknown.
JsonNode write_described(const DocumentTable& table, const void* object, const engine::Registry& registry);

/// Returns a struct of type T as a JSON node that write_described() makes.
template <class T>
JsonNode write_document(const T& object, const engine::Registry& registry) {
  return write_described(document_table<T>(), &object, registry);
}

}  // namespace troupe::worldio

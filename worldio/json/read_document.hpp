#pragma once

#include "engine/kinds.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

namespace troupe::worldio {

/// What a document is read with.
struct DocumentReading {
  const engine::Registry& registry;
  double most_bodies;  ///< LoadOptions::most_bodies
};

/// Reads a described struct: what is wrong is reported, all of it, at its line; such values are as if they
/// were not there. object: one with its defaults, of the table's struct
void read_described(const JsonCursor& at, const DocumentTable& table, const DocumentReading& reading,
                    void* object);

/// The same of a struct whose keys stand among others of an object.
void read_described_keys(JsonObject& keys, const DocumentTable& table, const DocumentReading& reading,
                         void* object);

/// The same as read_described().
template <class T>
T read_document(const JsonCursor& at, const DocumentReading& reading) {
  T object;
  read_described(at, document_table<T>(), reading, &object);
  return object;
}

}  // namespace troupe::worldio

#pragma once

#include "engine/kinds.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

namespace troupe::worldio {

/// Context of reading a document.
struct DocumentReading {
  const engine::Registry& registry;
  double most_bodies;  ///< LoadOptions::most_bodies
};

/// Reads an object into a struct by its table. Reports all errors, each at its line, and treats a wrong value
/// as absent. `object` points to a default-constructed struct of the type that the table describes.
void read_described(const JsonCursor& at, const DocumentTable& table, const DocumentReading& reading,
                    void* object);

/// Like read_described(), for a struct whose keys are among other keys of an object.
void read_described_keys(JsonObject& keys, const DocumentTable& table, const DocumentReading& reading,
                         void* object);

/// Reads a struct of type T with read_described().
template <class T>
T read_document(const JsonCursor& at, const DocumentReading& reading) {
  T object;
  read_described(at, document_table<T>(), reading, &object);
  return object;
}

}  // namespace troupe::worldio

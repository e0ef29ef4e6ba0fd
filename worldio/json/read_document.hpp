#pragma once

#include "engine/kinds/kinds.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

namespace troupe::worldio {

/// The arguments of read_described() that are the same for all objects of a document. Holds a reference: the
/// registry must outlive it.
struct DocumentReading {
  const engine::Registry& registry;
  double most_bodies;  ///< greatest number of bodies, LoadOptions::most_bodies
};

/// Reads the JSON object at `at` into the struct at `object`, which must be default-constructed and of the
/// type that `table` describes. If the table has a shorthand, a text is accepted in place of the JSON object.
/// Reports all errors, each at its line, and treats a wrong value as absent, except that the unknown name of
/// a model kind (Form::model_kind) is stored. A wrong entry of a list of structs stays in the list, without
/// its wrong values; a wrong entry of a list of names is left out. If the kind of the object is unknown, or
/// missing and not implied (DocumentKinds::implied), no other key is read. If the value of the key
/// DocumentTable::variant is missing or wrong, the keys that depend on it are not read.
void read_described(const JsonCursor& at, const DocumentTable& table, const DocumentReading& reading,
                    void* object);

/// Like read_described(), for a JSON object that also has keys of other structs. Does not report unknown keys
/// and does not apply the rules and checks of the table. The table must not have kinds or variants.
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

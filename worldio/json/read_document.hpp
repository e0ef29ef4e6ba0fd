#pragma once

#include "engine/kinds/kinds.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

/// Reads JSON objects into structs such as TypeDocument (worldio/json/world_document.hpp). A DocumentTable
/// (worldio/json/document_table.hpp) lists the keys of such a struct, and the form and the limits of their
/// values. A kind is a sort of drive, device, controller, measure or fault, which determines further keys:
/// its parameters. The engine::Registry lists all kinds.
namespace troupe::worldio {

/// The arguments of read_described() that are the same for all objects of a document. The struct holds a
/// reference to the registry, which must outlive the struct.
struct DocumentReading {
  const engine::Registry& registry;
  double most_bodies;  ///< greatest number of bodies that the world may have: LoadOptions::most_bodies
};

/// Reads the JSON object at `at` into the struct at `object`, which must be default-constructed and of the
/// type that `table` describes. If the table has a shorthand (DocumentTable::shorthand), a text is accepted
/// in place of the JSON object. Reports all errors, each at its line, and treats a wrong value as absent,
/// except that an unknown name of a model type of Stage (Form::model_kind) is stored. A wrong entry of a list
/// of structs stays in the list, without its wrong values; a wrong entry of a list of names is left out. If
/// the kind of the object is unknown, or missing and not implied (DocumentKinds::implied), no other key is
/// read. If the value of the key DocumentTable::variant is missing or wrong, the keys that depend on it are
/// not read.
void read_described(const JsonCursor& at, const DocumentTable& table, const DocumentReading& reading,
                    void* object);

/// Like read_described(), for a JSON object that also has keys of other structs. Does not report unknown keys
/// and does not apply the rules and checks of the table. The members `kinds` and `variant` of the table must
/// be empty.
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

#pragma once

#include "engine/kinds/registry.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

/// Reads JSON objects into structs such as TypeDocument (worldio/json/world_document.hpp). The DocumentTable
/// of a struct (worldio/json/document_table.hpp) lists the keys of the JSON object, and the form and the
/// limits of their values. A kind is a sort of drive, device, controller, measure or fault. The key `kind` of
/// an object names its kind, and the parameters of the kind are further keys of the object. The
/// engine::Registry lists all kinds.
namespace troupe::worldio {

/// The arguments of read_described() that are the same for all objects of a document. The registry must
/// outlive the struct, which refers to it.
struct DocumentReading {
  const engine::Registry& registry;
  double most_bodies;  ///< greatest number of bodies that the world may have: LoadOptions::most_bodies
};

/// Reads the JSON object at `at` into the struct at `object`. The struct must be default-constructed, and
/// `table` must be the table of its type. If the struct has a shorthand (DocumentTable::shorthand), the JSON
/// value may also be a text. Reports all errors, each at its line. A member whose value is wrong or missing
/// keeps its default, with these exceptions:
/// - An unknown model type of Stage (Form::model_kind), which is an error, is nevertheless stored.
/// - In a list of structs, a wrong entry stays in the list, without its wrong values. In a list of names, a
///   wrong entry is left out.
/// - If the kind of the object is unknown, no other key is read. The same holds if the key `kind` is missing,
///   unless the enclosing object determines the kind (DocumentKinds::implied).
/// - If the key DocumentTable::variant is missing or wrong, the keys that depend on its value are not read.
void read_described(const JsonCursor& at, const DocumentTable& table, const DocumentReading& reading,
                    void* object);

/// Reads the keys of one struct from a JSON object that also has the keys of other structs. `keys` is the
/// object, and `table` and `object` are as for read_described(). In contrast to that function, reports no
/// unknown keys, and makes neither the checks of DocumentTable::rules nor that of DocumentTable::check. The
/// members `kinds` and `variant` of the table must be empty.
void read_described_keys(JsonObject& keys, const DocumentTable& table, const DocumentReading& reading,
                         void* object);

/// Returns a struct of type T that read_described() has filled.
template <class T>
T read_document(const JsonCursor& at, const DocumentReading& reading) {
  T object;
  read_described(at, document_table<T>(), reading, &object);
  return object;
}

}  // namespace troupe::worldio

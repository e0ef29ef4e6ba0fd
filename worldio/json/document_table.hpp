#pragma once

#include "base/result.hpp"
#include "engine/fields/fields.hpp"
#include "engine/kinds/registry.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Tables of the keys that the JSON objects of a world can have. Each JSON object is read into a C++ struct,
/// such as TypeDocument; each key is read into a member of the struct. worldio/json/world_document.hpp
/// defines the structs. The outermost struct is WorldDocument, the content of a whole JSON world. The
/// function describe() of a struct fills a DocumentTable with one DocumentKey per key. The reader
/// (read_document.cpp), the writer (write_document.cpp) and the JSON schema (world_schema.cpp) use these
/// tables.
///
/// Terms:
///
/// kind        A sort of drive, device, controller, measure or fault. It has parameters. An object with the
///             key `kind` names a kind, and the parameters of the kind are further keys of this object, as in
///             {"kind": "wander", "cruise_speed_mps": 0.2}.
/// preset      A kind of controller with other default values, under a name of its own.
/// registry    The list of kinds and presets (engine::Registry): the built-in ones, and those that loaded
///             plug-ins (shared libraries) have added.
/// field       The description of a value: name, type, unit, limits, default (engine::Field). An
///             engine::FieldTable is a list of fields.
/// record      One value for each field of a table (engine::Record).
/// model type  The type of a model in Stage, an older robot simulator whose world files Troupe reads, such as
///             "ranger" or "position".
/// place       A file and a line in it (Where).
namespace troupe::worldio {

struct DocumentTable;

/// The form that a value has in a JSON file. Each comment gives the C++ type of the struct member that stores
/// the value, then a colon, then the JSON value.
enum class Form : std::uint8_t {
  value,            ///< a type that engine::Field can describe: its JSON form follows from DocumentKey::field
  choice,           ///< an enum of one byte: a text; entry i of Field::choices means the value i
  block,            ///< engine::Record: an object with the fields of DocumentKey::block
  version,          ///< no member: the version of the format, which must be k_format_version
  seed,             ///< std::uint64_t: a whole number from 0 to 2^64 - 1
  name,             ///< std::string: a text, not empty
  names,            ///< std::vector<std::string>: a list of texts, none of which is empty
  model_kind,       ///< std::string: the name of a model type of Stage (Registry::models)
  color,            ///< Color: an X11 name, [r, g, b] or [r, g, b, a]
  color_or_random,  ///< ColorDocument: a color, or "random"
  heading,          ///< HeadingDocument: an angle, or "random"; heading_field() describes the key
  points,           ///< std::vector<Vec2>: [[x, y], ...], m
  box,              ///< Box: [[x_min, y_min], [x_max, y_max]], m
  contours,         ///< std::vector<Ring>: a list of outlines, each [[x, y], ...], m
  joint,            ///< JointName: the name of a joint, or null for no joint
  comparison,       ///< ComparisonDocument: a text such as `>= 0.9`
  kept,             ///< JsonNode: stored uninterpreted, because its valid keys depend on other objects
  kind,             ///< std::string: the name of one of DocumentTable::kinds
  parameters,       ///< engine::Record: the parameters of the kind, which are keys of the same object
  faults,  ///< std::vector<FaultDocument::Impairment>: one key of the object per entry; the key has the
           ///< name of a fault in Registry::faults, and its value is an object of parameters
  object,  ///< a struct with a DocumentTable: an object with the keys of this table
  list,    ///< std::vector of structs with a DocumentTable: a list of such objects
  map,     ///< std::vector of pairs of a name and a struct with a DocumentTable: an object whose keys are the
           ///< names
};

/// The description of one key of the JSON objects that are read into a struct.
struct DocumentKey {
  /// Name and meaning of the key. If the form is Form::value, also the unit, the limits and the choices of
  /// the value. If the form is Form::choice, also the choices.
  engine::Field field;
  Form form = Form::value;     ///< form of the value of the key
  bool required = false;       ///< true: an object without the key is an error
  std::string_view hint = {};  ///< text after `missing "key": ` in errors; empty: see missing_hint()
  /// If the value is a text: what follows `expected ` in errors. If the form is Form::kept: the name of a key
  /// that the schema requires in the object that is the value; empty if it requires none.
  std::string_view expects = {};
  /// Text for the documentation and the schema that says what an absent key means, such as "the bounds of the
  /// world". Empty: the default value of the member is shown.
  std::string_view by_default = {};
  /// Minimum number of entries of Form::names, or of points of an outline. 1 for Form::list: an empty list is
  /// an error, because it would mean the same as no list (`by_default`).
  std::size_t least = 0;
  std::size_t most = std::numeric_limits<std::size_t>::max();  ///< maximum number of points of an outline
  bool always = false;  ///< true: the writer also writes default values, except a z of 0 in a pose
  /// True: the value is a number of bodies, and must also be at most LoadOptions::most_bodies.
  bool counts_bodies = false;
  /// The description of the key under a second name; set by or_named(). If the kind of an object has a
  /// parameter with the name of `field`, the object has the key `other` in place of `field`, because
  /// parameters are keys of the same object. Empty: the key has no second name.
  std::optional<engine::Field> other;
  /// A table can have a key whose value decides which other keys are valid (DocumentTable::variant). Bit i of
  /// `variants` is 1 if this key is valid together with choice i of that key, counted from 0. All bits are 1
  /// if this key is always valid.
  std::uint32_t variants = ~0u;
  const DocumentTable& (*table)() = nullptr;  ///< Form::object, list and map: table of the struct
  const engine::FieldTable* block = nullptr;  ///< Form::block: the fields of the object
  /// Returns whether a JSON object may have this key, which depends on the other keys of `object`. If the
  /// function is null, every object may have the key.
  bool (*is_there)(const JsonNode& object) = nullptr;
  /// Returns whether objects of a kind may have this key. `kind` is DocumentKind::kind of the object, which
  /// can be null. If the function is null, objects of all kinds may have the key.
  bool (*is_of)(const void* kind) = nullptr;

  /// True: the struct has no member for this key. The loader handles the key before it reads the object into
  /// the struct. Such keys are `include` and `extends` (worldio/json/json_include.hpp), and `ring`
  /// (worldio/json/json_ring.hpp).
  bool is_resolved = false;
  bool is_optional = false;  ///< whether the member is a std::optional
  /// True: the member is a float; the writer then writes only as many digits as a float needs.
  bool is_float = false;

  // Functions that access the member, for every form except `value`; null if the key has no member. make()
  // and find() get the struct as `object`. The other functions exist only for lists and maps, and get the
  // list or the map that make() or find() returned.
  void* (*make)(void* object) = nullptr;  ///< returns the member; an empty std::optional gets a value
  const void* (*find)(const void* object) = nullptr;  ///< returns the member; null: an empty std::optional
  std::size_t (*size)(const void* object) = nullptr;  ///< returns the number of entries
  /// Adds an entry and returns it. name: its key in a map
  void* (*append)(void* object, std::string_view name) = nullptr;
  const void* (*item)(const void* object, std::size_t index) = nullptr;  ///< returns entry `index`
  /// Returns the key of an entry of a map.
  const std::string* (*item_name)(const void* object, std::size_t) = nullptr;

  /// Text that follows `missing "key": ` in errors: the first of `hint`, the meaning of the key and `expects`
  /// that is not empty.
  std::string_view missing_hint() const {
    return !hint.empty() ? hint : !field.text.empty() ? field.text : expects;
  }
  // Each of the functions below sets members and returns this key, so that calls can be chained.
  DocumentKey& require(std::string_view what = {}) {
    required = true;
    hint = what;
    return *this;
  }
  DocumentKey& when(bool (*holds)(const JsonNode& object)) {
    is_there = holds;
    return *this;
  }
  DocumentKey& of_kind(bool (*holds)(const void* kind)) {
    is_of = holds;
    return *this;
  }
  DocumentKey& of_variants(std::uint32_t bits) {
    variants = bits;
    return *this;
  }
  DocumentKey& entries(std::size_t at_least, std::size_t at_most = std::numeric_limits<std::size_t>::max()) {
    least = at_least;
    most = at_most;
    return *this;
  }
  /// Sets a second name of the key. Objects whose kind has a parameter with the first name use the second
  /// name (see `other`).
  DocumentKey& or_named(std::string_view name) {
    other = field;
    other->name = name;
    return *this;
  }
  DocumentKey& or_default(std::string_view what) {
    by_default = what;
    return *this;
  }
  DocumentKey& resolve() {
    is_resolved = true;
    return *this;
  }
  DocumentKey& write_always() {
    always = true;
    return *this;
  }
};

/// A rule about a group of keys: how many keys of the group an object must have. The reader and the schema
/// check it.
struct DocumentRule {
  /// How many of the keys an object must have: exactly one (one_of), at least one (any_of), or at most one
  /// (not_both).
  enum class How : std::uint8_t { one_of, any_of, not_both };
  How how = How::one_of;
  std::vector<std::string_view> keys = {};  ///< names of keys, as in DocumentKey::field
  std::string none = {};                    ///< text of the error if the object has none of the keys
  std::string several = {};                 ///< text of the error if it has several of them; empty: `none`
  bool at_key = false;  ///< true: `several` is reported at every key after the first; false: once, at the
                        ///< object
};

/// A kind or preset that objects with the key `kind` can have. The members refer to data of the
/// engine::Registry, which must outlive this struct. The functions of DocumentKinds describe a preset in two
/// ways:
/// - all() returns it under its own name, with the name of its kind in `preset_of`.
/// - find() returns it under the name of its kind, with an empty `preset_of`.
struct DocumentKind {
  std::string_view name;                       ///< name of the kind or preset
  std::string_view text;                       ///< meaning of the kind
  const engine::FieldTable* params = nullptr;  ///< parameters of the kind: keys of the same object
  /// For a preset: pairs of the name of a parameter and its default value, which replace the defaults in
  /// `params`. Empty for a kind that is not a preset.
  std::span<const std::pair<std::string_view, engine::Value>> presets = {};
  std::string_view preset_of = {};  ///< for a preset that all() returned: name of its kind
  const void* kind = nullptr;  ///< argument of DocumentKey::is_of: engine::DeviceKind of a device, else null
};

/// The kinds that the objects of one struct can have, for example all kinds of drives.
struct DocumentKinds {
  std::string_view what;  ///< word for a kind in messages: "drive"
  /// Name of the page of docs/ about plug-ins that contain such kinds, such as "extending". Empty: plug-ins
  /// cannot contain such kinds.
  std::string_view page;
  /// Returns those kinds of the registry that the objects can have, then all presets of these kinds.
  std::vector<DocumentKind> (*all)(const engine::Registry& registry);
  /// Returns the names of all kinds and presets, sorted, for messages.
  std::vector<std::string_view> (*known)(const engine::Registry& registry);
  /// Returns the names that a kind of a plug-in must not have, because kinds or presets of the registry have
  /// them. Null if `page` is empty.
  std::vector<std::string_view> (*named)(const engine::Registry& registry);
  /// Returns the kind or preset with the name `name`. If a plug-in contains the kind, the plug-in is loaded.
  /// If the objects cannot have a kind of this name, returns an error whose text is the message for the user.
  Result<DocumentKind> (*find)(const engine::Registry& registry, const std::string& name);
  /// Returns the kind of an object that has no key `kind`. `around` is the object that contains this object.
  /// Returns nothing if the kind does not follow from `around`. If the function is null, every object must
  /// have the key `kind`.
  std::optional<DocumentKind> (*implied)(const engine::Registry& registry, const JsonNode& around) = nullptr;
  std::string_view expects = {};  ///< DocumentKey::expects of `kind`; empty: "the name of a " and `what`
  std::string_view hint = {};     ///< DocumentKey::hint of the key `kind`; empty: a list of all known kinds
};

/// A form of text that may be given in place of an object, such as "stalls" in place of {"kind": "stalls"}.
struct DocumentShorthand {
  std::string_view expects;  ///< what follows `expected ` in errors
  /// Fills the default-constructed struct at `object` from the text. If the text is wrong, reports errors at
  /// `at`; the struct is then incomplete.
  void (*read)(const JsonCursor& at, const std::string& text, const engine::Registry& registry, void* object);
  /// Returns the text for the struct at `object`; empty if no text can express the struct.
  std::optional<std::string> (*write)(const void* object, const engine::Registry& registry);
  /// Returns the JSON schemas of the texts: a text is valid if it fits one of them.
  std::vector<JsonNode> (*schemas)(const engine::Registry& registry);
  bool before_object = false;  ///< true: the schema lists the text before the object; false: after it
};

/// The description of a struct: its keys, and rules for them.
struct DocumentTable {
  /// Name under "definitions" in the JSON schema; empty: the schema repeats the struct at each use.
  std::string_view definition;
  std::vector<DocumentKey> keys;         ///< in the order in which the writer writes them
  std::vector<DocumentRule> rules;       ///< checked in this order
  const DocumentKinds* kinds = nullptr;  ///< the kinds that the objects can have; null: no key of Form::kind
  const DocumentShorthand* shorthand = nullptr;  ///< null: no text may be given in place of an object
  /// Name of the key that decides which other keys are valid (DocumentKey::variants); its form is
  /// Form::choice. For example, the key `rule` decides which other keys an object `place` may have. Empty:
  /// the same keys are valid in all objects.
  std::string_view variant;
  /// Checks the struct at `object` after all keys are read, and reports errors. `at` is the JSON object.
  /// Null: no check.
  void (*check)(const void* object, const JsonCursor& at) = nullptr;
  /// Returns the struct at `object` as its base class Placed, which stores the places (file and line) of the
  /// JSON object and its keys.
  Placed& (*placed)(void* object) = nullptr;
  const void* usual = nullptr;  ///< a struct whose members have their default values
  /// Errors in describe(): the names of the structs of which a member has neither a key nor a call of
  /// DocumentKeys::no_key(). A test checks that this list is empty.
  std::vector<std::string> incomplete;
  /// Returns whether the writer omits the key `kind` of the struct at `object`. The writer may omit the key
  /// if the reader finds the same kind with DocumentKinds::implied. Null: the writer always writes the key.
  bool (*is_kind_implied)(const void* object) = nullptr;

  /// Returns the key whose DocumentKey::field has this name; null if there is none.
  const DocumentKey* find(std::string_view name) const;
};

/// Reads `text` as a comparison with a finite number, such as `>= 0.9`. Spaces around the operator and the
/// number are allowed. If the text is not such a comparison, reports an error at `at` and returns nothing.
/// `at` is the JSON value that contains the text.
std::optional<ComparisonDocument> read_comparison(const JsonCursor& at, std::string_view text);
/// Returns a regular expression for the schema. Every text that read_comparison() accepts matches this
/// expression.
std::string comparison_pattern();

/// Returns the table of a struct T of a WorldDocument. The first call fills the table with T::describe().
/// Defined in worldio/json/document_keys.hpp, and instantiated in worldio/json/world_document.cpp.
template <class T>
const DocumentTable& document_table();

/// Returns the field `heading` of a pose, an angle. A file writes the angle under the key `heading_rad` or
/// `heading_deg`. The angle of a HeadingDocument is written in the same way.
const engine::Field& heading_field();
/// Returns the field that describes a key in objects of a kind. `params` are the parameters of the kind; null
/// if the objects have no kind. The result is DocumentKey::other if `other` is set and a parameter has the
/// name of DocumentKey::field. Else the result is DocumentKey::field.
const engine::Field& field_of(const DocumentKey& key, const engine::FieldTable* params);

}  // namespace troupe::worldio

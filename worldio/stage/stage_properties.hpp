#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// How Troupe treats a property of the `.world` files of Stage, an older robot simulator.
enum class StageSupport {
  honoured,       ///< read; the property means the same as in Stage 4.3, or Troupe added it
  fixed,          ///< honoured, but not exactly as in Stage 4.3: the note says how it differs
  no_effect,      ///< accepted and ignored: the note says why
  window_camera,  ///< accepted; it affects only Stage's window, and Troupe's pictures with `--camera window`
  window_only,    ///< accepted; it affects only Stage's window
  /// A word of older versions of Stage. As a property, it is accepted and ignored, as by Stage 4.3; as a
  /// type, it is an error. The note says what to write today.
  obsolete,
};

/// A property that entities of one type can have, and how Troupe treats it. An entity is a model, block,
/// sensor or window of a file, or the world itself.
struct StageRow {
  /// "world", "block", "sensor", "window" or a model type; "model": every model type; "type": the name is
  /// that of a type itself
  std::string_view type;
  std::string_view name;  ///< name of the property; a number in brackets is written [k], as in `point[k]`
  StageSupport support;   ///< how Troupe treats the property
  std::string_view note;  ///< meaning of the property, or difference from Stage, as Markdown; may be empty
};

/// Returns all rows, in the order of the table in docs/stage-worlds.md. There is a row for every property
/// that Stage 4.3 knows, that files written for Stage have, or that Troupe adds.
std::span<const StageRow> stage_rows();

/// Returns the row that describes a property of an entity of this type; null if there is none. `name` is the
/// name in the file, with its numbers: "point[3]". If a model type has no row for the property, the rows of
/// "model" are searched. `type` may also be an older name of a type: "wifi" means "radio", and for "laser"
/// and "sonar" the rows of "ranger" and "sensor" are searched.
const StageRow* find_stage_row(std::string_view type, std::string_view name);

/// Returns the text of the message about obsolete properties with the same note: `old syntax: "scount" and
/// "sview" are ignored, as in Stage: write ...`. example: what to write for the first of them; may be empty
std::string old_words_text(std::span<const std::string_view> names, std::string_view example,
                           std::string_view note);
/// Returns the text of the error about a model type that only older versions of Stage had.
std::string old_type_text(const StageRow& row);

/// Whether a property of this name never has an effect on a run, whatever the type of its entity. Bodies that
/// differ only in such properties can have the same type. Returns false for an unknown property. `name` is
/// the name in the file.
bool is_without_effect(std::string_view name);

/// Returns the names of the properties that an entity of this type can have, without obsolete ones. The names
/// are used to suggest one for a misspelt property. `type` may be an older name of a type, as in
/// find_stage_row().
std::vector<std::string_view> stage_property_names(std::string_view type);

/// Returns the properties that models of this type, and the blocks in such models, can have. The result is
/// text for `troupe describe`. Properties without effect on a run are omitted. For "ranger", the properties
/// of a `sensor` in a ranger are included.
std::string stage_properties_text(std::string_view model);

}  // namespace troupe::worldio

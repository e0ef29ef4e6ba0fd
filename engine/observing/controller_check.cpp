#include "engine/observing/controller_check.hpp"

#include "base/fp_environment.hpp"
#include "engine/interventions/experiment.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/state/kind_calls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace troupe::engine {
namespace {

// Bytes with which storage is filled before a controller writes to the storage. start_twice() uses both.
constexpr std::byte k_junk{0xa5};
constexpr std::byte k_other_junk{0x5a};
// Rows per batch of the second repetition, and per call of spoil_stack() in both. The number is no divisor of
// the number of rows per batch in a step, so that the batches consist of other robots than in the step.
constexpr std::size_t k_rows_per_batch = 61;

/// Overwrites with junk the part of the stack in which the next call places its local variables.
[[gnu::noinline]] void spoil_stack() {
  std::array<volatile std::byte, 16384> below;
  for (volatile std::byte& byte : below) byte = k_junk;
}

void copy_fields(const std::vector<StateField>& fields, const std::byte* from, std::byte* to) {
  for (const StateField& field : fields) std::memcpy(to + field.offset, from + field.offset, field.bytes());
}

std::string controller_name(const BodyType::Controller& controller, std::size_t number) {
  return fmt::format("{}/{}", controller.kind->name, number);
}

/// Merges a finding into a list that has at most one finding for each field of each controller. The merged
/// finding names the repetition that found a difference first, the lowest id of a body with this difference,
/// and the number of decisions that differ.
void add(const ControllerFinding& finding, std::vector<ControllerFinding>& findings) {
  const auto known = std::ranges::find_if(findings, [&](const ControllerFinding& other) {
    return other.controller == finding.controller && other.field == finding.field;
  });
  if (known == findings.end()) {
    findings.push_back(finding);
  } else if (known->repeat == finding.repeat) {
    const std::size_t decisions = known->decisions + 1;
    if (finding.body < known->body) *known = finding;
    known->decisions = decisions;
  }
}

/// Makes a controller of a type again, on a stack that is filled with junk. Without the junk, a member that
/// the controller leaves unset could get the same value each time, from data that earlier calls left on the
/// stack.
void make_afresh(const WorldSpec& world, const TypeSpec& spec, BodyType& type, std::size_t controller) {
  std::vector<bool> claimed(type.devices.size(), false);  // devices that earlier controllers reserve
  for (std::size_t c = 0; c <= controller; ++c) {
    spoil_stack();
    Result<ControllerKind::Prepared> prepared =
        prepare_controller(*type.controllers[c].kind, spec.controllers[c], world, spec, type, claimed);
    if (c == controller) type.controllers[c].data = prepared ? std::move(prepared->data) : std::any();
  }
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

std::string finding_text(const World& world, const ControllerFinding& finding) {
  if (finding.repeat == ControllerFinding::Repeat::other)
    return fmt::format(
        "controller \"{}\": {} of \"{}\" (id {}) is changed from {} to {} by the decision of "
        "another robot; {} change{}",
        finding.controller, finding.field, world.spec().name(finding.body), finding.body.value,
        value_text(finding.first), value_text(finding.second), finding.decisions,
        finding.decisions == 1 ? "" : "s");
  const auto when = [&] {
    switch (finding.repeat) {
      case ControllerFinding::Repeat::start:
        return "when its memory is initialised in storage that held other bytes";
      case ControllerFinding::Repeat::again: return "when the decision is repeated";
      case ControllerFinding::Repeat::afresh:
      case ControllerFinding::Repeat::other: break;
    }
    return "when a newly constructed controller decides";
  };
  std::string text =
      fmt::format("controller \"{}\": {} of \"{}\" (id {}) is {} {}, not {}", finding.controller,
                  finding.field, world.spec().name(finding.body), finding.body.value,
                  value_text(finding.second), when(), value_text(finding.first));
  if (finding.repeat != ControllerFinding::Repeat::start)
    text +=
        fmt::format("; {} decision{}", finding.decisions, finding.decisions == 1 ? " differs" : "s differ");
  return text;
}

ControllerCheck::ControllerCheck(World& world, const Registry& registry) : world_(world) {
  Diagnostics diagnostics;
  for (const TypeSpec& type : world.spec().types) {
    fresh_types_.push_back(make_body_type(type, world.spec(), registry, diagnostics));
  }
  diagnostics.throw_if_errors();
  const ExperimentSpec& experiment = world.spec().experiment;
  for (const std::size_t i : order_of_interventions(experiment, world.view().tick_s()))
    if (const InterventionSpec& at = experiment.at[i]; at.setting)
      settings_.push_back({ticks_until(at.time_s, world.view().tick_s()), *at.setting});
  follow_settings(world.tick() + 1);
  for (const BodyType& type : world.view().types()) {
    watched_.emplace_back();
    for (const BodyType::Controller& controller : type.controllers)
      watched_.back().push_back(watch(type, controller));
  }
  const auto commands = std::ranges::find(world.tables(), "command", &StateTable::component);
  command_fields_.assign(commands->fields().begin(), commands->fields().end());
  world.on_decide([this](const BodyType& type, const BodyType::Controller& controller,
                         const DecideBatch& batch) { record(type, controller, batch); });
}

ControllerCheck::~ControllerCheck() { world_.on_decide(nullptr); }

std::vector<ControllerFinding> ControllerCheck::start_twice() const {
  std::vector<Finding> findings;
  for (const BodyType& type : world_.view().types()) {
    for (std::size_t c = 0; c < type.controllers.size(); ++c) {
      const BodyType::Controller& controller = type.controllers[c];
      if (!controller.table) continue;
      std::vector<std::byte> first(controller.kind->memory_bytes, k_other_junk);
      std::vector<std::byte> second(controller.kind->memory_bytes, k_junk);
      call_kind(world_.view(), {}, controller, [&] {
        controller.kind->start(first.data());
        spoil_stack();
        controller.kind->start(second.data());
      });
      Finding finding{.controller = controller_name(controller, c), .repeat = Finding::Repeat::start};
      finding.body = std::ranges::min(world_.tables()[*controller.table].ids());
      compare_rows(
          controller.kind->memory, first.data(), second.data(),
          [&](const StateField& field, std::size_t column, const StateValue& a, const StateValue& b) {
            finding.field = "memory " + field_text(field, column);
            finding.first = a;
            finding.second = b;
            add(finding, findings);
          });
    }
  }
  return findings;
}

/// A setting (an intervention `set`, which changes parameters) takes effect between two ticks. A setting at
/// the end of a tick applies to the decisions of the next tick. As in the world itself, a setting of a
/// controller makes this controller again, and a setting of the drive or of a drive device makes all
/// controllers of the type again if one of them may have read the drive.
void ControllerCheck::follow_settings(std::uint64_t tick) {
  const WorldSpec& spec = world_.spec();
  const auto in_force = static_cast<std::size_t>(
      std::ranges::lower_bound(settings_, tick, {}, &Setting::tick) - settings_.begin());
  if (type_specs_.empty() || in_force < followed_) {  // on the first call, and after a reset of the world
    followed_ = 0;
    type_specs_ = spec.types;
    for (std::size_t t = 0; t < fresh_types_.size(); ++t)
      for (std::size_t c = 0; c < fresh_types_[t].controllers.size(); ++c)
        make_afresh(spec, type_specs_[t], fresh_types_[t], c);
  }
  for (; followed_ < in_force; ++followed_) {
    const SettingSpec& setting = settings_[followed_].setting;
    TypeSpec& type = type_specs_[setting.type.index()];
    Record& params = params_of(type, setting);
    params = changed(params, setting);
    BodyType& fresh = fresh_types_[setting.type.index()];
    const bool is_of_drive =
        setting.of == SettingSpec::Of::drive ||
        (setting.of == SettingSpec::Of::device && fresh.devices[setting.index].kind->drives);
    for (std::size_t c = 0; c < fresh.controllers.size(); ++c)
      if (setting.of == SettingSpec::Of::controller ? c == setting.index
                                                    : is_of_drive && fresh.binds_controllers())
        make_afresh(spec, type, fresh, c);
  }
}

ControllerCheck::Watched ControllerCheck::watch(const BodyType& type,
                                                const BodyType::Controller& controller) const {
  Watched watched;
  if (controller.table) {
    const StateTable& memories = world_.tables()[*controller.table];
    watched.written.push_back(
        {"memory", controller.kind->memory, memories.row_bytes(), std::nullopt, *controller.table});
  }
  for (std::size_t s = 0; s < controller.devices.size(); ++s) {
    const BodyType::Device& sensor = type.devices[controller.devices[s]];
    if (!sensor.command_table) continue;
    const StateTable& commands = world_.tables()[*sensor.command_table];
    watched.written.push_back(
        {commands.component(), sensor.prepared.commands, commands.row_bytes(), s, *sensor.command_table});
  }
  watched.taken.written_before.resize(watched.written.size());
  watched.taken.written_after.resize(watched.written.size());
  watched.taken.percepts.resize(controller.devices.size());
  return watched;
}

/// The callback Tick::OnDecide, which the worker threads of the world call for each batch of robots. Calls
/// the controller, and stores copies of the inputs and outputs of its decisions.
void ControllerCheck::record(const BodyType& type, const BodyType::Controller& controller,
                             const DecideBatch& batch) {
  Watched& watched = watched_[static_cast<std::size_t>(&type - world_.view().types().data())]
                             [static_cast<std::size_t>(&controller - type.controllers.data())];
  const std::size_t written = watched.written.size();
  Decisions here{.given = batch, .rows = {batch.rows.begin(), batch.rows.end()}};
  here.written_before.resize(written);
  here.written_after.resize(written);
  here.percepts.resize(batch.devices);
  const auto copy_rows = [&](std::vector<Command>& commands, std::vector<std::vector<std::byte>>& rows) {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      commands.push_back(batch.command(i));
      for (std::size_t w = 0; w < written; ++w) {
        const std::byte* row = watched.written[w].rows(here.given).of(batch.slot(i));
        rows[w].insert(rows[w].end(), row, row + watched.written[w].row_bytes);
      }
    }
  };
  copy_rows(here.commands_before, here.written_before);
  for (std::size_t i = 0; i < batch.size(); ++i) here.estimates.push_back(batch.estimate(i));
  for (std::size_t s = 0; s < batch.devices; ++s) {
    const StateTable& table = *batch.percepts[s];
    for (std::size_t i = 0; i < batch.size(); ++i)
      here.percepts[s].insert(here.percepts[s].end(), table.row(batch.slot(i)),
                              table.row(batch.slot(i)) + table.row_bytes());
  }
  controller.kind->decide(controller.data, batch);
  copy_rows(here.commands_after, here.written_after);

  const std::lock_guard lock(mutex_);
  Decisions& taken = watched.taken;
  taken.given = batch;
  append(taken.rows, here.rows);
  append(taken.estimates, here.estimates);
  append(taken.commands_before, here.commands_before);
  append(taken.commands_after, here.commands_after);
  for (std::size_t w = 0; w < written; ++w) {
    append(taken.written_before[w], here.written_before[w]);
    append(taken.written_after[w], here.written_after[w]);
  }
  for (std::size_t s = 0; s < batch.devices; ++s) append(taken.percepts[s], here.percepts[s]);
}

std::size_t ControllerCheck::pending() const {
  std::size_t count = 0;
  for (const auto& of_type : watched_)
    for (const Watched& watched : of_type) count += watched.taken.rows.size();
  return count;
}

std::vector<ControllerFinding> ControllerCheck::repeat() {
  restore_fp_environment();  // the calling thread may have another floating-point mode
  follow_settings(world_.tick());
  commands_.assign(world_.view().rows(), Command{k_nan, k_nan, k_nan});
  kept_commands_ = commands_;
  estimates_.assign(world_.view().rows(), k_nowhere);
  std::vector<Finding> findings;
  for (std::size_t t = 0; t < watched_.size(); ++t) {
    for (std::size_t c = 0; c < watched_[t].size(); ++c) {
      Watched& watched = watched_[t][c];
      if (watched.taken.rows.empty()) continue;
      decisions_ += watched.taken.rows.size();
      const BodyType::Controller& same = world_.view().types()[t].controllers[c];
      for (const auto how : {Finding::Repeat::again, Finding::Repeat::afresh}) {
        const Finding about{.controller = controller_name(same, c), .repeat = how};
        repeat(world_.view().types()[t],
               how == Finding::Repeat::again ? same : fresh_types_[t].controllers[c], watched, about,
               findings);
        compare(watched, about, findings);
      }
      watched = watch(world_.view().types()[t], same);
    }
  }
  return findings;
}

/// Calls visit(name, fields, output, kept, bytes) for each output of the repeated decisions of a row: its
/// command in commands_ and, if its body has the type of the decisions, its rows in written_. `kept` is the
/// same row in kept_commands_ or kept_written_.
template <class Visit>
void ControllerCheck::for_outputs(const BodyType& type, const Watched& watched, Row row, Visit&& visit) {
  visit(std::string_view("command"), command_fields_, reinterpret_cast<std::byte*>(&commands_[row.index()]),
        reinterpret_cast<std::byte*>(&kept_commands_[row.index()]), sizeof(Command));
  if (&world_.view().type(row) != &type) return;
  for (std::size_t w = 0; w < written_.size(); ++w) {
    const Written& written = watched.written[w];
    const std::size_t first = world_.view().slot(row) * written.row_bytes;
    visit(written.what, written.fields, written_[w].data() + first, kept_written_[w].data() + first,
          written.row_bytes);
  }
}

/// Copies the stored inputs of `watched` to commands_, estimates_, written_ and percepts_. Returns the stored
/// batch, changed so that it reads these copies, and writes its outputs to commands_ and written_.
DecideBatch ControllerCheck::restore_inputs(const Watched& watched) {
  const Decisions& taken = watched.taken;
  DecideBatch batch = taken.given;
  std::size_t slots = 0;
  for (const Row row : taken.rows) slots = std::max<std::size_t>(slots, batch.slots[row.index()] + 1);
  for (const Written& written : watched.written)
    slots = std::max(slots, world_.tables()[written.table].rows());
  static const Localization k_as_noted;
  batch.commands = commands_;
  batch.drive_commands = {};
  batch.drive_state = nullptr;
  batch.estimates = {&k_as_noted, estimates_, {}};
  for (std::size_t i = 0; i < taken.rows.size(); ++i) {
    commands_[taken.rows[i].index()] = taken.commands_before[i];
    estimates_[taken.rows[i].index()] = taken.estimates[i];
  }
  written_.resize(watched.written.size());
  for (std::size_t w = 0; w < written_.size(); ++w) {
    const Written& written = watched.written[w];
    written_[w].assign(slots * written.row_bytes, k_junk);
    written.rows(batch).first = written_[w].data();
    for (std::size_t i = 0; i < taken.rows.size(); ++i)
      copy_fields(written.fields, taken.written_before[w].data() + i * written.row_bytes,
                  written_[w].data() + batch.slots[taken.rows[i].index()] * written.row_bytes);
  }
  percepts_.clear();
  percepts_.reserve(batch.devices);
  for (std::size_t s = 0; s < batch.devices; ++s) {
    const StateTable*& now = batch.percepts[s];
    StateTable& then = percepts_.emplace_back(*now);
    now = &then;
    for (std::size_t i = 0; i < taken.rows.size(); ++i)
      std::copy_n(taken.percepts[s].data() + i * then.row_bytes(), then.row_bytes(),
                  then.row(batch.slots[taken.rows[i].index()]));
  }
  return batch;
}

/// Repeats the stored decisions of `watched`, which are of robots of `type`, with a controller, from the
/// stored inputs. Writes the outputs to commands_ and written_. Undoes changes of these by decisions of other
/// robots, and reports them if `about` is about the first repetition.
void ControllerCheck::repeat(const BodyType& type, const BodyType::Controller& controller,
                             const Watched& watched, const Finding& about, std::vector<Finding>& findings) {
  DecideBatch batch = restore_inputs(watched);
  // A collective controller gets the same batch again, because its result may depend on the whole batch.
  const bool is_collective = controller.kind->is_collective;
  std::vector<Row> backwards = watched.taken.rows;
  if (!is_collective) std::ranges::sort(backwards, std::ranges::greater{});
  const std::span<const Row> rows = backwards;
  const bool is_first = about.repeat == Finding::Repeat::again;
  const std::size_t most = is_collective ? rows.size() : is_first ? 1 : k_rows_per_batch;
  kept_written_ = written_;
  const auto undo_changes_by_others = [&](Row row) {
    const auto undo = [&](std::string_view what, const std::vector<StateField>& fields, std::byte* output,
                          const std::byte* kept, std::size_t bytes) {
      if (std::memcmp(output, kept, bytes) == 0) return;
      Finding finding{.controller = about.controller, .repeat = Finding::Repeat::other};
      finding.body = world_.view().body(row);
      const auto report = [&](const StateField& field, std::size_t column, const StateValue& a,
                              const StateValue& b) {
        finding.field = fmt::format("{} {}", what, field_text(field, column));
        finding.first = a;
        finding.second = b;
        add(finding, findings);
      };
      if (is_first) compare_rows(fields, kept, output, report);
      std::memcpy(output, kept, bytes);
    };
    for_outputs(type, watched, row, undo);
  };
  const auto keep = [&](Row row) {
    for_outputs(type, watched, row,
                [](std::string_view, const std::vector<StateField>&, const std::byte* output, std::byte* kept,
                   std::size_t bytes) { std::memcpy(kept, output, bytes); });
  };
  std::ranges::for_each(rows, keep);
  for (std::size_t first = 0; first < rows.size(); first += most) {
    batch.rows = rows.subspan(first, std::min(most, rows.size() - first));
    std::ranges::for_each(batch.rows, undo_changes_by_others);
    if (first % k_rows_per_batch == 0) spoil_stack();
    call_kind(world_.view(), batch.rows, controller,
              [&] { controller.kind->decide(controller.data, batch); });
    std::ranges::for_each(batch.rows, keep);
  }
  // Tests first whether there are changes at all: in a world with many types, a loop over all rows for each
  // type would take long.
  const std::size_t bytes = commands_.size() * sizeof(Command);
  if (std::memcmp(commands_.data(), kept_commands_.data(), bytes) == 0 && written_ == kept_written_) return;
  for (std::size_t r = 0; r < world_.view().rows(); ++r) undo_changes_by_others(Row(r));
}

void ControllerCheck::compare(const Watched& watched, const Finding& about,
                              std::vector<Finding>& findings) const {
  const Decisions& taken = watched.taken;
  Finding finding = about;
  for (std::size_t i = 0; i < taken.rows.size(); ++i) {
    const std::size_t row = taken.rows[i].index();
    finding.body = world_.view().body(taken.rows[i]);
    const auto report = [&](std::string_view of) {
      return [&finding, &findings, of](const StateField& field, std::size_t column, const StateValue& a,
                                       const StateValue& b) {
        finding.field = fmt::format("{} {}", of, field_text(field, column));
        finding.first = a;
        finding.second = b;
        add(finding, findings);
      };
    };
    for (std::size_t w = 0; w < watched.written.size(); ++w) {
      const Written& written = watched.written[w];
      compare_rows(written.fields, taken.written_after[w].data() + i * written.row_bytes,
                   written_[w].data() + taken.given.slots[row] * written.row_bytes, report(written.what));
    }
    compare_rows(command_fields_, reinterpret_cast<const std::byte*>(&taken.commands_after[i]),
                 reinterpret_cast<const std::byte*>(&commands_[row]), report("command"));
  }
}

}  // namespace troupe::engine

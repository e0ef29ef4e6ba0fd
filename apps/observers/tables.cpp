#include "apps/observers/tables.hpp"

#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "base/split.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

// Keys under which checkpoints contain the starts of tables.
constexpr const char* k_measures = "measures";  // key of Measures::memory()
constexpr const char* k_measures_start = "table of measures";
constexpr const char* k_events_start = "table of events";
constexpr const char* k_measures_interval = "interval of measures";  // key of the interval, ticks

/// The first line of a table of events: the names of its columns.
constexpr std::string_view k_events_header = "tick,time_s,event,robot,id,x_m,y_m,heading_rad,other,other_id";

std::string header_of(const Measures& measures) {
  std::string header = "tick,time_s";
  for (const std::string& column : measures.columns()) {
    header += ',';
    header += csv_cell(column);
  }
  return header;
}

/// Whether the table `file` is continued: the run was resumed from a checkpoint, and the file exists.
bool goes_on(const fs::path& file, const Simulation& simulation) {
  std::error_code ignored;
  return simulation.resumed_at_tick() && fs::is_regular_file(file, ignored);
}

/// Returns the value that the checkpoint contains under the key `name`, or nothing.
template <class Value>
std::optional<Value> saved(const Simulation& simulation, const std::string& name) {
  const auto memory = simulation.saved_memory(name);
  Value value{};
  if (!memory || memory->size() != sizeof value) return std::nullopt;
  std::memcpy(&value, memory->data(), sizeof value);
  return value;
}

/// Returns the bytes of a value, in the form that the callback of Simulation::on_save() returns.
template <class Value>
std::vector<std::byte> memory_of(const Value& value) {
  std::vector<std::byte> memory(sizeof value);
  std::memcpy(memory.data(), &value, sizeof value);
  return memory;
}

/// Makes each checkpoint store, under the key `name`, which lines of a table a resumed run keeps
/// (CsvFile::Start): the lines before the tick T + `keep_before`, where T is the tick of the checkpoint.
void save_start(Simulation& simulation, const std::string& name, const CsvFile& csv,
                std::uint64_t keep_before) {
  simulation.on_save(name, [&simulation, &csv, keep_before] {
    return memory_of(csv.before(simulation.tick() + keep_before));
  });
}

/// Returns the first line of a table of measures; empty if the file is no such table.
std::string columns_of_table(const fs::path& file) {
  std::string line;
  std::getline(std::ifstream(file), line);
  return line.starts_with(k_measures_mark) ? line : "";
}

/// Throws OutputError if `file` is a table of other measures than `measures`.
void check_columns(const fs::path& file, const Measures& measures) {
  const std::string columns = columns_of_table(file);
  const std::string header = header_of(measures);
  if (columns.empty() || columns == header.substr(0, header.find('\n')))
    return;  // names may contain line ends
  throw OutputError(fmt::format(
      "{}: error: this table cannot be continued: its first line is \"{}\", but the measures of this "
      "run have the columns \"{}\": repeat the --measure options of the run that wrote the table, or "
      "give --measures a new file",
      file.string(), columns, header));
}

/// Restores the data that the measures keep from earlier ticks from the checkpoint from which the run was
/// resumed. Returns the columns that need such data, but for which the checkpoint has none. Throws
/// OutputError, which names the table `file`, if the table is continued but has other measures.
std::vector<std::string> restore(const fs::path& file, const Simulation& simulation, Measures& measures) {
  if (!simulation.resumed_at_tick()) return {};
  if (goes_on(file, simulation)) check_columns(file, measures);
  const auto saved_measures = simulation.saved_memory(k_measures);
  std::vector<std::size_t> missing =
      measures.remember(saved_measures ? *saved_measures : std::vector<std::byte>());
  if (!saved_measures)
    std::erase_if(missing, [&](std::size_t column) { return !measures.has_memory(column); });
  if (!missing.empty() && goes_on(file, simulation))
    throw OutputError(fmt::format(
        "{}: error: this table cannot be continued: when the checkpoint was saved, \"{}\" was not "
        "computed, or with other robots, parameters or bounds: repeat the --measure options of the run that "
        "wrote the table, or give --measures a new file",
        file.string(), measures.columns()[missing.front()]));
  std::vector<std::string> fresh;
  for (const std::size_t column : missing)
    if (measures.has_memory(column)) fresh.push_back(measures.columns()[column]);
  return fresh;
}

}  // namespace

MeasuresTable::MeasuresTable(const fs::path& file, Simulation& simulation, Measures measures,
                             std::uint64_t every)
    : simulation_(simulation),
      file_(file),
      measures_(std::move(measures)),
      fresh_(restore(file, simulation, measures_)),
      every_(every),
      csv_(goes_on(file, simulation)
               ? CsvFile(file, header_of(measures_), saved<CsvFile::Start>(simulation, k_measures_start))
               : CsvFile(file, header_of(measures_))) {
  simulation_.on_save(k_measures, [this] { return measures_.memory(); });
  save_start(simulation_, k_measures_start, csv_, 0);  // the line of its tick is written again
  simulation_.on_save(k_measures_interval, [this] { return memory_of(every_); });
}

MeasuresTable::~MeasuresTable() {
  simulation_.on_save(k_measures, nullptr);
  simulation_.on_save(k_measures_start, nullptr);
  simulation_.on_save(k_measures_interval, nullptr);
}

void MeasuresTable::observe(const Simulation& simulation) {
  measures_.see();
  if (simulation.tick() % every_ != 0) return;
  csv_.add(simulation.tick()).add(time_cell(simulation.time_s()));
  for (const double value : measures_.values()) csv_.add(value);
  csv_.end_line();
  csv_.flush(simulation.tick());
}

std::string MeasuresTable::warning() const {
  if (fresh_.empty()) return {};
  return fmt::format(
      "{}: warning: the checkpoint has no data of earlier ticks for \"{}\", which was not computed before, "
      "or with other robots, parameters or bounds: the measure{} at tick {}",
      file_.string(), joined(fresh_, "\", \""), fresh_.size() == 1 ? " begins" : "s begin",
      *simulation_.resumed_at_tick());
}

EventsTable::EventsTable(const fs::path& file, Simulation& simulation)
    : simulation_(simulation),
      watch_(simulation.world()),
      csv_(goes_on(file, simulation)
               ? CsvFile(file, k_events_header, saved<CsvFile::Start>(simulation, k_events_start))
               : CsvFile(file, k_events_header)) {
  save_start(simulation_, k_events_start, csv_, 1);
}

EventsTable::~EventsTable() { simulation_.on_save(k_events_start, nullptr); }

void EventsTable::observe(const Simulation& simulation) {
  const engine::World& world = simulation.world();
  for (const engine::Event& event : watch_.see(world)) {
    const Pose pose = world.view().pose(event.body);
    csv_.add(world.tick()).add(time_cell(world.view().time_s())).add(engine::event_name(event.type));
    csv_.add(world.spec().name(event.body)).add(std::uint64_t{event.body.value});
    csv_.add(pose.x).add(pose.y).add(pose.heading);
    if (event.other.valid())
      csv_.add(world.spec().name(event.other)).add(std::uint64_t{event.other.value});
    else
      csv_.add(std::string_view()).add(std::string_view());
    csv_.end_line();
  }
  csv_.flush(world.tick());
}

namespace {

class MeasuresOutput : public FileOutput<MeasuresOutput> {
 public:
  void add_options(CLI::App& app, RunOptions&) override {
    CLI::Option* measures =
        add_value(app, "--measures", "FILE.csv",
                  "Write a table of measures, by default with one line per simulated second",
                  [this](const std::string& text) { file_ = file_name("--measures", text); });
    add_values(
        app, "--measure", "NAME[:OF],...",
        "Measures (OF: type, population); repeatable; default: world's, or all that need no parameters",
        [this](const std::string& text) { add_names(text); }, measures);
    add_value(
        app, "--measure-every", "S",
        "Interval of measures in simulated seconds; 0: every tick (default: the world's, else 1)",
        [this](const std::string& text) { every_s_ = seconds_from_zero("--measure-every", text); }, measures);
  }
  OpenOutput prepare(const RunOptions&, Simulation& simulation, std::uint64_t) const override {
    if (file_.empty()) return nullptr;
    check_lines_file(
        file_, simulation,
        {.name = "a table of measures (--measures)", .mark = k_measures_mark, .other = k_events_mark});
    return opening(std::make_unique<MeasuresTable>(file_, simulation, Measures(simulation, names_),
                                                   interval(simulation)));
  }

 private:
  /// Returns the interval of the lines, ticks: the value of --measure-every, or else the interval of the
  /// table that is continued, or else the interval in the world file.
  std::uint64_t interval(const Simulation& simulation) const {
    if (!every_s_ && goes_on(file_, simulation))
      if (const auto every = saved<std::uint64_t>(simulation, k_measures_interval)) return *every;
    return engine::period_ticks(every_s_.value_or(simulation.world().spec().measure_every_s),
                                simulation.tick_s());
  }
  /// Adds the measures that a value of --measure names: `stalls,displacement:leaders`, or one JSON object as
  /// in the list `measures` of a world file.
  void add_names(const std::string& text) {
    if (text.starts_with('{')) {
      names_.push_back(text);
      return;
    }
    for (std::string& name :
         names_in("--measure", text,
                  "a list of measures, as in --measure coverage,stalls; `troupe describe` lists them"))
      names_.push_back(std::move(name));
  }

  std::vector<std::string> names_;  // in the syntax of Measures; empty: those of the world
  std::optional<double> every_s_;   // --measure-every, see interval()
};

class EventsOutput : public FileOutput<EventsOutput> {
 public:
  void add_options(CLI::App& app, RunOptions&) override {
    add_value(app, "--events", "FILE.csv",
              "Write a table of events, one per line (a robot is blocked or would leave the bounds, ...)",
              [this](const std::string& text) { file_ = file_name("--events", text); });
  }
  OpenOutput prepare(const RunOptions&, Simulation& simulation, std::uint64_t) const override {
    if (file_.empty()) return nullptr;
    check_lines_file(file_, simulation, {.name = "a table of events (--events)", .mark = k_events_mark});
    return opening(std::make_unique<EventsTable>(file_, simulation));
  }
};

}  // namespace

std::unique_ptr<RunOutput> measures_output() { return std::make_unique<MeasuresOutput>(); }
std::unique_ptr<RunOutput> events_output() { return std::make_unique<EventsOutput>(); }

}  // namespace troupe::apps

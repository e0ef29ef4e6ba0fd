#include "apps/observers/profile.hpp"

#include "apps/memory.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "base/number_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <utility>

namespace troupe::apps {
namespace {

// Groups of tracks. The Trace Event Format calls them processes.
constexpr int k_this_process = 1;
constexpr int k_ranks = 2;
constexpr std::size_t k_tick_track = 0;  // the track of ticks; the tracks of worker threads follow it

double microseconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double, std::micro>(d).count();
}

}  // namespace

Profile::Profile(const std::filesystem::path& file, const Simulation& simulation, const ProfileLimits& limits)
    : file_(file),
      limits_(limits),
      tasks_left_(limits.most_tasks),
      ticks_left_(limits.most_ticks),
      start_tick_(simulation.tick()),
      tick_(start_tick_),
      threads_(simulation.threads()) {
  lock_ = open_output(stream_, file, std::nullopt);
  about_.emplace_back("version", version_line());
  std::ranges::copy(simulation.effective_options(), std::back_inserter(about_));
  stream_ << k_profile_mark;
  end_ = stream_.tellp();
  tracks_.own();  // makes the calling thread the first worker
  const auto name_group = [&](int group, std::string_view name) {
    add(fmt::format(R"({{"name":"process_name","ph":"M","pid":{},"args":{{"name":"{}"}}}})", group, name));
  };
  name_group(k_this_process, "troupe");
  add_name(k_this_process, k_tick_track, "ticks");
  const unsigned ranks = simulation.ranks();
  if (ranks > 1) name_group(k_ranks, "ranks");
  for (unsigned rank = 0; ranks > 1 && rank < ranks; ++rank)
    add_name(k_ranks, rank, fmt::format("rank {}", rank));
  flush();
}

void Profile::phase(std::optional<Phase> phase) {
  const auto now = Clock::now();
  if (phase == Phase::intervene) {
    ++tick_;
    recording_ = tick_ >= limits_.first_tick && tick_ <= limits_.last_tick && ticks_left_ > 0;
  }
  if (current_) phases_[static_cast<std::size_t>(*current_)].end = now;
  if (phase) phases_[static_cast<std::size_t>(*phase)] = {now, now};
  current_ = phase;
}

void Profile::task(std::size_t index, bool begins) {
  // Needs no lock, because recording_ and current_ are written only between loops. Loops outside phases, such
  // as those of hashes, do not belong to the tick.
  if (!recording_ || !current_) return;
  Track& track = tracks_.own();
  if (begins)
    track.begin = Clock::now();
  else
    track.tasks.push_back({{track.begin, Clock::now()}, index, *current_});
}

void Profile::observe(const Simulation& simulation) {
  if (tick_ == start_tick_) return;
  if (!recording_) {
    const bool wanted = tick_ >= limits_.first_tick && tick_ <= limits_.last_tick;
    if (wanted && std::exchange(ended_, true) == false) {
      left_out_ += fmt::format("{}everything from tick {} on", left_out_.empty() ? "" : "; ", tick_);
      flush();
    }
    return;
  }
  recording_ = false;
  --ticks_left_;

  const Span whole{phases_.front().begin, phases_.back().end};
  add_span("tick", whole, k_this_process, k_tick_track, fmt::format("\"tick\":{}", tick_));
  for (std::size_t i = 0; i < k_phases; ++i)
    add_span(std::string(phase_name(static_cast<Phase>(i))), phases_[i], k_this_process, k_tick_track,
             fmt::format("\"tick\":{}{}", tick_, load(static_cast<Phase>(i))));
  write_tasks(simulation.rank_work());
  add_counter("resident bytes", whole.end, resident_bytes());
  // statistics() of distributed robots would fetch the robots of all ranks.
  if (!simulation.rank_statistics().is_distributed) {
    const Statistics statistics = simulation.statistics();
    add_counter("state bytes", whole.end, statistics.state_bytes);
    add_counter("robots", whole.end, statistics.robots);
    add_counter("stalled", whole.end, statistics.stalled);
  }
  flush();
}

std::string Profile::load(Phase phase) const {
  double most = 0;
  double sum = 0;
  unsigned workers = 0;
  for (const Track& track : tracks_.all()) {
    double busy = 0;
    for (const Task& task : track.tasks)
      if (task.phase == phase) busy += microseconds(task.span.end - task.span.begin);
    most = std::max(most, busy);
    sum += busy;
    workers += busy > 0;
  }
  if (!(sum > 0)) return {};
  // The thread pool may replace a thread by another one within a phase, so more than `threads_` threads may
  // have run tasks.
  workers = std::max(workers, threads_);
  return fmt::format(",\"imbalance\":{:.3f},\"busy_us\":{:.1f}", most * workers / sum, sum);
}

void Profile::write_rank(std::size_t rank, const RankWork& work) {
  Clock::time_point begin = phases_[static_cast<std::size_t>(Phase::sense)].begin;
  for (const auto& [phase, seconds] :
       {std::pair{Phase::sense, work.sense_s}, std::pair{Phase::actuate, work.actuate_s},
        std::pair{Phase::decide, work.decide_s}}) {
    const auto end =
        begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    add_span(std::string(phase_name(phase)), {begin, end}, k_ranks, rank,
             fmt::format("\"tick\":{},\"rows\":{}", tick_, work.rows));
    begin = end;
  }
}

void Profile::write_tasks(std::span<const RankWork> ranks) {
  std::size_t count = 3 * ranks.size();
  for (const Track& track : tracks_.all()) count += track.tasks.size();
  const bool shown = count <= tasks_left_;
  if (shown)
    tasks_left_ -= count;
  else if (left_out_.empty())
    left_out_ = fmt::format("tasks from tick {} on", tick_);
  for (std::size_t t = 0; t < tracks_.all().size(); ++t) {
    Track& track = tracks_.all()[t];
    if (!std::exchange(track.named, true)) add_name(k_this_process, t + 1, fmt::format("worker {}", t + 1));
    for (const Task& task : track.tasks)
      if (shown)
        add_span(std::string(phase_name(task.phase)), task.span, k_this_process, t + 1,
                 fmt::format("\"task\":{}", task.index));
    track.tasks.clear();
  }
  for (std::size_t rank = 0; shown && rank < ranks.size(); ++rank) write_rank(rank, ranks[rank]);
}

void Profile::add_name(int group, std::size_t track, const std::string& name) {
  add(fmt::format(R"({{"name":"thread_name","ph":"M","pid":{},"tid":{},"args":{{"name":"{}"}}}})", group,
                  track, name));
}

void Profile::add(const std::string& event) {
  if (!std::exchange(first_event_, false)) pending_ += ",\n";
  pending_ += event;
}

void Profile::add_span(const std::string& name, const Span& span, int group, std::size_t track,
                       const std::string& arguments) {
  add(fmt::format(R"({{"name":"{}","ph":"X","ts":{:.3f},"dur":{:.3f},"pid":{},"tid":{},"args":{{{}}}}})",
                  name, microseconds(span.begin - start_), microseconds(span.end - span.begin), group, track,
                  arguments));
}

void Profile::add_counter(const std::string& name, Clock::time_point at, std::uint64_t value) {
  add(fmt::format(R"({{"name":"{}","ph":"C","ts":{:.3f},"pid":1,"args":{{"{}":{}}}}})", name,
                  microseconds(at - start_), name, value));
}

void Profile::flush() {
  stream_.seekp(end_);
  stream_ << pending_;
  end_ = stream_.tellp();
  pending_.clear();
  nlohmann::ordered_json about;
  for (const auto& [key, value] : about_) about[key] = value;
  if (!left_out_.empty()) about["left_out"] = left_out_;
  stream_ << "\n],\"otherData\":" << about.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
          << "}\n"
          << std::flush;
  if (!stream_)
    throw std::runtime_error(
        fmt::format("{}: error: writing failed at tick {}: {}", file_.string(), tick_, std::strerror(errno)));
}

std::string Profile::warning() const {
  if (tick_ > start_tick_ && (limits_.first_tick > tick_ || limits_.last_tick <= start_tick_))
    return fmt::format(
        "{}: warning: the profile has no tick: --profile-ticks selects the ticks {} to {}, but the run had "
        "the ticks {} to {}",
        file_.string(), limits_.first_tick, limits_.last_tick, start_tick_ + 1, tick_);
  if (left_out_.empty()) return {};
  return fmt::format(
      "{}: warning: to keep the file small, the profile omits: {} (--profile-ticks selects the ticks to "
      "profile)",
      file_.string(), left_out_);
}

namespace {

class ProfileOutput : public FileOutput<ProfileOutput> {
 public:
  void add_options(CLI::App& app, RunOptions&) override {
    CLI::Option* profile =
        add_value(app, "--profile", "FILE.json", "Write a timing profile for a browser's trace viewer",
                  [this](const std::string& text) {
                    file_ = text;
                    if (file_.extension() != ".json" || text.starts_with('-'))
                      refuse("--profile", text, "the name of a JSON file, as in --profile trace.json");
                  });
    add_value(
        app, "--profile-ticks", "A:B", "Profile only ticks A to B (default: all, up to a size limit)",
        [this](const std::string& text) { set_ticks(text); }, profile);
  }
  OpenOutput prepare(const RunOptions&, Simulation& simulation, std::uint64_t) const override {
    if (file_.empty()) return nullptr;
    check_unlocked(file_);
    check_replaced(file_, {.name = "a profile (--profile)", .mark = k_profile_mark});
    return [this, &simulation](Observers& observers) {
      observers.push_back(std::make_unique<Profile>(file_, simulation, limits_));
    };
  }

 private:
  void set_ticks(const std::string& text) {
    const auto colon = text.find(':');
    const auto first = number_of<std::uint64_t>(text.substr(0, colon));
    const auto last = colon == text.npos ? std::nullopt : number_of<std::uint64_t>(text.substr(colon + 1));
    if (!first || !last || *first < 1 || *first > *last)
      refuse("--profile-ticks", text,
             "a first and a last tick, counted from 1, as in --profile-ticks 100:120");
    limits_.first_tick = *first;
    limits_.last_tick = *last;
  }

  ProfileLimits limits_;
};

}  // namespace

std::unique_ptr<RunOutput> profile_output() { return std::make_unique<ProfileOutput>(); }

}  // namespace troupe::apps

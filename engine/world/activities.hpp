#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string_view>

namespace troupe::engine {

/// What a World is doing.
enum class Activity : std::uint8_t {
  none,                ///< nothing: it is between two steps
  step,                ///< step() computes a tick
  callback,            ///< the callback of before_tick() runs
  apply,               ///< the hook `apply` of a kind without DeviceKind::carries runs
  measure,             ///< measures are computed
  failed,              ///< none, and the state is incomplete, because work that changes it threw an exception
  failed_in_callback,  ///< callback, and the state is incomplete
};
inline constexpr std::size_t k_activities = 7;  ///< number of values of Activity

/// How a function of World uses the state. Together with the activity, it decides whether the function may be
/// called.
enum class Access : std::uint8_t {
  read,     ///< reads the state as a whole
  examine,  ///< as read, but not while a tick is computed
  change,   ///< changes the state between two steps
  replace,  ///< replaces the state by a complete one
  step,     ///< computes a tick
  listen,   ///< replaces a callback that step() calls
  prepare,  ///< replaces the callback of before_tick()
  touch,    ///< changes data that hooks of kinds may change, too
  carry,    ///< attaches bodies to one another, or detaches them
};
inline constexpr std::size_t k_accesses = 9;  ///< number of values of Access

/// The present activity of a World, and the rule which of its functions may be called when. An activity can
/// begin within another, which continues afterwards: a step within none, callback, apply and measure within
/// a step, and measure also within none and callback.
class Activities {
 public:
  /// tick: WorldState::now.tick of the world, for error texts; must outlive the object
  explicit Activities(const std::uint64_t& tick) : tick_(tick) {}
  Activities(const Activities&) = delete;
  Activities& operator=(const Activities&) = delete;

  /// Throws std::logic_error if the present activity does not allow the access. call: name of the calling
  /// function, for the error text.
  void require(Access access, std::string_view call) const {
    if (const Refusal why = k_refusals[static_cast<std::size_t>(access)][static_cast<std::size_t>(now_)];
        why != Refusal::none)
      refuse(why, call);
  }
  /// The state is complete, because it was replaced.
  void complete() {
    if (now_ == Activity::failed) now_ = Activity::none;
    if (now_ == Activity::failed_in_callback) now_ = Activity::callback;
  }

  /// An activity that lasts as long as the object.
  class During {
   public:
    /// Begins the activity. The arguments must outlive the object.
    During(Activities& activities, Activity activity)
        : activities_(activities), before_(activities.enter(activity)) {}
    ~During() { activities_.leave(before_); }
    During(const During&) = delete;
    During& operator=(const During&) = delete;

   private:
    Activities& activities_;
    Activity before_;
  };

  /// Exists while work changes the state: the state is incomplete if the work throws an exception. It is
  /// complete when the work begins. If a callback in the work catches an exception of inner work, such as a
  /// birth, the state stays incomplete.
  class Change {
   public:
    /// Called before the work begins.
    explicit Change(Activities& activities) : activities_(activities) { activities.complete(); }
    ~Change() {
      if (std::uncaught_exceptions() > before_) activities_.fail();
    }
    Change(const Change&) = delete;
    Change& operator=(const Change&) = delete;

   private:
    Activities& activities_;
    int before_ = std::uncaught_exceptions();
  };

 private:
  enum class Refusal : std::uint8_t { none, incomplete, in_step, in_callback, in_measure, in_apply };
  [[noreturn]] void refuse(Refusal why, std::string_view call) const;
  // Not inline: at -O1 and above, gcc 12 removes the store in leave() from the path of an exception.
  [[gnu::noinline]] Activity enter(Activity activity);  // returns the activity before
  [[gnu::noinline]] void leave(Activity before);
  [[gnu::noinline]] void fail();

  static constexpr std::array<std::array<Refusal, k_activities>, k_accesses> k_refusals = [] {
    using enum Refusal;
    return std::array<std::array<Refusal, k_activities>, k_accesses>{{
        // none, step, callback, apply, measure, failed, failed_in_callback
        {none, none, none, none, none, incomplete, incomplete},                     // read
        {none, in_step, none, in_step, none, incomplete, incomplete},               // examine
        {none, in_step, none, in_step, in_measure, incomplete, incomplete},         // change
        {none, in_step, none, in_step, in_measure, none, none},                     // replace
        {none, in_step, in_callback, in_step, in_measure, incomplete, incomplete},  // step
        {none, in_step, none, in_step, none, none, none},                           // listen
        {none, in_step, in_callback, in_step, none, none, in_callback},             // prepare
        {none, none, none, none, in_measure, none, none},                           // touch
        {none, none, none, in_apply, none, none, none},                             // carry
    }};
  }();

  const std::uint64_t& tick_;
  Activity now_ = Activity::none;
};

}  // namespace troupe::engine

// SPDX-License-Identifier: GPL-3.0-or-later
// User-defined guides at run time: every call of their functions.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/guiding_space.hpp>
#include <dsl/language/words/instance_value.hpp>
#include <dsl/language/words/known_value.hpp>
#include <dsl/language/words/scene_values.hpp>
#include <trellis/base/lua_time.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/goal_choice.hpp>
#include <trellis/guide/lifted.hpp>
#include <trellis/guide/pieces.hpp>
#include <trellis/guide/reached_nodes.hpp>

namespace trellis::dsl {

namespace {

using lua::Located;
using lua::Reference;
using lua::Stack;
using lua::Type;
using lua::Value;

/// Pushes the solution in S; nil if there was no search.
void push_found(Stack& stack, const Solution* found) {
  if (found == nullptr) {
    stack.push_nil();
    return;
  }
  const Value table = stack.push_table();
  stack.push(found->solved());
  stack.set_field(table, "solved");
  stack.push(to_string(found->status));
  stack.set_field(table, "status");
  const Value path = stack.push_table();
  for (std::size_t i = 0; i < found->path.size(); ++i) {
    push_numbers(stack, found->path[i]);
    stack.append(path);
  }
  stack.set_field(table, "path");
}

/// The functions of one guide in one run, as C++ functions.
class Calls {
 public:
  Calls(std::shared_ptr<RunInterpreter> run, std::shared_ptr<const GuideDefinition> definition,
        std::shared_ptr<CalledSlots> called, const GuideSite& site)
      : run_(std::move(run)),
        definition_(std::move(definition)),
        called_(std::move(called)),
        place_(site.place),
        math_(site.seed, site.key, "math.random"),
        drawn_from_(std::make_shared<RandomSource>(math_)) {
    drawn_from_->now = nullptr;
    protect([&](Stack& stack) {
      stack.push_function(random_function(drawn_from_, "random"));
      random_ = std::make_unique<Reference>(stack, stack.top());
      stack.push_function(normal_function(drawn_from_));
      normal_ = std::make_unique<Reference>(stack, stack.top());
    });
  }

  [[nodiscard]] const GuideDefinition& definition() const { return *definition_; }
  [[nodiscard]] bool has(Slot slot) const { return (*definition_)[slot] != nullptr; }

  /// Calls a function: `push` pushes its arguments and returns their number, `read` reads its results. Errors name
  /// `which()`.
  template <class Which, class Push, class Read>
  void call(Slot slot, const Reference& function, const Which& which, const Push& push, const Read& read) const {
    auto& called = called_->flags[static_cast<std::size_t>(slot)];
    if (!called.load(std::memory_order_relaxed)) called = true;
    try {
      protect([&](Stack& stack) {
        function.push(stack);
        stack.call(push(stack));
        read(stack);
      });
    } catch (const Error& error) {
      throw PlacedError(fmt::format("{}: {}: {}", place_, which(), error.what()));
    }
  }

  /// Calls a function with coordinates, and with random and normal if it draws.
  template <class Read>
  void ask(Slot slot, View coordinates, Stream* stream, const Read& read) const {
    const Restore restore{drawn_from_->now, std::exchange(drawn_from_->now, stream)};
    const auto which = [&] { return fmt::format("{} at {}", slot_name(slot), coordinates_of(coordinates)); };
    const auto push = [&](Stack& stack) {
      for (const double x : coordinates) stack.push(x);
      return static_cast<int>(coordinates.size()) + (stream != nullptr ? push_random(stack) : 0);
    };
    call(slot, *(*definition_)[slot], which, push, read);
  }

  /// What a function that draws returned besides a configuration of C.
  struct Expansion {
    std::uint32_t node = no_node;  ///< to extend; no_node: the nearest one
    Configuration control;         ///< empty: the planner chooses it
    std::uint32_t steps = 0;       ///< duration of the control, in steps of the motion model
  };
  /// Draws with a function that 'heuristic' returned.
  /// \param model  of C; nullptr: its motions are straight
  /// \param number  index of the sample, for messages
  Expansion draw(const Reference& function, const Space& c, const MotionModel* model, std::uint64_t number,
                 Stream& stream, MutableView out) const {
    const Restore restore{drawn_from_->now, std::exchange(drawn_from_->now, &stream)};
    Expansion expansion;
    call(
        Slot::heuristic, function, [&] { return fmt::format("its sample {}", number); },
        [&](Stack& stack) { return push_random(stack); },
        [&](Stack& stack) {
          constexpr auto what = "what the function that draws returns";
          const auto coordinates = static_cast<int>(c.dimension());
          if (stack.size() == 1 && stack[1].type() == Type::table && !stack[1].keys().names.empty()) {
            expansion = read_expansion(stack[1], c, model, out);
          } else {
            const bool names = stack.size() == coordinates + 1;
            if (names) expansion.node = node_number(stack[stack.size()], "after the coordinates it returned");
            read_coordinates(stack, 1, names ? coordinates : stack.size(), c, out, what);
          }
          place(c, out, what);
        });
    return expansion;
  }

  [[nodiscard]] double density(const Reference& function, View q, bool drawn = false) const {
    double value = 0.0;
    call(
        Slot::density, function,
        [&] { return fmt::format("density at {}{}", coordinates_of(q), drawn ? ", where it drew a sample" : ""); },
        [&](Stack& stack) {
          for (const double x : q) stack.push(x);
          return static_cast<int>(q.size());
        },
        [&](Stack& stack) {
          const auto number = stack.size() > 0 ? stack[1].number() : std::nullopt;
          if (!number || !std::isfinite(*number) || *number < 0.0 || (drawn && *number == 0.0)) {
            throw Located(fmt::format("it returned {}, expected a finite number {}",
                                      stack.size() > 0 ? stack[1].describe() : "nothing",
                                      drawn ? "greater than 0: h has a density wherever it draws" : "of at least 0"));
          }
          value = *number;
        });
    return value;
  }

  /// Normalises a script's coordinates in a space; throws Error where that is not possible.
  static void place(const Space& space, MutableView q, const char* what) {
    try {
      bring_into(space, q, what);
    } catch (const Error& error) {
      throw Located(error.what());
    }
  }

  /// Runs `body` in the interpreter, with math.random on the guide's own stream.
  template <class Body>
  void protect(const Body& body) const {
    std::unique_lock<std::recursive_mutex> lock;
    if (run_->shared) lock = std::unique_lock(*run_->shared);
    const LuaTimer timer;
    RandomSource& random = *run_->book->random;
    const Restore restore{random.now, std::exchange(random.now, &math_)};
    try {
      // A function object of this size needs no heap memory.
      run_->state->run([&body](Stack& stack) { body(stack); }, run_->book->each);
    } catch (...) {
      run_->failed = true;
      throw;
    }
  }

 private:
  struct Restore {
    Stream*& now;
    Stream* before;
    Restore(Stream*& at, Stream* was) : now(at), before(was) {}
    Restore(const Restore&) = delete;
    Restore& operator=(const Restore&) = delete;
    ~Restore() { now = before; }
  };

  /// Reads { to = ..., node = ..., control = ..., duration = ... }.
  static Expansion read_expansion(const Value& table, const Space& c, const MotionModel* model, MutableView out) {
    static const std::vector<std::string> fields = {"to", "node", "control", "duration"};
    for (const std::string& name : table.keys().names) {
      if (std::find(fields.begin(), fields.end(), name) != fields.end()) continue;
      throw Located(fmt::format("it returned a table with the field '{}'{}; there are: {}", name,
                                did_you_mean(name, fields), fmt::join(fields, ", ")));
    }
    Expansion expansion;
    try {
      const Value to = table.field("to");
      if (!to.given()) throw Error("the table that it returned needs 'to', the configuration to extend towards");
      const Configuration q = read_configuration(to, c, "'to'");
      std::copy(q.begin(), q.end(), out.begin());
      expansion.node = node_number(table.field("node"), "'node' is");
      const Value control = table.field("control");
      const Value duration = table.field("duration");
      if (!control.given() && !duration.given()) return expansion;
      if (model == nullptr) throw Error("'control' needs a motion model: motions of this problem are straight");
      if (!control.given() || !duration.given()) throw Error("'control' and 'duration' belong together");
      expansion.control = read_control(control, *model, "'control'");
      expansion.steps = read_duration(duration, *model, "'duration'");
    } catch (const Located&) {
      throw;
    } catch (const Error& error) {
      throw Located(error.what());
    }
    return expansion;
  }

  /// The node that a script names by its number; no_node for nil.
  static std::uint32_t node_number(const Value& value, const char* what) {
    if (!value.given()) return no_node;
    const auto number = value.number();
    if (!number || *number != std::floor(*number) || *number < 0.0 || *number >= static_cast<double>(no_node)) {
      throw Located(
          fmt::format("{} {}, expected the number of a node, as outcomes have it, or nil", what, value.describe()));
    }
    return static_cast<std::uint32_t>(*number);
  }

  int push_random(Stack& stack) const {
    random_->push(stack);
    normal_->push(stack);
    return 2;
  }

  std::shared_ptr<RunInterpreter> run_;
  std::shared_ptr<const GuideDefinition> definition_;
  std::shared_ptr<CalledSlots> called_;
  std::string place_;
  mutable Stream math_;
  std::shared_ptr<RandomSource> drawn_from_;
  std::unique_ptr<Reference> random_;
  std::unique_ptr<Reference> normal_;
};

// f
// ----------------------------------------------------------------------------------------------------------------

/// f and its fibres, one or both defined by a script.
class ScriptProjection final : public Projection {
 public:
  ScriptProjection(std::shared_ptr<const Calls> calls, Space c, Space s)
      : calls_(std::move(calls)), c_(std::move(c)), s_(std::move(s)) {
    if (!calls_->has(Slot::project)) axes_.emplace(c_, s_);
  }

  void project(View q, MutableView s) const override {
    if (axes_) {
      axes_->project(q, s);
      return;
    }
    calls_->ask(Slot::project, q, nullptr, [&](Stack& stack) {
      read_coordinates(stack, 1, stack.size(), s_, s, "what it returns");
      s_.normalise(s);
    });
  }
  void lift(View s, Stream& stream, MutableView q) const override {
    calls_->ask(Slot::lift, s, &stream, [&](Stack& stack) {
      read_coordinates(stack, 1, stack.size(), c_, q, "what it returns");
      Calls::place(c_, q, "what it returns");
    });
  }
  [[nodiscard]] bool closed_form() const override { return false; }
  [[nodiscard]] double log_fibre_density(View) const override { return std::numeric_limits<double>::quiet_NaN(); }

 private:
  std::shared_ptr<const Calls> calls_;
  Space c_;
  Space s_;
  std::optional<AxisProjection> axes_;
};

/// \throws Error where project(lift(s)) is not s.
void check_fibres(const Projection& projection, const Space& c, const Space& s, Stream stream) {
  constexpr int samples = 20;
  constexpr double tolerance = 1e-6;  // of the space's diameter
  Configuration from(s.dimension());
  Configuration back(s.dimension());
  Configuration q(c.dimension());
  for (int i = 0; i < samples; ++i) {
    s.sample_uniform(stream, from);
    projection.lift(from, stream, q);
    projection.project(q, back);
    if (s.distance(from, back) <= tolerance * s.diameter()) continue;
    throw Error(fmt::format("project(lift(s)) must be s, but lift at {} gave {}, and project of that {}",
                            coordinates_of(from), coordinates_of(q), coordinates_of(back)));
  }
}

// Validity
// ----------------------------------------------------------------------------------------------------------------

/// Every configuration is valid, at no cost.
class AllValid final : public Validity {
 public:
  [[nodiscard]] bool state(View) override { return true; }
  [[nodiscard]] MotionReport motion(View, View) override { return {true, 0, std::numeric_limits<double>::quiet_NaN()}; }
  [[nodiscard]] double clearance(View) override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool spends_checks() const override { return false; }
};

/// Validity by a script's function.
class ScriptValidity final : public Validity {
 public:
  ScriptValidity(std::shared_ptr<const Calls> calls, Space space, double resolution)
      : calls_(std::move(calls)), space_(std::move(space)), resolution_(resolution), q_(space_.dimension()) {}

  [[nodiscard]] const CheckCost& cost() const override {
    static constexpr CheckCost of_a_call{.on_motion = 7.0, .alone = 7.0, .distance = 7.0};
    return of_a_call;
  }
  [[nodiscard]] bool state(View q) override {
    announce_checks(1);
    bool valid = false;
    calls_->ask(Slot::valid, q, nullptr, [&](Stack& stack) {
      const auto answer = stack.size() > 0 ? stack[1].boolean() : std::nullopt;
      if (!answer) {
        throw Located(
            fmt::format("it returned {}, expected true or false", stack.size() > 0 ? stack[1].describe() : "nothing"));
      }
      valid = *answer;
    });
    return valid;
  }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    const auto n = static_cast<std::uint32_t>(std::max(1.0, std::ceil(space_.distance(a, b) / resolution_)));
    if (n != order_of_) {
      order_ = bisection_order(n);
      order_of_ = n;
    }
    MotionReport report{true, 0, std::numeric_limits<double>::quiet_NaN()};
    for (const std::uint32_t i : order_) {
      const double t = static_cast<double>(i) / n;
      space_.interpolate(a, b, t, q_);
      ++report.checks;
      if (!state(q_)) return {false, report.checks, t};
    }
    return report;
  }
  [[nodiscard]] double clearance(View) override {
    throw Error("validity is a function of the script, which has no clearance");
  }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View) override {
    throw Error("validity is a function of the script, which has no obstacles");
  }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  /// Records that later results may differ.
  void changed() { ++epoch_; }

 private:
  std::shared_ptr<const Calls> calls_;
  Space space_;
  double resolution_;
  Configuration q_;  // scratch
  std::uint32_t order_of_ = 0;
  std::vector<std::uint32_t> order_;
  std::uint64_t epoch_ = 0;
};

// h
// ----------------------------------------------------------------------------------------------------------------

/// The result of 'heuristic' or 'observe': a composition of distributions, or functions.
struct Returned {
  std::optional<GuideSpec> pieces;
  std::shared_ptr<const Reference> sample;
  std::shared_ptr<const Reference> density;
};

/// A density that a script's function computes.
class FunctionDensity final : public Density {
 public:
  FunctionDensity(std::shared_ptr<const Calls> calls, std::shared_ptr<const Reference> function)
      : calls_(std::move(calls)), function_(std::move(function)) {}
  [[nodiscard]] double at(View q) const override { return calls_->density(*function_, q); }
  [[nodiscard]] double at_sample(View q) const { return calls_->density(*function_, q, true); }

 private:
  std::shared_ptr<const Calls> calls_;
  std::shared_ptr<const Reference> function_;
};

/// A heuristic h that samples with a script's function.
class FunctionHeuristic final : public Heuristic {
 public:
  FunctionHeuristic(const std::shared_ptr<const Calls>& calls, const Instance& c, const Returned& returned)
      : calls_(calls), c_(c.space), model_(c.motion_model), function_(returned.sample) {
    if (returned.density) density_ = std::make_shared<const FunctionDensity>(calls, returned.density);
  }

  Source sample(Stream& stream, MutableView out) override {
    constexpr std::uint64_t checked_samples = 8;  // number of samples at which to check the density
    expansion_ = calls_->draw(*function_, c_, model_.get(), ++drawn_, stream, out);
    if (density_ && drawn_ <= checked_samples) static_cast<void>(density_->at_sample(out));
    return 0;
  }
  [[nodiscard]] std::uint32_t vertex() const override { return expansion_.node; }
  std::uint32_t draw_control(Stream&, const ControlQuery& query, MutableView control) override {
    std::copy(expansion_.control.begin(), expansion_.control.end(), control.begin());
    return std::min(expansion_.steps, query.longest);
  }
  void record(DensityRecord& record, double share) const override {
    if (density_) {
      record.add(density_, share);
    } else {
      record.add_unknown(share);
    }
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {calls_->definition().name}; }

 private:
  std::shared_ptr<const Calls> calls_;
  Space c_;
  std::shared_ptr<const MotionModel> model_;  ///< nullptr: motions of C are straight
  std::shared_ptr<const Reference> function_;
  std::shared_ptr<const FunctionDensity> density_;
  Calls::Expansion expansion_;  ///< towards the last sample
  std::uint64_t drawn_ = 0;
};

/// The table argument of 'observe'.
class OutcomeTable {
 public:
  /// \param model  of C; nullptr: its motions are straight
  explicit OutcomeTable(const MotionModel* model) : dt_(model != nullptr ? model->dt() : 0.0) {}
  void push(Stack& stack, const Outcome& outcome, bool mine) {
    if (!table_) make(stack);
    table_->push(stack);
    const Value table = stack.top();
    stack.push(fate_name(outcome.fate));
    stack.set_field(table, "fate");
    stack.push(mine);
    stack.set_field(table, "mine");
    const auto push_row = [&](std::uint32_t row, const char* name) {
      if (row == no_node) {
        stack.push_nil();
      } else {
        stack.push(static_cast<double>(row));
      }
      stack.set_field(table, name);
    };
    push_row(outcome.added_row, "number");
    push_row(outcome.near_row, "near_number");
    if (outcome.control.empty()) {
      stack.push_nil();
    } else {
      stack.push(dt_ * static_cast<double>(outcome.steps));
    }
    stack.set_field(table, "duration");
    const std::array<View, 5> views = {outcome.proposal, outcome.near, outcome.added, outcome.blocked_at,
                                       outcome.control};
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (views[i].empty()) {
        stack.push_nil();
      } else {
        lists_[i]->push(stack);
        const Value list = stack.top();
        for (std::size_t k = 0; k < views[i].size(); ++k) stack.set_index(list, k + 1, views[i][k]);
      }
      stack.set_field(table, names[i]);
    }
  }

 private:
  static constexpr std::array<const char*, 5> names = {"proposal", "near", "added", "blocked_at", "control"};

  void make(Stack& stack) {
    const int before = stack.size();
    table_ = std::make_unique<Reference>(stack, stack.push_table());
    for (auto& list : lists_) list = std::make_unique<Reference>(stack, stack.push_table());
    stack.resize(before);
  }

  std::unique_ptr<Reference> table_;
  std::array<std::unique_ptr<Reference>, 5> lists_;
  double dt_;
};

class ScriptGuide;

/// h of a user-defined guide: the most recent result of the script, which receives the outcomes.
class ScriptHeuristic final : public Wrapping<Heuristic, Heuristic> {
 public:
  ScriptHeuristic(ScriptGuide& guide, std::shared_ptr<const Calls> calls, std::unique_ptr<Heuristic> h,
                  const MotionModel* model)
      : Wrapping(std::move(h)), guide_(guide), calls_(std::move(calls)), table_(model) {}

  Source sample(Stream& stream, MutableView out) override {
    part()->sample(stream, out);
    return 0;
  }
  [[nodiscard]] double progress() const override { return progress_ + Wrapping::progress(); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_ + Wrapping::epoch(); }
  void record(DensityRecord& record, double share) const override { part()->record(record, share); }
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {calls_->definition().name}; }
  [[nodiscard]] bool stale() const override;
  [[nodiscard]] Configurations lifted_path() const override { return part()->lifted_path(); }

 private:
  ScriptGuide& guide_;
  std::shared_ptr<const Calls> calls_;
  OutcomeTable table_;
  std::uint64_t epoch_ = 0;
  std::uint64_t reported_ = 0;  ///< number of reported outcomes
  double progress_ = 0.0;       ///< progress of earlier results
};

/// A distribution of the registry, with its guide.
class OwnedHeuristic final : public Wrapping<Heuristic, Heuristic> {
 public:
  OwnedHeuristic(std::unique_ptr<Guide> guide, Instance& instance)
      : Wrapping(guide->heuristic(instance, nullptr, nullptr)), guide_(std::move(guide)) {}
  ~OwnedHeuristic() override { replace(nullptr); }  // h may refer to its guide
  OwnedHeuristic(const OwnedHeuristic&) = delete;
  OwnedHeuristic& operator=(const OwnedHeuristic&) = delete;
  Source sample(Stream& stream, MutableView out) override { return part()->sample(stream, out); }
  void record(DensityRecord& record, double share) const override { part()->record(record, share); }
  void observe(const Outcome& outcome, bool mine) override {
    guide_->learn(outcome);
    Wrapping::observe(outcome, mine);
  }
  void restart() override {
    guide_->restart();
    Wrapping::restart();
  }
  [[nodiscard]] bool stale() const override { return part()->stale(); }
  [[nodiscard]] Configurations lifted_path() const override { return part()->lifted_path(); }

 private:
  std::unique_ptr<Guide> guide_;
};

class ScriptGuide final : public Guide, public Repairs {
 public:
  ScriptGuide(std::shared_ptr<const Calls> calls, const GuideSite& site)
      : calls_(std::move(calls)), checking_(site.seed, site.key, "check lift") {}

  std::unique_ptr<Instance> project(const Instance& parent) override;
  [[nodiscard]] bool uses_known() const override { return calls_->definition().uses_known(); }
  std::unique_ptr<Instance> project_from(const Instance& parent, const Known& known) override;
  Repairs& repairs() override { return *this; }
  void attach(Instance& sub) override { sub_ = &sub; }
  void project(View q, MutableView s) const override { projection_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { projection_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View q) const override { return projection_->log_fibre_density(q); }
  [[nodiscard]] bool closed_fibre() const override { return projection_->closed_form(); }
  [[nodiscard]] std::shared_ptr<const Projection> shared_projection() const override { return projection_; }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override;
  void learn(const Outcome& outcome) override;
  void restart() override;
  void before_resolve() override {
    if (validity_) validity_->changed();
  }
  [[nodiscard]] Configurations refuted_places() const override { return refuted_; }
  /// Records where an outcome refuted h, for guides that make S of what is known.
  void refute(View place) {
    if (uses_known()) refuted_.push(place);
  }

  /// Converts the values on the stack, from 1 on, to h.
  Returned read_returned(Stack& stack) const;
  std::unique_ptr<Heuristic> make(const Returned& returned);

 private:
  /// Calls a function with an instance, and with what is known if it takes that, and one result; or returns a constant.
  template <class Read>
  void with_value(Slot slot, Instance& parent, const Read& read) const;
  void make_space(Instance& parent);
  void make_validity(Instance& parent, Instance& sub);
  void make_graph(Instance& parent, Instance& sub) const;
  /// Adds all nodes learnt so far, projected to S.
  void begin_in_s();
  void add_in_s(View q);
  /// \param in_s  whether it is a distribution over S
  std::unique_ptr<Heuristic> compose(const GuideSpec& spec, bool in_s);
  std::unique_ptr<Heuristic> component(const GuideSpec& spec, bool in_s);

  std::shared_ptr<const Calls> calls_;
  Stream checking_;
  std::shared_ptr<const Projection> projection_;
  std::optional<Space> s_;
  bool identity_ = false;  ///< S has the axes of C, and f is the identity
  std::shared_ptr<ScriptValidity> validity_;
  std::shared_ptr<KnownAccess> known_ = std::make_shared<KnownAccess>();  ///< while f is applied to what is known
  Configurations refuted_{0};                                             ///< places of C where outcomes refuted h
  Instance* parent_ = nullptr;
  Space c_;
  Configuration c_start_;  ///< empty before f is applied
  Instance* sub_ = nullptr;
  std::shared_ptr<InstanceAccess> asked_ = std::make_shared<InstanceAccess>();  ///< by the argument of 'heuristic'
  InstanceAccess::Scope over_{*asked_};
  std::optional<ReachedIndex> reached_;       ///< the nodes of the planner in C
  Configurations learnt_{0};                  ///< the nodes of C, if there is an S
  std::optional<ReachedIndex> reached_in_s_;  ///< the same in S
  bool follows_in_s_ = false;                 ///< reached_in_s_ is up to date
};

void ScriptHeuristic::observe(const Outcome& outcome, bool mine) {
  const bool was_stale = part()->stale();
  Wrapping::observe(outcome, mine);
  if (!was_stale && !outcome.blocked_at.empty() && part()->stale()) guide_.refute(outcome.blocked_at);
  if (!calls_->has(Slot::observe)) return;
  ++reported_;
  std::optional<Returned> returned;
  calls_->call(
      Slot::observe, *calls_->definition()[Slot::observe],
      [&] { return fmt::format("observe, outcome {}", reported_); },
      [&](Stack& stack) {
        const int count = calls_->definition().arguments(Slot::observe, 1);
        if (count > 0) table_.push(stack, outcome, mine);
        return count;
      },
      [&](Stack& stack) {
        if (stack.size() > 0 && stack[1].given()) returned = guide_.read_returned(stack);
      });
  if (!returned) return;
  epoch_ = epoch() + 1;
  progress_ += part()->progress();
  replace(guide_.make(*returned));
}

bool ScriptHeuristic::stale() const {
  if (part()->stale()) return true;
  if (!calls_->has(Slot::stale)) return false;
  bool stale = false;
  calls_->ask(Slot::stale, {}, nullptr, [&](Stack& stack) {
    const auto answer = stack.size() > 0 ? stack[1].boolean() : std::nullopt;
    if (!answer) {
      throw Located(
          fmt::format("it returned {}, expected true or false", stack.size() > 0 ? stack[1].describe() : "nothing"));
    }
    stale = *answer;
  });
  return stale;
}

template <class Read>
void ScriptGuide::with_value(Slot slot, Instance& parent, const Read& read) const {
  const Reference& value = *calls_->definition()[slot];
  if (!calls_->definition().calls(slot)) {
    calls_->protect([&](Stack& stack) {
      value.push(stack);
      read(stack[1]);
    });
    return;
  }
  const auto asked = std::make_shared<InstanceAccess>(InstanceAccess{&parent});
  const InstanceAccess::Scope over(*asked);
  calls_->call(
      slot, value, [&] { return std::string(slot_name(slot)); },
      [&](Stack& stack) {
        if (calls_->definition().arguments(slot, 1) == 0) return 0;
        push_instance(stack, parent, asked);
        if (!calls_->definition().known[static_cast<std::size_t>(slot)]) return 1;
        push_known(stack, known_);
        return 2;
      },
      [&](Stack& stack) {
        if (stack.size() == 0) throw Located("it returned nothing");
        read(stack[1]);
      });
}

void ScriptGuide::make_space(Instance& parent) {
  s_ = parent.space;
  if (calls_->has(Slot::space)) {
    with_value(Slot::space, parent, [&](Value value) { s_ = read_space(value, parent.space, "space"); });
  }
  if (!calls_->has(Slot::project)) {
    const auto axes = std::make_shared<const AxisProjection>(parent.space, *s_);
    identity_ = axes->identity() && !calls_->has(Slot::lift);
    projection_ = axes;
  }
  if (calls_->has(Slot::lift)) {
    projection_ = std::make_shared<const ScriptProjection>(calls_, parent.space, *s_);
    // f of a configuration remains the same where f is applied to what is known.
    if (!uses_known() || sub_ == nullptr) check_fibres(*projection_, parent.space, *s_, checking_);
  }
}

void ScriptGuide::make_validity(Instance& parent, Instance& sub) {
  const GuideDefinition& definition = calls_->definition();
  const bool same_axes = s_->dimension() == parent.space.dimension() && !calls_->has(Slot::project);
  const bool checked = calls_->has(Slot::robot) || calls_->has(Slot::world);
  sub.scene = same_axes ? parent.scene : parent.scene->of_point();
  if (definition.calls(Slot::valid)) {
    validity_ = std::make_shared<ScriptValidity>(calls_, *s_, parent.resolution);
    sub.validity = validity_;
    return;
  }
  if (definition.validity == "parent") {
    if (!same_axes)
      throw Error("valid = \"parent\": S has other axes than C, so what is valid in C says nothing of it");
    sub.validity = parent.validity;
    return;
  }
  if (definition.validity == "free" || (!checked && calls_->has(Slot::graph))) {
    sub.validity = std::make_shared<AllValid>();
    return;
  }
  if (!checked && !same_axes) {
    throw Error("S has other axes than C, so 'robot', 'world' or 'valid' must say what is valid in it");
  }
  AnyWorld world = world_of(*parent.scene);
  AnyRobot robot = robot_of(*parent.scene);
  if (calls_->has(Slot::robot)) {
    with_value(Slot::robot, parent, [&](Value value) {
      const auto given = robot_in(value);
      if (!given) throw Located(fmt::format("it must be a robot, got {}", describe(value)));
      robot = *given;
    });
  }
  if (calls_->has(Slot::world)) {
    with_value(Slot::world, parent, [&](Value value) {
      const auto given = world_in(value);
      if (!given) throw Located(fmt::format("it must be a world, got {}", describe(value)));
      world = *given;
    });
  }
  sub.scene = make_scene(std::move(world), std::move(robot));
  if (!sub.validity_of && sub.scene->robot_dimension() > s_->dimension()) {
    throw Error(fmt::format("its robot needs {} coordinates, and S has {} ({})", sub.scene->robot_dimension(),
                            s_->dimension(), axis_names(*s_)));
  }
  // Checks collisions, even if the parent presumes validity.
  sub.validity = sub.validity_in(sub.scene);
}

void ScriptGuide::make_graph(Instance& parent, Instance& sub) const {
  auto graph = std::make_shared<Graph>();
  with_value(Slot::graph, parent, [&](Value value) {
    if (value.type() != Type::table) {
      throw Located(
          fmt::format("it must be {{ vertices = ..., edges = ..., start = i, goal = j }}, got {}", describe(value)));
    }
    const auto list = [&](const char* name) {
      const Value entry = value.field(name);
      if (entry.type() != Type::table) {
        throw Located(fmt::format("its field '{}' must be a list, got {}", name, describe(entry)));
      }
      return entry;
    };
    graph->vertices = Configurations(s_->dimension());
    list("vertices").each([&](std::size_t i, Value vertex) {
      const std::string what = fmt::format("vertex {}", i);
      Configuration q = read_configuration(vertex, *s_, what);
      Calls::place(*s_, q, what.c_str());
      graph->vertices.push(q);
    });
    const auto vertex_of = [&](Value number, const std::string& what) {
      const auto i = number.integer();
      if (!i || *i < 1 || static_cast<std::size_t>(*i) > graph->vertices.size()) {
        throw Located(fmt::format("{} must be the number of a vertex, from 1 to {}, got {}", what,
                                  graph->vertices.size(), describe(number)));
      }
      return static_cast<std::uint32_t>(*i - 1);
    };
    list("edges").each([&](std::size_t i, Value edge) {
      const std::string what = fmt::format("edge {}", i);
      if (edge.type() != Type::table) throw Located(fmt::format("{} must be {{i, j}} or {{i, j, cost}}", what));
      Graph::Edge made;
      std::size_t entries = 0;
      edge.each([&](std::size_t k, Value entry) {
        entries = k;
        if (k == 1) made.from = vertex_of(entry, what + ": its first end");
        if (k == 2) made.to = vertex_of(entry, what + ": its second end");
        if (k == 3) made.cost = entry.number().value_or(-1.0);
      });
      if (entries < 2 || entries > 3) throw Located(fmt::format("{} must be {{i, j}} or {{i, j, cost}}", what));
      const View a = std::as_const(graph->vertices)[made.from];
      const View b = std::as_const(graph->vertices)[made.to];
      if (entries == 2) made.cost = s_->distance(a, b);
      if (!(made.cost >= 0.0) || !std::isfinite(made.cost)) {
        throw Located(fmt::format("{}: its cost must be a finite number of at least 0", what));
      }
      made.points = Configurations(s_->dimension());
      made.points.push(a);
      made.points.push(b);
      graph->edges.push_back(std::move(made));
    });
    graph->start = vertex_of(value.field("start"), "'start'");
    const Value goal = value.field("goal");
    if (goal.type() == Type::table) {
      goal.each([&](std::size_t i, Value entry) {
        graph->goals.push_back(vertex_of(entry, fmt::format("entry {} of 'goal'", i)));
      });
      if (graph->goals.empty()) throw Located("its field 'goal' is an empty list; give the number of a vertex");
    } else {
      graph->goals = {vertex_of(goal, "'goal'")};
    }
  });
  sub.graph = std::move(graph);
}

std::unique_ptr<Instance> ScriptGuide::project(const Instance& parent) {
  // From here on the guide learns nodes, as built-in guides do.
  if (c_start_.empty()) {
    c_ = parent.space;
    c_start_ = parent.start;
    reached_.emplace(c_, c_start_);
    learnt_ = Configurations(c_.dimension());
    refuted_ = Configurations(c_.dimension());
  }
  if (calls_->definition().spaceless) return nullptr;
  // Checks by the functions count in the level that they create.
  Instance c = parent;
  c.checks = {};
  make_space(c);
  auto sub = std::make_unique<Instance>();
  sub->space = *s_;
  sub->goal_tolerance = parent.goal_tolerance;
  sub->resolution = parent.resolution;
  sub->collision = parent.collision;
  // Another space than C has no states to propagate, and another pose of the robot.
  if (identity_) {
    sub->motion_model = parent.motion_model;
    sub->validity_of = parent.validity_of;
  }
  make_validity(c, *sub);
  if (calls_->has(Slot::graph)) make_graph(c, *sub);
  project_ends(*projection_, parent, *sub);
  for (const auto& [s, what] : {std::pair{sub->start, "f of the start"}, {sub->goal(), "f of the goal"}}) {
    if (s_->contains(s)) continue;
    throw Error(fmt::format("{}, {}, is outside of S, which is {} with {}", what, coordinates_of(s), s_->name(),
                            axis_names(*s_)));
  }
  if (const auto axes = std::dynamic_pointer_cast<const AxisProjection>(projection_)) {
    for (const std::size_t position : parent.position_axes) {
      const auto found = std::find(axes->kept().begin(), axes->kept().end(), position);
      if (found != axes->kept().end()) {
        sub->position_axes.push_back(static_cast<std::size_t>(found - axes->kept().begin()));
      }
    }
    if (sub->position_axes.size() != parent.position_axes.size()) sub->position_axes.clear();
  } else if (calls_->has(Slot::robot) && sub->scene->translates()) {
    sub->position_axes = {0, 1};
  }
  sub->checks = c.checks;
  sub_ = sub.get();
  begin_in_s();
  return sub;
}

std::unique_ptr<Instance> ScriptGuide::project_from(const Instance& parent, const Known& known) {
  const KnownAccess::Scope scope(*known_);
  known_->known = &known;
  return project(parent);
}

void ScriptGuide::begin_in_s() {
  reached_in_s_.emplace(*s_, sub_->start);
  if (!follows_in_s_) return;
  for (std::size_t i = 0; i < learnt_.size(); ++i) add_in_s(std::as_const(learnt_)[i]);
}

void ScriptGuide::add_in_s(View q) {
  Configuration s(s_->dimension());
  projection_->project(q, s);
  reached_in_s_->add(s);
}

void ScriptGuide::learn(const Outcome& outcome) {
  if (outcome.added.empty() || !outcome.connected) return;
  reached_->add(outcome.added);
  if (!projection_) return;
  learnt_.push(outcome.added);
  if (follows_in_s_) add_in_s(outcome.added);
}

void ScriptGuide::restart() {
  if (reached_) reached_->clear();
  learnt_.clear();
  // Before the first h there was no progress to record.
  if (parent_ == nullptr) return;
  if (sub_ != nullptr) begin_in_s();
  if (!calls_->has(Slot::restart)) return;
  calls_->call(
      Slot::restart, *calls_->definition()[Slot::restart], [] { return std::string("restart"); },
      [](Stack&) { return 0; }, [](Stack&) {});
}

Returned ScriptGuide::read_returned(Stack& stack) const {
  Returned returned;
  const int count = stack.size();
  const auto fail = [](const std::string& got) -> void {
    throw Located(
        fmt::format("it returned {}, expected a distribution such as along(found.path), or a function that "
                    "draws, with its density or without",
                    got));
  };
  if (count == 0) fail("nothing");
  if (const auto* spec = stack[1].get<GuideSpec>()) {
    returned.pieces = *spec;
    if (count > 1 && stack[2].given()) fail("a distribution and " + describe(stack[2]));
    return returned;
  }
  if (stack[1].type() != Type::function) fail(describe(stack[1]));
  returned.sample = std::make_shared<const Reference>(stack, stack[1]);
  if (count > 1 && stack[2].given()) {
    if (stack[2].type() != Type::function) fail("a function and " + describe(stack[2]));
    returned.density = std::make_shared<const Reference>(stack, stack[2]);
  } else if (calls_->has(Slot::density)) {
    calls_->definition()[Slot::density]->push(stack);
    returned.density = std::make_shared<const Reference>(stack, stack.top());
  }
  return returned;
}

std::unique_ptr<Heuristic> ScriptGuide::make(const Returned& returned) {
  if (!returned.pieces) return std::make_unique<FunctionHeuristic>(calls_, *parent_, returned);
  return compose(*returned.pieces, false);
}

std::unique_ptr<Heuristic> ScriptGuide::compose(const GuideSpec& spec, bool in_s) {
  switch (spec.kind()) {
    case GuideSpec::Kind::component: return component(spec, in_s);
    case GuideSpec::Kind::mixture: {
      std::vector<SumHeuristic::Part> parts;
      parts.reserve(spec.terms().size());
      for (const auto& term : spec.terms()) parts.push_back({term.weight, compose(term.guide, in_s)});
      return std::make_unique<SumHeuristic>(calls_->definition().name, std::move(parts));
    }
    default:
      throw Error(fmt::format("h is a sum of distributions; '{}' has feedback of its own and cannot be a part of it",
                              spec.text()));
  }
}

std::unique_ptr<Heuristic> ScriptGuide::component(const GuideSpec& spec, bool in_s) {
  Instance& over = in_s ? *sub_ : *parent_;
  if (spec.searches()) {
    throw Error(
        fmt::format("h is a distribution; '{}' has a space of its own to search: compose it with this guide, by "
                    ">>, + or ..",
                    spec.text()));
  }
  if (!spec.custom()) {
    const GuideKind& kind = *find_guide(spec.name());
    return std::make_unique<OwnedHeuristic>(kind.make(spec.options()), over);
  }
  if (const auto* piece = dynamic_cast<const Piece*>(spec.custom().get())) {
    if (!in_s) return piece->over(over, *reached_);
    if (!std::exchange(follows_in_s_, true)) begin_in_s();
    return piece->over(over, *reached_in_s_);
  }
  const auto* lift = dynamic_cast<const Lifted*>(spec.custom().get());
  if (lift == nullptr) {
    throw Error(
        fmt::format("h is a distribution; '{}' is a guide of the script's own: compose it with this one, by + "
                    "or ..",
                    spec.text()));
  }
  if (in_s) throw Error("lifted within lifted: it is over S already");
  if (!projection_) throw Error("lifted: S = {0}, so there is nothing to lift from");
  auto inner = compose(lift->distribution(), true);
  const Configuration goal = GoalChoice().choose(
      *parent_, [this](View q, MutableView s) { project(q, s); }, *s_, inner->lifted_path());
  return std::make_unique<LiftedHeuristic>(projection_, *s_, std::move(inner), parent_->start, goal,
                                           LiftedHeuristic::Points::unknown, calls_->definition().name);
}

std::unique_ptr<Heuristic> ScriptGuide::heuristic(Instance& parent, const Instance*, const Solution* found) {
  if (parent_ == nullptr) {
    parent_ = &parent;
    asked_->instance = &parent;
  }
  Returned returned;
  if (calls_->has(Slot::heuristic)) {
    calls_->call(
        Slot::heuristic, *calls_->definition()[Slot::heuristic], [] { return std::string("heuristic"); },
        [&](Stack& stack) {
          const int count = calls_->definition().arguments(Slot::heuristic, 2);
          if (count > 0) push_found(stack, found);
          if (count > 1) push_instance(stack, parent, asked_);
          return count;
        },
        [&](Stack& stack) { returned = read_returned(stack); });
  } else {
    const Options plain = Options::validate(along_settings().component(), {});
    GuideSpec path = GuideSpec::make(along(found->path, plain));
    returned.pieces = identity_ ? path : GuideSpec::make(std::make_shared<Lifted>(path));
  }
  return std::make_unique<ScriptHeuristic>(*this, calls_, make(returned), parent.motion_model.get());
}

}  // namespace

std::unique_ptr<Guide> make_script_guide(std::shared_ptr<RunInterpreter> run,
                                         std::shared_ptr<const GuideDefinition> definition,
                                         std::shared_ptr<CalledSlots> called, const GuideSite& site) {
  return std::make_unique<ScriptGuide>(
      std::make_shared<const Calls>(std::move(run), std::move(definition), std::move(called), site), site);
}

}  // namespace trellis::dsl

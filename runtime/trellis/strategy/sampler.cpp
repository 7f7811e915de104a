// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/sampler.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <string>
#include <unordered_map>
#include <utility>

#include <trellis/motion/motion_model.hpp>
#include <trellis/planner/common.hpp>
#include <trellis/planner/step.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/level.hpp>
#include <trellis/strategy/scale.hpp>

namespace trellis {

namespace {

/// Stands for a planner that is elsewhere: the search has the roots, and proposals for the tree that was asked for.
class Elsewhere final : public Planner {
 public:
  explicit Elsewhere(PlannerContext context) : Planner(std::move(context)) {}

  std::optional<Status> begin(const Budget& budget) override {
    static_cast<void>(budget);
    return std::nullopt;
  }
  Outcome extend(View proposal) override {
    static_cast<void>(proposal);
    throw Fault("a sampler extends nothing");
  }
  [[nodiscard]] Solution solution(Status status) override { return {status, path_of_start(context_.instance)}; }
};

PlannerSpec planner_of(const SamplerOptions& options) {
  using Entry = Options::Entry;
  std::vector<Entry> given = {
      {"uniform", options.uniform}, {"goal_bias", options.goal_bias}, {"bound", 0.0}, {"proposals", 1e9}};
  const bool tree = options.step > 0.0;
  if (tree) given.emplace_back("step", options.step);
  return PlannerSpec::make(tree ? "rrt" : "prm", given);
}

void check_option(bool right, const char* name, double value, const char* range) {
  if (!right) throw Error(fmt::format("sampler: '{}' is {}, not {}", name, value, range));
}

}  // namespace

class Sampler::Asked {
 public:
  Asked(const GuideSpec& guide, Problem problem, std::uint64_t seed, const SamplerOptions& options)
      : problem_(std::move(problem)), guide_(guide), options_(options), strategy_(planner_of(checked(options)), guide) {
    if (problem_.motion_model) {
      throw Error(
          fmt::format("sampler: problem '{}' has the motion model {}; a sampler draws for planners that join "
                      "configurations by straight motions: drop the model, or plan by kinodynamic_rrt",
                      problem_.name, problem_.motion_model->name()));
    }
    check(problem_);
    check_depth(strategy_);
    check_scale(strategy_, problem_);
    execute_.interrupted = options_.interrupted;
    run_.ledger.begin(execute_);
    run_.cpu_begin = thread_seconds();
    run_.problem = problem_.name;
    run_.seed = seed;
    run_.seeded = true;
    level_ = std::make_unique<Level>(run_, nullptr, "0", "root", root_instance(strategy_, problem_),
                                     strategy_.planner(), nullptr);
    const auto dimension = space().dimension();
    proposal_.resize(dimension);
    near_.resize(dimension);
    added_.resize(dimension);
  }

  [[nodiscard]] const Space& space() const { return level_->instance().space; }

  Draw draw(MutableView out, Side side) {
    check_size(out.size(), "the draw");
    const Timed timed(*this);
    search_ahead();
    const View drawn = level_->draw({.proposal = true, .tree = tree(side)});
    std::copy(drawn.begin(), drawn.end(), proposal_.begin());
    std::copy(drawn.begin(), drawn.end(), out.begin());
    side_ = side;
    pending_ = true;
    Draw draw{++id_, LevelHeuristic::is_guided(search().proposal_sources.back()), number(h().vertex())};
    if (options_.optimistic) {
      Outcome outcome;
      outcome.fate = Fate::reached;
      outcome.proposal = outcome.added = proposal_;
      outcome.from_goal = side == Side::goal;
      answer(outcome, id_);
    }
    return draw;
  }

  Configurations draw_many(std::size_t n, Side side) {
    if (!options_.optimistic) {
      throw Error(
          "sampler: draw_many gives draws before their answers: set 'optimistic', by which each counts as "
          "accepted, or call draw");
    }
    Configurations rows(space().dimension());
    rows.reserve(n);
    Configuration q(space().dimension());
    for (std::size_t i = 0; i < n; ++i) {
      draw(q, side);
      rows.push(q);
    }
    return rows;
  }

  std::uint32_t root(Side side, std::size_t goal) {
    begin();
    if (side == Side::start) return 0;
    const auto& goals = level_->instance().goals;
    if (goal >= goals.size()) throw Error(fmt::format("sampler: there is no goal {} of {}", goal, goals.size()));
    if (goals_ == no_node) {
      bidirectional_ = true;
      goals_ = count();
      for (const Configuration& q : goals) add_root(q);
    }
    return goals_ + static_cast<std::uint32_t>(goal);
  }

  [[nodiscard]] std::uint32_t node(View q) {
    begin();
    check_configuration(q, "the node");
    Configuration normal;
    set(normal, q);
    return number(row_of(normal));
  }
  [[nodiscard]] std::size_t nodes() const { return std::max<std::size_t>(1, count()); }
  [[nodiscard]] Configuration configuration(std::uint32_t node) {
    begin();
    check_node(node);
    const View q = std::as_const(search().nodes)[row(node)];
    return {q.begin(), q.end()};
  }

  std::uint32_t accepted(std::uint64_t id, View q, std::uint32_t parent, bool reached, bool connected, Side side) {
    begin();
    check_answer(id);
    check_configuration(q, "the node");
    if (parent != no_node) check_node(parent);
    if (parent != no_node) {
      const View of = std::as_const(search().nodes)[row(parent)];
      near_.assign(of.begin(), of.end());
    }
    set(added_, q);
    Outcome outcome;
    outcome.fate = reached ? Fate::reached : Fate::advanced;
    outcome.added = added_;
    outcome.proposal = id != 0 ? View(proposal_) : View(added_);
    outcome.added_row = add(added_, parent);
    if (parent != no_node) {
      outcome.near = near_;
      outcome.near_row = row(parent);
    }
    outcome.from_goal = side == Side::goal;
    outcome.connected = connected;
    answer(outcome, id);
    return number(outcome.added_row);
  }

  void rejected(std::uint64_t id, View from, View to, View first_invalid) {
    begin();
    check_answer(id);
    for (const auto& [q, what] : {std::pair(from, "the beginning of a motion"), std::pair(to, "the end of a motion"),
                                  std::pair(first_invalid, "the invalid configuration")}) {
      if (!q.empty()) check_configuration(q, what);
    }
    if (id == 0 && to.empty()) throw Error("sampler: a motion without a draw needs its second end");
    Configuration target;
    Configuration blocked;
    Outcome outcome;
    if (!from.empty()) {
      set(near_, from);
      outcome.near = near_;
      outcome.near_row = row_of(near_);
    }
    if (id == 0) set(target, to);
    outcome.proposal = id != 0 ? View(proposal_) : View(target);
    if (!first_invalid.empty()) {
      set(blocked, first_invalid);
      outcome.blocked_at = blocked;
    }
    outcome.from_goal = id != 0 ? side_ == Side::goal : of_goal(outcome.near_row);
    answer(outcome, id);
  }

  void joined(std::uint32_t node, Side side) {
    begin();
    check_node(node);
    const View q = std::as_const(search().nodes)[row(node)];
    added_.assign(q.begin(), q.end());
    Outcome outcome;
    outcome.fate = Fate::reached;
    outcome.proposal = outcome.added = added_;
    outcome.added_row = row(node);
    outcome.from_goal = side == Side::goal;
    answer(outcome, 0);
  }

  void cleared() {
    begin();
    close();
    h().restart();
    rows_.clear();
    goals_ = no_node;
    first_ = static_cast<std::uint32_t>(search().nodes.size());
    add_start();
  }

  void path_found(double length) {
    if (!(length >= 0.0) || !std::isfinite(length)) throw Error("sampler: the length of a path is not finite");
    begin();
    const auto ready = [length] { return length; };
    h().found(ready);
  }

  [[nodiscard]] bool worth_connecting(View from, View to) {
    begin();
    check_configuration(from, "the beginning of a motion");
    check_configuration(to, "the end of a motion");
    return h().worth_connecting(from, to);
  }
  [[nodiscard]] double edge_factor(View a, View b) {
    begin();
    check_configuration(a, "an end of an edge");
    check_configuration(b, "an end of an edge");
    return h().edge_factor(a, b).value_or(1.0);
  }

  void spent(std::uint64_t checks) {
    Checks& counted = level_->instance().checks;
    counted.validity += checks;
    counted.work += static_cast<double>(checks) * level_->instance().validity->cost().on_motion;
    spent_ += checks;
  }

  bool allow(std::uint64_t checks) {
    const Timed timed(*this);
    level_->ledger().ask_again();
    search(static_cast<double>(checks));
    const Found found = level();
    return found != Found::searching && found != Found::untried;
  }

  [[nodiscard]] Found level() const {
    if (!begun_ || h().guide() == nullptr) return Found::untried;
    const SearchedGuidance* guide = h().guide();
    Found best = guide->searches() ? Found::untried : Found::found;
    for (const Level* below : run_.levels) {
      if (below->record().depth != 1) continue;
      const Found found = found_of(*below);
      // The order of what a guide may draw from.
      constexpr auto rank = [](Found of) {
        switch (of) {
          case Found::found: return 4;
          case Found::searching: return 3;
          case Found::nothing: return 2;
          case Found::impossible: return 1;
          case Found::untried: break;
        }
        return 0;
      };
      if (rank(found) > rank(best)) best = found;
    }
    return best == Found::untried ? Found::searching : best;
  }

  [[nodiscard]] std::uint64_t checks() const {
    std::uint64_t sum = 0;
    for (Level* level : run_.levels) sum += level->instance().checks.validity;
    return sum - spent_;
  }

  [[nodiscard]] std::optional<double> density(View q) {
    check_configuration(q, "the configuration");
    const Timed timed(*this);
    search_ahead();
    DensityRecord next;
    next.served(h());
    if (!next.exact()) return std::nullopt;
    Configuration normal;
    set(normal, q);
    return next.at(normal);
  }

  [[nodiscard]] std::vector<LevelRecord> levels() {
    begin();
    std::vector<LevelRecord> records;
    records.reserve(run_.levels.size());
    for (Level* level : run_.levels) records.push_back(level->record_so_far(true));
    return records;
  }

 private:
  /// Charges the root with the time of its life.
  class Timed {
   public:
    explicit Timed(Asked& asked) : asked_(asked) {
      asked_.begin();
      asked_.run_.clock.switch_to(&asked_.level_->search().seconds);
    }
    ~Timed() { asked_.run_.clock.switch_to(nullptr); }
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;

   private:
    Asked& asked_;
  };

  static const SamplerOptions& checked(const SamplerOptions& options) {
    check_option(std::isfinite(options.step) && options.step >= 0.0, "step", options.step, "a length of at least 0 m");
    check_option(options.uniform >= 0.0 && options.uniform <= 1.0, "uniform", options.uniform, "a share in [0, 1]");
    check_option(options.goal_bias >= 0.0 && options.goal_bias < 1.0, "goal_bias", options.goal_bias,
                 "a share in [0, 1)");
    check_option(options.grant >= 0.0, "grant", options.grant, "at least 0");
    return options;
  }

  [[nodiscard]] LevelHeuristic& h() const { return level_->heuristic(); }
  [[nodiscard]] Search& search() const { return level_->search(); }
  [[nodiscard]] bool is_tree() const { return options_.step > 0.0; }

  /// Sets up the guides, and the search. Where that fails, it fails at each call: levels may be there in part.
  void begin() {
    if (failed_) std::rethrow_exception(failed_);
    if (std::exchange(begun_, true)) return;
    run_.ledger.set_up([this] {
      try {
        level_->guide_by(guide_);
      } catch (...) {
        failed_ = std::current_exception();
        throw;
      }
      return true;
    });
    level_->plan_elsewhere(std::make_unique<Elsewhere>(PlannerContext{
        level_->instance(), h(), Stream(run_.seed, "0", "proposals"), search(), true, nullptr, "sampler"}));
    search().sources = h().sources();
    level_->begin_root();
    run_.clock.switch_to(nullptr);
    h().restart();
    add_start();
  }
  void add_start() { add_root(level_->instance().start); }
  /// A root of a tree is its own parent.
  void add_root(View q) {
    const std::uint32_t at = add(q, no_node);
    if (is_tree()) search().parents.back() = at;
  }
  /// Adds a node, and returns its row.
  std::uint32_t add(View q, std::uint32_t parent) {
    const auto at = static_cast<std::uint32_t>(search().nodes.size());
    search().nodes.push(q);
    search().parents.push_back(parent != no_node ? row(parent) : no_node);
    rows_.emplace(key(q), at);
    return at;
  }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(search().nodes.size()) - first_; }
  [[nodiscard]] std::uint32_t row(std::uint32_t number) const { return first_ + number; }
  [[nodiscard]] std::uint32_t number(std::uint32_t row) const {
    return row == no_node || row < first_ ? no_node : row - first_;
  }
  [[nodiscard]] static std::string key(View q) {
    std::string bytes(q.size() * sizeof(double), '\0');
    std::memcpy(bytes.data(), q.data(), bytes.size());
    return bytes;
  }
  [[nodiscard]] std::uint32_t row_of(View q) const {
    const auto found = rows_.find(key(q));
    return found != rows_.end() ? found->second : no_node;
  }
  /// Whether a node belongs to a tree from a goal.
  [[nodiscard]] bool of_goal(std::uint32_t row) const {
    if (row == no_node || goals_ == no_node || !is_tree()) return false;
    const auto& parents = search().parents;
    while (parents[row] != row) {
      row = parents[row];
      if (row == no_node) return false;
    }
    return number(row) >= goals_;
  }
  /// A planner with one tree selects none.
  [[nodiscard]] std::optional<TreeSide> tree(Side side) {
    if (side == Side::goal) bidirectional_ = true;
    return bidirectional_ ? std::optional(side) : std::nullopt;
  }

  /// The searches below before the next draw.
  void search_ahead() { search(options_.grant > 0.0 ? options_.grant : level_->ledger().grant()); }
  void search(double work) {
    close();
    Ledger& ledger = level_->ledger();
    if (ledger.stop(true) == Status::interrupted) interrupt();
    const bool limited = work < SamplerOptions::unlimited;
    const double before = ledger.limit_work(limited ? ledger.work() + work : Budget::unlimited);
    const auto stop = level_->search_below();
    ledger.limit_work(before);
    if (stop == Status::interrupted) interrupt();
  }
  [[noreturn]] static void interrupt() { throw SamplerInterrupted("the sampler was interrupted"); }

  /// A draw without an answer counts as rejected.
  void close() {
    if (!pending_) return;
    Outcome outcome;
    outcome.proposal = proposal_;
    outcome.from_goal = side_ == Side::goal;
    answer(outcome, id_);
  }
  void answer(const Outcome& outcome, std::uint64_t id) {
    if (id == 0) {
      h().observe(outcome, false);
      return;
    }
    pending_ = false;
    record_outcome(h(), outcome, search());
  }

  void check_answer(std::uint64_t id) const {
    if (id == 0 || (pending_ && id == id_)) return;
    if (id == id_) throw Error(fmt::format("sampler: draw {} has an answer; a further motion has the id 0", id));
    throw Error(fmt::format("sampler: draw {} is not the last one, {}", id, id_));
  }
  void check_node(std::uint32_t number) const {
    if (number >= count()) throw Error(fmt::format("sampler: there is no node {}: {} are known", number, count()));
  }
  void check_size(std::size_t size, const char* what) const {
    if (size == space().dimension()) return;
    throw Error(fmt::format("sampler: {} has {} coordinates; the space has {}", what, size, space().dimension()));
  }
  void check_configuration(View q, const char* what) const {
    check_size(q.size(), what);
    if (std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); })) return;
    throw Error(fmt::format("sampler: {} has a coordinate that is not finite", what));
  }
  /// The configuration with its angles and rotations in the form that the space gives them.
  void set(Configuration& to, View q) const {
    to.assign(q.begin(), q.end());
    space().normalise(to);
  }

  [[nodiscard]] static Found found_of(const Level& level) {
    if (level.found() || level.solution().solved()) return Found::found;
    switch (level.solution().status) {
      case Status::untried: return level.record().search.proposals.empty() ? Found::untried : Found::searching;
      case Status::no_path:
      case Status::invalid_start:
      case Status::invalid_goal: return Found::impossible;
      default: return level.record().solves > 0 ? Found::nothing : Found::searching;
    }
  }

  Problem problem_;
  GuideSpec guide_;
  SamplerOptions options_;
  StrategySpec strategy_;
  ExecuteOptions execute_;
  Run run_;
  std::unique_ptr<Level> level_;
  bool begun_ = false;
  std::exception_ptr failed_;  ///< what set-up threw
  std::uint64_t spent_ = 0;
  std::uint64_t id_ = 0;  ///< of the last draw
  bool pending_ = false;  ///< it has no answer
  Side side_ = Side::start;
  bool bidirectional_ = false;
  Configuration proposal_;
  Configuration near_;
  Configuration added_;
  std::unordered_map<std::string, std::uint32_t> rows_;  ///< of nodes, by the bytes of their coordinates
  std::uint32_t first_ = 0;                              ///< row of node 0
  std::uint32_t goals_ = no_node;                        ///< number of the first goal's node
};

Sampler::Sampler(const GuideSpec& guide, const Problem& problem, std::uint64_t seed, const SamplerOptions& options)
    : asked_(std::make_unique<Asked>(guide, problem, seed, options)) {}
Sampler::Sampler(Sampler&&) noexcept = default;
Sampler& Sampler::operator=(Sampler&&) noexcept = default;
Sampler::~Sampler() = default;

Draw Sampler::draw(MutableView out, Side side) { return asked_->draw(out, side); }
Configurations Sampler::draw_many(std::size_t n, Side side) { return asked_->draw_many(n, side); }
std::uint32_t Sampler::root(Side side, std::size_t goal) { return asked_->root(side, goal); }
std::uint32_t Sampler::node(View q) { return asked_->node(q); }
std::size_t Sampler::nodes() const { return asked_->nodes(); }
Configuration Sampler::configuration(std::uint32_t node) { return asked_->configuration(node); }
std::uint32_t Sampler::accepted(std::uint64_t id, View q, std::uint32_t parent, bool reached, bool connected,
                                Side side) {
  return asked_->accepted(id, q, parent, reached, connected, side);
}
void Sampler::rejected(std::uint64_t id, View from, View to, View first_invalid) {
  asked_->rejected(id, from, to, first_invalid);
}
void Sampler::joined(std::uint32_t node, Side side) { asked_->joined(node, side); }
void Sampler::cleared() { asked_->cleared(); }
void Sampler::path_found(double length) { asked_->path_found(length); }
bool Sampler::worth_connecting(View from, View to) { return asked_->worth_connecting(from, to); }
double Sampler::edge_factor(View a, View b) { return asked_->edge_factor(a, b); }
void Sampler::spent(std::uint64_t checks) { asked_->spent(checks); }
bool Sampler::allow(std::uint64_t checks) { return asked_->allow(checks); }
Found Sampler::level() const { return asked_->level(); }
std::uint64_t Sampler::checks() const { return asked_->checks(); }
std::optional<double> Sampler::density(View q) { return asked_->density(q); }
std::vector<LevelRecord> Sampler::levels() { return asked_->levels(); }
const Space& Sampler::space() const { return asked_->space(); }

}  // namespace trellis

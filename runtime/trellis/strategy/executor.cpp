// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/executor.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <trellis/base/error.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/nearest_valid.hpp>

namespace trellis {

namespace {

/// Charges wall-clock time to the level that is at work: solving a level below stops the clock of the one above.
class Clock {
 public:
  /// Switches to `account`; returns the one before, to switch back to.
  double* switch_to(double* account) {
    const auto now = std::chrono::steady_clock::now();
    if (account_ != nullptr) *account_ += std::chrono::duration<double>(now - since_).count();
    since_ = now;
    return std::exchange(account_, account);
  }

 private:
  double* account_ = nullptr;
  std::chrono::steady_clock::time_point since_;
};

class Level;

/// "script.lua:3: ", "" for what was built through C++.
std::string where(const Origin& origin) {
  return origin.script.empty() ? "" : fmt::format("{}:{}: ", origin.script, origin.line);
}

/// What all levels of one run share.
struct Run {
  std::string problem;  ///< its name
  std::uint64_t seed = 0;
  std::function<bool()> interrupted;
  std::function<void(const LevelRecord&, const Guidance&)> watch;
  Clock clock;
  std::vector<Level*> levels;  ///< in the order of their numbers
  std::vector<Turn> turns;
  Level* at_work = nullptr;
  int first_solves = 0;  ///< levels whose first solve has ended
};

/// A guidance that a level can prepare (solve what is below) before it draws from it, and inform by another's path.
class Prepared : public Guidance {
 public:
  /// Solves the instances below that are needed for the first proposal.
  virtual void prepare() {}
  /// The path in this level's space along which it guides now; empty where it has none.
  [[nodiscard]] virtual Configurations guiding_path() const { return {}; }
  /// A path in this level's space found by other means, for the searches below to go by.
  virtual void inform(const Configurations& path) { static_cast<void>(path); }
};

std::unique_ptr<Prepared> make_guidance(Run& run, Level& level, const GuideSpec& spec);

/// What a level's planner draws from: the goal, uniform, the guide, and a path that another space informed it of.
class LevelGuidance final : public Guidance {
 public:
  LevelGuidance(const Instance& instance, const PlannerCommon& common)
      : instance_(instance), common_(common), uniform_(instance.space), goal_(instance.goal) {}

  void set_guide(std::unique_ptr<Prepared> guide) { guide_ = std::move(guide); }
  [[nodiscard]] Prepared* guide() const { return guide_.get(); }
  void inform(const Configurations& path) {
    ++epoch_;
    if (path.empty()) {
      hint_.reset();
      return;
    }
    hint_.emplace(instance_.space, path, natural_distance(instance_));
  }
  [[nodiscard]] bool guided() const { return guide_ != nullptr || hint_; }

  Source sample(Stream& stream, MutableView out) override {
    double u = stream.uniform();
    drawn_ = Part::goal;
    if (u < common_.goal_bias) return goal_.sample(stream, out);
    if (!guided()) {
      drawn_ = Part::uniform;
      uniform_.sample(stream, out);
      return 1;
    }
    u = (u - common_.goal_bias) / (1.0 - common_.goal_bias);
    if (u < common_.uniform) {
      drawn_ = Part::uniform;
      uniform_.sample(stream, out);
      return 1;
    }
    u = (u - common_.uniform) / (1.0 - common_.uniform);
    if (hint_ && (guide_ == nullptr || u < hint_share)) {
      drawn_ = Part::hint;
      hint_->sample(stream, out);
      return 2;
    }
    drawn_ = Part::guide;
    return static_cast<Source>(3 + guide_->sample(stream, out));
  }

  [[nodiscard]] double density(View q) const override {
    const Shares share = shares();
    double sum = share.uniform * uniform_.density(q);
    if (share.hint > 0.0) sum += share.hint * hint_->density(q);
    if (share.guide > 0.0) sum += share.guide * guide_->density(q);
    return sum;
  }
  [[nodiscard]] double atom_mass() const override {
    const Shares share = shares();
    return share.goal + (share.guide > 0.0 ? share.guide * guide_->atom_mass() : 0.0);
  }
  [[nodiscard]] std::uint64_t epoch() const override { return guide_ == nullptr ? epoch_ : epoch_ + guide_->epoch(); }
  void record(DensityRecord& record, double share) const override {
    const Shares of = shares();
    goal_.record(record, share * of.goal);
    uniform_.record(record, share * of.uniform);
    if (of.hint > 0.0) record.add(hint_->density(), share * of.hint);
    if (of.guide > 0.0) guide_->record(record, share * of.guide);
  }

  void observe(const Outcome& outcome, bool mine) override {
    if (guide_ != nullptr) guide_->observe(outcome, mine && drawn_ == Part::guide);
  }
  void found(double length) override {
    if (guide_ != nullptr) guide_->found(length);
  }

  [[nodiscard]] std::vector<std::string> sources() const override {
    std::vector<std::string> all = {"goal", "uniform", "informed path"};
    if (guide_ != nullptr) {
      for (auto& name : guide_->sources()) all.push_back(std::move(name));
    }
    return all;
  }

 private:
  enum class Part : std::uint8_t { goal, uniform, hint, guide };
  static constexpr double hint_share = 0.5;

  /// The probabilities that `sample` gives the parts.
  struct Shares {
    double goal = 0.0;
    double uniform = 0.0;
    double hint = 0.0;
    double guide = 0.0;
  };
  [[nodiscard]] Shares shares() const {
    const double rest = 1.0 - common_.goal_bias;
    if (!guided()) return {common_.goal_bias, rest, 0.0, 0.0};
    const double guided_share = rest * (1.0 - common_.uniform);
    const double hint = !hint_ ? 0.0 : guide_ == nullptr ? 1.0 : hint_share;
    return {common_.goal_bias, rest * common_.uniform, guided_share * hint, guided_share * (1.0 - hint)};
  }

  const Instance& instance_;
  PlannerCommon common_;
  UniformGuidance uniform_;
  GoalGuidance goal_;
  std::optional<TubeKernel> hint_;
  std::unique_ptr<Prepared> guide_;
  Part drawn_ = Part::goal;
  std::uint64_t epoch_ = 0;  ///< how often the hint changed
};

/// A level's guidance, shown to whoever watches the run each time that it has drawn.
class WatchedGuidance final : public Guidance {
 public:
  WatchedGuidance(const Run& run, const LevelRecord& level, Guidance& h) : run_(run), level_(level), h_(h) {}
  Source sample(Stream& stream, MutableView out) override {
    const Source source = h_.sample(stream, out);
    run_.watch(level_, h_);
    return source;
  }
  [[nodiscard]] double density(View q) const override { return h_.density(q); }
  [[nodiscard]] double atom_mass() const override { return h_.atom_mass(); }
  [[nodiscard]] std::uint64_t epoch() const override { return h_.epoch(); }
  void record(DensityRecord& record, double share) const override { h_.record(record, share); }
  void observe(const Outcome& outcome, bool mine) override { h_.observe(outcome, mine); }
  void found(double length) override { h_.found(length); }
  [[nodiscard]] std::vector<std::string> sources() const override { return h_.sources(); }

 private:
  const Run& run_;
  const LevelRecord& level_;
  Guidance& h_;
};

/// One level at work: an instance, its planner, its guidance and its record.
class Level {
 public:
  Level(Run& run, Level* parent, std::string key, std::string name, std::unique_ptr<Instance> instance,
        const PlannerSpec& planner, std::shared_ptr<const Guide> lift)
      : run_(run),
        parent_(parent),
        lift_(std::move(lift)),
        instance_(std::move(instance)),
        kind_(*find_planner(planner.name())),
        planner_spec_(planner),
        common_(kind_.common(planner.options())),
        guidance_(*instance_, common_) {
    if (!kind_.graph) instance_->graph = nullptr;
    record_.level = static_cast<int>(run.levels.size());
    record_.parent = parent != nullptr ? parent->record_.level : -1;
    record_.depth = parent != nullptr ? parent->record_.depth + 1 : 0;
    record_.key = std::move(key);
    record_.name = std::move(name);
    record_.space = instance_->space;
    record_.start = instance_->start;
    record_.goal = instance_->goal;
    record_.position_axes = instance_->position_axes;
    record_.scene = instance_->scene;
    record_.presumed = !instance_->validity->spends_checks();
    record_.planner = planner.name();
    record_.search = Search(instance_->space.dimension());
    run.levels.push_back(this);
  }

  void guide_by(const GuideSpec& spec) { guidance_.set_guide(make_guidance(run_, *this, spec)); }

  /// Solves the instance, or solves it again; the instances below are solved first.
  /// \param proposals  that may be spent on it, within the level's budget
  const Solution& solve(double proposals = Budget::unlimited) {
    double* above = run_.clock.switch_to(&record_.search.seconds);
    if (run_.at_work != nullptr) run_.at_work->pause();
    Level* asking = std::exchange(run_.at_work, this);
    if (guidance_.guide() != nullptr) guidance_.guide()->prepare();
    if (!planner_) {
      Guidance* h = &guidance_;
      if (run_.watch) h = &watched_.emplace(run_, record_, guidance_);
      planner_ =
          kind_.make(planner_spec_.options(), Planner::Task{*instance_, *h, Stream(run_.seed, record_.key, "proposals"),
                                                            record_.search, guidance_.guided(), run_.interrupted});
    }
    ++record_.solves;
    Budget budget = common_.budget;
    budget.proposals = std::min(budget.proposals, static_cast<double>(record_.search.proposals.size()) + proposals);
    Solution found = planner_->solve(budget);
    found_ = found.solved();
    if (found_) guidance_.found(path_length(instance_->space, found.path));
    if (record_.solved_as < 0) record_.solved_as = run_.first_solves++;
    end_turn(found.solved() ? found.path : Configurations(), true);
    run_.at_work = asking;
    // A later solve that finds nothing does not undo what was found: its path may still guide.
    if (found.solved() || !record_.solution.solved()) record_.solution = std::move(found);
    run_.clock.switch_to(above);
    return record_.solution;
  }

  /// The record, completed once the run is over; given away, but for its key.
  LevelRecord take_record() {
    record_.search.checks = instance_->checks;
    record_.search.sources = guidance_.sources();
    record_.root_nodes = lifted(record_.search.nodes, "lift nodes");
    record_.root_proposals = lifted(record_.search.proposals, "lift proposals");
    record_.valid = [validity = instance_->validity](View q) { return validity->state(q); };
    record_.valid_motion = [validity = instance_->validity](View a, View b) { return validity->motion(a, b).valid; };
    record_.search.density.compact();
    if (record_.search.density.exact()) {
      const auto density = std::make_shared<const DensityRecord>(record_.search.density);
      record_.proposal_density = [density](View q) { return density->at(q); };
      record_.root_proposal_density = lifted(record_.proposal_density);
      record_.proposal_atoms = density->atoms();
    }
    std::string key = record_.key;
    LevelRecord taken = std::move(record_);
    // The levels below draw their lifts from streams that are named by it.
    record_.key = std::move(key);
    return taken;
  }

  /// Adds time spent for this level outside its solves: making its instance by f.
  void charge(double seconds) { record_.search.seconds += seconds; }

  /// A level below is asked for its solution in the middle of this one's solve.
  void pause() {
    const Search& search = record_.search;
    if (search.proposals.size() + search.nodes.size() > noted_) end_turn({}, false);
  }

  /// Whether the last solve found a path.
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] Instance& instance() { return *instance_; }
  [[nodiscard]] LevelGuidance& guidance() { return guidance_; }
  [[nodiscard]] const LevelRecord& record() const { return record_; }

 private:
  void end_turn(Configurations path, bool solve_ended) {
    const Search& search = record_.search;
    noted_ = search.proposals.size() + search.nodes.size();
    const auto length = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
    run_.turns.push_back(
        {record_.level, length(search.proposals.size()), length(search.nodes.size()), solve_ended, std::move(path)});
  }

  /// Rows of this level's space lifted to the root's by the chain of h's: each step draws from the fibre.
  Configurations lifted(const Configurations& rows, const std::string& purpose) const {
    Configurations current = rows;
    for (const Level* at = this; at->parent_ != nullptr; at = at->parent_) {
      Stream stream(run_.seed, record_.key, purpose + " from " + at->record_.key);
      const std::size_t dimension = at->parent_->instance_->space.dimension();
      Configurations next(dimension);
      next.reserve(current.size());
      Configuration q(dimension);
      for (std::size_t i = 0; i < current.size(); ++i) {
        at->lift_->lift(std::as_const(current)[i], stream, q);
        next.push(q);
      }
      current = std::move(next);
    }
    return current;
  }

  /// A density over this level's space as that of what is lifted to the root's: at f of a configuration, times the
  /// density on the fibre. It keeps every f that it needs.
  [[nodiscard]] std::function<double(View)> lifted(std::function<double(View)> density) const {
    for (const Level* at = this; at->parent_ != nullptr; at = at->parent_) {
      density = [density = std::move(density), f = at->lift_,
                 s = Configuration(at->instance_->space.dimension())](View q) mutable {
        f->project(q, s);
        const double p = density(s);
        return p > 0.0 ? p * std::exp(f->log_fibre_density(q)) : p;
      };
    }
    return density;
  }

  Run& run_;
  Level* parent_;
  std::shared_ptr<const Guide> lift_;  ///< that made this level's space from the parent's; nullptr at the root
  std::unique_ptr<Instance> instance_;
  const PlannerKind& kind_;
  PlannerSpec planner_spec_;
  PlannerCommon common_;
  LevelGuidance guidance_;
  std::optional<WatchedGuidance> watched_;
  std::unique_ptr<Planner> planner_;
  LevelRecord record_;
  std::size_t noted_ = 0;  ///< proposals and nodes when its last turn ended
  bool found_ = false;
};

/// A component of the algebra at work: f makes the level below, which is solved; h is drawn from, told, and renewed.
class ComponentGuidance final : public Prepared {
 public:
  ComponentGuidance(Run& run, Level& parent, const GuideSpec& spec, const std::string& key)
      : parent_(parent),
        guide_(find_guide(spec.name())->make(spec.options())),
        name_(GuideSpec::make(spec.name(), spec.options().entries()).text()),
        resolves_left_(find_guide(spec.name())->resolves(spec.options())) {
    double seconds = 0.0;
    double* above = run.clock.switch_to(&seconds);
    auto sub = project(run, parent, spec);
    run.clock.switch_to(above);
    if (!sub) return;
    level_ = std::make_unique<Level>(run, &parent, key, name_, std::move(sub), *spec.planner(), guide_);
    level_->charge(seconds);
    if (spec.below() != nullptr) level_->guide_by(*spec.below());
  }

  void prepare() override {
    if (heuristic_) return;
    if (!level_) {
      ++epoch_;
      heuristic_ = guide_->heuristic(parent_.instance(), nullptr, nullptr);
      return;
    }
    const Solution& found = solve_below();
    ++epoch_;
    heuristic_ = guide_->heuristic(parent_.instance(), &level_->instance(), &found);
  }

  Source sample(Stream& stream, MutableView out) override {
    heuristic_->sample(stream, out);
    return 0;
  }
  [[nodiscard]] double density(View q) const override {
    return heuristic_ ? heuristic_->density(q) : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] double atom_mass() const override { return heuristic_ ? heuristic_->atom_mass() : 0.0; }
  [[nodiscard]] std::uint64_t epoch() const override { return heuristic_ ? epoch_ + heuristic_->epoch() : epoch_; }
  void record(DensityRecord& record, double share) const override {
    if (!heuristic_) throw Fault("a guide that was not prepared has drawn nothing to record");
    heuristic_->record(record, share);
  }

  void observe(const Outcome& outcome, bool mine) override {
    guide_->learn(outcome);
    if (!heuristic_) return;
    heuristic_->observe(outcome, mine);
    if (!heuristic_->stale() || resolves_left_ <= 0) return;
    --resolves_left_;
    guide_->before_resolve();
    const Solution& found = solve_below();
    epoch_ = epoch() + 1;
    heuristic_ = guide_->heuristic(parent_.instance(), &level_->instance(), &found);
  }

  void found(double length) override {
    if (heuristic_) heuristic_->found(length);
  }

  [[nodiscard]] std::vector<std::string> sources() const override { return {name_}; }
  [[nodiscard]] Configurations guiding_path() const override {
    return heuristic_ ? heuristic_->lifted_path() : Configurations{};
  }

  void inform(const Configurations& path) override {
    if (!level_) return;
    Configurations projected(level_->instance().space.dimension());
    Configuration s(projected.dimension());
    for (std::size_t i = 0; i < path.size(); ++i) {
      guide_->project(path[i], s);
      projected.push(s);
    }
    level_->guidance().inform(projected);
  }

 private:
  std::unique_ptr<Instance> project(const Run& run, const Level& parent, const GuideSpec& spec) const {
    try {
      return guide_->project(parent_.instance());
    } catch (const Error& error) {
      const auto at = [&](int i) -> const LevelRecord& { return run.levels[static_cast<std::size_t>(i)]->record(); };
      const std::string path = level_path(parent.record(), at);
      throw Error(fmt::format("{}in {} >> {}, level {} (problem '{}'): {}", where(spec.origin()), name_,
                              path.substr(0, path.rfind(',')), run.levels.size(), run.problem, error.what()));
    }
  }

  /// Solves the instance in S, for as many paths as the guide wants.
  const Solution& solve_below() {
    const Solution* found = &level_->solve(guide_->effort());
    while (const std::int64_t more = guide_->another(level_->found() ? found : nullptr)) {
      found = &level_->solve(static_cast<double>(more));
    }
    return *found;
  }

  Level& parent_;
  std::shared_ptr<Guide> guide_;
  std::string name_;
  std::unique_ptr<Level> level_;
  std::unique_ptr<Heuristic> heuristic_;
  std::uint64_t epoch_ = 0;  ///< beside the heuristic's own
  std::int64_t resolves_left_;
};

/// What mixtures and sequences share: parts, one of which draws.
class PartsGuidance : public Prepared {
 public:
  explicit PartsGuidance(std::vector<std::unique_ptr<Prepared>> parts) : parts_(std::move(parts)) {
    for (const auto& part : parts_) {
      first_source_.push_back(static_cast<Source>(sources_.size()));
      for (auto& name : part->sources()) sources_.push_back(std::move(name));
    }
  }
  void observe(const Outcome& outcome, bool mine) override {
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i]->observe(outcome, mine && i == drawn_);
  }
  void found(double length) override {
    for (auto& part : parts_) part->found(length);
  }
  [[nodiscard]] std::uint64_t epoch() const override {
    std::uint64_t sum = 0;
    for (const auto& part : parts_) sum += part->epoch();
    return sum;
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return sources_; }
  void inform(const Configurations& path) override {
    for (auto& part : parts_) part->inform(path);
  }

 protected:
  Source draw(Stream& stream, MutableView out) {
    return static_cast<Source>(first_source_[drawn_] + parts_[drawn_]->sample(stream, out));
  }

  std::vector<std::unique_ptr<Prepared>> parts_;
  std::size_t drawn_ = 0;

 private:
  std::vector<Source> first_source_;
  std::vector<std::string> sources_;
};

/// A mixture of guides.
class MixtureGuidance final : public PartsGuidance {
 public:
  MixtureGuidance(const std::vector<double>& weights, std::vector<std::unique_ptr<Prepared>> parts)
      : PartsGuidance(std::move(parts)) {
    double total = 0.0;
    for (const double w : weights) total += w;
    for (const double w : weights) weights_.push_back(w / total);
  }
  void prepare() override {
    for (auto& part : parts_) part->prepare();
  }
  Source sample(Stream& stream, MutableView out) override {
    double u = stream.uniform();
    drawn_ = 0;
    while (drawn_ + 1 < parts_.size() && u >= weights_[drawn_]) u -= weights_[drawn_++];
    return draw(stream, out);
  }
  [[nodiscard]] double density(View q) const override {
    double sum = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) sum += weights_[i] * parts_[i]->density(q);
    return sum;
  }
  [[nodiscard]] double atom_mass() const override {
    double sum = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) sum += weights_[i] * parts_[i]->atom_mass();
    return sum;
  }
  void record(DensityRecord& record, double share) const override {
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i]->record(record, share * weights_[i]);
  }
  [[nodiscard]] Configurations guiding_path() const override {
    for (const auto& part : parts_) {
      Configurations path = part->guiding_path();
      if (!path.empty()) return path;
    }
    return {};
  }

 private:
  std::vector<double> weights_;
};

/// A mixture whose weights follow what each part's proposals achieved (BlendSettings).
class BlendGuidance final : public PartsGuidance {
 public:
  BlendGuidance(const BlendSettings& settings, const Space& space, std::vector<std::unique_ptr<Prepared>> parts)
      : PartsGuidance(std::move(parts)), settings_(settings), space_(space), arms_(parts_.size()) {}
  void prepare() override {
    for (auto& part : parts_) part->prepare();
  }
  Source sample(Stream& stream, MutableView out) override {
    const double total = total_weight();
    double u = stream.uniform();
    drawn_ = 0;
    while (drawn_ + 1 < parts_.size() && u >= share(drawn_, total)) u -= share(drawn_++, total);
    return draw(stream, out);
  }
  [[nodiscard]] double density(View q) const override {
    return sum([&](const Prepared& part) { return part.density(q); });
  }
  [[nodiscard]] double atom_mass() const override {
    return sum([](const Prepared& part) { return part.atom_mass(); });
  }
  [[nodiscard]] std::uint64_t epoch() const override { return counted_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double of) const override {
    const double total = total_weight();
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i]->record(record, of * share(i, total));
  }
  void observe(const Outcome& outcome, bool mine) override {
    if (mine) {
      auto& arm = arms_[drawn_];
      arm.successes = settings_.decay * arm.successes + credit(outcome);
      arm.attempts = settings_.decay * arm.attempts + 1.0;
      ++counted_;
    }
    PartsGuidance::observe(outcome, mine);
  }
  /// Of the parts that have a path, that of the one with the most weight.
  [[nodiscard]] Configurations guiding_path() const override {
    Configurations best;
    double most = -1.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (arms_[i].weight() <= most) continue;
      Configurations path = parts_[i]->guiding_path();
      if (path.empty()) continue;
      most = arms_[i].weight();
      best = std::move(path);
    }
    return best;
  }

 private:
  struct Arm {
    double successes = 1.0;
    double attempts = 1.0;
    [[nodiscard]] double weight() const { return successes / attempts; }
  };

  [[nodiscard]] double total_weight() const {
    double total = 0.0;
    for (const auto& arm : arms_) total += arm.weight();
    return total;
  }
  /// The probability that part i draws the next proposal, `total` the weight of all.
  [[nodiscard]] double share(std::size_t i, double total) const {
    const double even = 1.0 / static_cast<double>(arms_.size());
    const double follow = total > 0.0 ? arms_[i].weight() / total : even;
    return settings_.floor * even + (1.0 - settings_.floor) * follow;
  }
  template <class Value>
  [[nodiscard]] double sum(const Value& value) const {
    const double total = total_weight();
    double sum = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) sum += share(i, total) * value(*parts_[i]);
    return sum;
  }
  double credit(const Outcome& outcome) {
    if (outcome.added.empty()) return 0.0;
    if (settings_.credit == "node" || outcome.near.empty()) return 1.0;
    const double length = space_.distance(outcome.near, outcome.added);
    longest_ = std::max(longest_, length);
    return longest_ > 0.0 ? length / longest_ : 0.0;
  }

  BlendSettings settings_;
  const Space& space_;
  std::vector<Arm> arms_;
  double longest_ = 0.0;       ///< extension so far
  std::uint64_t counted_ = 0;  ///< outcomes
};

/// A sequence of guides: each serves a turn of proposals; the path that it leaves informs the next one's search. After
/// the last the first has its turn again.
class SequenceGuidance final : public PartsGuidance {
 public:
  SequenceGuidance(std::vector<std::unique_ptr<Prepared>> parts, std::int64_t turn)
      : PartsGuidance(std::move(parts)), turn_(turn) {}
  void prepare() override { parts_[drawn_]->prepare(); }
  Source sample(Stream& stream, MutableView out) override {
    if (served_ == turn_ && parts_.size() > 1) {
      const Configurations path = parts_[drawn_]->guiding_path();
      drawn_ = (drawn_ + 1) % parts_.size();
      served_ = 0;
      ++turns_;
      if (!path.empty()) parts_[drawn_]->inform(path);
      parts_[drawn_]->prepare();
    }
    ++served_;
    return draw(stream, out);
  }
  [[nodiscard]] double density(View q) const override { return parts_[drawn_]->density(q); }
  [[nodiscard]] double atom_mass() const override { return parts_[drawn_]->atom_mass(); }
  [[nodiscard]] std::uint64_t epoch() const override { return turns_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double share) const override { parts_[drawn_]->record(record, share); }
  [[nodiscard]] Configurations guiding_path() const override { return parts_[drawn_]->guiding_path(); }

 private:
  std::int64_t turn_;
  std::int64_t served_ = 0;
  std::uint64_t turns_ = 0;  ///< passed on
};

std::unique_ptr<Prepared> make_guidance_at(Run& run, Level& level, const GuideSpec& spec, const std::string& key) {
  if (spec.kind() == GuideSpec::Kind::component) return std::make_unique<ComponentGuidance>(run, level, spec, key);
  std::vector<double> weights;
  std::vector<std::unique_ptr<Prepared>> parts;
  for (const auto& term : spec.terms()) {
    weights.push_back(term.weight);
    // The key names the place in the hierarchy, so that no level's stream depends on its neighbours.
    parts.push_back(make_guidance_at(run, level, term.guide, fmt::format("{}.{}", key, parts.size())));
  }
  if (spec.kind() == GuideSpec::Kind::mixture) return std::make_unique<MixtureGuidance>(weights, std::move(parts));
  if (spec.kind() == GuideSpec::Kind::blend) {
    return std::make_unique<BlendGuidance>(spec.blending(), level.instance().space, std::move(parts));
  }
  return std::make_unique<SequenceGuidance>(std::move(parts), spec.turn());
}

std::unique_ptr<Prepared> make_guidance(Run& run, Level& level, const GuideSpec& spec) {
  return make_guidance_at(run, level, spec, level.record().key + "/0");
}

/// What could be written instead of a start or goal that is invalid.
std::string nearest(const Problem& problem, const Configuration& q, const Checker& checker) {
  for (const double x : q) {
    if (!std::isfinite(x)) return "another coordinate is no finite number";
  }
  const auto found = nearest_valid(problem.space, q, [&](View x) { return checker.valid(x); });
  if (!found) return "no valid configuration was found in its space";
  return fmt::format("a valid configuration near by is {}, at a distance of {:.2g}", found->text, found->distance);
}

constexpr int deepest = 64;

int depth(const GuideSpec& guide) {
  if (guide.kind() == GuideSpec::Kind::component) return 1 + (guide.below() != nullptr ? depth(*guide.below()) : 0);
  int most = 0;
  for (const auto& term : guide.terms()) most = std::max(most, depth(term.guide));
  return most;
}

}  // namespace

std::string level_path(const LevelRecord& level, const std::function<const LevelRecord&(int)>& at) {
  std::string path;
  const LevelRecord* record = &level;
  while (record->parent >= 0) {
    path += record->name + " >> ";
    record = &at(record->parent);
  }
  return fmt::format("{}{}, level {}", path, record->planner, level.level);
}

void check(const Problem& problem) {
  if (!problem.scene) throw Error(fmt::format("problem '{}': has no scene", problem.name));
  const auto& axes = problem.space.axes();
  const auto& robot = problem.scene->robot;
  if (problem.space.dimension() < robot.dimension()) {
    throw Error(fmt::format("problem '{}': the robot needs {} coordinates and the space {} has {}", problem.name,
                            robot.dimension(), problem.space.name(), problem.space.dimension()));
  }
  if (!(problem.resolution > 0.0) || !std::isfinite(problem.resolution)) {
    throw Error(fmt::format("problem '{}': resolution must be a number greater than 0, in m, got {}", problem.name,
                            problem.resolution));
  }
  if (!(problem.goal_tolerance >= 0.0) || !std::isfinite(problem.goal_tolerance)) {
    throw Error(fmt::format("problem '{}': goal_tolerance must be a number of at least 0, in m, got {}", problem.name,
                            problem.goal_tolerance));
  }
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  for (const auto& [what, q] : {std::pair<const char*, const Configuration&>{"start", problem.start},
                                std::pair<const char*, const Configuration&>{"goal", problem.goal}}) {
    if (q.size() != axes.size()) {
      std::vector<std::string> names;
      names.reserve(axes.size());
      for (const auto& axis : axes) names.push_back(axis.name);
      throw Error(fmt::format("problem '{}': {} has {} coordinate{}, expected {} ({})", problem.name, what, q.size(),
                              q.size() == 1 ? "" : "s", axes.size(), fmt::join(names, ", ")));
    }
    for (std::size_t j = 0; j < q.size(); ++j) {
      if (!std::isfinite(q[j])) {
        throw Error(fmt::format("problem '{}': {}: coordinate {} ({}) is {}, expected a finite number", problem.name,
                                what, j + 1, axes[j].name, q[j]));
      }
      if (!axes[j].periodic && (q[j] < axes[j].lo || q[j] > axes[j].hi)) {
        throw Error(fmt::format("problem '{}': {} is out of bounds: {} = {:g}, expected it in [{:g}, {:g}]; {}",
                                problem.name, what, axes[j].name, q[j], axes[j].lo, axes[j].hi,
                                nearest(problem, q, *checker)));
      }
    }
    if (const auto contact = checker->contact(q)) {
      throw Error(fmt::format("problem '{}': {} ({:g}) is in collision with {}; {}", problem.name, what,
                              fmt::join(q, ", "), describe(*contact, *problem.scene), nearest(problem, q, *checker)));
    }
  }
}

namespace {

void check_depth(const StrategySpec& strategy) {
  if (strategy.guide() == nullptr || depth(*strategy.guide()) <= deepest) return;
  throw Error(fmt::format("the hierarchy is deeper than {} levels; is it built in an endless loop?", deepest));
}

std::unique_ptr<Instance> root_instance(const Problem& problem) {
  auto instance = make_instance(problem);
  instance->space.normalise(instance->start);
  instance->space.normalise(instance->goal);
  return instance;
}

/// The first place in a guide that was written somewhere.
std::string where(const GuideSpec& guide) {
  if (guide.kind() == GuideSpec::Kind::component) return where(guide.origin());
  for (const auto& term : guide.terms()) {
    std::string place = where(term.guide);
    if (!place.empty()) return place;
  }
  return "";
}

void find_unreachable(const GuideSpec& guide, const PlannerSpec& planner, double proposals,
                      std::vector<std::string>& sentences) {
  switch (guide.kind()) {
    case GuideSpec::Kind::component: {
      const PlannerCommon common = find_planner(planner.name())->common(planner.options());
      if ((1.0 - common.goal_bias) * (1.0 - common.uniform) <= 0.0) {
        sentences.push_back(
            fmt::format("{}{} never draws: {} leaves it no share of its proposals (uniform = {:g}, "
                        "goal_bias = {:g})",
                        where(guide), guide.text(), planner.text(), common.uniform, common.goal_bias));
      } else if (guide.below() != nullptr) {
        const PlannerSpec& own = *guide.planner();
        find_unreachable(*guide.below(), own, find_planner(own.name())->common(own.options()).budget.proposals,
                         sentences);
      }
      return;
    }
    case GuideSpec::Kind::sequence:
      for (std::size_t i = 0; i < guide.terms().size(); ++i) {
        const GuideSpec& part = guide.terms()[i].guide;
        const double begins = static_cast<double>(i) * static_cast<double>(guide.turn());
        if (begins < proposals) {
          find_unreachable(part, planner, proposals, sentences);
        } else {
          sentences.push_back(
              fmt::format("{}{} never draws: its turn begins after {:g} proposals, and {} ends after {:g}", where(part),
                          part.text(), begins, planner.text(), proposals));
        }
      }
      return;
    case GuideSpec::Kind::mixture:
    case GuideSpec::Kind::blend:
      for (const auto& term : guide.terms()) find_unreachable(term.guide, planner, proposals, sentences);
      return;
  }
}

}  // namespace

void check(const StrategySpec& strategy, const Problem& problem) {
  check_depth(strategy);
  if (strategy.guide() == nullptr) return;
  Run run;
  run.problem = problem.name;
  Level root(run, nullptr, "0", "root", root_instance(problem), strategy.planner(), nullptr);
  root.guide_by(*strategy.guide());
}

std::vector<std::string> unreachable_guides(const StrategySpec& strategy) {
  std::vector<std::string> sentences;
  if (strategy.guide() == nullptr) return sentences;
  const PlannerSpec& planner = strategy.planner();
  find_unreachable(*strategy.guide(), planner, find_planner(planner.name())->common(planner.options()).budget.proposals,
                   sentences);
  return sentences;
}

RunRecord execute(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                  const ExecuteOptions& options) {
  check(problem);
  check_depth(strategy);
  const auto begin = std::chrono::steady_clock::now();
  Run run;
  run.problem = problem.name;
  run.seed = seed;
  run.interrupted = options.interrupted;
  run.watch = options.watch;
  Level root(run, nullptr, "0", "root", root_instance(problem), strategy.planner(), nullptr);
  double setup = 0.0;
  run.clock.switch_to(&setup);
  if (strategy.guide() != nullptr) root.guide_by(*strategy.guide());
  const Solution& found = root.solve();
  run.clock.switch_to(nullptr);

  RunRecord record;
  record.status = found.status;
  record.solved = found.solved();
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (Level* level : run.levels) {
    record.validity_checks += level->instance().checks.validity;
    record.motion_checks += level->instance().checks.motion;
  }
  const Checks planned = root.instance().checks;
  if (record.solved) {
    record.path = found.path;
    if (options.shortcut > 0) {
      Stream stream(seed, "0", "shortcut");
      record.path = shortcut(root.instance(), record.path, options.shortcut, stream);
      record.shortcut_checks = root.instance().checks.validity - planned.validity;
      root.instance().checks = planned;
    }
    record.length = path_length(problem.space, record.path);
  }
  for (Level* level : run.levels) record.levels.push_back(level->take_record());
  // The root's own path is the one that is reported.
  if (record.solved) record.levels.front().solution.path = record.path;
  record.turns = std::move(run.turns);
  return record;
}

}  // namespace trellis

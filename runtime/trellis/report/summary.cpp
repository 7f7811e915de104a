// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/summary.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>

#include <trellis/planner/planner.hpp>
#include <trellis/report/resolves.hpp>
#include <trellis/report/words.hpp>
#include <trellis/results/quantities.hpp>

namespace trellis {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Levels = std::vector<const LevelFacts*>;

template <class F>
double median_of(const Levels& levels, F f) {
  std::vector<double> values;
  for (const auto* level : levels) values.push_back(f(*level));
  return median(values);
}

using Where = std::optional<Scores> LevelScores::*;
using Role = Efficiency Scores::*;

/// Distributes shares in bins over `count` bins of the same total extent.
std::vector<double> spread(const std::vector<double>& shares, std::size_t count) {
  std::vector<double> result(count, 0.0);
  const double scale = static_cast<double>(count) / static_cast<double>(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double lo = static_cast<double>(i) * scale;
    const double hi = static_cast<double>(i + 1) * scale;
    for (auto j = static_cast<std::size_t>(lo); j < count && static_cast<double>(j) < hi; ++j) {
      const auto at = static_cast<double>(j);
      result[j] += shares[i] * std::max(0.0, std::min(hi, at + 1.0) - std::max(lo, at)) / (hi - lo);
    }
  }
  return result;
}

/// Computes the mean profile over paths of different lengths: along the share of the path, in the smallest number of
/// bins that at least half of the runs have.
void add_profile(const std::vector<const Efficiency*>& figures, Figure& result) {
  std::vector<double> counts;
  for (const Efficiency* e : figures) {
    if (!e->along.target.empty()) counts.push_back(static_cast<double>(e->along.target.size()));
  }
  if (counts.empty()) return;
  const auto bins = static_cast<std::size_t>(std::floor(median(counts)));
  std::vector<std::vector<double>> samples(bins);
  result.profile_target.assign(bins, 0.0);
  for (const Efficiency* e : figures) {
    if (e->along.target.empty()) continue;
    const auto target = spread(e->along.target, bins);
    const auto drawn = spread(e->along.samples, bins);
    for (std::size_t j = 0; j < bins; ++j) {
      result.profile_target[j] += target[j] / static_cast<double>(counts.size());
      samples[j].push_back(drawn[j]);
    }
  }
  for (const auto& shares : samples) result.profile.push_back(student_interval(shares));
}

/// Raises an interval to a lower bound.
void at_least(Interval& interval, double bound) {
  if (std::isnan(bound)) return;
  for (double* x : {&interval.value, &interval.lo, &interval.hi}) {
    if (*x < bound) *x = bound;
  }
}

/// \param least  the lower bound of SE, the mean over the runs
void bound_below(Figure& figure, double least) {
  constexpr double visible = 0.005;  // half of the last printed digit
  if (figure["SE"].value < least - visible) figure.flags.emplace_back("at its bound", figure.scored);
  at_least(figure["D"], figure["D_mass_lower95"].value);
  at_least(figure["SE"], least);
  const double most_gain = figure["D_uniform"].value - least;
  Interval& gain = figure["above_uniform"];
  for (double* x : {&gain.value, &gain.lo, &gain.hi}) {
    if (*x > most_gain) *x = most_gain;
  }
  for (const MeasureIndex part : {MeasureIndex("SE_parts.mass"), MeasureIndex("SE_parts.spread")}) {
    at_least(figure[part], 0.0);
  }
}

/// Returns the scores with a value, and adds what names and counts all scores: reasons, estimators, flags.
std::vector<const Efficiency*> collect(const std::vector<const Efficiency*>& all, Figure& result) {
  const auto add_once = [](std::vector<std::string>& names, const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  std::vector<const Efficiency*> figures;
  for (const Efficiency* e : all) {
    if (std::isnan(e->value)) {
      add_once(result.reasons, e->reason);
      continue;
    }
    figures.push_back(e);
    add_once(result.estimators, e->estimator);
    for (const auto& flag : e->flags) {
      const auto same = [&](const auto& entry) { return entry.first == flag; };
      const auto it = std::find_if(result.flags.begin(), result.flags.end(), same);
      if (it == result.flags.end()) {
        result.flags.emplace_back(flag, 1);
      } else {
        ++it->second;
      }
    }
  }
  return figures;
}

template <class Field>
std::vector<double> values_of(const std::vector<const Efficiency*>& figures, const Field& field) {
  std::vector<double> values;
  values.reserve(figures.size());
  for (const Efficiency* e : figures) values.push_back(static_cast<double>(field(*e)));
  return values;
}

/// Compares the headline estimator with the first other one, in the runs that have both.
void add_check(const std::vector<const Efficiency*>& figures, Figure& result) {
  std::vector<double> headline;
  std::vector<double> beside;
  for (const Efficiency* e : figures) {
    if (e->others.empty()) continue;
    if (result.check.empty()) result.check = e->others.front().estimator;
    if (e->others.front().estimator != result.check) continue;
    headline.push_back(e->value);
    beside.push_back(e->others.front().value);
  }
  result.check_difference = paired(headline, beside);
}

Figure figure(const Levels& levels, Where where, Role role) {
  std::vector<const Efficiency*> all;
  for (const auto* level : levels) {
    if (const Efficiency* e = level->score(where, role)) all.push_back(e);
  }
  Figure result;
  const auto figures = collect(all, result);
  result.scored = figures.size();
  result.samples = median(values_of(figures, [](const Efficiency& e) { return e.samples; }));
  result.in_target = median(values_of(figures, [](const Efficiency& e) { return e.in_target; }));
  for (const MeasureQuantity& quantity : measure_quantities) {
    if (!quantity.in_runs) continue;
    // Uniform sampling has its divergence where the samples have none, too; hitting needs no estimate.
    const std::string_view group = quantity.group;
    const bool without = quantity.is("D_uniform") || group == "hitting" || group == "bottleneck";
    const auto& scores = without ? all : figures;
    result[MeasureIndex(quantity)] = student_interval(values_of(scores, quantity.of_run));
  }
  const auto least = [](const Efficiency& e) { return e.estimator.starts_with("exact") ? e.perfect : least_value(e); };
  bound_below(result, student_interval(values_of(figures, least)).value);
  add_profile(figures, result);
  add_check(figures, result);
  return result;
}

MetricsSummary metrics(const Levels& levels) {
  MetricsSummary result;
  std::vector<const SearchMetrics*> measured;
  for (const auto* level : levels) {
    if (level->scores && level->scores->metrics) measured.push_back(&*level->scores->metrics);
  }
  result.measured = measured.size();
  const auto over_runs = [&](auto field) {
    std::vector<double> values;
    values.reserve(measured.size());
    for (const SearchMetrics* m : measured) values.push_back(field(*m));
    return student_interval(values);
  };
  using M = const SearchMetrics&;
  for (std::size_t c = 0; c < result.classes.size(); ++c) {
    result.classes[c] = over_runs([&](M m) {
      const std::size_t all = std::accumulate(m.nodes.begin(), m.nodes.end(), std::size_t{0});
      return all == 0 ? nan : static_cast<double>(m.nodes[c]) / static_cast<double>(all);
    });
  }
  result.components = over_runs([](M m) { return static_cast<double>(m.components); });
  result.coverage = over_runs([](M m) { return m.coverage; });
  result.connectivity = over_runs([](M m) { return m.connectivity; });
  result.information = over_runs([](M m) { return m.information; });
  result.information_per_sample = over_runs([](M m) { return m.information_per_sample; });
  result.invalid = over_runs([](M m) { return m.invalid; });
  result.trapped = over_runs([](M m) { return m.trapped; });
  result.redundant = over_runs([](M m) { return m.redundant; });
  result.useful = over_runs([](M m) { return m.useful; });
  return result;
}

/// Returns the middle of an interval with its ends; NaN where it is blank.
Interval middle(const AboveUniform& above, std::size_t runs) {
  if (!above.printed()) return {};
  return {0.5 * (above.lo + above.hi), above.lo, above.hi, runs, 0};
}

Waterfall waterfall(const std::vector<LevelSummary>& levels, SampleRole role) {
  Waterfall result;
  if (levels.empty()) return result;
  const LevelSummary& root = levels.front();
  const Headline of_root = headline(root, role);
  result.uniform = {of_root.uniform, of_root.uniform, of_root.uniform, of_root.runs, 0};
  const auto of_level = [&](int level) { return headline(levels[static_cast<std::size_t>(level)], role); };
  const auto scored = [&](int level) { return of_level(level).runs > 0; };
  const auto gain = [&](int level) {
    if (level < 0) return Interval{0.0, 0.0, 0.0, of_root.runs, 0};
    const Headline found = of_level(level);
    return middle(found.above, found.runs);
  };
  // Skip a level without samples of its own (a graph search makes no proposals): its guides count instead.
  const auto guides_of = [&](int level, auto&& self) -> std::vector<int> {
    std::vector<int> guides;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      if (levels[i].parent != level) continue;
      const int guide = static_cast<int>(i);
      if (scored(guide)) {
        guides.push_back(guide);
      } else {
        const auto below = self(guide, self);
        guides.insert(guides.end(), below.begin(), below.end());
      }
    }
    return guides;
  };
  for (auto i = static_cast<int>(levels.size()); i-- > 0;) {
    if (!scored(i)) continue;
    auto guides = guides_of(i, guides_of);
    if (guides.empty()) guides.push_back(-1);
    for (const int guide : guides) {
      WaterfallStep step;
      step.level = i;
      step.from = guide;
      step.before = gain(guide);
      step.after = gain(i);
      step.added = {step.after.value - step.before.value, step.after.lo - step.before.hi,
                    step.after.hi - step.before.lo, std::min(step.before.n, step.after.n), 0};
      result.steps.push_back(step);
    }
  }
  return result;
}

double median_spent(const std::vector<CensoredCost>& costs) {
  std::vector<double> values;
  values.reserve(costs.size());
  for (const CensoredCost& one : costs) values.push_back(one.spent);
  return median(values);
}

/// Computes each level's share of the costs of all levels of all runs.
void add_shares(std::span<const RunFacts* const> runs, std::vector<LevelSummary>& levels) {
  std::map<std::string, std::pair<double, double>> spent;
  double checks = 0.0;
  double seconds = 0.0;
  for (const RunFacts* run : runs) {
    for (const LevelFacts& level : run->levels) {
      auto& [of_checks, of_seconds] = spent[level.key];
      of_checks += static_cast<double>(level.validity_checks);
      of_seconds += level.seconds;
      checks += static_cast<double>(level.validity_checks);
      seconds += level.seconds;
    }
  }
  for (LevelSummary& level : levels) {
    if (checks > 0.0) level.check_share = spent[level.key].first / checks;
    if (seconds > 0.0) level.time_share = spent[level.key].second / seconds;
  }
}

FigurePair figures(const Levels& levels, Where where) {
  return {figure(levels, where, &Scores::tree), figure(levels, where, &Scores::expansion)};
}

LevelSummary summarise_level(const Levels& levels) {
  const LevelFacts& first = *levels.front();
  LevelSummary result;
  result.key = first.key;
  result.name = first.name;
  result.space = first.space;
  result.dimension = first.degrees;
  result.planner = first.planner;
  result.runs = levels.size();
  for (const auto* level : levels) {
    const LevelFacts& record = *level;
    if (record.status == Status::solved) ++result.solved;
    for (const ResolveReason& reason : resolve_reasons) {
      result.resolved_for.total.*reason.count += record.resolves.*reason.count;
    }
    if (record.resolves.exhausted) ++result.resolved_for.exhausted;
    if (record.resolves.limit_reached) ++result.resolved_for.limited;
    if (record.space != result.space || record.degrees != result.dimension) result.space.clear();
  }
  using R = const LevelFacts&;
  const auto count = [](auto n) { return static_cast<double>(n); };
  result.resolves = median_of(levels, [&](R r) { return r.solves > 0 ? count(r.solves - 1) : nan; });
  result.proposals = median_of(levels, [&](R r) { return count(r.proposals); });
  result.nodes = median_of(levels, [&](R r) { return count(r.nodes); });
  result.validity_checks = median_of(levels, [&](R r) { return count(r.validity_checks); });
  result.motion_checks = median_of(levels, [&](R r) { return count(r.motion_checks); });
  result.seconds = median_of(levels, [&](R r) { return r.seconds; });
  Levels guided;
  std::copy_if(levels.begin(), levels.end(), std::back_inserter(guided),
               [](const LevelFacts* level) { return level->guided; });
  result.guided = !guided.empty();
  if (result.guided) {
    result.by_guided = {median_of(guided, [&](R r) { return count(r.guided_checks); }),
                        median_of(guided, [&](R r) { return count(r.guided_proposals); })};
    result.by_unguided = {median_of(guided, [&](R r) { return count(r.unguided_checks); }),
                          median_of(guided, [&](R r) { return count(r.proposals - r.guided_proposals); })};
    result.by_below = {median_of(guided, [&](R r) { return count(r.checks_below); }),
                       median_of(guided, [&](R r) { return count(r.proposals_below); })};
  }
  result.own = figures(levels, &LevelScores::own);
  result.root = figures(levels, &LevelScores::root);
  result.own_cross = figures(levels, &LevelScores::own_cross);
  result.root_cross = figures(levels, &LevelScores::root_cross);
  result.equal = figures(levels, &LevelScores::equal);
  result.oracle = figures(levels, &LevelScores::oracle);
  result.uniform = figures(levels, &LevelScores::uniform);
  result.metrics = metrics(levels);
  return result;
}

}  // namespace

std::vector<std::uint64_t> parse_key(const std::string& key) {
  std::vector<std::uint64_t> numbers;
  bool inside = false;
  for (const char c : key) {
    const bool digit = c >= '0' && c <= '9';
    if (digit && !inside) numbers.push_back(0);
    if (digit) numbers.back() = 10 * numbers.back() + static_cast<std::uint64_t>(c - '0');
    inside = digit;
  }
  return numbers;
}

namespace {

/// Whether the root's planner continues after its first path.
bool is_anytime(const RunFacts& run) {
  if (run.levels.empty()) return false;
  const PlannerKind* planner = find_planner(run.levels.front().planner);
  return planner != nullptr && planner->component->find("improve") != nullptr;
}

BesideSummary summarise_beside(std::span<const RunFacts* const> runs) {
  BesideSummary beside;
  std::vector<double> shares;
  std::vector<double> certificates;
  for (const RunFacts* run : runs) {
    const BoundedLoss& law = run->bounded;
    if (law.bound == 0.0) continue;
    ++beside.runs;
    const double all = law.guided.work + law.unguided.work;
    if (all > 0.0) shares.push_back(law.unguided.work / all);
    beside.largest_step = {std::max(beside.largest_step.checks, law.largest_step.checks),
                           std::max(beside.largest_step.work, law.largest_step.work)};
    certificates.push_back(static_cast<double>(run->path_checks));
    beside.unguided_won += law.unguided_won ? 1 : 0;
    if (!law.guides_set_up) {
      ++beside.not_set_up;
    } else if (!run->levels.empty() && run->levels.front().guided_proposals == 0) {
      ++beside.no_guided;
    }
  }
  beside.unguided_share = median(std::move(shares));
  beside.certificate_checks = median(std::move(certificates));
  return beside;
}

void add_waterfalls(RunsSummary& summary) {
  summary.tree_waterfall = waterfall(summary.levels, SampleRole::tree);
  summary.expansion_waterfall = waterfall(summary.levels, SampleRole::expansion);
}

}  // namespace

namespace {

/// \param lo, hi  of SE
AboveUniform between(double lo, double hi, double uniform, bool exact) {
  return {.lo = uniform - hi, .hi = uniform - lo, .exact = exact, .blank = exact ? "" : blank_reason(lo, hi, uniform)};
}

}  // namespace

AboveUniform above_uniform(const Figure& figure) {
  if (figure.scored == 0) return {};
  const bool exact = std::all_of(figure.estimators.begin(), figure.estimators.end(),
                                 [](const std::string& name) { return name.starts_with("exact"); });
  const double uniform = figure["D_uniform"].value;
  const auto end = [](double bound, double value) { return std::isnan(bound) ? value : bound; };
  // No SE is below that of perfect guidance or above that of samples that never lie in the target.
  const double least = figure["D_perfect"].value;
  const double most = uniform - std::log(uniform_mix);
  // `uniform` is the mean over all runs, the ends those over the runs with samples: both are bounded.
  const auto bounded = [&](double bound) { return std::min(std::max(bound, least), most); };
  const double lo = bounded(end(figure["SE_lo"].lo, figure["SE_lo"].value));
  const double hi = bounded(end(figure["SE_hi"].hi, figure["SE_hi"].value));
  return between(lo, hi, uniform, exact);
}

AboveUniform above_uniform(const Efficiency& efficiency) {
  if (std::isnan(efficiency.value)) return {};
  return between(efficiency.value_lo, efficiency.value_hi, efficiency.uniform,
                 efficiency.estimator.starts_with("exact"));
}

Headline over_runs(const LevelSummary& level, SampleRole role) {
  Figure FigurePair::*const part = role == SampleRole::tree ? &FigurePair::tree : &FigurePair::expansion;
  const Figure& figure = (level.root_cross.*part).scored > 0 ? level.root_cross.*part : level.root.*part;
  Headline result{.above = above_uniform(figure),
                  .uniform = figure["D_uniform"].value,
                  .perfect = figure["D_perfect"].value,
                  .mass = figure["SE_parts.mass"].value,
                  .runs = figure.scored};
  for (const auto& [flag, runs] : figure.flags) {
    if (2 * runs >= figure.scored) result.flags.push_back(flag);
  }
  return result;
}

Headline headline(const LevelSummary& level, SampleRole role) {
  Headline result = over_runs(level, role);
  if (!level.pooled || level.pooled->seeds + 1 < least_for_interval) return result;
  const Efficiency& together = role == SampleRole::tree ? level.pooled->tree : level.pooled->expansion;
  if (std::isnan(together.value)) return result;
  return {.above = above_uniform(together),
          .uniform = together.uniform,
          .perfect = together.perfect,
          .mass = shown(together).parts.mass,
          .flags = together.flags,
          .seeds = level.pooled->seeds + 1,
          .runs = result.runs};
}

Hitting hitting_of(const LevelSummary& level, SampleRole role, bool* own) {
  if (own != nullptr) *own = false;
  if (level.pooled) {
    const Efficiency& together = role == SampleRole::tree ? level.pooled->tree : level.pooled->expansion;
    if (!std::isnan(together.hitting.position.hitting)) return together.hitting;
  }
  Figure FigurePair::*const part = role == SampleRole::tree ? &FigurePair::tree : &FigurePair::expansion;
  const bool cross = !std::isnan((level.root_cross.*part)["hitting.nats"].value);
  if (own != nullptr) *own = !cross;
  const Figure& figure = (cross ? level.root_cross : level.root).*part;
  Hitting result;
  const auto over_runs = [](const Interval& interval, BallHits& hits) {
    hits.hitting = interval.value;
    hits.hitting_lo = interval.lo;
    hits.hitting_hi = interval.hi;
  };
  over_runs(figure["hitting.nats"], result.position);
  over_runs(figure["hitting.full"], result.full);
  result.samples = figure["hitting.N"].value;
  // Places on several paths have no mean.
  const Figure& alone = level.root.*part;
  if (level.runs != 1) return result;
  result.position.bottleneck = alone["bottleneck.nats"].value;
  result.position.bottleneck_lo = alone["bottleneck.lo"].value;
  result.position.bottleneck_hi = alone["bottleneck.hi"].value;
  result.position.at = alone["bottleneck.at"].value;
  result.full.bottleneck = alone["bottleneck.full"].value;
  result.full.bottleneck_lo = alone["bottleneck.full_lo"].value;
  result.full.bottleneck_hi = alone["bottleneck.full_hi"].value;
  result.full.at = alone["bottleneck.full_at"].value;
  result.length = alone["bottleneck.length"].value;
  return result;
}

bool disagree(const AboveUniform& a, const AboveUniform& b) {
  constexpr double visible = 0.005;  // half of the last printed digit
  return a.printed() && b.printed() && (a.hi < b.lo - visible || b.hi < a.lo - visible);
}

RunsSummary summarise(std::span<const RunFacts* const> runs) {
  RunsSummary result;
  result.runs = runs.size();
  std::vector<CensoredCost> first_path;
  std::vector<double> improvement;
  std::vector<double> set_up;
  double lua = 0.0;
  double cpu = 0.0;
  std::vector<double> work;
  std::vector<CensoredCost> validity;
  std::vector<CensoredCost> motion;
  std::vector<CensoredCost> seconds;
  std::vector<double> length;
  std::vector<double> makespan;
  std::vector<double> sum_of_costs;
  // By key: a run that ended early may lack the deeper levels.
  std::map<std::vector<std::uint64_t>, Levels> levels;
  for (const auto* run : runs) {
    first_path.push_back(path_cost(*run));
    if (run->solved && is_anytime(*run)) {
      improvement.push_back(static_cast<double>(run->improvement_checks));
    }
    set_up.push_back(run->set_up);
    result.set_up_seconds = std::max(result.set_up_seconds, run->set_up_seconds + run->shared_set_up_seconds);
    if (!std::isnan(run->queries)) result.queries = run->queries;
    work.push_back(run->work);
    validity.push_back({static_cast<double>(run->validity_checks), run->solved});
    motion.push_back({static_cast<double>(run->motion_checks), run->solved});
    seconds.push_back({run->seconds, run->solved});
    lua += run->lua_seconds;
    cpu += run->cpu_seconds;
    if (run->solved) {
      ++result.solved;
      length.push_back(run->length);
      if (run->times) {
        makespan.push_back(run->times->makespan);
        sum_of_costs.push_back(run->times->sum_of_costs);
      }
    }
    for (const auto& level : run->levels) levels[parse_key(level.key)].push_back(&level);
  }
  result.success = wilson_interval(result.solved, result.runs);
  result.validity_checks = median_cost(first_path);
  result.improvement_checks = median(improvement);
  result.set_up = median(set_up);
  if (const double all = median(work); all > 0.0) result.set_up_share = result.set_up / all;
  if (cpu > 0.0) result.lua_share = lua / cpu;
  result.motion_checks = median_cost(motion);
  result.seconds = median_cost(seconds);
  result.spent_validity_checks = median_spent(validity);
  result.spent_motion_checks = median_spent(motion);
  result.spent_seconds = median_spent(seconds);
  result.length = student_interval(length);
  result.makespan = student_interval(makespan);
  result.sum_of_costs = student_interval(sum_of_costs);

  std::map<std::vector<std::uint64_t>, int> index;
  for (const auto& [key, group] : levels) {
    index.emplace(key, static_cast<int>(result.levels.size()));
    result.levels.push_back(summarise_level(group));
    std::vector<std::uint64_t> parent = key;
    while (!parent.empty() && result.levels.back().parent < 0) {
      parent.pop_back();
      const auto above = index.find(parent);
      if (above != index.end()) result.levels.back().parent = above->second;
    }
  }
  add_shares(runs, result.levels);
  result.beside = summarise_beside(runs);
  add_waterfalls(result);
  return result;
}

RunsSummary summarise(const RunFacts& run) {
  const RunFacts* one = &run;
  return summarise({&one, 1});
}

namespace {

/// Adds the guides without a level, with their shares of the proposals.
void add_parts(const std::vector<const RunFacts*>& runs, std::vector<LevelSummary>& levels) {
  for (std::size_t i = 0; i < levels.size(); ++i) {
    std::vector<std::string> other = {"goal", "uniform", "informed path"};
    for (const LevelSummary& one : levels) {
      if (one.parent == static_cast<int>(i)) other.push_back(one.name);
    }
    std::vector<PartSummary>& parts = levels[i].parts;
    double all = 0.0;
    for (const RunFacts* run : runs) {
      for (const LevelFacts& one : run->levels) {
        if (one.key != levels[i].key) continue;
        for (const auto& source : one.sources) {
          const std::string& name = source.first;
          const auto proposals = static_cast<double>(source.second);
          all += proposals;
          if (std::find(other.begin(), other.end(), name) != other.end()) continue;
          auto part =
              std::find_if(parts.begin(), parts.end(), [&](const PartSummary& known) { return known.name == name; });
          if (part == parts.end()) part = parts.insert(parts.end(), {name, 0.0});
          part->share += proposals;
        }
      }
    }
    for (PartSummary& part : parts) part.share = all > 0.0 ? part.share / all : 0.0;
  }
}

/// Adds the obstacles that rejected each level's proposals.
void add_rejections(const std::vector<const RunFacts*>& runs, std::vector<LevelSummary>& levels) {
  for (LevelSummary& level : levels) {
    std::map<std::string, std::size_t> by;
    for (const RunFacts* run : runs) {
      for (const LevelFacts& one : run->levels) {
        if (one.key != level.key || !one.rejections) continue;
        level.rejections.proposals += one.proposals;
        level.rejections.rejected += one.rejections->rejected;
        level.rejections.examined += one.rejections->examined;
        for (const auto& [name, count] : one.rejections->by) by[name] += count;
      }
    }
    level.rejections.by.assign(by.begin(), by.end());
    std::stable_sort(level.rejections.by.begin(), level.rejections.by.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
  }
}

CertifiedSummary summarise_certified(std::span<const RunFacts* const> runs) {
  CertifiedSummary result;
  for (const RunFacts* run : runs) {
    if (!run->certified) continue;
    ++result.paths;
    if (result.paths > 1 && !(run->clearance < result.clearance)) continue;
    result.clearance = run->clearance;
    result.seed = run->seed;
  }
  return result;
}

}  // namespace

RunsSummary summarise(const ExperimentFacts& experiment, const std::string& problem, const std::string& strategy) {
  const std::vector<const RunFacts*> runs = experiment.select(problem, strategy);
  RunsSummary summary = summarise(runs);
  add_parts(runs, summary.levels);
  add_rejections(runs, summary.levels);
  summary.certified = summarise_certified(runs);
  for (LevelSummary& level : summary.levels) {
    std::vector<Efficiency> tree;
    std::vector<Efficiency> expansion;
    PooledSummary pooled;
    for (const PooledScores& one : experiment.pooled) {
      if (one.strategy != strategy || one.key != level.key || (!problem.empty() && one.problem != problem)) continue;
      tree.push_back(one.scores.tree);
      expansion.push_back(one.scores.expansion);
      pooled.seeds = tree.size() == 1 ? one.seeds : std::min(pooled.seeds, one.seeds);
      pooled.targets += one.targets;
    }
    if (tree.empty()) continue;
    pooled.tree = mean(tree);
    pooled.expansion = mean(expansion);
    for (Efficiency* one : {&pooled.tree, &pooled.expansion}) {
      if (tree.size() == 1) continue;
      // Paths of several problems have no common place.
      one->hitting = {{.hitting = one->hitting.position.hitting}, {.hitting = one->hitting.full.hitting}};
    }
    level.pooled = std::move(pooled);
  }
  add_waterfalls(summary);
  return summary;
}

namespace {

/// On one problem, or "" on all, without correction.
std::vector<Comparison> compare_on(const ExperimentFacts& experiment, const std::string& problem) {
  std::vector<Comparison> comparisons;
  if (experiment.strategies.size() < 2) return comparisons;
  const std::string common = experiment.baseline();
  for (const StrategyFacts& strategy : experiment.strategies) {
    const std::string& name = strategy.name;
    Comparison c;
    c.problem = problem;
    c.strategy = name;
    c.baseline = strategy.ablation.empty() ? common : strategy.of;
    c.text = strategy.ablation;
    if (c.baseline == name || c.baseline.empty()) continue;
    const auto mine = experiment.select(problem, name);
    const auto theirs = experiment.select(problem, c.baseline);
    if (mine.size() != theirs.size()) continue;
    const auto costs = [](const std::vector<const RunFacts*>& runs) {
      std::vector<CensoredCost> list;
      list.reserve(runs.size());
      for (const RunFacts* run : runs) list.push_back(path_cost(*run));
      return list;
    };
    const auto values = [](const std::vector<const RunFacts*>& runs, auto field) {
      std::vector<double> list;
      list.reserve(runs.size());
      for (const RunFacts* run : runs) list.push_back(field(*run));
      return list;
    };
    const auto both = [&](auto field) { return paired(values(theirs, field), values(mine, field)); };
    c.solved = both([](const RunFacts& r) { return r.solved ? 1.0 : 0.0; });
    c.validity_checks = paired_costs(costs(mine), costs(theirs));
    c.solved.difference =
        newcombe_interval({c.validity_checks.solved, mine.size()}, {c.validity_checks.reference_solved, theirs.size()});
    const auto crossed = [](const RunFacts* r) {
      return !r->levels.empty() && r->levels.front().scores && r->levels.front().scores->root_cross;
    };
    c.cross = std::any_of(mine.begin(), mine.end(), crossed) && std::any_of(theirs.begin(), theirs.end(), crossed);
    const auto efficiency = [&](Role role, double Estimate::*quantity) {
      return both([&](const RunFacts& r) {
        if (r.levels.empty()) return nan;
        const Efficiency* e = r.levels.front().score(c.cross ? &LevelScores::root_cross : &LevelScores::root, role);
        return e != nullptr ? e->*quantity : nan;
      });
    };
    c.tree_above = efficiency(&Scores::tree, &Estimate::above_uniform);
    c.expansion_above = efficiency(&Scores::expansion, &Estimate::above_uniform);
    c.tree = efficiency(&Scores::tree, &Estimate::value);
    c.expansion = efficiency(&Scores::expansion, &Estimate::value);
    comparisons.push_back(std::move(c));
  }
  return comparisons;
}

/// Corrects the p values of one quantity; `any` returns whether a comparison has it.
template <class Quantity, class Any>
void correct(std::vector<Comparison>& comparisons, Quantity quantity, Any any) {
  std::vector<double> p;
  p.reserve(comparisons.size());
  for (Comparison& c : comparisons) p.push_back(any(quantity(c)) ? quantity(c).sign_p : nan);
  p = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isnan(p[i])) quantity(comparisons[i]).holm_p = p[i];
  }
}

}  // namespace

std::vector<Comparison> compare(const ExperimentFacts& experiment, bool together) {
  std::vector<Comparison> shown;
  if (together) {
    shown = compare_on(experiment, "");
  } else {
    for (const ProblemFacts& one : experiment.problems) {
      auto found = compare_on(experiment, one.name);
      shown.insert(shown.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
    }
  }
  const auto has_pairs = [](const Paired& p) { return p.less + p.greater + p.equal > 0; };
  correct(
      shown, [](Comparison& c) -> PairedCosts& { return c.validity_checks; },
      [](const PairedCosts& p) { return p.pairs > 0; });
  correct(
      shown, [](Comparison& c) -> Paired& { return c.solved; }, has_pairs);
  for (Paired Comparison::*quantity :
       {&Comparison::tree_above, &Comparison::expansion_above, &Comparison::tree, &Comparison::expansion}) {
    correct(
        shown, [quantity](Comparison& c) -> Paired& { return c.*quantity; }, has_pairs);
  }
  return shown;
}

std::vector<std::string> level_labels(const std::vector<LevelSummary>& levels) {
  const std::size_t digits = fmt::format("{}", levels.size()).size();
  const auto last_child = [&](std::size_t i) {
    return std::none_of(levels.begin() + static_cast<std::ptrdiff_t>(i) + 1, levels.end(),
                        [&](const LevelSummary& other) { return other.parent == levels[i].parent; });
  };
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    std::string branches;
    for (int at = static_cast<int>(i); at >= 0 && levels[static_cast<std::size_t>(at)].parent >= 0;
         at = levels[static_cast<std::size_t>(at)].parent) {
      const bool last = last_child(static_cast<std::size_t>(at));
      const bool self = at == static_cast<int>(i);
      branches.insert(0, self ? (last ? "└ " : "├ ") : (last ? "  " : "│ "));
    }
    labels.push_back(fmt::format("{:>{}} {}{}", i, digits, branches, levels[i].name));
  }
  return labels;
}

std::string set_up_text(const std::vector<const RunsSummary*>& strategies) {
  const RunsSummary* largest = nullptr;
  double ms = 0.0;
  for (const RunsSummary* one : strategies) {
    if (!(one->set_up_share > least_set_up_share) || std::isnan(one->queries)) continue;
    // The strategy that ran first has computed it for all.
    ms = std::max(ms, 1000.0 * one->set_up_seconds);
    if (largest == nullptr || one->set_up > largest->set_up) largest = one;
  }
  if (largest == nullptr) return "";
  const std::string cost =
      fmt::format("set-up: {:.0f} units of work, {} ms", largest->set_up, fixed(ms, ms < 10.0 ? 1 : 0));
  if (largest->queries <= 1.0) return cost + ", in each run (queries = 1)";
  return fmt::format("{}, once per world; shared by {:g} queries, by assumption", cost, largest->queries);
}

std::string beside_text(const RunsSummary& summary) {
  const BesideSummary& beside = summary.beside;
  if (beside.runs == 0 || summary.levels.empty()) return "";
  const auto runs = [&](std::size_t n) {
    if (n < beside.runs) return fmt::format("{} of {}", n, plural(beside.runs, "run"));
    return std::string(n == 1 ? "the run" : "all runs");
  };
  std::string text = fmt::format("{} without guides, beside the guided search: {:.0f} % of the work",
                                 summary.levels.front().planner, 100.0 * beside.unguided_share);
  if (beside.unguided_won > 0) text += fmt::format("; it found the path in {}", runs(beside.unguided_won));
  if (beside.not_set_up > 0) {
    text += fmt::format("; the guides were not set up in {}, where it had not done as much work as that costs",
                        runs(beside.not_set_up));
  }
  if (beside.no_guided > 0) text += fmt::format("; the guides drew no proposal in {}", runs(beside.no_guided));
  const RunCost& step = beside.largest_step;
  if (step.checks > companion_step.checks || step.work > companion_step.work) {
    text += fmt::format("; one call of a function of the script costs up to {:.0f} checks and {:.0f} units of work",
                        step.checks, step.work);
  }
  if (beside.certificate_checks > 0.0) {
    text += fmt::format("; the certificate of a path, outside of the bound: {:.0f} checks", beside.certificate_checks);
  }
  return text;
}

}  // namespace trellis

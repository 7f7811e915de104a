// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/search_metrics.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/base/random.hpp>
#include <trellis/measure/low_discrepancy.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

namespace {

/// Configurations tried for each requested witness: with validity rarer than one in as many, witnesses are missing.
constexpr std::size_t tries_per_witness = 64;

/// Quasi-random configurations of a space.
class Uniform {
 public:
  Uniform(const Space& space, std::uint64_t seed, const char* purpose)
      : space_(space), unit_(space.degrees()), sequence_(space.degrees(), shift(space.degrees(), seed, purpose)) {}

  void next(MutableView q) {
    sequence_.next(unit_);
    space_.from_unit(unit_, q);
  }

 private:
  static std::vector<double> shift(std::size_t dimension, std::uint64_t seed, const char* purpose) {
    Stream stream(seed, "", purpose);
    std::vector<double> result(dimension);
    for (double& x : result) x = stream.uniform();
    return result;
  }

  const Space& space_;
  std::vector<double> unit_;
  measure::LowDiscrepancy sequence_;
};

/// The connected components of a growing graph.
class Components {
 public:
  std::uint32_t add() {
    above_.push_back(static_cast<std::uint32_t>(above_.size()));
    ++count_;
    return above_.back();
  }
  [[nodiscard]] std::uint32_t of(std::uint32_t id) {
    while (above_[id] != id) id = above_[id] = above_[above_[id]];
    return id;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = of(a);
    b = of(b);
    if (a == b) return;
    above_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::vector<std::uint32_t> above_;
  std::size_t count_ = 0;
};

class InducedRoadmap {
 public:
  InducedRoadmap(const Space& space, Configurations witnesses, const std::function<bool(View)>& valid,
                 const std::function<bool(View, View)>& valid_motion, std::size_t neighbours)
      : valid_(valid),
        valid_motion_(valid_motion),
        neighbours_(neighbours),
        nodes_(space),
        arena_(space.dimension()),
        witnesses_(std::move(witnesses)),
        witness_index_(space),
        seers_(witnesses_.size()) {
    for (std::size_t w = 0; w < witnesses_.size(); ++w) witness_index_.add(std::as_const(witnesses_)[w]);
  }

  NodeClass add(View q) {
    if (!valid_(q)) return NodeClass::invalid;
    nodes_.k_nearest(q, neighbours_, near_);
    if (!near_.empty() && near_.front().squared_distance == 0.0) return NodeClass::oversample;
    const std::uint32_t id = components_.add();
    nodes_.add(q);
    arena_.push(q);
    std::size_t joined = 0;
    for (const auto& other : near_) {
      if (components_.of(other.id) == components_.of(id)) continue;
      if (!valid_motion_(std::as_const(arena_)[other.id], q)) continue;
      components_.join(other.id, id);
      ++joined;
    }
    const bool news = look_for_witnesses(id, q);
    if (joined == 0) return NodeClass::create;
    if (joined > 1) return NodeClass::merge;
    return news ? NodeClass::expand : NodeClass::oversample;
  }

  [[nodiscard]] std::size_t components() const { return components_.count(); }

  [[nodiscard]] double coverage() const {
    if (witnesses_.empty()) return SearchMetrics::none;
    const auto seen = std::count_if(seers_.begin(), seers_.end(), [](const auto& s) { return !s.empty(); });
    return static_cast<double>(seen) / static_cast<double>(seers_.size());
  }

  [[nodiscard]] double connectivity() {
    const std::size_t n = seers_.size();
    if (n < 2) return SearchMetrics::none;
    for (auto& seers : seers_) {
      for (auto& seer : seers) seer = components_.of(seer);
      std::sort(seers.begin(), seers.end());
    }
    std::size_t pairs = 0;
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = a + 1; b < n; ++b) {
        const auto shared = std::find_first_of(seers_[a].begin(), seers_[a].end(), seers_[b].begin(), seers_[b].end());
        if (shared != seers_[a].end()) ++pairs;
      }
    }
    return static_cast<double>(pairs) / (0.5 * static_cast<double>(n) * static_cast<double>(n - 1));
  }

 private:
  /// Whether a new node sees a witness that no earlier node sees.
  bool look_for_witnesses(std::uint32_t id, View q) {
    bool news = false;
    witness_index_.k_nearest(q, neighbours_, near_);
    for (const auto& witness : near_) {
      auto& seers = seers_[witness.id];
      const auto mine = [&](std::uint32_t seer) { return components_.of(seer) == components_.of(id); };
      if (std::any_of(seers.begin(), seers.end(), mine)) continue;
      if (!valid_motion_(q, std::as_const(witnesses_)[witness.id])) continue;
      news = news || seers.empty();
      seers.push_back(id);
    }
    return news;
  }

  const std::function<bool(View)>& valid_;
  const std::function<bool(View, View)>& valid_motion_;
  std::size_t neighbours_;
  NearestIndex nodes_;  ///< the valid nodes, one per position
  Configurations arena_;
  Components components_;
  Configurations witnesses_;
  NearestIndex witness_index_;
  std::vector<std::vector<std::uint32_t>> seers_;  ///< of each witness: nodes of the different components that see it
  std::vector<NearestIndex::Neighbour> near_;
};

/// Returns log 2 minus the mean log loss of predicting validity from the nearest labelled samples.
double information(const Space& space, const Configurations& samples, const std::vector<char>& labels,
                   const std::function<bool(View)>& valid, const SearchMetricsSettings& settings, std::uint64_t seed) {
  if (samples.empty() || settings.witnesses == 0) return SearchMetrics::none;
  NearestIndex index(space);
  std::vector<char> known;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    poll();
    if (index.size() > 0 && index.nearest(samples[i]).squared_distance == 0.0) continue;
    index.add(samples[i]);
    known.push_back(labels[i]);
  }
  Uniform uniform(space, seed, "information witnesses");
  Configuration q(space.dimension());
  std::vector<NearestIndex::Neighbour> near;
  double loss = 0.0;
  for (std::size_t w = 0; w < settings.witnesses; ++w) {
    poll();
    uniform.next(q);
    index.k_nearest(q, settings.model_neighbours, near);
    const bool is_valid = valid(q);
    const auto agree = std::count_if(near.begin(), near.end(),
                                     [&](const auto& sample) { return (known[sample.id] != 0) == is_valid; });
    loss -= std::log((static_cast<double>(agree) + 1.0) / (static_cast<double>(near.size()) + 2.0));
  }
  return std::numbers::ln2 - loss / static_cast<double>(settings.witnesses);
}

}  // namespace

Configurations valid_witnesses(const Space& space, const std::function<bool(View)>& valid, std::size_t count,
                               std::uint64_t seed) {
  Configurations witnesses(space.dimension());
  Uniform uniform(space, seed, "roadmap witnesses");
  Configuration q(space.dimension());
  for (std::size_t i = 0; i < count * tries_per_witness && witnesses.size() < count; ++i) {
    poll();
    uniform.next(q);
    if (valid(q)) witnesses.push(q);
  }
  return witnesses;
}

SearchMetrics search_metrics(const Space& space, const Search& search, const std::function<bool(View)>& valid,
                             const std::function<bool(View, View)>& valid_motion, const SearchMetricsSettings& settings,
                             std::uint64_t seed) {
  SearchMetrics result;
  if (!search.nodes.empty()) {
    InducedRoadmap roadmap(space, valid_witnesses(space, valid, settings.witnesses, seed), valid, valid_motion,
                           settings.neighbours);
    result.classes.reserve(search.nodes.size());
    for (std::size_t i = 0; i < search.nodes.size(); ++i) {
      poll();
      result.classes.push_back(roadmap.add(search.nodes[i]));
      ++result.nodes[static_cast<std::size_t>(result.classes.back())];
    }
    result.components = roadmap.components();
    result.coverage = roadmap.coverage();
    result.connectivity = roadmap.connectivity();
  }
  const std::size_t n = search.proposals.size();
  if (n == 0) return result;

  std::vector<char> labels(n);
  for (std::size_t i = 0; i < n; ++i) {
    poll();
    labels[i] = valid(search.proposals[i]) ? 1 : 0;
  }
  result.information = information(space, search.proposals, labels, valid, settings, seed);
  result.information_per_sample = result.information / static_cast<double>(n);

  std::size_t invalid = 0;
  std::size_t trapped = 0;
  std::size_t redundant = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (labels[i] == 0) {
      ++invalid;
    } else if (search.fates[i] == Fate::rejected) {
      ++trapped;
    } else if (search.added[i] != no_node && result.classes[search.added[i]] == NodeClass::oversample) {
      ++redundant;
    }
  }
  const auto share = [&](std::size_t count) { return static_cast<double>(count) / static_cast<double>(n); };
  result.invalid = share(invalid);
  result.trapped = share(trapped);
  result.redundant = share(redundant);
  result.useful = share(n - invalid - trapped - redundant);
  return result;
}

}  // namespace trellis

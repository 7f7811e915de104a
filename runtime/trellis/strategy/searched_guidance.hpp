// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/planner/composed.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

class Level;
struct Run;

/// The result of a search with a limited slice.
enum class Advance : std::uint8_t {
  unfinished,  ///< it spent the slice and can continue
  found,       ///< it found a path, or there is nothing to search
  nothing,     ///< it ended without a path
};

/// Limits of a search before it pauses.
struct Slice {
  double proposals = std::numeric_limits<double>::infinity();  ///< for each level
  double work = std::numeric_limits<double>::infinity();       ///< for a level and all below it, see `Level::work`
};

/// Limits of one call of Level::advance.
struct Grant {
  double solve = std::numeric_limits<double>::infinity();  ///< proposals of this solve, all its slices together
  Slice slice = {};                                        ///< of this call
};

/// A part of h that searches a space S.
class GuideSearch {
 public:
  GuideSearch() = default;
  GuideSearch(const GuideSearch&) = delete;
  GuideSearch& operator=(const GuideSearch&) = delete;
  virtual ~GuideSearch() = default;

  /// Applies f where the instance in S is out of date, and reports to the level below what was learnt in C.
  /// \return whether the level below is searched now: not where the slice is spent, or the run ends
  virtual bool project() = 0;
  /// The level of S.
  [[nodiscard]] virtual Level& level() = 0;
  /// What it may spend now.
  [[nodiscard]] virtual Grant grant() = 0;
  /// Makes h of what the level found.
  virtual void learn(Advance advance) = 0;
};

/// The results of a guidance so far, in the space of the level that it guides.
struct Finding {
  Configurations path;     ///< current guiding path; empty if none
  Configurations refuted;  ///< places that evidence refuted
};

/// A guidance whose level searches the levels below before it draws, and that accepts the findings of other guidances.
class SearchedGuidance : public Guidance {
 public:
  /// Called before every proposal: then `needs_search` may return searches, each of which is to be advanced.
  /// \param slice  what the searches may spend before the proposal
  virtual void begin(const Slice& slice) { static_cast<void>(slice); }
  /// The next search before h may draw: the first time, or after h was refuted. nullptr: none.
  [[nodiscard]] virtual GuideSearch* needs_search() { return nullptr; }
  /// Whether h may draw, once there is no such search: not while it is `unfinished`.
  [[nodiscard]] virtual Advance ready() const { return Advance::found; }
  /// Whether parts of it draw while the space of another part is searched.
  [[nodiscard]] virtual bool draws_while_searching() const { return false; }
  /// Work of all levels below, as this level counts it (Level::work).
  [[nodiscard]] virtual double work() const { return 0.0; }
  /// How often h was refuted; with several searching parts, the minimum over them.
  [[nodiscard]] virtual std::uint64_t refuted() const { return 0; }
  /// Whether h is permanently refuted: no further solves are left.
  [[nodiscard]] virtual bool spent() const { return false; }
  /// Whether it searches a space. If not, it is never refuted.
  [[nodiscard]] virtual bool searches() const { return false; }
  /// The current guiding path in this level's space; empty if none.
  [[nodiscard]] virtual Configurations guiding_path() const { return {}; }
  /// Places in this level's space that evidence refuted.
  [[nodiscard]] virtual Configurations refuted_places() const { return {}; }
  /// Adds the current guiding paths of all its guides, in this level's space.
  virtual void add_paths(std::vector<Known::Path>& paths) const { static_cast<void>(paths); }
  [[nodiscard]] Finding finding() const { return {guiding_path(), refuted_places()}; }
  /// Passes the findings of another guidance of this level to the searches below: they follow its path and exclude the
  /// refuted places.
  virtual void inform(const Finding& finding) { static_cast<void>(finding); }
  /// Called before any search if `inform` may be called.
  virtual void expect_findings() {}
  /// Called with a place that this level excluded because a level above refuted it.
  virtual void lost(View place) { static_cast<void>(place); }
  /// Called with a configuration found invalid, if this level presumes validity.
  virtual void found_invalid(View q) { static_cast<void>(q); }
};

/// Shared by combinators: several parts, of which one draws each proposal.
class PartsGuidance : public Composed<SearchedGuidance> {
 public:
  explicit PartsGuidance(std::vector<std::unique_ptr<SearchedGuidance>> parts) : parts_(std::move(parts)) {
    std::size_t count = 0;
    for (const auto& part : parts_) {
      first_source_.push_back(static_cast<Source>(count));
      count += part->sources().size();
    }
  }
  [[nodiscard]] double work() const override {
    double sum = 0.0;
    for (const auto& part : parts_) sum += part->work();
    return sum;
  }
  [[nodiscard]] std::uint64_t refuted() const override {
    std::optional<std::uint64_t> least;
    for (const auto& part : parts_) {
      if (part->searches()) least = std::min(least.value_or(part->refuted()), part->refuted());
    }
    return least.value_or(0);
  }
  [[nodiscard]] bool spent() const override {
    return searches() && std::all_of(parts_.begin(), parts_.end(),
                                     [](const auto& part) { return !part->searches() || part->spent(); });
  }
  [[nodiscard]] bool searches() const override {
    return std::any_of(parts_.begin(), parts_.end(), [](const auto& part) { return part->searches(); });
  }
  [[nodiscard]] Configurations refuted_places() const override {
    Configurations all;
    for (const auto& part : parts_) {
      Configurations places = part->refuted_places();
      if (all.empty()) {
        all = std::move(places);
        continue;
      }
      for (std::size_t i = 0; i < places.size(); ++i) all.push(std::as_const(places)[i]);
    }
    return all;
  }
  void add_paths(std::vector<Known::Path>& paths) const override {
    for (const auto& part : parts_) part->add_paths(paths);
  }
  void inform(const Finding& finding) override {
    for (auto& part : parts_) part->inform(finding);
  }
  void expect_findings() override {
    for (auto& part : parts_) part->expect_findings();
  }
  void lost(View place) override {
    for (auto& part : parts_) part->lost(place);
  }
  void found_invalid(View q) override {
    for (auto& part : parts_) part->found_invalid(q);
  }

 protected:
  Source draw(Stream& stream, MutableView out) {
    return static_cast<Source>(first_source_[drawn_] + parts_[drawn_]->sample(stream, out));
  }

  [[nodiscard]] std::size_t part_count() const override { return parts_.size(); }
  [[nodiscard]] Guidance* part_at(std::size_t i) const override { return parts_[i].get(); }
  [[nodiscard]] Guidance* drew_last() const override { return parts_[drawn_].get(); }

  std::vector<std::unique_ptr<SearchedGuidance>> parts_;
  std::size_t drawn_ = 0;

 private:
  std::vector<Source> first_source_;
};

/// The searches of all parts, one part after another: each gets the whole slice.
class AllInTurn {
 public:
  using Parts = std::vector<std::unique_ptr<SearchedGuidance>>;

  void begin(const Slice& slice, const Parts& parts) {
    slice_ = slice;
    at_ = 0;
    parts.front()->begin(slice_);
  }
  [[nodiscard]] GuideSearch* needs_search(const Parts& parts) {
    while (at_ < parts.size()) {
      if (GuideSearch* next = parts[at_]->needs_search()) return next;
      if (++at_ < parts.size()) parts[at_]->begin(slice_);
    }
    return nullptr;
  }
  /// `unfinished` if no part is ready, `found` if a part has a path.
  [[nodiscard]] Advance ready(const Parts& parts) const {
    Advance best = Advance::unfinished;
    for (const auto& part : parts) {
      const Advance ready = part->ready();
      if (best != Advance::found && ready != Advance::unfinished) best = ready;
    }
    return best;
  }

 private:
  Slice slice_;
  std::size_t at_ = 0;  ///< the part that has its turn
};

/// These functions combine guides. A mixture's weights are those of its terms.
std::unique_ptr<SearchedGuidance> make_mixture(const std::vector<double>& weights,
                                               std::vector<std::unique_ptr<SearchedGuidance>> parts);
std::unique_ptr<SearchedGuidance> make_sequence(const SequenceSettings& settings,
                                                std::vector<std::unique_ptr<SearchedGuidance>> parts);
std::unique_ptr<SearchedGuidance> make_blend(const BlendSettings& settings, const Instance& instance,
                                             std::vector<std::unique_ptr<SearchedGuidance>> parts);
std::unique_ptr<SearchedGuidance> make_schedule(const ScheduleSettings& settings,
                                                std::vector<std::unique_ptr<SearchedGuidance>> parts);
std::unique_ptr<SearchedGuidance> make_race(const RaceSettings& settings,
                                            std::vector<std::unique_ptr<SearchedGuidance>> parts);
/// Makes the guidance of a component, with the levels below it.
/// \param key  location in the hierarchy
std::unique_ptr<SearchedGuidance> make_component(Run& run, Level& level, const GuideSpec& spec, const std::string& key);
/// Makes the guidance of a level, with the levels below it.
std::unique_ptr<SearchedGuidance> make_guidance(Run& run, Level& level, const GuideSpec& spec);
/// Estimates the work of setting up guides and their own guides, in units of search_cost, before it is done.
/// \param scene  of the root
/// \param queries  runs that share what is set up for the world
double set_up_work(const GuideSpec& guides, const Scene& scene, double queries);

}  // namespace trellis

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>
#include <utility>

#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

namespace {

/// Guides whose spaces are searched alternately by growing slices (RaceSettings). The first part that finds a path
/// becomes the leader: it guides, and the other searches pause, until it is refuted. Then the race continues, starting
/// with the next part. If all searches end without a path, the first part with a path to its node nearest to the goal
/// guides.
class RaceGuidance final : public PartsGuidance {
 public:
  RaceGuidance(const RaceSettings& settings, std::vector<std::unique_ptr<SearchedGuidance>> parts)
      : PartsGuidance(std::move(parts)), slice_(static_cast<double>(settings.slice)), out_(parts_.size(), false) {}

  void begin(const Slice& slice) override {
    given_ = slice;
    searched_ = worked_ = 0.0;
    racing_ = !(led_ && (parts_[drawn_]->refuted() == begun_ || over()));
    if (!racing_) {
      parts_[drawn_]->begin(slice);
      return;
    }
    if (led_ && !resumed_) {
      resumed_ = true;
      turn_ = (drawn_ + 1) % parts_.size();
    }
    next_runner();
  }
  [[nodiscard]] GuideSearch* needs_search() override {
    if (!racing_) return parts_[drawn_]->needs_search();
    while (runner_) {
      if (GuideSearch* next = parts_[*runner_]->needs_search()) return next;
      end_turn();
    }
    return nullptr;
  }
  [[nodiscard]] Advance ready() const override { return racing_ ? ready_ : parts_[drawn_]->ready(); }
  Source sample(Stream& stream, MutableView out) override { return draw(stream, out); }
  /// The race counts as refuted only if its leader is refuted and no other part can lead.
  [[nodiscard]] std::uint64_t refuted() const override { return over() ? parts_[drawn_]->refuted() - begun_ : 0; }
  [[nodiscard]] bool spent() const override { return over() && parts_[drawn_]->spent(); }

  [[nodiscard]] std::uint64_t epoch() const override { return leaders_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double share) const override { parts_[drawn_]->record(record, share); }
  [[nodiscard]] Configurations guiding_path() const override { return parts_[drawn_]->guiding_path(); }

 private:
  /// Whether no other part can become the leader.
  [[nodiscard]] bool over() const {
    for (std::size_t i = 0; i < out_.size(); ++i) {
      if (i != drawn_ && !out_[i]) return false;
    }
    return led_;
  }

  /// Begins the turn of the next part, or ends the race for this proposal.
  void next_runner() {
    runner_.reset();
    while (std::find(out_.begin(), out_.end(), false) != out_.end()) {
      ready_ = Advance::unfinished;
      if (searched_ >= given_.proposals || worked_ >= given_.work) return;
      const std::size_t part = turn_;
      const double slice = slice_;
      turn_ = (turn_ + 1) % parts_.size();
      if (turn_ == 0) slice_ *= 2.0;
      if (out_[part]) continue;
      runner_ = part;
      runs_ = slice;
      before_ = parts_[part]->work();
      parts_[part]->begin({slice, given_.work - worked_});
      return;
    }
    ready_ = Advance::nothing;
    if (led_) return;
    std::size_t best = 0;
    while (best + 1 < parts_.size() && parts_[best]->guiding_path().empty()) ++best;
    lead(parts_[best]->guiding_path().empty() ? 0 : best);
  }
  /// Ends the turn of a part: it becomes the leader, or the next one has its turn.
  void end_turn() {
    const std::size_t part = *runner_;
    const Advance advance = parts_[part]->ready();
    searched_ += runs_;
    worked_ += parts_[part]->work() - before_;
    if (advance == Advance::found && !parts_[part]->spent()) {
      lead(part);
      ready_ = advance;
      runner_.reset();
      return;
    }
    // A permanently refuted part keeps its path, which may still guide, but cannot become the leader again.
    if (advance != Advance::unfinished) out_[part] = true;
    next_runner();
  }
  void lead(std::size_t part) {
    led_ = true;
    resumed_ = false;
    ++leaders_;
    drawn_ = part;
    begun_ = parts_[part]->refuted();
  }

  double slice_;                       ///< of the current round
  Slice given_;                        ///< for this proposal
  double searched_ = 0.0;              ///< of it, proposals
  double worked_ = 0.0;                ///< of it, work
  bool racing_ = true;                 ///< no leader draws this proposal yet
  std::optional<std::size_t> runner_;  ///< the part that has its turn
  double runs_ = 0.0;                  ///< its slice
  double before_ = 0.0;                ///< its work before
  Advance ready_ = Advance::unfinished;
  std::size_t turn_ = 0;       ///< part to search next
  std::vector<bool> out_;      ///< parts that cannot become the leader again
  bool led_ = false;           ///< there is a leader, or the best part guides
  bool resumed_ = false;       ///< the leader was refuted, and the race continues
  std::uint64_t begun_ = 0;    ///< refutations of the leader before it became the leader
  std::uint64_t leaders_ = 0;  ///< number of changes of the leader
};

}  // namespace

std::unique_ptr<SearchedGuidance> make_race(const RaceSettings& settings,
                                            std::vector<std::unique_ptr<SearchedGuidance>> parts) {
  return std::make_unique<RaceGuidance>(settings, std::move(parts));
}

}  // namespace trellis

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
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

  Advance prepare(const Slice& slice) override {
    if (led_ && (parts_[drawn_]->refuted() == begun_ || over())) return parts_[drawn_]->prepare(slice);
    if (led_ && !resumed_) {
      resumed_ = true;
      turn_ = (drawn_ + 1) % parts_.size();
    }
    return run(slice);
  }
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

  Advance run(const Slice& given) {
    double searched = 0.0;
    double worked = 0.0;
    while (std::find(out_.begin(), out_.end(), false) != out_.end()) {
      if (searched >= given.proposals || worked >= given.work) return Advance::unfinished;
      const std::size_t part = turn_;
      const double slice = slice_;
      turn_ = (turn_ + 1) % parts_.size();
      if (turn_ == 0) slice_ *= 2.0;
      if (out_[part]) continue;
      const double before = parts_[part]->work();
      const Advance advance = parts_[part]->prepare({slice, given.work - worked});
      searched += slice;
      worked += parts_[part]->work() - before;
      if (advance == Advance::found && !parts_[part]->spent()) {
        lead(part);
        return advance;
      }
      // A permanently refuted part keeps its path, which may still guide, but cannot become the leader again.
      if (advance != Advance::unfinished) out_[part] = true;
    }
    if (!led_) {
      std::size_t best = 0;
      while (best + 1 < parts_.size() && parts_[best]->guiding_path().empty()) ++best;
      lead(parts_[best]->guiding_path().empty() ? 0 : best);
    }
    return Advance::nothing;
  }
  void lead(std::size_t part) {
    led_ = true;
    resumed_ = false;
    ++leaders_;
    drawn_ = part;
    begun_ = parts_[part]->refuted();
  }

  double slice_;               ///< of the current round
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

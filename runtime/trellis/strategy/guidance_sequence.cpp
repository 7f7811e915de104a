// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

namespace {

/// A sequence of guides. Each draws a turn of proposals; evidence that refutes its h ends the turn early. It passes
/// what it found to the search of the next part's space. The first part follows the last.
class SequenceGuidance final : public PartsGuidance {
 public:
  SequenceGuidance(std::vector<std::unique_ptr<SearchedGuidance>> parts, std::int64_t turn)
      : PartsGuidance(std::move(parts)), turn_(turn) {
    if (parts_.size() > 1) expect_findings();
  }
  void begin(const Slice& slice) override {
    if (parts_.size() > 1 && (served_ >= turn_ || given_up())) pass_on();
    slice_ = slice;
    tried_ = 1;
    parts_[drawn_]->begin(slice);
  }
  [[nodiscard]] GuideSearch* needs_search() override {
    for (;;) {
      if (GuideSearch* next = parts_[drawn_]->needs_search()) return next;
      refuted_ = parts_[drawn_]->refuted();
      // If a search ends without a path, the turn passes to the next part, unless all parts failed.
      if (ready() != Advance::nothing || tried_ == parts_.size()) return nullptr;
      ++tried_;
      pass_on();
      parts_[drawn_]->begin(slice_);
    }
  }
  [[nodiscard]] Advance ready() const override { return parts_[drawn_]->ready(); }
  Source sample(Stream& stream, MutableView out) override {
    ++served_;
    return draw(stream, out);
  }
  [[nodiscard]] std::uint64_t epoch() const override { return turns_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double share) const override { parts_[drawn_]->record(record, share); }
  [[nodiscard]] Configurations guiding_path() const override { return parts_[drawn_]->guiding_path(); }

 private:
  /// Whether proposals refuted the current part, and not all parts are permanently refuted.
  [[nodiscard]] bool given_up() const { return parts_[drawn_]->refuted() > refuted_ && !spent(); }
  void pass_on() {
    const Finding finding = parts_[drawn_]->finding();
    drawn_ = (drawn_ + 1) % parts_.size();
    served_ = 0;
    ++turns_;
    parts_[drawn_]->inform(finding);
    refuted_ = parts_[drawn_]->refuted();
  }

  std::int64_t turn_;
  Slice slice_;
  std::size_t tried_ = 0;  ///< parts that had the turn before this proposal
  std::int64_t served_ = 0;
  std::uint64_t turns_ = 0;    ///< number of turns passed on
  std::uint64_t refuted_ = 0;  ///< refutations of the current part before it drew
};

}  // namespace

std::unique_ptr<SearchedGuidance> make_sequence(const SequenceSettings& settings,
                                                std::vector<std::unique_ptr<SearchedGuidance>> parts) {
  return std::make_unique<SequenceGuidance>(std::move(parts), settings.turn);
}

}  // namespace trellis

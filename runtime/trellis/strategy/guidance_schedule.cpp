// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

namespace {

/// Guides in order (ScheduleSettings). Each passes what it found to the search of the next, as in a sequence. If the
/// search of a part finds no path, the next part starts at once.
class ScheduleGuidance final : public PartsGuidance {
 public:
  ScheduleGuidance(const ScheduleSettings& settings, std::vector<std::unique_ptr<SearchedGuidance>> parts)
      : PartsGuidance(std::move(parts)), settings_(settings) {
    if (parts_.size() > 1) expect_findings();
  }

  void begin(const Slice& slice) override {
    const auto rounds = static_cast<std::uint64_t>(settings_.rounds);
    const auto& part = *parts_[drawn_];
    if (!last() &&
        (static_cast<double>(served_) >= settings_.turn || part.refuted() >= begun_ + rounds || part.spent())) {
      pass_on();
    }
    slice_ = slice;
    parts_[drawn_]->begin(slice);
  }
  [[nodiscard]] GuideSearch* needs_search() override {
    for (;;) {
      if (GuideSearch* next = parts_[drawn_]->needs_search()) return next;
      if (ready() != Advance::nothing || last()) return nullptr;
      pass_on();
      parts_[drawn_]->begin(slice_);
    }
  }
  [[nodiscard]] Advance ready() const override { return parts_[drawn_]->ready(); }
  Source sample(Stream& stream, MutableView out) override {
    ++served_;
    return draw(stream, out);
  }
  /// The schedule counts as refuted when its last part is refuted.
  [[nodiscard]] std::uint64_t refuted() const override { return last() ? parts_[drawn_]->refuted() - begun_ : 0; }
  [[nodiscard]] bool spent() const override { return last() && parts_[drawn_]->spent(); }

  [[nodiscard]] std::uint64_t epoch() const override { return drawn_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double share) const override { parts_[drawn_]->record(record, share); }
  [[nodiscard]] Configurations guiding_path() const override { return parts_[drawn_]->guiding_path(); }

 private:
  [[nodiscard]] bool last() const { return drawn_ + 1 == parts_.size(); }
  /// Activates the next part.
  void pass_on() {
    const Finding finding = parts_[drawn_]->finding();
    ++drawn_;
    served_ = 0;
    begun_ = parts_[drawn_]->refuted();
    parts_[drawn_]->inform(finding);
  }

  ScheduleSettings settings_;
  Slice slice_;
  std::int64_t served_ = 0;  ///< proposals of the current part
  std::uint64_t begun_ = 0;  ///< refutations of the current part before it became active
};

}  // namespace

std::unique_ptr<SearchedGuidance> make_schedule(const ScheduleSettings& settings,
                                                std::vector<std::unique_ptr<SearchedGuidance>> parts) {
  return std::make_unique<ScheduleGuidance>(settings, std::move(parts));
}

}  // namespace trellis

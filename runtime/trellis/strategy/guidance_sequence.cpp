// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/strategy/prepared.hpp>

namespace trellis {

namespace {

/// A sequence of guides: each serves a turn of proposals, which ends early where evidence refutes what it guides by.
/// What it found takes part in the search of the next one's space. After the last the first has its turn again.
class SequenceGuidance final : public PartsGuidance {
 public:
  SequenceGuidance(std::vector<std::unique_ptr<Prepared>> parts, std::int64_t turn)
      : PartsGuidance(std::move(parts)), turn_(turn) {
    if (parts_.size() > 1) expect_findings();
  }
  Advance prepare(const Slice& slice) override {
    if (parts_.size() > 1 && (served_ >= turn_ || given_up())) pass_on();
    for (std::size_t i = 1;; ++i) {
      const Advance advance = parts_[drawn_]->prepare(slice);
      refuted_ = parts_[drawn_]->refuted();
      // A search that ended without a path leaves the turn to the next, unless all did.
      if (advance != Advance::nothing || i == parts_.size()) return advance;
      pass_on();
    }
  }
  Source sample(Stream& stream, MutableView out) override {
    ++served_;
    return draw(stream, out);
  }
  [[nodiscard]] double density(View q) const override { return parts_[drawn_]->density(q); }
  [[nodiscard]] double atom_mass() const override { return parts_[drawn_]->atom_mass(); }
  [[nodiscard]] std::uint64_t epoch() const override { return turns_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double share) const override { parts_[drawn_]->record(record, share); }
  [[nodiscard]] Configurations guiding_path() const override { return parts_[drawn_]->guiding_path(); }

 private:
  /// Whether the part in turn was refuted by its own proposals, and another one is not refuted for good.
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
  std::int64_t served_ = 0;
  std::uint64_t turns_ = 0;    ///< passed on
  std::uint64_t refuted_ = 0;  ///< how often the part in turn was, before it drew
};

}  // namespace

std::unique_ptr<Prepared> make_sequence(const SequenceSettings& settings,
                                        std::vector<std::unique_ptr<Prepared>> parts) {
  return std::make_unique<SequenceGuidance>(std::move(parts), settings.turn);
}

}  // namespace trellis

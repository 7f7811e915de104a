// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/strategy/prepared.hpp>

namespace trellis {

namespace {

/// A sequence of guides: each serves a turn of proposals; the path that it leaves informs the next one's search. After
/// the last the first has its turn again.
class SequenceGuidance final : public PartsGuidance {
 public:
  SequenceGuidance(std::vector<std::unique_ptr<Prepared>> parts, std::int64_t turn)
      : PartsGuidance(std::move(parts)), turn_(turn) {}
  Advance prepare(const Slice& slice) override {
    if (served_ == turn_ && parts_.size() > 1) {
      const Configurations path = parts_[drawn_]->guiding_path();
      drawn_ = (drawn_ + 1) % parts_.size();
      served_ = 0;
      ++turns_;
      if (!path.empty()) parts_[drawn_]->inform(path);
    }
    return parts_[drawn_]->prepare(slice);
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
  std::int64_t turn_;
  std::int64_t served_ = 0;
  std::uint64_t turns_ = 0;  ///< passed on
};

}  // namespace

std::unique_ptr<Prepared> make_sequence(const SequenceSettings& settings,
                                        std::vector<std::unique_ptr<Prepared>> parts) {
  return std::make_unique<SequenceGuidance>(std::move(parts), settings.turn);
}

}  // namespace trellis

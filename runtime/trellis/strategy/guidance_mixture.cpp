// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

namespace {

/// A mixture of guides.
class MixtureGuidance final : public PartsGuidance {
 public:
  MixtureGuidance(const std::vector<double>& weights, std::vector<std::unique_ptr<SearchedGuidance>> parts)
      : PartsGuidance(std::move(parts)) {
    double total = 0.0;
    for (const double w : weights) total += w;
    for (const double w : weights) given_.push_back(w / total);
    weights_ = given_;
  }
  /// While the space of a part is searched, the other parts share its weight.
  void begin(const Slice& slice) override { turns_.begin(slice, parts_); }
  [[nodiscard]] GuideSearch* needs_search() override {
    GuideSearch* next = turns_.needs_search(parts_);
    if (next == nullptr) weigh();
    return next;
  }
  [[nodiscard]] Advance ready() const override { return turns_.ready(parts_); }
  [[nodiscard]] bool draws_while_searching() const override { return true; }
  Source sample(Stream& stream, MutableView out) override {
    double u = stream.uniform();
    drawn_ = 0;
    while (drawn_ + 1 < parts_.size() && u >= weights_[drawn_]) u -= weights_[drawn_++];
    // Rounding may select a part with zero weight.
    while (weights_[drawn_] == 0.0) --drawn_;
    return draw(stream, out);
  }
  [[nodiscard]] std::uint64_t epoch() const override { return changes_ + PartsGuidance::epoch(); }
  void record(DensityRecord& record, double share) const override {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (weights_[i] > 0.0) parts_[i]->record(record, share * weights_[i]);
    }
  }
  [[nodiscard]] Configurations guiding_path() const override {
    for (const auto& part : parts_) {
      Configurations path = part->guiding_path();
      if (!path.empty()) return path;
    }
    return {};
  }

 private:
  /// Divides the weights among the parts that can draw.
  void weigh() {
    double total = 0.0;
    ready_.assign(parts_.size(), 0.0);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (parts_[i]->ready() == Advance::unfinished) continue;
      ready_[i] = given_[i];
      total += given_[i];
    }
    if (total == 0.0) return;
    for (double& w : ready_) w /= total;
    if (ready_ == weights_) return;
    weights_ = ready_;
    ++changes_;
  }

  AllInTurn turns_;
  std::vector<double> given_;    ///< normalised weights
  std::vector<double> weights_;  ///< weights of the parts that can draw; 0 for the others
  std::vector<double> ready_;    ///< scratch
  std::uint64_t changes_ = 0;    ///< number of changes of the weights
};

}  // namespace

std::unique_ptr<SearchedGuidance> make_mixture(const std::vector<double>& weights,
                                               std::vector<std::unique_ptr<SearchedGuidance>> parts) {
  return std::make_unique<MixtureGuidance>(weights, std::move(parts));
}

}  // namespace trellis

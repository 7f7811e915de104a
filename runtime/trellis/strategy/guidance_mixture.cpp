// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/strategy/prepared.hpp>

namespace trellis {

namespace {

/// A mixture of guides.
class MixtureGuidance final : public PartsGuidance {
 public:
  MixtureGuidance(const std::vector<double>& weights, std::vector<std::unique_ptr<Prepared>> parts)
      : PartsGuidance(std::move(parts)) {
    double total = 0.0;
    for (const double w : weights) total += w;
    for (const double w : weights) weights_.push_back(w / total);
  }
  Advance prepare(double proposals) override { return prepare_all(proposals); }
  Source sample(Stream& stream, MutableView out) override {
    double u = stream.uniform();
    drawn_ = 0;
    while (drawn_ + 1 < parts_.size() && u >= weights_[drawn_]) u -= weights_[drawn_++];
    return draw(stream, out);
  }
  [[nodiscard]] double density(View q) const override {
    double sum = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) sum += weights_[i] * parts_[i]->density(q);
    return sum;
  }
  [[nodiscard]] double atom_mass() const override {
    double sum = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) sum += weights_[i] * parts_[i]->atom_mass();
    return sum;
  }
  void record(DensityRecord& record, double share) const override {
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i]->record(record, share * weights_[i]);
  }
  [[nodiscard]] Configurations guiding_path() const override {
    for (const auto& part : parts_) {
      Configurations path = part->guiding_path();
      if (!path.empty()) return path;
    }
    return {};
  }

 private:
  std::vector<double> weights_;
};

}  // namespace

std::unique_ptr<Prepared> make_mixture(const std::vector<double>& weights,
                                       std::vector<std::unique_ptr<Prepared>> parts) {
  return std::make_unique<MixtureGuidance>(weights, std::move(parts));
}

}  // namespace trellis

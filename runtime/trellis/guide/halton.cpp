// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdint>

#include <trellis/guide/bias.hpp>

namespace trellis {

namespace {

struct HaltonSettings {};

const Settings<HaltonSettings>& halton_settings() {
  static const Settings<HaltonSettings> settings(
      Component::Kind::guide, "halton",
      "the Halton sequence, moved round the space by a seeded shift: spread more evenly than uniform samples; S = {0}",
      "Halton 1960; in planning: LaValle, Branicky and Lindemann 2004; the shift: Cranley and Patterson 1976");
  return settings;
}

/// The first `count` primes, one per axis.
std::vector<std::uint64_t> primes(std::size_t count) {
  std::vector<std::uint64_t> found;
  found.reserve(count);
  for (std::uint64_t candidate = 2; found.size() < count; ++candidate) {
    bool prime = true;
    for (const std::uint64_t p : found) prime = prime && candidate % p != 0;
    if (prime) found.push_back(candidate);
  }
  return found;
}

/// The digits of i to the base, mirrored at the radix point.
double radical_inverse(std::uint64_t i, std::uint64_t base) {
  const double share = 1.0 / static_cast<double>(base);
  double value = 0.0;
  double digit = share;
  for (; i != 0; i /= base) {
    value += digit * static_cast<double>(i % base);
    digit *= share;
  }
  return value;
}

class Halton final : public Heuristic {
 public:
  explicit Halton(const Space& space)
      : space_(space), uniform_(space), primes_(primes(space.degrees())), unit_(space.degrees()) {}

  Source sample(Stream& stream, MutableView out) override {
    if (shift_.empty()) {
      shift_.resize(primes_.size());
      for (double& x : shift_) x = stream.uniform();
    }
    ++index_;
    for (std::size_t j = 0; j < unit_.size(); ++j) {
      const double u = radical_inverse(index_, primes_[j]) + shift_[j];
      unit_[j] = u - std::floor(u);
    }
    if (space_.flat()) {
      for (std::size_t j = 0; j < out.size(); ++j) {
        const Axis& axis = space_.axes()[j];
        out[j] = axis.lo + unit_[j] * (axis.hi - axis.lo);
      }
    } else {
      space_.from_unit(unit_, out);
    }
    space_.normalise(out);
    return 0;
  }
  /// Averaged over the random shifts, each single sample is uniform.
  void record(DensityRecord& record, double share) const override { uniform_.record(record, share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"halton"}; }

 private:
  Space space_;
  UniformGuidance uniform_;
  std::vector<std::uint64_t> primes_;
  std::vector<double> shift_;
  std::vector<double> unit_;
  std::uint64_t index_ = 0;
};

}  // namespace

GuideKind halton_kind() {
  return sampling_kind(
      halton_settings().component(),
      [](const Options&) -> std::unique_ptr<Guide> {
        return bias(
            [](Instance& parent) -> std::unique_ptr<Heuristic> { return std::make_unique<Halton>(parent.space); });
      },
      "the next point of the sequence, one prime base for each axis", "of C's volume, over the shifts", true);
}

}  // namespace trellis

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/bias.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

namespace {

struct InformationGainSettings {
  std::int64_t candidates = 4;
  std::int64_t neighbours = 5;
  double reach = 0.0;
  bool useful = false;
};

const Settings<InformationGainSettings>& information_gain_settings() {
  static const Settings<InformationGainSettings> settings =
      Settings<InformationGainSettings>(
          Component::Kind::guide, "information_gain",
          "of some uniform configurations the one whose validity is predicted with the least certainty, by the nearest "
          "of the configurations that the planner found valid and invalid; S = {0}",
          "Burns and Brock 2003, Information theoretic construction of probabilistic roadmaps; utility: Burns and "
          "Brock 2005, Toward optimal configuration space sampling")
          .integer("candidates", &InformationGainSettings::candidates, "configurations", {.lo = 1, .hi = 1000},
                   "uniform configurations of which the one with the most gain is proposed")
          .integer("neighbours", &InformationGainSettings::neighbours, "configurations", {.lo = 1, .hi = 100},
                   "configurations of known validity, the nearest ones, that predict that of a candidate")
          .number("reach", &InformationGainSettings::reach, "m in the metric", Range::non_negative(),
                  "standard deviation of the Gaussian weight of a neighbour by its distance; 0: the planner's step")
          .choice("gain", &InformationGainSettings::useful, {{"information", false}, {"utility", true}},
                  "\"information\": the entropy of the validity that the model predicts; \"utility\": that times the "
                  "probability that the candidate is valid, as an invalid configuration joins nothing")
          .positional({"candidates"});
  return settings;
}

class InformationGain final : public Heuristic {
 public:
  InformationGain(Instance& parent, const InformationGainSettings& settings)
      : parent_(parent),
        space_(parent.space),
        settings_(settings),
        reach_(settings.reach > 0.0 ? settings.reach : step_length(parent)),
        index_(parent.space),
        candidate_(parent.space.dimension()) {}

  Source sample(Stream& stream, MutableView out) override {
    double most = -1.0;
    for (std::int64_t i = 0; i < settings_.candidates; ++i) {
      parent_.spend(search_cost::neighbours +
                    search_cost::neighbours_compared * std::exp2(std::min(7.0, static_cast<double>(space_.degrees()))));
      space_.sample_uniform(stream, candidate_);
      const double gain = this->gain(candidate_);
      if (gain <= most) continue;
      most = gain;
      std::copy(candidate_.begin(), candidate_.end(), out.begin());
    }
    return 0;
  }

  void observe(const Outcome& outcome, bool) override {
    if (!outcome.added.empty()) add(outcome.added, true);
    if (!outcome.blocked_at.empty()) add(outcome.blocked_at, false);
  }

  [[nodiscard]] std::vector<std::string> sources() const override { return {"information_gain"}; }

 private:
  void add(View q, bool valid) {
    index_.add(q);
    valid_.push_back(valid ? 1 : 0);
  }

  [[nodiscard]] double gain(View q) {
    // One observation of each kind beforehand: far from all that is known, both are as likely.
    double valid = 1.0;
    double all = 2.0;
    index_.k_nearest(q, static_cast<std::size_t>(settings_.neighbours), near_);
    for (const auto& neighbour : near_) {
      const double weight = std::exp(-0.5 * neighbour.squared_distance / (reach_ * reach_));
      all += weight;
      if (valid_[neighbour.id] != 0) valid += weight;
    }
    const double p = valid / all;
    const double entropy = -p * std::log(p) - (1.0 - p) * std::log(1.0 - p);
    return settings_.useful ? p * entropy : entropy;
  }

  Instance& parent_;  ///< counts the work of the queries
  Space space_;
  InformationGainSettings settings_;
  double reach_;
  NearestIndex index_;               ///< configurations of known validity
  std::vector<std::uint8_t> valid_;  ///< of each
  std::vector<NearestIndex::Neighbour> near_;
  Configuration candidate_;
};

}  // namespace

GuideKind information_gain_kind() {
  return sampling_kind(
      information_gain_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias([settings = information_gain_settings().read(o)](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<InformationGain>(parent, settings);
        });
      },
      "of `candidates` uniform configurations the one with the most gain",
      "it would need the share of C with less gain than q", false,
      "nodes are valid and the first invalid configurations of blocked motions invalid in the model");
}

}  // namespace trellis

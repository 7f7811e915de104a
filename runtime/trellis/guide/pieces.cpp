// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/pieces.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>

namespace trellis {

namespace {

std::uint64_t hash_of(std::span<const double> numbers) {
  return stable_hash({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});  // NOLINT: its bytes
}

/// \throws Error if q is no configuration of the space
void require_in(const Space& space, View q, const std::string& what) {
  if (q.size() != space.dimension()) {
    throw Error(fmt::format("{} has {} coordinates, and the space {} that it is to lie in has {}", what, q.size(),
                            space.name(), space.dimension()));
  }
  if (space.contains(q)) return;
  throw Error(fmt::format("{}, ({:g}), is outside of the space {}", what, fmt::join(q, ", "), space.name()));
}

/// A piece as a guide.
class PieceGuide final : public SamplingGuide {
 public:
  explicit PieceGuide(const Piece& piece) : piece_(piece) {}
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    if (!reached_) reached_.emplace(parent.space, parent.start);
    return piece_.over(parent, *reached_);
  }
  void learn(const Outcome& outcome) override {
    if (reached_ && !outcome.added.empty() && outcome.connected) reached_->add(outcome.added);
  }
  void restart() override {
    if (reached_) reached_->clear();
  }

 private:
  const Piece& piece_;                   // the spec owns it and outlives this object
  std::optional<ReachedIndex> reached_;  ///< the planner's nodes
};

class Along final : public Piece {
 public:
  Along(Configurations path, const Options& options)
      : Piece({.name = fmt::format("along(a path of {} points)", path.size()),
               .identity = identity(path, options),
               .default_planner = ""}),
        path_(std::move(path)),
        settings_(along_settings().read(options)) {}

  [[nodiscard]] std::unique_ptr<Heuristic> over(Instance& instance, const ReachedIndex& reached) const override {
    for (std::size_t i = 0; i < path_.size(); ++i) {
      require_in(instance.space, path_[i], fmt::format("along: point {} of the path", i + 1));
    }
    if (path_.size() < 2) return std::make_unique<UniformHeuristic>("along (no path)", instance.space);
    return follow_path("along", settings_, instance, path_, {&reached, nullptr});
  }

 private:
  static std::string identity(const Configurations& path, const Options& options) {
    std::string text = fmt::format("along {:016x}", hash_of(path.values()));
    for (const auto& [name, value] : options.entries()) text += fmt::format(", {} = {}", name, to_string(value));
    return text;
  }

  Configurations path_;
  PathGuideSettings settings_;
};

class BallHeuristic final : public Heuristic {
 public:
  explicit BallHeuristic(TubeKernel tube) : tube_(std::move(tube)) {}
  Source sample(Stream& stream, MutableView out) override {
    tube_.sample(stream, out);
    return 0;
  }
  void record(DensityRecord& record, double share) const override { record.add(tube_.density(), share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"ball"}; }

 private:
  TubeKernel tube_;
};

class Ball final : public Piece {
 public:
  Ball(Configuration centre, double radius)
      : Piece({.name = fmt::format("ball({{ {:g} }}, {:g})", fmt::join(centre, ", "), radius),
               .identity = fmt::format("ball {:016x}, {}", hash_of(centre), to_string(OptionValue(radius))),
               .default_planner = ""}),
        centre_(std::move(centre)),
        radius_(radius) {}

  [[nodiscard]] std::unique_ptr<Heuristic> over(Instance& instance, const ReachedIndex&) const override {
    require_in(instance.space, centre_, "ball: its centre");
    Configurations alone(centre_.size());
    alone.push(centre_);
    return std::make_unique<BallHeuristic>(TubeKernel(instance.space, std::move(alone), radius_));
  }

 private:
  Configuration centre_;
  double radius_;
};

}  // namespace

std::unique_ptr<Guide> Piece::make(const GuideSite&) const { return std::make_unique<PieceGuide>(*this); }

const Settings<PathGuideSettings>& along_settings() {
  static const Settings<PathGuideSettings> settings = with_following_options(Settings<PathGuideSettings>(
      Component::Kind::combinator, "along", "near a path, ahead of what the planner has reached of it: S = {0}", ""));
  return settings;
}

std::shared_ptr<const Piece> along(Configurations path, const Options& options) {
  return std::make_shared<Along>(std::move(path), options);
}

std::shared_ptr<const Piece> ball(Configuration centre, double radius) {
  return std::make_shared<Ball>(std::move(centre), radius);
}

SumHeuristic::SumHeuristic(std::string source, std::vector<Part> parts)
    : source_(std::move(source)), parts_(std::move(parts)) {
  double total = 0.0;
  for (const Part& part : parts_) total += part.weight;
  for (Part& part : parts_) part.weight /= total;
}

Guidance::Source SumHeuristic::sample(Stream& stream, MutableView out) {
  drawn_ = 0;
  if (parts_.size() > 1) {
    double u = stream.uniform();
    while (drawn_ + 1 < parts_.size() && u >= parts_[drawn_].weight) u -= parts_[drawn_++].weight;
  }
  parts_[drawn_].heuristic->sample(stream, out);
  return 0;
}

void SumHeuristic::record(DensityRecord& record, double share) const {
  for (const Part& part : parts_) part.heuristic->record(record, share * part.weight);
}

bool SumHeuristic::stale() const {
  return std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.heuristic->stale(); });
}

Configurations SumHeuristic::lifted_path() const {
  for (const Part& part : parts_) {
    Configurations path = part.heuristic->lifted_path();
    if (!path.empty()) return path;
  }
  return {};
}

}  // namespace trellis

// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/team_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/instance/certified_validity.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/planner/common.hpp>

namespace trellis {

namespace {

/// The displacement at which a certificate of a motion that could as well be left out gives up: one that comes closer
/// to another robot takes hundreds of checks to certify, and leaves the next robots no room.
double coarse_tolerance_of(const Instance& instance) {
  constexpr double share = 0.2;
  return share * instance.resolution;
}

}  // namespace

double exact_tolerance_of(const Instance& instance) { return certificate_share * instance.resolution; }

bool certified(Instance& instance, const Configurations& path) {
  for (const double tolerance : {coarse_tolerance_of(instance), exact_tolerance_of(instance)}) {
    const Instance::Announced before = instance.open_certificate();
    const PathCertificate certificate = certify(instance.space, *instance.validity, path, tolerance);
    instance.count_certificate(before, certificate.checks);
    if (certificate.certified()) return true;
  }
  return false;
}

Configuration picked(View q, const std::vector<std::size_t>& columns) {
  Configuration part;
  part.reserve(columns.size());
  for (const std::size_t column : columns) part.push_back(q[column]);
  return part;
}

bool guides_searches_of(const GuideSpec& guide, std::size_t robots) {
  if (guide.kind() != GuideSpec::Kind::component) {
    return std::all_of(guide.terms().begin(), guide.terms().end(),
                       [&](const GuideSpec::Term& term) { return guides_searches_of(term.guide, robots); });
  }
  if (guide.custom()) return robots == 1;
  switch (find_guide(guide.name())->claims.needs) {
    case GuideClaims::Needs::team: return robots > 1;
    case GuideClaims::Needs::position:
    case GuideClaims::Needs::position_axes: return robots == 1;
    default: return true;
  }
}

TeamPartsSearch::TeamPartsSearch(TeamSearchContext of)
    : DividingPlanner(std::move(of.context)),
      run_(of.run),
      level_(of.level),
      planner_(std::move(of.planner)),
      guide_(of.guide),
      division_(std::move(of.division)),
      members_(context_.instance.scene->members()) {}

std::optional<Status> TeamPartsSearch::begin(const Budget&) {
  Instance& instance = context_.instance;
  if (context_.search.nodes.empty()) {
    if (const auto invalid = remove_invalid_goals(instance)) return invalid;
    context_.search.nodes.push(instance.start);
    context_.search.parents.push_back(0);
  }
  // A further solve begins anew, with other random numbers.
  if (found_ || tries_left_ <= 0) {
    found_.reset();
    tries_left_ = division_.tries;
    begin_anew();
  }
  if (instance.to_goal(instance.start) > instance.goal_tolerance) return std::nullopt;
  found_ = path_of_start(instance);
  return Status::solved;
}

Solution TeamPartsSearch::solution(Status status) {
  if (status == Status::solved && found_) return {status, *found_, {}};
  return {status, path_of_start(context_.instance), {}};
}

const Configuration& TeamPartsSearch::goal() const {
  const std::vector<Configuration>& goals = context_.instance.goals;
  return goals[static_cast<std::size_t>(division_.tries - tries_left_) % goals.size()];
}

std::unique_ptr<Instance> TeamPartsSearch::part_of(Guide& space, std::size_t along) {
  auto part = space.project(context_.instance);
  Configuration q(part->space.dimension());
  space.project(goal(), q);
  std::copy_n(part->goals.front().begin(), along, q.begin());
  part->goals.assign(1, q);
  return part;
}

void TeamPartsSearch::begin_search(std::unique_ptr<Instance> part, std::shared_ptr<Guide> space,
                                   const std::vector<std::size_t>& robots) {
  if (certifies_) part->validity = std::make_shared<CertifiedValidity>(part->validity, exact_tolerance_of(*part));
  // The level of a robot has the same key in all runs; a further search of it another number.
  const std::size_t number = robots.empty() ? members_.size() : robots.size() == 1 ? robots.front() : next_number_++;
  levels_.push_back(std::make_unique<Level>(run_, &level_,
                                            fmt::format("{}/{}.{}", level_.record().key, searches_[number]++, number),
                                            name_of(robots), std::move(part), planner_, std::move(space)));
  current_ = levels_.back().get();
}

void TeamPartsSearch::guide_part(std::size_t robots) {
  if (guide_ != nullptr && guides_searches_of(*guide_, robots)) current_->guide_by(*guide_);
}

DividingPlanner::Part TeamPartsSearch::part() {
  constexpr double piece = 256.0;
  if (!std::exchange(advances_, false)) return {};
  return {current_, {std::ceil(effort_), {Budget::unlimited, piece}}};
}

std::optional<Status> TeamPartsSearch::take(Advance advance) {
  double work = 0.0;
  for (const auto& level : levels_) work += level->work();
  level_.ledger().count_parts(work);
  if (advance == Advance::unfinished) return std::nullopt;
  Level& ended = *std::exchange(current_, nullptr);
  if (ended.record().solution.status == Status::interrupted) return Status::interrupted;
  if (advance != Advance::nothing) return end_part(ended);
  certifies_ = false;
  fail();
  return std::nullopt;
}

bool TeamPartsSearch::accepts(Level& ended, const Configurations& path) {
  certifies_ = !certifies_ && !certified(ended.instance(), path);
  return !certifies_;
}

Configurations TeamPartsSearch::shortened(Level& ended) const {
  constexpr std::int64_t rounds = 30;
  Stream stream(run_.seed, ended.record().key, "shortcut");
  return shortcut(ended.instance(), ended.solution().path, rounds, stream);
}

void TeamPartsSearch::begin_pruning(const Instance& instance, const Configurations& path) {
  const auto validity = std::make_shared<CertifiedValidity>(instance.validity, coarse_tolerance_of(instance));
  pruning_.emplace(path, [&team = context_.instance, validity](View a, View b) {
    return team.check_certificate([&] { return validity->motion(a, b); }).valid;
  });
}

std::optional<Configurations> TeamPartsSearch::prune() {
  constexpr std::uint64_t piece = 256;
  const std::uint64_t before = context_.instance.checks.validity;
  while (!pruning_->done() && context_.instance.checks.validity < before + piece) pruning_->step();
  if (!pruning_->done()) return std::nullopt;
  const Configurations path = pruning_->path();
  pruning_.reset();
  return path;
}

void TeamPartsSearch::finish(Configurations path) {
  found_ = std::move(path);
  Search& search = context_.search;
  for (std::size_t i = 1; i < found_->size(); ++i) {
    search.parents.push_back(i == 1 ? 0 : static_cast<std::uint32_t>(search.nodes.size() - 1));
    search.nodes.push(std::as_const(*found_)[i]);
  }
}

void TeamPartsSearch::count(const Instance& part) { context_.instance.checks += part.checks; }

std::vector<std::size_t> TeamPartsSearch::numbers_of(const std::vector<std::size_t>& robots) const {
  std::vector<std::size_t> numbers;
  numbers.reserve(robots.size());
  for (const std::size_t i : robots) numbers.push_back(members_[i].number);
  return numbers;
}

std::string TeamPartsSearch::name_of(const std::vector<std::size_t>& robots) const {
  if (robots.empty()) return "coordination";
  return fmt::format("robot{} {}", robots.size() == 1 ? "" : "s", fmt::join(numbers_of(robots), ", "));
}

}  // namespace trellis

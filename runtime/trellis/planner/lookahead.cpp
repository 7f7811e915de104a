// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/lookahead.hpp>

#include <trellis/base/slice_monitor.hpp>

namespace trellis {

namespace {

constexpr std::size_t fewest_nodes = 64;
constexpr std::size_t measured_alone = 256;
constexpr std::size_t measured_ahead = 1024;
constexpr std::size_t between_measurements = 32768;
constexpr std::size_t most_rounds = 6;

}  // namespace

Lookahead::Timed Lookahead::begin(StepsAhead& of, const Stream& stream) {
  present_ = nullptr;
  if (of.nodes() < fewest_nodes) return Timed(nullptr);
  if (left_ == 0) next_phase(of);
  --left_;
  const bool measures = phase_ == Phase::measure_alone || phase_ == Phase::measure_ahead;
  if (phase_ == Phase::measure_ahead || phase_ == Phase::ahead) {
    const bool computes = next_ == count_;
    // The steps of a turn that began in the phase before are part of it.
    const auto begin = measures && computes ? Clock::now() : Clock::time_point();
    if (computes && !compute(of, stream)) {
      of.mark_new_nodes(false);
      enter(Phase::alone, between_measurements);
      return Timed(nullptr);
    }
    if (measures && computes) spent_ += Clock::now() - begin;
  }
  if (measures) ++taken_;
  return Timed(measures ? this : nullptr);
}

void Lookahead::enter(Phase phase, std::size_t steps) {
  phase_ = phase;
  left_ = steps;
  taken_ = 0;
  spent_ = {};
}

void Lookahead::next_phase(StepsAhead& of) {
  const double step = taken_ > 0 ? std::chrono::duration<double>(spent_).count() / static_cast<double>(taken_) : 0.0;
  switch (phase_) {
    case Phase::measure_alone:
      alone_ = step;
      enter(Phase::measure_ahead, measured_ahead);
      return;
    case Phase::measure_ahead:
      if (step < alone_) {
        rounds_ = 0;
        enter(Phase::ahead, between_measurements);
        return;
      }
      rounds_ = std::min(rounds_ + 1, most_rounds);
      clear();
      of.mark_new_nodes(false);
      enter(Phase::alone, between_measurements << (rounds_ - 1));
      return;
    case Phase::alone:
    case Phase::ahead:
      clear();
      of.mark_new_nodes(false);
      enter(Phase::measure_alone, measured_alone);
      return;
  }
}

bool Lookahead::has_validities() {
  const unsigned workers = helpers_->workers();
  const bool equal = validities_.size() == workers && validities_.front() == instance_.validity;
  if (equal && epoch_ == instance_.epoch()) return true;
  validities_.assign(1, instance_.validity);
  epoch_ = instance_.epoch();
  while (validities_.size() < workers) {
    validities_.push_back(instance_.validity->for_thread());
    if (validities_.back() == nullptr) {
      validities_.clear();
      return false;
    }
  }
  return true;
}

bool Lookahead::compute(StepsAhead& of, Stream stream) {
  if (!has_validities()) return false;
  // Of many steps some meet nodes that are newer; of few, helpers wait for each other.
  const unsigned workers = helpers_->workers();
  const std::size_t most = std::clamp<std::size_t>(of.nodes() / 4, 16UL * workers, 128UL * workers);
  if (steps_.size() < most) steps_.resize(most);
  const std::size_t dimension = instance_.space.dimension();
  next_ = 0;
  for (count_ = 0; count_ < most; ++count_) {
    StepAhead& step = steps_[count_];
    step.clear();
    step.proposal.resize(dimension);
    step.target.resize(dimension);
    if (!h_.preview(stream, step.proposal)) break;
  }
  if (count_ == 0) return false;
  // This thread is one of them. The search announces the checks of a step when the step comes.
  const MonitorScope unmonitored(nullptr);
  helpers_->run(count_, [&](std::size_t i, unsigned worker) {
    try {
      of.look_ahead(i, steps_[i], *validities_[worker]);
    } catch (...) {
      // The search asks again, and fails if the step does come.
      steps_[i].clear();
    }
  });
  of.mark_new_nodes(true);
  return true;
}

void Lookahead::find(View proposal) {
  const StepAhead& step = steps_[next_++];
  const bool foreseen = std::equal(proposal.begin(), proposal.end(), step.proposal.begin(), step.proposal.end());
  present_ = foreseen ? &step : nullptr;
  if (!foreseen) next_ = count_;
}

}  // namespace trellis

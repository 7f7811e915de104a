// SPDX-License-Identifier: GPL-3.0-or-later
// Planners of OMPL 1.5 that draw from a guide, and problems of Trellis as problems of OMPL. No other header includes
// it: a program that includes it finds OMPL itself. docs/sampler.md describes it.
#pragma once

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/StateValidityChecker.h>
#include <ompl/base/ValidStateSampler.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <trellis/instance/instance.hpp>
#include <trellis/strategy/sampler.hpp>

namespace trellis {

/// The numbers of a state, in OMPL's order of reals: that of the axes of Trellis' spaces.
inline Configuration reals_of(const ompl::base::StateSpace& space, const ompl::base::State* state) {
  std::vector<double> reals;
  space.copyToReals(reals, state);
  return {reals.begin(), reals.end()};
}

/// A problem of Trellis in OMPL: its space with its metric, its validity, its motions at its resolution, and the
/// problem's start and goals. Not thread-safe.
class OmplProblem {
 public:
  /// \param problem  valid (check)
  /// \throws Error as `check`
  explicit OmplProblem(const Problem& problem) : instance_(made(problem)) {
    const auto space = std::make_shared<Space>(instance_->space);
    information_ = std::make_shared<ompl::base::SpaceInformation>(space);
    information_->setStateValidityChecker([this](const ompl::base::State* q) {
      const Configuration at = reals_of(*information_->getStateSpace(), q);
      return instance_->space.contains(at) && instance_->valid(at);
    });
    information_->setMotionValidator(std::make_shared<Motions>(information_.get(), *instance_));
    information_->setup();
    definition_ = std::make_shared<ompl::base::ProblemDefinition>(information_);
    const auto state = [&](const Configuration& q) {
      ompl::base::ScopedState<> of(information_);
      information_->getStateSpace()->copyFromReals(of.get(), {q.begin(), q.end()});
      return of;
    };
    definition_->addStartState(state(instance_->start));
    definition_->setGoalState(state(instance_->goals.front()), 1e-6);
  }

  [[nodiscard]] const ompl::base::SpaceInformationPtr& information() const { return information_; }
  /// The start, and the first goal.
  [[nodiscard]] const ompl::base::ProblemDefinitionPtr& definition() const { return definition_; }
  /// Validity checks so far, those on motions included.
  [[nodiscard]] std::uint64_t checks() const { return instance_->checks.validity; }
  [[nodiscard]] const Instance& instance() const { return *instance_; }

  /// Motions at the resolution of a problem; stores the first invalid configuration of the last one.
  class Motions final : public ompl::base::MotionValidator {
   public:
    Motions(ompl::base::SpaceInformation* information, Instance& instance)
        : ompl::base::MotionValidator(information), instance_(instance), invalid_at_(instance.space.dimension()) {}
    bool checkMotion(const ompl::base::State* a, const ompl::base::State* b) const override {
      const Configuration from = reals_of(*si_->getStateSpace(), a);
      const Configuration to = reals_of(*si_->getStateSpace(), b);
      const MotionReport report = instance_.motion(from, to);
      ++(report.valid ? valid_ : invalid_);
      if (!report.valid) instance_.space.interpolate(from, to, report.invalid_at, invalid_at_);
      return report.valid;
    }
    bool checkMotion(const ompl::base::State* a, const ompl::base::State* b,
                     std::pair<ompl::base::State*, double>& last) const override {
      if (checkMotion(a, b)) return true;
      // It says no more than that a is valid.
      last.second = 0.0;
      if (last.first != nullptr && last.first != a) si_->copyState(last.first, a);
      return false;
    }
    [[nodiscard]] View invalid_at() const { return invalid_at_; }
    [[nodiscard]] std::uint64_t checks() const { return instance_.checks.validity; }

   private:
    Instance& instance_;
    mutable Configuration invalid_at_;
  };

 private:
  class Space final : public ompl::base::RealVectorStateSpace {
   public:
    explicit Space(trellis::Space space)
        : ompl::base::RealVectorStateSpace(static_cast<unsigned>(space.dimension())), space_(std::move(space)) {
      setName("Trellis");
      ompl::base::RealVectorBounds box(getDimension());
      // Samples come from the space itself; OMPL asks for some box.
      box.setLow(-1e6);
      box.setHigh(1e6);
      setBounds(box);
    }
    double distance(const ompl::base::State* a, const ompl::base::State* b) const override {
      return space_.distance(view(a), view(b));
    }
    void interpolate(const ompl::base::State* a, const ompl::base::State* b, double t,
                     ompl::base::State* out) const override {
      Configuration q(getDimension());
      space_.interpolate(view(a), view(b), t, q);
      std::copy(q.begin(), q.end(), out->as<StateType>()->values);
    }
    double getMaximumExtent() const override { return space_.diameter(); }
    double getMeasure() const override { return std::exp(space_.log_volume()); }
    ompl::base::StateSamplerPtr allocDefaultStateSampler() const override {
      return std::make_shared<Uniform>(this, space_);
    }

   private:
    class Uniform final : public ompl::base::StateSampler {
     public:
      Uniform(const ompl::base::StateSpace* space, const trellis::Space& of)
          : ompl::base::StateSampler(space),
            of_(of),
            stream_(static_cast<std::uint64_t>(rng_.uniformInt(0, 1 << 30)), "ompl", "uniform") {}
      void sampleUniform(ompl::base::State* state) override {
        Configuration q(of_.dimension());
        of_.sample_uniform(stream_, q);
        std::copy(q.begin(), q.end(), state->as<StateType>()->values);
      }
      void sampleUniformNear(ompl::base::State* state, const ompl::base::State* near, double distance) override {
        // Towards a uniform sample, at most so far.
        sampleUniform(state);
        const double whole = space_->distance(near, state);
        if (whole > distance) space_->interpolate(near, state, rng_.uniform01() * distance / whole, state);
      }
      void sampleGaussian(ompl::base::State* state, const ompl::base::State* mean, double deviation) override {
        sampleUniformNear(state, mean, std::abs(rng_.gaussian(0.0, deviation)));
      }

     private:
      const trellis::Space& of_;
      Stream stream_;
    };
    [[nodiscard]] View view(const ompl::base::State* q) const { return {q->as<StateType>()->values, getDimension()}; }
    trellis::Space space_;
  };

  static std::unique_ptr<Instance> made(const Problem& problem) {
    check(problem);
    return make_instance(problem);
  }

  std::unique_ptr<Instance> instance_;
  ompl::base::SpaceInformationPtr information_;
  ompl::base::ProblemDefinitionPtr definition_;
};

/// Lets a planner of OMPL draw from a guide: it has the state sampler and the valid state sampler of a space
/// information ask a Sampler, and reports what becomes of the draws. Nodes are found by their coordinates. It counts
/// the validity checks of the planner. A motion is invalid at the state that was found invalid.
///
/// Make it before the planner's setup(); it outlives the planner's solve. Its end gives the space information back its
/// validity checker and motion validator, and OMPL's samplers. It serves one planner and one solve: later ones may
/// continue its tree, but not after Planner::clear, before which `Sampler::cleared` is called. Planners that draw or
/// check in several threads are not supported; `connected` may be called by any thread, as PRM calls its termination
/// condition.
class OmplGuide {
 public:
  /// How the planner searches.
  enum class Search : std::uint8_t {
    tree,  ///< one tree, as RRT: from the start
    /// Two in turn, as RRTConnect: the first draw is for the tree from the start. A motion to the node that a draw has
    /// added counts as invalid, without a check, where the guide has evidence against it.
    trees,
    roadmap  ///< as PRM: of valid states, which it connects
  };

  /// \param information  its samplers, its validity checker and its motion validator are replaced
  /// \param sampler  of the same problem: the reals of a state are its coordinates. It outlives this object
  /// \param search  of the planner
  /// \param spent  called with each number of checks of the planner, and of the guide; empty: nothing is
  OmplGuide(const ompl::base::SpaceInformationPtr& information, Sampler& sampler, Search search,
            std::function<void(std::uint64_t)> spent = {})
      : ask_(std::make_shared<Ask>(information.get(), sampler, search, std::move(spent))),
        information_(information),
        valid_(information->getStateValidityChecker()),
        motions_(information->getMotionValidator()) {
    const auto ask = ask_;
    information->setStateValidityChecker(std::make_shared<Valid>(information.get(), valid_, *ask));
    information->setMotionValidator(std::make_shared<Motions>(information.get(), motions_, *ask));
    // It estimates the space's projection by many samples, which are not the guide's.
    information->setup();
    information->getStateSpace()->setStateSamplerAllocator(
        [ask](const ompl::base::StateSpace* of) { return std::make_shared<Draws>(of, *ask); });
    if (search == Search::tree) return;
    ask_->end = sampler.configuration(sampler.root(Side::goal));
    ask_->start = sampler.configuration(0);
    if (search == Search::trees) return;
    information->setValidStateSamplerAllocator(
        [ask](const ompl::base::SpaceInformation* of) { return std::make_shared<ValidDraws>(of, *ask); });
  }

  OmplGuide(const OmplGuide&) = delete;
  OmplGuide& operator=(const OmplGuide&) = delete;
  ~OmplGuide() {
    information_->setStateValidityChecker(valid_);
    information_->setMotionValidator(motions_);
    information_->getStateSpace()->clearStateSamplerAllocator();
    if (ask_->search == Search::roadmap) information_->clearValidStateSamplerAllocator();
  }

  /// Validity checks of the planner so far.
  [[nodiscard]] std::uint64_t checks() const { return ask_->checks; }
  /// Draws so far.
  [[nodiscard]] std::uint64_t draws() const { return ask_->draws; }
  /// Whether checked motions connect the start to the first goal in a roadmap: PRM itself looks once in a millisecond.
  [[nodiscard]] bool connected() const { return ask_->connected; }

 private:
  /// What the objects that OMPL calls share.
  struct Ask {
    Ask(ompl::base::SpaceInformation* of, Sampler& of_sampler, Search how, std::function<void(std::uint64_t)> with)
        : information(of),
          sampler(of_sampler),
          search(how),
          spent(std::move(with)),
          proposal(of_sampler.space().dimension()) {}

    [[nodiscard]] Configuration reals(const ompl::base::State* q) const {
      return reals_of(*information->getStateSpace(), q);
    }
    void count(std::uint64_t more) {
      checks += more;
      untold += more;
      if (spent) spent(more);
    }
    void draw(ompl::base::State* out) {
      close();
      sampler.spent(std::exchange(untold, 0));
      const std::uint64_t before = sampler.checks();
      const Side side = search == Search::trees && draws % 2 == 1 ? Side::goal : Side::start;
      pending = sampler.draw(proposal, side).id;
      ++draws;
      if (spent) spent(sampler.checks() - before);
      invalid.clear();
      grown.clear();
      information->getStateSpace()->copyFromReals(out, {proposal.begin(), proposal.end()});
      drawn = reals(out);
    }
    /// Answers a draw that no motion of a tree has answered: its state was invalid, or the planner left it.
    void close() {
      if (search == Search::roadmap) return close_roadmap();
      if (pending != 0) sampler.rejected(std::exchange(pending, 0), {}, proposal, invalid);
    }
    /// Answers with a motion of a tree. Motions to a goal's tree are checked from its child to the node.
    void tree_motion(Configuration from, Configuration to, bool valid, View place) {
      std::uint32_t near = sampler.node(from);
      if (near == no_node) {
        near = sampler.node(to);
        if (near != no_node) std::swap(from, to);
      }
      const std::uint64_t id = std::exchange(pending, 0);
      if (!valid) return sampler.rejected(id, from, to, place);
      if (sampler.node(to) != no_node) return close_unused(id);
      const bool reached = id == 0 || to == drawn;
      of_goal.resize(sampler.nodes());
      const bool goal =
          search == Search::trees && near != no_node && (near == sampler.root(Side::goal) || of_goal[near]);
      sampler.accepted(id, to, near, reached, true, goal ? Side::goal : Side::start);
      if (id != 0) grown = to;
      of_goal.push_back(goal);
    }
    /// Whether the guide has no evidence against the motion of the other tree to the node that a draw has added.
    bool worth_trying(const Configuration& a, const Configuration& b) {
      if (search != Search::trees || pending != 0 || grown.empty()) return true;
      return sampler.worth_connecting(sampler.node(a) != no_node ? a : b, grown);
    }
    void close_unused(std::uint64_t id) {
      if (id != 0) sampler.rejected(id, {}, proposal, {});
    }
    // Of a roadmap, whose answers wait until all motions of a draw are known:
    std::uint32_t place_of(const Configuration& q) {
      const auto [found, added] = places.try_emplace(q, static_cast<std::uint32_t>(components.size()));
      if (added) {
        components.push_back(found->second);
        states.push_back(q);
        numbers.push_back(no_node);
        told.push_back(false);
      }
      return found->second;
    }
    std::uint32_t component(std::uint32_t at) {
      while (components[at] != at) at = components[at] = components[components[at]];
      return at;
    }
    void plant() {
      for (const Side side : {Side::start, Side::goal}) {
        const std::uint32_t number = sampler.root(side);
        numbers[place_of(side == Side::start ? start : end)] = number;
      }
      told[0] = true;
    }
    void edge(const Configuration& a, const Configuration& b, bool valid) {
      if (!valid) {
        blocked.push_back({a, b, invalid});
        return;
      }
      const std::uint32_t x = component(place_of(a));
      const std::uint32_t y = component(place_of(b));
      if (x == y) return;
      gains = gains || x == component(0) || y == component(0);
      components[x] = y;
      if (component(0) == component(1)) connected = true;
    }
    void close_roadmap() {
      if (numbers.empty()) plant();
      const bool valid = pending != 0 && milestone;
      const std::uint32_t at = valid ? place_of(drawn) : no_node;
      if (valid && numbers[at] == no_node) {
        told[at] = component(at) == component(0);
        numbers[at] = sampler.accepted(pending, drawn, no_node, true, told[at]);
      } else if (pending != 0) {
        sampler.rejected(pending, {}, proposal, invalid);
      }
      pending = 0;
      milestone = false;
      for (const auto& [from, to, place] : blocked) sampler.rejected(0, from, to, place);
      blocked.clear();
      for (std::size_t i = std::exchange(gains, false) ? 1 : closed; i < states.size(); ++i) {
        const bool joins = !told[i] && component(static_cast<std::uint32_t>(i)) == component(0);
        if (joins) told[i] = true;
        if (numbers[i] == no_node) {
          numbers[i] = sampler.accepted(0, states[i], no_node, true, joins);
        } else if (joins) {
          sampler.joined(numbers[i]);
        }
      }
      closed = states.size();
    }

    ompl::base::SpaceInformation* information;
    Sampler& sampler;
    Search search;
    std::function<void(std::uint64_t)> spent;
    Configuration proposal;
    Configuration drawn;    ///< the proposal as OMPL stores it
    Configuration invalid;  ///< the last state found invalid since the last draw or motion
    Configuration grown;    ///< the node that the last draw has added to a tree
    std::uint64_t pending = 0;
    std::uint64_t draws = 0;
    std::uint64_t checks = 0;
    std::uint64_t untold = 0;
    std::vector<bool> of_goal;  ///< of nodes: of the tree from the goal
    // Of a roadmap's nodes, the start and the goal first:
    std::map<Configuration, std::uint32_t> places;
    std::vector<Configuration> states;
    std::vector<std::uint32_t> components;
    std::vector<std::uint32_t> numbers;  ///< of the sampler
    std::vector<bool> told;              ///< that it is connected to the start
    std::vector<std::array<Configuration, 3>> blocked;
    Configuration start;
    Configuration end;
    bool milestone = false;  ///< the draw is valid
    bool gains = false;      ///< nodes became connected to the start
    std::size_t closed = 1;  ///< the nodes after these are new to the sampler
    std::atomic<bool> connected = false;
  };

  class Valid final : public ompl::base::StateValidityChecker {
   public:
    Valid(ompl::base::SpaceInformation* of, ompl::base::StateValidityCheckerPtr inner, Ask& ask)
        : ompl::base::StateValidityChecker(of), inner_(std::move(inner)), ask_(ask) {}
    bool isValid(const ompl::base::State* q) const override {
      ask_.count(1);
      const bool valid = inner_->isValid(q);
      if (!valid) ask_.invalid = ask_.reals(q);
      return valid;
    }

   private:
    ompl::base::StateValidityCheckerPtr inner_;
    Ask& ask_;
  };

  class Motions final : public ompl::base::MotionValidator {
   public:
    Motions(ompl::base::SpaceInformation* of, ompl::base::MotionValidatorPtr inner, Ask& ask)
        : ompl::base::MotionValidator(of), inner_(std::move(inner)), ask_(ask) {}
    bool checkMotion(const ompl::base::State* a, const ompl::base::State* b) const override {
      if (!ask_.worth_trying(ask_.reals(a), ask_.reals(b))) return false;
      ask_.invalid.clear();
      const bool valid = checked([&] { return inner_->checkMotion(a, b); });
      answer(a, b, valid);
      return valid;
    }
    bool checkMotion(const ompl::base::State* a, const ompl::base::State* b,
                     std::pair<ompl::base::State*, double>& last) const override {
      ask_.invalid.clear();
      const bool valid = checked([&] { return inner_->checkMotion(a, b, last); });
      answer(a, b, valid);
      return valid;
    }

   private:
    /// Counts the checks of motions that do not call the validity checker.
    template <class Check>
    bool checked(const Check& check) const {
      const auto* own = dynamic_cast<const OmplProblem::Motions*>(inner_.get());
      if (own == nullptr) return check();
      const std::uint64_t before = own->checks();
      const bool valid = check();
      ask_.count(own->checks() - before);
      if (!valid) ask_.invalid.assign(own->invalid_at().begin(), own->invalid_at().end());
      return valid;
    }
    void answer(const ompl::base::State* a, const ompl::base::State* b, bool valid) const {
      ++(valid ? valid_ : invalid_);
      if (ask_.search == Search::roadmap) {
        ask_.edge(ask_.reals(a), ask_.reals(b), valid);
      } else {
        ask_.tree_motion(ask_.reals(a), ask_.reals(b), valid, ask_.invalid);
      }
    }

    ompl::base::MotionValidatorPtr inner_;
    Ask& ask_;
  };

  class Draws final : public ompl::base::StateSampler {
   public:
    Draws(const ompl::base::StateSpace* of, Ask& ask) : ompl::base::StateSampler(of), ask_(ask) {}
    void sampleUniform(ompl::base::State* state) override { ask_.draw(state); }
    void sampleUniformNear(ompl::base::State* state, const ompl::base::State* near, double distance) override {
      own().sampleUniformNear(state, near, distance);
    }
    void sampleGaussian(ompl::base::State* state, const ompl::base::State* mean, double deviation) override {
      own().sampleGaussian(state, mean, deviation);
    }

   private:
    /// OMPL's generators have seeds in the order in which they are made: this one is made only where it is used.
    ompl::base::StateSampler& own() {
      if (!own_) own_ = space_->allocDefaultStateSampler();
      return *own_;
    }

    Ask& ask_;
    ompl::base::StateSamplerPtr own_;
  };

  class ValidDraws final : public ompl::base::ValidStateSampler {
   public:
    ValidDraws(const ompl::base::SpaceInformation* of, Ask& ask) : ompl::base::ValidStateSampler(of), ask_(ask) {
      name_ = "guide";
    }
    bool sample(ompl::base::State* state) override {
      ask_.draw(state);
      ask_.milestone = si_->isValid(state);
      return ask_.milestone;
    }
    bool sampleNear(ompl::base::State* state, const ompl::base::State* near, double distance) override {
      si_->getStateSpace()->allocDefaultStateSampler()->sampleUniformNear(state, near, distance);
      return si_->isValid(state);
    }

   private:
    Ask& ask_;
  };

  std::shared_ptr<Ask> ask_;
  ompl::base::SpaceInformationPtr information_;
  ompl::base::StateValidityCheckerPtr valid_;  ///< the information's own
  ompl::base::MotionValidatorPtr motions_;
};

}  // namespace trellis

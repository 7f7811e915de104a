// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/guidance.hpp>

namespace trellis {

/// A distribution made of others, its parts: what most such distributions have in common. What the planner reports
/// reaches every part. What it asks about the last proposal is answered by the part that drew it. Lengths and counters
/// are sums over the parts; an edge has the minimum of their factors.
/// \tparam Base  Guidance, or a class derived from it
template <class Base>
class Composed : public Base {
 public:
  using Base::Base;

  void select_tree(TreeSide side) override {
    side_ = side;
    each([&](Guidance& part) { part.select_tree(side); });
  }
  void observe(const Outcome& outcome, bool mine) override {
    const Guidance* drew = drew_last();
    each([&](Guidance& part) { part.observe(outcome, mine && &part == drew); });
  }
  [[nodiscard]] std::uint32_t vertex() const override {
    const Guidance* drew = drew_last();
    return drew != nullptr ? drew->vertex() : no_node;
  }
  std::uint32_t draw_control(Stream& stream, const ControlQuery& query, MutableView control) override {
    Guidance* drew = drew_last();
    return drew != nullptr ? drew->draw_control(stream, query, control) : 0;
  }
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    const Guidance* drew = drew_last();
    return drew == nullptr || drew->worth_connecting(from, to);
  }
  [[nodiscard]] double progress() const override {
    double sum = 0.0;
    each([&](const Guidance& part) { sum += part.progress(); });
    return sum;
  }
  [[nodiscard]] double connected() const override {
    double sum = 0.0;
    each([&](const Guidance& part) { sum += part.connected(); });
    return sum;
  }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override {
    std::optional<double> least;
    each([&](const Guidance& part) { least = least_factor(least, part.edge_factor(a, b)); });
    return least;
  }
  void restart() override {
    each([](Guidance& part) { part.restart(); });
  }
  void found(double length) override {
    each([&](Guidance& part) { part.found(length); });
  }
  [[nodiscard]] std::uint64_t epoch() const override {
    std::uint64_t sum = 0;
    each([&](const Guidance& part) { sum += part.epoch(); });
    return sum;
  }
  /// Those of all parts, in their order.
  [[nodiscard]] std::vector<std::string> sources() const override {
    std::vector<std::string> all;
    each([&](const Guidance& part) {
      for (std::string& name : part.sources()) all.push_back(std::move(name));
    });
    return all;
  }

 protected:
  /// Number of parts.
  [[nodiscard]] virtual std::size_t part_count() const = 0;
  /// A part; nullptr while there is none with this number.
  [[nodiscard]] virtual Guidance* part_at(std::size_t i) const = 0;
  /// The part that drew the last proposal; nullptr if this distribution drew it itself.
  [[nodiscard]] virtual Guidance* drew_last() const = 0;
  /// The tree that the last proposal, or the next one, is for.
  [[nodiscard]] TreeSide side() const { return side_; }

 private:
  template <class F>
  void each(const F& call) const {
    for (std::size_t i = 0; i < part_count(); ++i) {
      if (Guidance* part = part_at(i); part != nullptr) call(*part);
    }
  }

  TreeSide side_ = TreeSide::start;
};

/// A distribution made of one other.
/// \tparam Base  see Composed
/// \tparam Part  class of the other
template <class Base, class Part>
class Wrapping : public Composed<Base> {
 public:
  explicit Wrapping(std::unique_ptr<Part> part) : part_(std::move(part)) {}

 protected:
  [[nodiscard]] std::size_t part_count() const override { return 1; }
  [[nodiscard]] Guidance* part_at(std::size_t) const override { return part_.get(); }
  [[nodiscard]] Guidance* drew_last() const override { return part_.get(); }
  [[nodiscard]] Part* part() const { return part_.get(); }
  /// Sets another part and selects its tree, that of the next proposal; nullptr: none.
  void replace(std::unique_ptr<Part> part) {
    part_ = std::move(part);
    if (part_) part_->select_tree(this->side());
  }

 private:
  std::unique_ptr<Part> part_;
};

}  // namespace trellis

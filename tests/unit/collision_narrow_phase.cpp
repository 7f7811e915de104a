// SPDX-License-Identifier: GPL-3.0-or-later
// What a checker makes of the answers of its narrow phase.
#include <trellis/collision/narrow_phase.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <trellis/collision/orders.hpp>
#include "collision_worlds.hpp"
#include "support/catch.hpp"

using namespace collision_test;

namespace {

/// The answers of a narrow phase, and the questions that it was asked.
struct Answers {
  double displacement = 1.0;
  NarrowPhase::Decision decision = NarrowPhase::Decision::undecided;
  std::vector<std::uint32_t> batches = {8};  ///< sizes; the last one repeats
  std::uint32_t first = 0;  ///< the rank of the first configuration that touches; the later ones do too
  std::optional<double> between = {};
  bool swept = false;
  double distance = 1.0;
  std::optional<double> sure = {};

  std::uint32_t asked = 0;  ///< functions called
  std::vector<std::uint32_t> ended = {};
  std::vector<double> longest = {};
};

class AnsweringPhase final : public NarrowPhase {
 public:
  explicit AnsweringPhase(Answers& answers) : answers_(answers), clearance_(answers) {}

  [[nodiscard]] double displacement(View /*a*/, View /*b*/) const override {
    ++answers_.asked;
    return answers_.displacement;
  }
  Decision begin(View /*a*/, View /*b*/, std::uint32_t n) override {
    ++answers_.asked;
    n_ = n;
    batch_ = 0;
    return answers_.decision;
  }
  Batch check(const Order& order, std::uint32_t rank) override {
    REQUIRE(order.indices.size() == n_);
    const std::uint32_t count = std::min(answers_.batches[batch_], n_ - rank);
    if (batch_ + 1 < answers_.batches.size()) ++batch_;
    std::uint32_t touches = 0;
    for (std::uint32_t i = 0; i < count; ++i) touches |= rank + i >= answers_.first ? 1U << i : 0U;
    return {count, touches};
  }
  std::optional<double> end(std::uint32_t first) override {
    answers_.ended.push_back(first);
    return first == n_ ? answers_.between : std::nullopt;
  }
  bool sweep(View /*a*/, View /*b*/, Certificate& /*certificate*/) override {
    ++answers_.asked;
    return answers_.swept;
  }
  Distances on(View /*a*/, View /*b*/, double longest) override {
    answers_.longest.push_back(longest);
    return {clearance_, answers_.displacement, longest, {}, answers_.sure};
  }
  [[nodiscard]] bool touches(View /*q*/) const override { return ++answers_.asked == 0; }
  [[nodiscard]] double clearance(View /*q*/) const override { return ++answers_.asked; }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View /*q*/) const override { return std::nullopt; }
  [[nodiscard]] std::optional<Contact> contact(View /*q*/) const override {
    ++answers_.asked;
    return std::nullopt;
  }
  [[nodiscard]] double invalid_radius(View /*q*/) const override { return ++answers_.asked; }

 private:
  class Clearance final : public MotionClearance {
   public:
    explicit Clearance(const Answers& answers) : answers_(answers) {}
    [[nodiscard]] unsigned apart(std::span<const double> /*shares*/, double /*half*/, double /*margin*/) override {
      return 0;
    }
    [[nodiscard]] Near near(double /*share*/, double half, double at_most) override {
      const double distance = std::min(answers_.distance, at_most);
      return {distance, distance - half * answers_.displacement};
    }

   private:
    const Answers& answers_;
  };

  Answers& answers_;
  Clearance clearance_;
  std::uint32_t n_ = 0;
  std::size_t batch_ = 0;
};

Checker checker_of(Answers& answers) {
  static const Case c = mixed_cases().front();
  return {*c.scene, std::make_unique<AnsweringPhase>(answers), 1.0};
}

Configuration at(double x) {
  static const Case c = mixed_cases().front();
  Configuration q(c.space.dimension(), x);
  return q;
}

}  // namespace

TEST_CASE("the first configuration that touches decides a motion, however many a step checks") {
  for (const std::vector<std::uint32_t>& batches : {std::vector<std::uint32_t>{1}, {8}, {32}, {1, 1, 8}}) {
    for (std::uint32_t n = 1; n <= 40; ++n) {
      for (std::uint32_t first = 0; first <= n; ++first) {
        Answers answers;
        answers.displacement = n;
        answers.batches = batches;
        answers.first = first;
        const Checker checker = checker_of(answers);
        const MotionReport report = checker.motion(at(0.0), at(1.0));
        REQUIRE(report.valid == (first == n));
        REQUIRE(report.checks == std::min(first + 1, n));
        REQUIRE(answers.ended == std::vector<std::uint32_t>{first});
        if (report.valid) {
          REQUIRE(std::isnan(report.invalid_at));
        } else {
          REQUIRE(report.invalid_at == bisection_order(n)[first] / static_cast<double>(n));
        }
      }
    }
  }
}

TEST_CASE("a checker takes a decision about the whole motion, and asks no further") {
  Answers answers;
  answers.displacement = 20.0;
  answers.decision = NarrowPhase::Decision::valid;
  const Checker checker = checker_of(answers);
  const MotionReport free = checker.motion(at(0.0), at(1.0));
  CHECK(free.valid);
  CHECK(free.checks == 20);
  answers.decision = NarrowPhase::Decision::end_touches;
  const MotionReport met = checker.validate(at(0.0), at(1.0), 20);
  CHECK_FALSE(met.valid);
  CHECK(met.checks == 1);
  CHECK(met.invalid_at == 1.0);
  CHECK(answers.ended.empty());
}

TEST_CASE("what a point touches between valid configurations counts all of them") {
  Answers answers;
  answers.displacement = answers.first = 9;
  answers.between = 0.3;
  const Checker checker = checker_of(answers);
  const MotionReport report = checker.motion(at(0.0), at(1.0));
  CHECK_FALSE(report.valid);
  CHECK(report.checks == 9);
  CHECK(report.invalid_at == 0.3);
}

TEST_CASE("a narrow phase receives finite coordinates only") {
  Answers answers;
  const Checker checker = checker_of(answers);
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    CHECK_FALSE(checker.valid(at(x)));
    CHECK(checker.most_checks(at(0.0), at(x)) == 1);
    const MotionReport report = checker.motion(at(0.0), at(x));
    CHECK_FALSE(report.valid);
    CHECK(report.checks == 1);
    CHECK(checker.clearance(at(x)) == 0.0);
    CHECK(checker.invalid_radius(at(x)) == 0.0);
    CHECK(checker.contact(at(x)).has_value());
    Certificate to{.tolerance = 1e-3};
    checker.certify(at(0.0), at(x), to);
    CHECK(to.refuted_at == 1.0);
    Certificate from{.tolerance = 1e-3};
    checker.certify(at(x), at(0.0), from);
    CHECK(from.refuted_at == 0.0);
  }
  CHECK(answers.asked == 0);
}

TEST_CASE("a certificate begins with intervals of the resolution, or of twice its distance") {
  Answers answers;
  answers.distance = 3.0;
  const Checker checker = checker_of(answers);
  Certificate certificate{.tolerance = 1e-3};
  checker.certify(at(0.0), at(1.0), certificate);
  checker.certify(at(0.0), at(1.0), certificate);
  CHECK(certificate.valid());
  CHECK(certificate.nearest == 3.0);
  CHECK(answers.longest == std::vector<double>{1.0, 6.0});
  answers.swept = true;
  checker.certify(at(0.0), at(1.0), certificate);
  CHECK(answers.longest.size() == 2);
}

TEST_CASE("distances refute no motion that is free of contact for another reason") {
  Answers answers;
  answers.distance = 1e-9;
  const Checker checker = checker_of(answers);
  Certificate refuted{.tolerance = 1e-3};
  checker.certify(at(0.0), at(1.0), refuted);
  CHECK_FALSE(refuted.valid());
  answers.sure = 1e-12;
  Certificate certified{.tolerance = 1e-3};
  checker.certify(at(0.0), at(1.0), certified);
  CHECK(certified.valid());
  CHECK(certified.clearance == 1e-12);
}

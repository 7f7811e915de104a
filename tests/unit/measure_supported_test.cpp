// SPDX-License-Identifier: GPL-3.0-or-later
// The interval of SE that samples support: it holds the truth, or is blank.
#include <cmath>
#include <cstdlib>

#include <trellis/measure/efficiency.hpp>

#include "support/catch.hpp"
#include "verify/supported_cases.hpp"

using namespace trellis;

namespace {

const verify::SupportedCase& find(const std::vector<verify::SupportedCase>& cases, const std::string& name) {
  for (const auto& c : cases) {
    if (c.name == name) return c;
  }
  throw Error("no case " + name);
}

}  // namespace

TEST_CASE("thin guidance has an interval that holds the truth, or none", "[supported]") {
  const auto cases = verify::supported_cases(3);
  const auto& thin = find(cases, "0.3 m x 0.8 rad");
  CHECK(thin.truth == Approx(5.12).margin(0.01));
  CHECK(verify::StraightTube(3).target(1)->uniform() == Approx(2.43).margin(0.01));
  for (const std::size_t n : {40U, 100U, 300U, 1000U}) {
    CAPTURE(n);
    const auto result = verify::supported_result(3, thin, n, 1, 4);
    CHECK(result.missed + result.missed_blank == 0);
    if (n == 1000) {
      CHECK(result.printed == 4);
      CHECK(result.lo > 2.43);
    }
  }
}

TEST_CASE("samples of the target itself are distinguished from thin ones", "[supported]") {
  for (const std::size_t d : {2U, 3U, 6U, 7U}) {
    CAPTURE(d);
    const auto cases = verify::supported_cases(d);
    const auto perfect = verify::supported_result(d, find(cases, "T itself"), 300, 1, 3);
    CHECK(perfect.missed + perfect.missed_blank == 0);
    CHECK(perfect.printed == 3);
    CHECK(perfect.hi < 1.0);
    const auto thin = verify::supported_result(d, find(cases, "a tube of 0.3 radii"), 300, 1, 3);
    CHECK(thin.missed + thin.missed_blank == 0);
    CHECK(thin.hi > 2.0);
  }
}

TEST_CASE("recorded densities are their own interval, and blanks state why", "[supported]") {
  const verify::StraightTube tube(2);
  const auto target = tube.target(1);
  Configurations rows(2);
  Configuration x(2);
  Stream stream(1, "", "rows");
  for (int i = 0; i < 20; ++i) {
    tube.draw(stream, x);
    rows.push(x);
  }
  const double inside = std::exp(-target->log_volume());
  const Efficiency e =
      efficiency(*target, rows, {.density = [&](View v) { return target->contains(v) ? inside : 0.0; }});
  CHECK(e.estimator == "exact");
  CHECK(e.value_lo == e.value);
  CHECK(e.value_hi == e.value);
  CHECK(e.value == Approx(e.perfect));
  CHECK(blank_reason(0.1, 5.0, 2.0).find("uniform") != std::string::npos);
  CHECK(blank_reason(0.1, 1.9, 2.0).empty());
  CHECK(blank_reason(2.1, 5.0, 2.0).empty());
  CHECK(blank_reason(1.8, 2.2, 2.0).empty());
}

TEST_CASE("a target that covers nearly the whole space is flagged", "[supported]") {
  const Space space = Space::euclidean({{0, 1}, {0, 1}});
  Configurations path(2);
  path.push(Configuration{0.1, 0.5});
  path.push(Configuration{0.9, 0.5});
  Configurations rows(2);
  for (int i = 0; i < 30; ++i) rows.push(Configuration{(i + 0.5) / 30, std::fmod(i * 0.618, 1.0)});
  const auto flags_of = [&](double delta) {
    TubeSettings settings;
    settings.delta = delta;
    return efficiency(Target(space, path, {0, 1}, settings, verify::anywhere, 1), rows).flags;
  };
  const auto raised = [](const std::vector<std::string>& flags) {
    return std::find(flags.begin(), flags.end(), "covers the space") != flags.end();
  };
  CHECK(raised(flags_of(0.5)));
  CHECK_FALSE(raised(flags_of(0.1)));
}

// SPDX-License-Identifier: GPL-3.0-or-later
// trellis plot: figures of stored results.
#include <filesystem>
#include <string>

#include "support/catch.hpp"
#include "support/process.hpp"

using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

/// A folder with results, and the figures that the run itself drew.
struct Results {
  Results() {
    place.script("it.lua", R"(
return experiment {
  problems = { scenes.cup(), scenes.trap() },
  strategies = { guided = skeleton() >> rrt { step = 0.5 }, rrt = rrt { step = 0.5, proposals = 20000 } },
  seeds = 4, measure = false, baseline = "rrt",
}
)");
    REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json", "--figures", "drawn"}).status == 0);
  }
  [[nodiscard]] Outcome plot(const std::string& figure) const {
    return place.run({"plot", "it.json", "--out", "plots", "--figure", figure});
  }

  Place place;
};

}  // namespace

TEST_CASE("plot draws the same bytes from stored results as the run did") {
  const Results results;
  const Outcome all = results.place.run({"plot", "it.json", "--out", "plots"});
  CHECK(all.status == 0);
  for (const char* name : {"cup/success.svg", "cup/ratios.svg", "trap/success.svg", "trap/ratios.svg", "ratios.svg"}) {
    CAPTURE(name);
    const std::string drawn = content(results.place / (std::string("drawn/") + name));
    CHECK_FALSE(drawn.empty());
    CHECK(content(results.place / (std::string("plots/") + name)) == drawn);
  }
}

TEST_CASE("plot draws one figure, and says what it cannot draw") {
  const Results results;
  const Outcome one = results.plot("success");
  CHECK(one.status == 0);
  CHECK(one.out == "plots/cup/success.svg, .png, .pdf\nplots/trap/success.svg, .png, .pdf\n");
  CHECK_FALSE(std::filesystem::exists(results.place / "plots/ratios.svg"));
  const Outcome length = results.plot("length");
  CHECK(length.status == 2);
  CHECK(length.err ==
        "trellis: --figure length: no strategy of the files improves its path, so there is nothing to draw\n");
  const Outcome other = results.place.run({"plot", "it.json", "--out", "plots", "--baseline", "rtr"});
  CHECK(other.status == 2);
  CHECK(other.err.find("there is no strategy 'rtr'") != std::string::npos);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// trellis report --figures: figures of stored results.
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"

using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

/// A folder with results.
struct Results {
  Results() {
    place.script("it.lua", R"(
return experiment {
  problems = { scenes.cup(), scenes.trap() },
  strategies = { guided = skeleton() >> rrt { step = 0.5 }, rrt = rrt { step = 0.5, proposals = 20000 } },
  seeds = 4, measure = false, baseline = "rrt",
}
)");
    REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json"}).status == 0);
  }
  [[nodiscard]] Outcome plot(const std::string& figure) const {
    return place.run({"report", "it.json", "--figures", "plots", "--figure", figure});
  }

  Place place;
};

}  // namespace

TEST_CASE("report --figures draws one figure, and says what it cannot draw") {
  if (!trellis::test::draws_figures()) return;
  const Results results;
  const Outcome one = results.plot("success");
  CHECK(one.status == 0);
  CHECK(one.out == "plots/success.svg\nplots/success.pdf\nplots/success.png\n");
  CHECK_FALSE(std::filesystem::exists(results.place / "plots/ratios.svg"));
  const Outcome length = results.plot("length");
  CHECK(length.status == 2);
  CHECK(length.err.starts_with("trellis: it.json: "));
  CHECK(std::count(length.err.begin(), length.err.end(), '\n') == 1);
  const Outcome unknown = results.plot("sucess");
  CHECK(unknown.status == 2);
  CHECK(unknown.err.starts_with("trellis: there is no figure 'sucess' (did you mean 'success'?)"));
  const Outcome other =
      results.place.run({"report", "it.json", "--figures", "plots", "--figure", "costs", "--baseline", "rtr"});
  CHECK(other.status == 2);
  CHECK(other.err.find("there is no strategy 'rtr' (did you mean 'rrt'?)") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(results.place / "plots/costs.svg"));
}

TEST_CASE("report --figures draws the costs of several documents together") {
  if (!trellis::test::draws_figures()) return;
  const Results results;
  REQUIRE(results.place.run({"run", "it.lua", "--quiet", "--seed", "9", "--json", "more.json"}).status == 0);
  const Outcome two = results.place.run({"report", "it.json", "more.json", "--figures", "two", "--figure", "costs"});
  CHECK(two.out == "two/costs.svg\ntwo/costs.pdf\ntwo/costs.png\n");
  CHECK(results.place.run({"report", "it.json", "it.json", "--figures", "two"}).err.find("is there twice") !=
        std::string::npos);
}

TEST_CASE("report --html writes the page of the run", "[slow]") {
  const Place place;
  place.script("it.lua", R"(
return experiment {
  problems = { scenes.cup(), scenes.simple_passage() },
  strategies = {
    guided = skeleton() >> rrt { step = 0.5 },
    ["a/b"] = (0.5*skeleton() + 0.5*shrink(0.5)) >> rrt { step = 0.5 },
    shrink = shrink(0.5) >> rrt { step = 0.5 },
    rrt = rrt { step = 0.5, proposals = 4000 },
  },
  seeds = 5, measure = tube { delta = 0.5 }, baseline = "rrt", ablate = true,
}
)");
  REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json"}).status == 0);
  const Outcome compared = place.run({"report", "it.json", "--report", "costs"});
  CHECK(compared.out.find("3 strategies with guides on 2 problems, 6 pairs of both") != std::string::npos);

  // The page has the same tables, warnings and figures, and no run to replay.
  REQUIRE(place.run({"run", "it.lua", "--quiet", "--html", "run.html", "--json", "it.json"}).status == 0);
  REQUIRE(place.run({"report", "it.json", "--html", "plot.html"}).status == 0);
  const std::string run = content(place / "run.html");
  const std::string plotted = content(place / "plot.html");
  for (const auto& [begin, end] :
       {std::pair{"<header>", "</header>"}, std::pair{"<section id=\"answer\"", "</section>"},
        std::pair{"<details id=\"fold-summary\"", "</details>"},
        std::pair{"<template", "<script type=\"application/json\" id=\"data\""}}) {
    const auto part = [&, from = begin, to = end](const std::string& page) {
      const auto at = page.find(from);
      REQUIRE(at != std::string::npos);
      return page.substr(at, page.find(to, at) - at);
    };
    CAPTURE(begin);
    CHECK(part(plotted) == part(run));
    CHECK(part(plotted).size() > 100);
  }
  CHECK(run.find("id=\"run-0\"") != std::string::npos);
  CHECK(plotted.find("id=\"run-0\"") == std::string::npos);
  CHECK(plotted.find("This page is made of it.json, which has no samples") != std::string::npos);
  CHECK(place.run({"report", "it.json", "it.json", "--html", "two.html"}).status == 2);
}

TEST_CASE("report draws a sweep, and says why it draws no figure of a measure") {
  const Place place;
  place.script("it.lua", "return rrt { step = 0.5 }, scenes.cup()\n");
  REQUIRE(place.run({"sweep", "it.lua", "--seeds", "2", "--out", "sweep", "--quiet"}).status == 0);
  REQUIRE(place.run({"report", "sweep/results.json", "--html", "page.html"}).status == 0);
  CHECK(content(place / "page.html").find("2/2") != std::string::npos);
  if (!trellis::test::draws_figures()) return;
  REQUIRE(place.run({"report", "sweep/results.json", "--figures", "plots", "--figure", "costs"}).status == 0);
  for (const std::string figure : {"waterfall", "correlation"}) {
    const Outcome none = place.run({"report", "sweep/results.json", "--figures", "plots", "--figure", figure});
    CAPTURE(figure, none.err);
    CHECK(none.status == 2);
    CHECK(none.err.starts_with("trellis: "));
    CHECK(std::count(none.err.begin(), none.err.end(), '\n') == 1);
  }
}

TEST_CASE("report of costs takes the first strategy without a guide for the baseline, as run does") {
  const Place place;
  place.script("it.lua", R"(
return experiment {
  problems = { scenes.cup() },
  strategies = { { "guided", skeleton() >> rrt {} }, { "plain", rrt { proposals = 20000 } } },
  seeds = 4, measure = false,
}
)");
  REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json"}).status == 0);
  const Outcome compared = place.run({"report", "it.json", "--report", "costs"});
  CHECK(compared.status == 0);
  CHECK(compared.out.find("costs divided by those of plain, 1 problem, 4 seeds") != std::string::npos);
  // Without groups there is nothing that strategies were tuned on.
  CHECK(compared.out.find("guided") != std::string::npos);
  CHECK(compared.out.find("tuned on") == std::string::npos);
  CHECK(compared.out.find("held out") == std::string::npos);
}

TEST_CASE("report says which options belong together") {
  const Place place;
  place.script("it.lua", "return rrt { step = 0.5 }, scenes.cup()\n");
  REQUIRE(place.run({"run", "it.lua", "--seeds", "2", "--quiet", "--json", "it.json"}).status == 0);
  const auto error = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"report", "it.json"});
    const Outcome outcome = place.run(options);
    CHECK(outcome.status == 2);
    return outcome.err;
  };
  CHECK(error({"--figure", "success"}) == "trellis: --figure: --figures FOLDER says where the figure goes\n");
  CHECK(error({"--report", "full", "--by-name"}) == "trellis: --by-name: it is of --report costs\n");
  CHECK(error({"--baseline", "rrt"}) ==
        "trellis: --baseline: it is of --report costs and --figures; a report has the baseline of its experiment\n");
  CHECK(error({"it.json", "--report", "levels"}).find("--report levels: it is of one document") != std::string::npos);
  // A page or figures alone print no report.
  CHECK(place.run({"report", "it.json", "--html", "page.html"}).out.empty());
  CHECK(place.run({"report", "it.json", "--html", "page.html", "--report", "overview"}).out ==
        place.run({"report", "it.json"}).out);
}

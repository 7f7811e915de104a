// SPDX-License-Identifier: GPL-3.0-or-later
// trellis report --figures: figures of stored results.
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

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
    return place.run({"report", "it.json", "--figures", "plots", "--figure", figure});
  }

  Place place;
};

}  // namespace

TEST_CASE("report --figures draws the same bytes from stored results as the run did") {
  const Results results;
  const Outcome all = results.place.run({"report", "it.json", "--figures", "plots"});
  CHECK(all.status == 0);
  for (const char* name : {"cup/success.svg", "cup/ratios.svg", "trap/success.svg", "trap/ratios.svg", "ratios.svg"}) {
    CAPTURE(name);
    const std::string drawn = content(results.place / (std::string("drawn/") + name));
    CHECK_FALSE(drawn.empty());
    CHECK(content(results.place / (std::string("plots/") + name)) == drawn);
  }
}

TEST_CASE("report --figures draws one figure, and says what it cannot draw") {
  const Results results;
  const Outcome one = results.plot("success");
  CHECK(one.status == 0);
  CHECK(one.out == "plots/cup/success.svg, .png, .pdf\nplots/trap/success.svg, .png, .pdf\n");
  CHECK_FALSE(std::filesystem::exists(results.place / "plots/ratios.svg"));
  const Outcome length = results.plot("length");
  CHECK(length.status == 2);
  CHECK(length.err ==
        "trellis: --figure length: no strategy of the files improves its path, so there is nothing to draw\n");
  const Outcome other = results.place.run({"report", "it.json", "--figures", "plots", "--baseline", "rtr"});
  CHECK(other.status == 2);
  CHECK(other.err.find("there is no strategy 'rtr'") != std::string::npos);
}

TEST_CASE("report --figures draws the panels and curves that were chosen, and the sweep of a number") {
  const Place place;
  place.script("it.lua", R"(
local s = { rrt = rrt { step = 0.5, proposals = 20000 } }
for _, f in ipairs { 0.3, 0.5, 0.7 } do s["shrink " .. f] = shrink(f) >> rrt { step = 0.5, proposals = 20000 } end
return experiment { problems = scenes.cup(), strategies = s, seeds = 4, measure = false, baseline = "rrt" }
)");
  REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json", "--figures", "drawn"}).status == 0);
  const auto plot = [&](const std::string& folder, std::vector<std::string> options) {
    std::vector<std::string> words = {"report", "it.json", "--figures", folder};
    words.insert(words.end(), options.begin(), options.end());
    REQUIRE(place.run(words).status == 0);
  };
  plot("all", {});
  CHECK(content(place / "all/cup/sweep.svg") == content(place / "drawn/cup/sweep.svg"));
  CHECK_FALSE(std::filesystem::exists(place / "all/cup/ratios.svg"));
  plot("checks", {"--figure", "success", "--panels", "checks"});
  plot("one", {"--figure", "success", "--panels", "checks", "--curves", "9"});
  CHECK(content(place / "checks/cup/success.svg") != content(place / "all/cup/success.svg"));
  CHECK(content(place / "one/cup/success.svg") == content(place / "checks/cup/success.svg"));  // four curves at most
  plot("rows", {"--figure", "success", "--panels", "checks", "--curves", "1"});
  CHECK(content(place / "rows/cup/success.svg") != content(place / "checks/cup/success.svg"));
}

TEST_CASE("report --figures draws the figures of the measure as the run did", "[slow]") {
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
  REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json", "--figures", "drawn"}).status == 0);
  REQUIRE(place.run({"report", "it.json", "--figures", "plots"}).status == 0);
  std::size_t same = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(place / "drawn")) {
    const std::string name = std::filesystem::relative(entry.path(), place / "drawn").string();
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".svg" || stem == "samples" || stem == "levels") continue;
    CAPTURE(name);
    CHECK(content(place / ("plots/" + name)) == content(entry.path()));
    ++same;
  }
  // Two comparisons of each problem, the waterfalls, ratios and correlation of all, and 4 figures of each strategy with
  // guides.
  CHECK(same >= 2 * 3 + 2 + 2 * 3 * 4);
  REQUIRE(place.run({"report", "it.json", "--out", "costs"}).status == 0);
  CHECK(content(place / "costs/figures/correlation.svg") == content(place / "drawn/correlation.svg"));
  const Outcome compared = place.run({"report", "it.json", "--report", "costs"});
  CHECK(compared.out.find("3 strategies with guides on 2 problems, 6 pairs of both") != std::string::npos);
  CHECK(content(place / "costs/table.md").find("## Rank correlation of efficiency and checks") != std::string::npos);

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

  const Outcome one = place.run({"report", "it.json", "--figures", "one", "--figure", "waterfalls"});
  CHECK(one.out == "one/cup/waterfalls.svg, .png, .pdf\none/simple_passage/waterfalls.svg, .png, .pdf\n");

  // Documents of the format before have costs, and a note says what is left out.
  std::string older = content(place / "it.json");
  const std::string format = "\"format\":4";
  REQUIRE(older.find(format) != std::string::npos);
  older.replace(older.find(format), format.size(), "\"format\":2");
  std::ofstream(place / "old.json") << older;
  const Outcome old = place.run({"report", "old.json", "--figures", "old"});
  CHECK(old.status == 0);
  CHECK(old.err.find("note: old.json: its figures of the measure are left out") != std::string::npos);
  CHECK(std::filesystem::exists(place / "old/cup/success.svg"));
  CHECK_FALSE(std::filesystem::exists(place / "old/cup/waterfalls.svg"));
  CHECK(place.run({"report", "old.json", "--figures", "old", "--figure", "success"}).err.empty());
  CHECK(place.run({"report", "old.json", "--figures", "old", "--figure", "waterfalls"}).status == 2);

  // Efficiencies of two documents do not add up; their costs do.
  const std::vector<std::string> more = {"run", "it.lua", "--quiet", "--seed", "6", "--json", "more.json"};
  REQUIRE(place.run(more).status == 0);
  const Outcome two = place.run({"report", "it.json", "more.json", "--figures", "two"});
  CHECK(two.status == 0);
  CHECK(two.err.find("is in several files, whose efficiencies do not add up") != std::string::npos);
  CHECK(std::filesystem::exists(place / "two/cup/success.svg"));
  CHECK_FALSE(std::filesystem::exists(place / "two/cup/waterfalls.svg"));
  CHECK(place.run({"report", "it.json", "more.json", "--figures", "three", "--figure", "strip"}).status == 2);
}

TEST_CASE("report --figures draws a sweep") {
  const Place place;
  place.script("it.lua", "return rrt { step = 0.5 }, scenes.cup()\n");
  REQUIRE(place.run({"sweep", "it.lua", "--seeds", "2", "--out", "sweep", "--quiet"}).status == 0);
  REQUIRE(place.run({"report", "sweep/results.json", "--html", "page.html"}).status == 0);
  CHECK(content(place / "page.html").find("2/2") != std::string::npos);
  REQUIRE(place.run({"report", "sweep/results.json", "--figures", "plots"}).status == 0);
}

TEST_CASE("report --figures says why it draws no figure of a measure") {
  const Results results;
  const Outcome strip = results.plot("strip");
  CHECK(strip.status == 2);
  CHECK(strip.err ==
        "trellis: --figure strip: the files have no scored strategy, as of `measure = false` or of a sweep\n");
  const Outcome correlation = results.plot("correlation");
  CHECK(correlation.status == 2);
  CHECK(correlation.err.find("--figure correlation: the files do not have two problems with three scored strategies") !=
        std::string::npos);
}

TEST_CASE("report of costs and figures take the first strategy without a guide for the baseline, as run does") {
  const Place place;
  place.script("it.lua", R"(
return experiment {
  problems = { scenes.cup() },
  strategies = { { "guided", skeleton() >> rrt {} }, { "plain", rrt { proposals = 20000 } } },
  seeds = 4, measure = false,
}
)");
  REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json", "--figures", "drawn"}).status == 0);
  const Outcome compared = place.run({"report", "it.json", "--out", "costs"});
  CHECK(compared.status == 0);
  CHECK(compared.out.find("costs divided by those of plain, 1 problem, 4 seeds") != std::string::npos);
  // Without groups there is nothing that strategies were tuned on.
  for (const std::string& text : {compared.out, content(place / "costs/table.md")}) {
    CHECK(text.find("guided") != std::string::npos);
    CHECK(text.find("tuned on") == std::string::npos);
    CHECK(text.find("held out") == std::string::npos);
  }
  REQUIRE(place.run({"report", "it.json", "--figures", "plots"}).status == 0);
  CHECK(content(place / "plots/cup/ratios.svg") == content(place / "drawn/cup/ratios.svg"));
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
  CHECK(error({"--report", "full", "--out", "there"}) == "trellis: --out: its tables are those of --report costs\n");
  CHECK(error({"--report", "full", "--by-name"}) == "trellis: --by-name: it is of --report costs\n");
  CHECK(error({"--baseline", "rrt"}) ==
        "trellis: --baseline: it is of --report costs and --figures; a report has the baseline of its experiment\n");
  CHECK(error({"it.json", "--report", "levels"}).find("--report levels: it is of one document") != std::string::npos);
  // A page or figures alone print no report.
  CHECK(place.run({"report", "it.json", "--html", "page.html"}).out.empty());
  CHECK(place.run({"report", "it.json", "--html", "page.html", "--report", "overview"}).out ==
        place.run({"report", "it.json"}).out);
}

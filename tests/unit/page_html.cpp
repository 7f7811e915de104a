// SPDX-License-Identifier: GPL-3.0-or-later
// The page as a file. tests/browser tests it in a browser.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/draw/palette.hpp>
#include <trellis/page/html.hpp>
#include <trellis/report/report.hpp>

#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/space.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Json = nlohmann::json;

namespace {

/// What is wrong with the page's tags, "" where nothing is: those that do not close in turn, bare '<' in text.
std::string fault(const std::string& html) {
  const std::set<std::string> empty = {"meta", "input", "br", "link"};
  std::vector<std::string> open;
  for (std::size_t i = html.find("<html"); i < html.size();) {
    if (html[i] != '<') {
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    for (char quote = 0; end < html.size() && (quote != 0 || html[end] != '>'); ++end) {
      if (html[end] == '"') quote = quote == 0 ? '"' : '\0';
    }
    const std::string tag = html.substr(i + 1, end - i - 1);
    const std::string name = tag.substr(0, tag.find_first_of(" \n/"));
    if (tag.starts_with("/")) {
      if (open.empty() || open.back() != tag.substr(1)) return "</" + tag.substr(1) + "> closes nothing";
      open.pop_back();
    } else if (tag.empty() || std::isalpha(static_cast<unsigned char>(tag[0])) == 0) {
      return "a bare < before " + html.substr(i, 40);
    } else if (empty.count(name) == 0) {
      open.push_back(name);
    }
    i = end + 1;
    if (name == "script" || name == "style") {
      i = html.find("</" + name + ">", i);
      if (i == std::string::npos) return "<" + name + "> is not closed";
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

/// The text of the <script> with an id; "" without one.
std::string script(const std::string& html, const std::string& id) {
  const std::string head = "id=\"" + id + "\">";
  const std::size_t begin = html.find(head);
  if (begin == std::string::npos) return "";
  return html.substr(begin + head.size(), html.find("</script>", begin) - begin - head.size());
}

std::string bytes(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : base64) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) continue;
    held = (held << 6U) | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    out += static_cast<char>((held >> static_cast<unsigned>(bits)) & 255U);
  }
  return out;
}

std::vector<std::uint64_t> numbers(const std::string& base64) {
  std::vector<std::uint64_t> out;
  std::uint64_t value = 0;
  unsigned shift = 0;
  for (const char c : bytes(base64)) {
    const auto byte = static_cast<unsigned char>(c);
    value |= static_cast<std::uint64_t>(byte & 127U) << shift;
    shift += 7;
    if (byte > 127U) continue;
    out.push_back(value);
    value = 0;
    shift = 0;
  }
  return out;
}

std::vector<double> coordinates(const std::string& base64, const Space& space) {
  const std::string from = bytes(base64);
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < from.size(); i += 2) {
    const Axis& axis = space.axes()[(i / 2) % space.dimension()];
    const unsigned share = static_cast<unsigned char>(from[i]) + 256U * static_cast<unsigned char>(from[i + 1]);
    out.push_back(axis.lo + (axis.hi - axis.lo) * share / 65535.0);
  }
  return out;
}

void forget_times(ExperimentResult& result) {
  for (auto& run : result.runs) {
    run.run.seconds = 0.0;
    run.run.set_up_seconds = 0.0;
    run.cpu_seconds = 0.0;
    for (auto& improvement : run.run.improvements) improvement.cpu_seconds = 0.0;
    for (auto& level : run.levels) level.record.search.seconds = 0.0;
  }
}

/// Two scenes, a tree and a hierarchy, few seeds, really run.
Experiment small() {
  Experiment experiment;
  experiment.problems = {test::cup_problem()};
  experiment.strategies = {{"rrt", fixture::plain()}, {"nested", fixture::nested()}};
  experiment.seeds = {1, 2};
  experiment.measure->cross = 1;
  TubeSettings tube;
  tube.points = 256;
  tube.pool = 1024;
  experiment.measure->target = tube;
  return experiment;
}

std::size_t held(const std::string& html) {
  std::size_t n = 0;
  while (!script(html, "run-" + std::to_string(n)).empty()) ++n;
  return n;
}

}  // namespace

TEST_CASE("the page is one file, well formed, and makes no requests", "[report][html]") {
  const Experiment experiment = small();
  const ExperimentResult result = run(experiment);
  const std::string html = fixture::report_html(experiment, result, "small.lua");
  CHECK(html.starts_with("<!DOCTYPE html>"));
  CHECK(fault(html).empty());
  CHECK(html.find("<title>Trellis: small.lua</title>") != std::string::npos);
  CHECK(html.find("default-src 'none'") != std::string::npos);
  for (const char* asks : {" src=", "<link", "@import", "fetch(", "XMLHttpRequest", "import(", "https://"}) {
    CAPTURE(asks);
    CHECK(html.find(asks) == std::string::npos);
  }
  // The only addresses are names of XML.
  for (std::size_t at = html.find("http://"); at != std::string::npos; at = html.find("http://", at + 1)) {
    CHECK(html.compare(at, 26, "http://www.w3.org/2000/svg") == 0);
  }
  CHECK(held(html) == 4);
  // What guides spent, in the table of the strategy that has some.
  const std::size_t nested = html.find("<template id=\"levels-0-1\">");
  REQUIRE(nested != std::string::npos);
  CHECK(html.find("checks by") > nested);
  CHECK(html.find("guided proposals", nested) != std::string::npos);
  CHECK(html.find(" proposals\">", nested) != std::string::npos);
  for (const char* id : {"data", "run-0", "run-3", "costs-0"}) {
    CAPTURE(id);
    CHECK(Json::accept(script(html, id)));
  }
  // The charts of costs have each run, with the colour of its strategy in the figures.
  const Json costs = Json::parse(script(html, "costs-0"));
  REQUIRE(costs.size() == 2);
  CHECK(costs[0]["name"] == "rrt");
  CHECK(costs[0]["colour"] == "var(--muted)");
  CHECK(costs[1]["colour"] == "#0072b2");
  for (const Json& strategy : costs) {
    REQUIRE(strategy["runs"].size() == experiment.seeds.size());
    for (const Json& run : strategy["runs"]) CHECK((run.size() == 4 && run[0] > 0 && run[2].is_boolean()));
  }
  CHECK(html.find("<th rowspan=\"2\" scope=\"col\">verdict</th>", nested) != std::string::npos);
}

TEST_CASE("the page holds the records", "[report][html]") {
  const Experiment experiment = small();
  const ExperimentResult result = run(experiment);
  const std::string html = fixture::report_html(experiment, result, "");
  const Json data = Json::parse(script(html, "data"));
  REQUIRE(data["cells"].size() == 1);
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t i = 0; i < 2; ++i) {
      const RunResult& run = result.runs[2 * s + i];
      const Json entry = data["cells"][0][s]["runs"][i];
      CHECK(entry["text"].get<std::string>().starts_with("solved"));
      const Json page = Json::parse(script(html, "run-" + std::to_string(entry["id"].get<int>())));
      REQUIRE(page["levels"].size() == run.levels.size());
      for (std::size_t l = 0; l < run.levels.size(); ++l) {
        const LevelRecord& record = run.levels[l].record;
        const Search& search = record.search;
        const Json& level = page["levels"][l];
        CAPTURE(record.name);
        CHECK(level["name"] == record.name);
        for (const auto& [name, rows] :
             {std::pair{"nodes", &search.nodes}, std::pair{"proposals", &search.proposals}}) {
          const auto q = coordinates(level[name], record.space);
          REQUIRE(q.size() == rows->values().size());
          for (std::size_t k = 0; k < q.size(); ++k) CHECK(std::abs(q[k] - rows->values()[k]) < 1e-3);
        }
        const auto sources = numbers(level["source"]);
        const auto near = numbers(level["near"]);
        const auto added = numbers(level["added"]);
        const std::string fates = bytes(level["fates"]);
        REQUIRE(near.size() == search.proposals.size());
        REQUIRE(added.size() == search.proposals.size());
        REQUIRE(fates.size() == search.proposals.size());
        std::int64_t last = 0;
        for (std::size_t k = 0; k < near.size(); ++k) {
          CHECK(sources[k] == search.proposal_sources[k]);
          CHECK(static_cast<std::uint32_t>(near[k]) - 1U == search.near[k]);  // none is the largest, one before 0
          CHECK((fates[k] & 3) == static_cast<int>(search.fates[k]));
          if (added[k] == 0) {
            CHECK(search.added[k] == no_node);
            continue;
          }
          const std::uint64_t step = added[k] - 1;
          last += step % 2 == 0 ? static_cast<std::int64_t>(step / 2) : -static_cast<std::int64_t>(step / 2) - 1;
          CHECK(last == search.added[k]);
        }
        if (!level["parents"].is_null()) {
          const auto parents = numbers(level["parents"]);
          REQUIRE(parents.size() == search.nodes.size());
          for (std::size_t k = 0; k < parents.size(); ++k) {
            const std::uint64_t back = parents[k] % 2 == 0 ? parents[k] / 2 : ~(parents[k] / 2);
            CHECK(k - back == search.parents[k]);
          }
        }
        CHECK(numbers(level["edges"]).size() == 2 * search.edges.size());
      }
      CHECK(page["turns"].size() == run.run.turns.size());
    }
  }
  // The shrunken robot is another one, and stands in the list once.
  CHECK(data["robots"].size() == 3);
}

TEST_CASE("rejected proposals are distinguished by their own validity", "[report][html]") {
  Experiment experiment = small();
  experiment.strategies = {{"rrt", fixture::plain()}};
  experiment.measure.reset();
  const ExperimentResult result = run(experiment);
  const std::string html = fixture::report_html(experiment, result, "");
  CHECK(fault(html).empty());
  const Problem& problem = experiment.problems.front();
  const auto checker = make_planar_checker(problem.scene, problem.space, problem.resolution);
  const Search& search = result.runs.front().levels.front().record.search;
  const std::string fates = bytes(Json::parse(script(html, "run-0"))["levels"][0]["fates"]);
  for (std::size_t i = 0; i < fates.size(); ++i) {
    CHECK((fates[i] >> 2) == (checker->valid(search.proposals[i]) ? 1 : 2));
  }
}

TEST_CASE("names cannot break out of the page", "[report][html]") {
  auto [experiment, result] = fixture::passage();
  const std::string evil = "</script><script>alert('x')</script><!-- & \" \xff";
  experiment.problems.front().name = evil;
  for (auto& run : result.runs) run.problem = evil;
  experiment.strategies.back().first = evil;
  for (auto& run : result.runs) {
    if (run.strategy == "nested") run.strategy = evil;
    for (auto& level : run.levels) level.record.name = evil;
  }
  const std::string html = fixture::report_html(experiment, result, evil);
  CHECK(fault(html).empty());
  CHECK(html.find("<script>alert") == std::string::npos);
  CHECK(html.find("</script><script>alert") == std::string::npos);
  const Json data = Json::parse(script(html, "data"));
  CHECK(data["problems"][0]["name"].get<std::string>().starts_with("</script><script>alert('x')</script><!-- & \""));
}

TEST_CASE("the page is the same twice, times apart", "[report][html]") {
  const Experiment experiment = small();
  std::vector<std::string> pages;
  for (const unsigned jobs : {1U, 2U}) {
    ExperimentResult result = run(experiment, {.jobs = jobs});
    forget_times(result);
    pages.push_back(fixture::report_html(experiment, result, ""));
  }
  CHECK(pages[0] == pages[1]);
}

TEST_CASE("a page that would be too large holds fewer runs, and says so", "[report][html]") {
  const auto [experiment, result] = fixture::passage();
  std::size_t reported = 0;
  const std::string all = fixture::report_html(
      experiment, result, "",
      {.progress = [&](std::size_t done, std::size_t of) { reported = done == of ? done : reported; }});
  CHECK(held(all) == 30);
  CHECK(reported == 30);
  CHECK(all.find("This file holds") == std::string::npos);
  const std::size_t pair = script(all, "run-0").size() + script(all, "run-1").size();

  const std::string three = fixture::report_html(experiment, result, "", {.most_bytes = 4 * pair});
  CHECK(held(three) == 6);
  CHECK(three.find("This file holds the samples of 3 seeds (1–3), of 15 in all") != std::string::npos);
  CHECK(three.size() < all.size());
  const Json data = Json::parse(script(three, "data"));
  CHECK(data["cells"][0][1]["runs"][2]["id"] == 5);
  CHECK(data["cells"][0][1]["runs"][3]["id"] == -1);

  const std::string one = fixture::report_html(experiment, result, "", {.most_bytes = pair / 2});
  CHECK(held(one) == 1);
  CHECK(one.find("This file holds the samples of the 1 run of 30 whose records are smallest") != std::string::npos);
  const std::string none = fixture::report_html(experiment, result, "", {.most_bytes = 0});
  CHECK(held(none) == 0);
  CHECK(fault(none).empty());
  CHECK(none.find("14/15") != std::string::npos);  // the tables are of all runs
}

TEST_CASE("of a long search the page holds a part, whose trees and turns are whole", "[report][html]") {
  Experiment experiment;
  experiment.problems = {test::make_problem("sealed", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(),
                                            {1, 8.5, 0}, {9, 1.5, 0})};
  experiment.strategies = {{"rrt", PlannerSpec::make("rrt", {{"proposals", std::int64_t{50000}}})}};
  experiment.seeds = {1, 2, 3, 4, 5, 6};
  const ExperimentResult result = run(experiment);
  const std::string html = fixture::report_html(experiment, result, "");
  CHECK(fault(html).empty());
  CHECK(html.size() < 5'000'000);
  CHECK(held(html) >= 2);

  const std::string small = fixture::report_html(experiment, result, "", {.most_bytes = 400'000});
  CHECK(held(small) == 2);
  CHECK(small.find("Of 2 long runs this file holds a part of the samples, evenly spread") != std::string::npos);
  const std::string text = script(small, "run-0");
  CHECK(text.size() <= 200'000);
  const Json page = Json::parse(text);
  const LevelRecord& record = result.runs.front().levels.front().record;
  const Search& search = record.search;
  const Json& level = page["levels"][0];
  CHECK(level["all"][0] == search.proposals.size());
  CHECK(level["all"][1] == search.nodes.size());
  const std::size_t d = record.space.dimension();
  const auto nodes = coordinates(level["nodes"], record.space);
  const auto proposals = coordinates(level["proposals"], record.space);
  CHECK(proposals.size() / d > 3000);
  CHECK(proposals.size() / d < search.proposals.size() / 4);
  for (const char* of_each : {"source", "near", "added"}) CHECK(numbers(level[of_each]).size() == proposals.size() / d);
  CHECK(bytes(level["fates"]).size() == proposals.size() / d);
  CHECK(page["turns"].back()[1] == proposals.size() / d);
  CHECK(page["turns"].back()[2] == nodes.size() / d);

  // Each node on the page is one of the search, in its order, and its parent one of its ancestors there.
  std::vector<std::uint32_t> rows;
  std::uint32_t row = 0;
  for (std::size_t k = 0; k < nodes.size(); k += d, ++row) {
    const auto is_it = [&](View q) {
      for (std::size_t j = 0; j < d; ++j) {
        if (std::abs(q[j] - nodes[k + j]) > 2e-4) return false;
      }
      return true;
    };
    while (row < search.nodes.size() && !is_it(search.nodes[row])) ++row;
    REQUIRE(row < search.nodes.size());
    rows.push_back(row);
  }
  const auto parents = numbers(level["parents"]);
  REQUIRE(parents.size() == rows.size());
  std::size_t ancestors = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::uint32_t parent = rows[k - (parents[k] / 2)];  // of a tree that grows: an earlier row
    std::uint32_t up = rows[k];
    while (up != 0 && up != parent) up = search.parents[up];
    if (up == parent && parent != rows[k]) ++ancestors;
  }
  CHECK(ancestors == rows.size() - 1);
}

TEST_CASE("a sample costs few bytes", "[report][html]") {
  // 3 scenes x 10 methods x 15 seeds of two levels of 2000 samples each must stay below 30 MB.
  RunResult run = fixture::nested_run("p", 1, true);
  run.levels.resize(2);
  for (auto& level : run.levels) {
    Search& search = level.record.search;
    const Space& space = level.record.space;
    Stream stream(1, "size", "proposals");
    Configuration q(space.dimension());
    search = Search(space.dimension());
    for (std::uint32_t i = 0; i < 1300; ++i) {
      space.sample_uniform(stream, q);
      search.proposals.push(q);
      search.proposal_sources.push_back(1);
      search.near.push_back(i / 2);
      const bool grew = i % 2 == 0;
      search.fates.push_back(grew ? Fate::advanced : Fate::rejected);
      search.added.push_back(grew ? i / 2 : no_node);
      if (!grew) continue;
      search.nodes.push(q);
      search.parents.push_back(i / 4);
    }
  }
  Experiment experiment;
  experiment.problems = {fixture::problem("p")};
  experiment.strategies = {{"nested", fixture::nested()}};
  experiment.seeds = {1};
  ExperimentResult result;
  result.runs.push_back(std::move(run));
  const std::string html = fixture::report_html(experiment, result, "");
  CHECK(script(html, "run-0").size() * 450 < 30'000'000);
}

TEST_CASE("unsolved runs, levels without samples and unmeasured experiments have their page", "[report][html]") {
  auto [experiment, result] = fixture::passage();
  const std::string html = fixture::report_html(experiment, result, "");
  CHECK(fault(html).empty());
  const Json data = Json::parse(script(html, "data"));
  CHECK(data["cells"][0][0]["runs"][6]["text"].get<std::string>().starts_with("not solved: budget spent"));
  CHECK(data["problems"][0]["bounds"].is_null());  // the fixture has no scene
  CHECK(data["cells"][0][0]["runs"][6]["solved"] == false);
  CHECK(data["cells"][0][0]["runs"][0]["solved"] == true);
  const Json nested = Json::parse(script(html, "run-1"));
  CHECK(nested["levels"][3]["proposals"] == "");
  CHECK(nested["turns"].size() == 4);

  experiment.measure.reset();
  const std::string bare = fixture::report_html(experiment, result, "");
  CHECK(fault(bare).empty());
  CHECK(bare.find("SE of the tree") == std::string::npos);

  Experiment nothing;
  CHECK(fault(fixture::report_html(nothing, {})).empty());
}

TEST_CASE("the page warns as the printed report does, and says why levels were solved again", "[report][html]") {
  auto [experiment, result] = fixture::passage();
  CHECK(fixture::report_html(experiment, result, "").find("costs more validity checks") == std::string::npos);
  for (RunResult& run : result.runs) {
    if (run.strategy == "nested") run.run.validity_checks *= 100;
  }
  result.runs[16].levels[2].record.resolves.rejections = 2;
  const std::string html = fixture::report_html(experiment, result, "");
  CHECK(fault(html).empty());
  const std::size_t list = html.find("<div class=\"notes\">");
  REQUIRE(list != std::string::npos);
  CHECK(html.find("warning: nested costs more validity checks than rrt", list) != std::string::npos);
  CHECK(html.find("rrt: 1 unsolved", list) != std::string::npos);
  CHECK(html.find("shrink(0.5): solved again 2 times: C rejected guided proposals (2)") != std::string::npos);
  // The level's colours on the page are those of the figures.
  for (std::size_t i = 0; i < draw::palette::levels.size(); ++i) {
    const draw::Colour colour = draw::palette::level(i);
    const auto byte = [](double part) { return static_cast<unsigned>(std::lround(255.0 * part)); };
    const std::string expected =
        fmt::format("--level-{}: #{:02x}{:02x}{:02x}", i, byte(colour.r), byte(colour.g), byte(colour.b));
    CAPTURE(expected);
    CHECK(html.find(expected) != std::string::npos);
  }
}

TEST_CASE("the page of problems in space has their triangles, positions of three axes, and the viewer",
          "[report][html]") {
  Experiment experiment = test::slot_experiment();
  ExperimentResult result = run(experiment);
  forget_times(result);
  const std::string html = fixture::report_html(experiment, result, "");
  CHECK(fault(html).empty());
  CHECK(html.find("const space3 = ") != std::string::npos);
  const Json data = Json::parse(script(html, "data"));
  REQUIRE(data["problems"].size() == 1);
  const Json& problem = data["problems"][0];
  CHECK(problem["bounds"] == Json{0.0, 0.0, 0.0, 10.0, 10.0, 10.0});
  CHECK(problem["position"] == Json{0, 1, 2});
  REQUIRE(data["worlds"].size() == 1);
  const Json& world = data["worlds"][problem["world"].get<std::size_t>()];
  // Of each obstacle the numbers of vertices, triangles and edges, and whether it is closed.
  const auto parts = numbers(world["surfaces"]["parts"]);
  REQUIRE(parts.size() == 4 * 6);
  CHECK(parts[0] == 8);
  CHECK(parts[1] == 12);
  CHECK(parts[2] == 12);
  CHECK(parts[3] == 1);
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < parts.size(); i += 4) {
    vertices += parts[i];
    triangles += parts[i + 1];
  }
  CHECK(bytes(world["surfaces"]["vertices"]).size() == 12 * vertices);
  CHECK(numbers(world["surfaces"]["triangles"]).size() == 3 * triangles);

  // The nested run: the robots of its levels, and their configurations within the steps of 16 bits.
  const Json run_json = Json::parse(script(html, "run-1"));
  const auto& levels = result.runs.back().levels;
  REQUIRE(run_json["levels"].size() == levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Json& level = run_json["levels"][i];
    const LevelRecord& record = levels[i].record;
    CHECK(level["position"].size() == 3);
    CHECK(level.contains("rotations") == !record.space.flat());
    if (record.space.flat()) continue;
    CHECK(level["rotations"] == Json{3});
    const std::string nodes = bytes(level["nodes"]);
    CHECK(nodes.size() == 2 * 7 * record.search.nodes.size());
    const unsigned share = static_cast<unsigned char>(nodes[12]) + 256U * static_cast<unsigned char>(nodes[13]);
    CHECK(-1.0 + 2.0 * share / 65535.0 == Approx(record.search.nodes[0][6]).margin(1e-4));
    const Json& robot = data["robots"][level["robot"].get<std::size_t>()];
    CHECK(robot["dimension"] == 7);
    CHECK(numbers(robot["surfaces"]["parts"])[1] == 12);
  }
  CHECK(fixture::report_html(experiment, result, "") == html);
  const Experiment plane = small();
  const ExperimentResult found = run(plane);
  CHECK(fixture::report_html(plane, found, "").find("const space3 = ") == std::string::npos);
}

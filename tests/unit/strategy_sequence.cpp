// SPDX-License-Identifier: GPL-3.0-or-later
// a .. b: when a turn ends, and the information from one space to the next.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/custom.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/informed_path.hpp>
#include <trellis/strategy/searched_guidance.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/outcomes.hpp"
#include "support/refuses.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

Configurations rows(const std::vector<Configuration>& all) {
  Configurations result(all.front().size());
  for (const auto& q : all) result.push(q);
  return result;
}

bool same(const Configurations& a, const Configurations& b) {
  return std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

/// A scripted part of a sequence, which records its input.
struct Part final : SearchedGuidance {
  Advance advance = Advance::found;
  std::uint64_t times_refuted = 0;
  bool is_spent = false;
  bool expects = false;
  Finding has;
  std::vector<Finding> given;
  int drew = 0;

  [[nodiscard]] Advance ready() const override { return advance; }
  [[nodiscard]] std::uint64_t refuted() const override { return times_refuted; }
  [[nodiscard]] bool spent() const override { return is_spent; }
  [[nodiscard]] bool searches() const override { return true; }
  [[nodiscard]] Configurations guiding_path() const override { return has.path; }
  [[nodiscard]] Configurations refuted_places() const override { return has.refuted; }
  void inform(const Finding& finding) override { given.push_back(finding); }
  void expect_findings() override { expects = true; }
  Source sample(Stream&, MutableView) override {
    ++drew;
    return 0;
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"part"}; }
};

/// A sequence of three such parts.
struct Three {
  std::vector<Part*> parts;
  std::unique_ptr<SearchedGuidance> sequence;
  Stream stream{1, "", "sequence"};

  explicit Three(std::int64_t turn) {
    std::vector<std::unique_ptr<SearchedGuidance>> owned;
    for (int i = 0; i < 3; ++i) {
      owned.push_back(std::make_unique<Part>());
      parts.push_back(static_cast<Part*>(owned.back().get()));
    }
    sequence = make_sequence({.turn = turn}, std::move(owned));
  }
  /// The guides of the next proposals: "001".
  std::string draw(int proposals) {
    std::string drew;
    for (int i = 0; i < proposals; ++i) {
      sequence->begin({});
      REQUIRE(sequence->needs_search() == nullptr);
      REQUIRE(sequence->ready() != Advance::unfinished);
      std::vector<int> before;
      for (const Part* part : parts) before.push_back(part->drew);
      Configuration q(1);
      sequence->sample(stream, q);
      for (std::size_t k = 0; k < parts.size(); ++k) {
        if (parts[k]->drew > before[k]) drew.push_back(static_cast<char>('0' + k));
      }
    }
    return drew;
  }
};

/// What the applications of f of all such guides of a run received, in their order.
struct Applications {
  std::vector<Known> known;
  std::vector<Configurations> vertices;  ///< of S
};

/// A guide whose S is a graph of the samples of C: start, goal, and each sample, each connected to the start and the
/// goal. h is uniform, and stale after three rejections.
class SampleGraph final : public Guide, public Repairs {
 public:
  explicit SampleGraph(Applications& applications) : applications_(applications) {}
  std::unique_ptr<Instance> project(const Instance&) override { throw Fault("f needs what is known"); }
  Repairs& repairs() override { return *this; }
  [[nodiscard]] bool uses_known() const override { return true; }
  std::unique_ptr<Instance> project_from(const Instance& parent, const Known& known) override {
    auto sub = std::make_unique<Instance>(parent);
    sub->checks = {};
    sub->graph = std::make_shared<Graph>();
    Graph& graph = *sub->graph;
    graph.vertices = Configurations(parent.space.dimension());
    graph.start = graph.vertices.push(parent.start);
    graph.goals = {graph.vertices.push(parent.goal())};
    graph.edges.push_back({graph.start, graph.goals.front(), parent.space.distance(parent.start, parent.goal()), {}});
    for (const Known::Sample& sample : known.samples) {
      const std::uint32_t vertex = graph.vertices.push(sample.q);
      for (const std::uint32_t end : {graph.start, graph.goals.front()}) {
        graph.edges.push_back({end, vertex, parent.space.distance(graph.vertices[end], sample.q), {}});
      }
    }
    applications_.known.push_back(known);
    applications_.vertices.push_back(graph.vertices);
    return sub;
  }
  void project(View q, MutableView s) const override { std::copy(q.begin(), q.end(), s.begin()); }
  void lift(View s, Stream&, MutableView q) const override { std::copy(s.begin(), s.end(), q.begin()); }
  [[nodiscard]] double log_fibre_density(View) const override { return 0.0; }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution* found) override {
    return std::make_unique<Along>(parent.space, found->path);
  }

 private:
  /// Uniform; its path is the one that was found.
  class Along final : public Heuristic {
   public:
    Along(const Space& space, Configurations path) : uniform_(space), path_(std::move(path)) {}
    Source sample(Stream& stream, MutableView out) override { return uniform_.sample(stream, out); }
    [[nodiscard]] std::vector<std::string> sources() const override { return {"samples"}; }
    [[nodiscard]] Configurations lifted_path() const override { return path_; }
    void observe(const Outcome& outcome, bool mine) override {
      if (mine && outcome.fate == Fate::rejected) ++rejected_;
    }
    [[nodiscard]] bool stale() const override { return rejected_ >= 3; }

   private:
    UniformGuidance uniform_;
    Configurations path_;
    int rejected_ = 0;
  };

  Applications& applications_;
};

class SampleGraphSpec final : public CustomGuide {
 public:
  SampleGraphSpec(Applications& applications, const std::string& name)
      : CustomGuide({.name = name, .identity = name, .default_planner = "graph_search", .resolves = 10}),
        applications_(applications) {}
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite&) const override {
    return std::make_unique<SampleGraph>(applications_);
  }

 private:
  Applications& applications_;
};

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
PlannerSpec unbounded(std::vector<Options::Entry> given = {}) {
  given.emplace_back("bound", 0.0);
  return PlannerSpec::make("rrt", given);
}

}  // namespace

TEST_CASE("a turn ends after its proposals, and after the last part the first has its turn again",
          "[strategy][sequence]") {
  Three three(2);
  CHECK(three.draw(7) == "0011220");
}

TEST_CASE("a turn ends at once where evidence refutes the guide in turn", "[strategy][sequence]") {
  Three three(100);
  CHECK(three.draw(2) == "00");
  three.parts[0]->times_refuted = 1;
  CHECK(three.draw(2) == "11");
  // What is refuted while another guide draws ends no turn, and is no reason to pass when the turn comes round.
  three.parts[2]->times_refuted = 5;
  CHECK(three.draw(1) == "1");
  three.parts[1]->times_refuted = 1;
  CHECK(three.draw(2) == "22");
  // Where all are refuted for good the turn does not end before its proposals do.
  for (Part* part : three.parts) part->is_spent = true;
  three.parts[2]->times_refuted = 6;
  CHECK(three.draw(2) == "22");
}

TEST_CASE("a guide whose search ends without a path leaves its turn to the next", "[strategy][sequence]") {
  Three three(2);
  three.parts[1]->advance = Advance::nothing;
  CHECK(three.draw(6) == "002200");
  for (Part* part : three.parts) part->advance = Advance::nothing;
  CHECK(three.draw(3).size() == 3);
}

TEST_CASE("what a guide found goes to the next: its path, and the places refuted", "[strategy][sequence]") {
  Three three(1);
  for (const Part* part : three.parts) CHECK(part->expects);
  three.parts[0]->has = {rows({{0.0}, {1.0}}), rows({{0.5}})};
  three.parts[1]->has = {rows({{0.0}, {2.0}}), {}};
  CHECK(three.draw(3) == "012");
  REQUIRE(three.parts[1]->given.size() == 1);
  CHECK(same(three.parts[1]->given[0].path, three.parts[0]->has.path));
  CHECK(same(three.parts[1]->given[0].refuted, three.parts[0]->has.refuted));
  REQUIRE(three.parts[2]->given.size() == 1);
  CHECK(same(three.parts[2]->given[0].path, three.parts[1]->has.path));
  // Its refutations so far are those of the whole sequence, for whatever the sequence is a part of.
  CHECK(same(three.sequence->refuted_places(), three.parts[0]->has.refuted));
}

TEST_CASE("in a sequence, another path in one space gives another search of the next", "[strategy][sequence][pairs]") {
  const auto problem = test::cup_problem();
  const auto run = [&](const GuideSpec& a, const GuideSpec& b) {
    return execute(sequence({a, b}, 3) >> unbounded({{"proposals", std::int64_t{12}}}), problem, 2);
  };
  int pairs = 0;
  for (const auto& first : test::guides_of_one_robot()) {
    if (first.default_planner.empty() || find_planner(first.default_planner)->graph) continue;
    // Two searches of the same space, and so two paths.
    const auto a =
        GuideSpec::make(first.component->name, {}, PlannerSpec::make("rrt_connect", {{"step", 0.5}, {"bound", 0.0}}));
    const auto other =
        GuideSpec::make(first.component->name, {}, PlannerSpec::make("rrt_connect", {{"step", 0.4}, {"bound", 0.0}}));
    for (const auto& second : test::guides_of_one_robot()) {
      if (second.default_planner.empty() || second.component->name == "experience") continue;
      const auto b = GuideSpec::make(second.component->name, {},
                                     PlannerSpec::make(second.default_planner, {{"proposals", std::int64_t{300}}}));
      CAPTURE(first.component->name, second.component->name);
      const RunRecord one = run(a, b);
      const RunRecord two = run(other, b);
      if (one.levels.size() < 3 || two.levels.size() < 3) continue;
      const auto& path = one.levels[1].solution.path;
      if (path.size() < 2 || same(path, two.levels[1].solution.path)) continue;
      const auto drawn = [](const RunRecord& record) {
        const auto& values = record.levels[2].search.proposals.values();
        return std::vector<double>(values.begin(), values.end());
      };
      const auto x = drawn(one);
      const auto y = drawn(two);
      if (x.empty() || y.empty()) continue;
      ++pairs;
      const auto shorter = static_cast<std::ptrdiff_t>(std::min(x.size(), y.size()));
      CHECK_FALSE(std::equal(x.begin(), x.begin() + shorter, y.begin()));
    }
  }
  CHECK(pairs > 40);
}

TEST_CASE("with turns of one sample each space differs from the one before by that sample", "[strategy][sequence]") {
  const auto problem = test::simple_passage_problem();
  Applications applications;
  const auto part = [&](const std::string& name) {
    return GuideSpec::make(std::make_shared<SampleGraphSpec>(applications, name));
  };
  const std::int64_t proposals = 20;
  const RunRecord run =
      execute(sequence({part("a"), part("b")}, 1) >> PlannerSpec::make("rrt", {{"proposals", proposals},
                                                                               {"bound", 0.0},
                                                                               {"goal_bias", 0.0},
                                                                               {"uniform", 0.0},
                                                                               {"connect_goal", false}}),
              problem, 3);
  const Search& c = run.levels.front().search;
  REQUIRE(c.proposals.size() == 20);
  // f of each guide is applied once before any sample, and once for each turn after the first one.
  REQUIRE(applications.known.size() == 2 + 19);
  CHECK(applications.known[0].samples.empty());
  for (std::size_t i = 1; i < applications.known.size(); ++i) {
    CAPTURE(i);
    const Known& known = applications.known[i];
    // S_(i+1) has the vertices of S_i and the one sample.
    REQUIRE(known.samples.size() == i - 1);
    const auto& before = applications.vertices[i - 1].values();
    const auto& after = applications.vertices[i].values();
    REQUIRE(after.size() == before.size() + (i > 1 ? 3 : 0));
    CHECK(std::equal(before.begin(), before.end(), after.begin()));
    if (i < 2) continue;
    const Known::Sample& sample = known.samples.back();
    CHECK(std::equal(sample.q.begin(), sample.q.end(), c.proposals[i - 2].begin(), c.proposals[i - 2].end()));
    CHECK(sample.fate == c.fates[i - 2]);
    CHECK(sample.node.empty() == (sample.fate == Fate::rejected));
    CHECK(sample.blocked_at.empty() != (sample.fate == Fate::rejected));
    // The guide drew every second one of them, and both were new to it but at the beginning.
    CHECK_FALSE(sample.mine);
    CHECK(known.samples.size() - known.new_from == (i == 2 ? 1 : 2));
    // Each guide learns the path of the other one, once there is one.
    REQUIRE(known.paths.size() == (i < 3 ? 1 : 2));
    CHECK(known.paths.front().guide == "a");
  }
  CHECK(run.levels[1].resolves.new_turn + run.levels[2].resolves.new_turn == 18);
  CHECK(run.levels[1].solves + run.levels[2].solves == 20);
}

TEST_CASE("f is applied again to what is known where h is stale", "[strategy]") {
  const auto problem = test::simple_passage_problem();
  Applications applications;
  const RunRecord run = execute(GuideSpec::make(std::make_shared<SampleGraphSpec>(applications, "a")) >>
                                    unbounded({{"proposals", std::int64_t{60}}}),
                                problem, 1);
  REQUIRE(applications.known.size() > 2);
  CHECK(run.levels[1].resolves.rejections == applications.known.size() - 1);
  for (std::size_t i = 1; i < applications.known.size(); ++i) {
    CHECK(applications.known[i].samples.size() > applications.known[i - 1].samples.size());
    CHECK(applications.known[i].new_from == applications.known[i - 1].samples.size());
  }
}

TEST_CASE("a search that is informed finds its path in fewer proposals", "[strategy][sequence]") {
  const auto problem = test::simple_passage_problem();
  const auto b = GuideSpec::make("shrink", {}, PlannerSpec::make("rrt", {{"step", 0.5}}));
  std::vector<double> ratios;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const auto drawn = [&](const GuideSpec& first) {
      const RunRecord run =
          execute(sequence({first, b}, 1) >> unbounded({{"proposals", std::int64_t{4}}}), problem, seed);
      REQUIRE(run.levels.back().solution.solved());
      return static_cast<double>(run.levels.back().search.proposals.size());
    };
    ratios.push_back(drawn(guide("skeleton")) / drawn(guide("uniform")));
  }
  std::sort(ratios.begin(), ratios.end());
  CHECK(ratios[7] < 0.3);
}

TEST_CASE("a space leaves out what evidence refuted in the space before it", "[strategy][sequence]") {
  const auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  const Configuration place = {5, 5, 0.3};
  for (const std::string name : {"shrink", "widen"}) {
    CAPTURE(name);
    const GuideKind& kind = *find_guide(name);
    const auto made = kind.make(Options::validate(*kind.component, {}));
    auto sub = made->project(*parent);
    made->attach(*sub);
    REQUIRE(sub->valid(place));
    CHECK(made->repairs().refuted_places().empty());
    const auto before = sub->epoch();
    made->repairs().avoid(place);
    CHECK_FALSE(sub->valid(place));
    CHECK(sub->epoch() > before);
    // It says so to the next one; and twice is once.
    CHECK(made->repairs().refuted_places().size() == 1);
    const auto once = sub->epoch();
    made->repairs().avoid(place);
    CHECK(sub->epoch() == once);
    // The start stays valid.
    made->repairs().avoid(problem.start);
    CHECK(sub->valid(problem.start));
  }
}

TEST_CASE("a graph of positions goes round what another space's evidence refuted", "[strategy][sequence]") {
  // Two gaps; the lower one is nearer.
  const auto problem = test::make_problem(
      "two gaps", test::rectangle_world({{4.5, 0, 5.5, 4.75}, {4.5, 5.25, 5.5, 8.5}, {4.5, 9.5, 5.5, 10}}),
      test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  using Given = std::vector<Options::Entry>;
  const std::vector<std::pair<std::string, Given>> guides = {
      {"skeleton", {}}, {"workspace", {}}, {"workspace", {{"lift", std::string("path")}}}};
  for (const auto& [name, given] : guides) {
    CAPTURE(name, given.size());
    const auto parent = make_instance(problem);
    const GuideKind& kind = *find_guide(name);
    const auto made = kind.make(Options::validate(*kind.component, given));
    const auto sub = made->project(*parent);
    made->attach(*sub);
    Solution found;
    const auto height = [&] {
      UniformGuidance uniform(sub->space);
      Search search(2);
      const PlannerKind& planner = *find_planner("graph_search");
      found =
          planner.make(Options::validate(*planner.component, {}), {*sub, uniform, Stream(1, "", ""), search, false})
              ->solve(uniform, {});
      REQUIRE(found.solved());
      double highest = 0.0;
      for (std::size_t i = 0; i < found.path.size(); ++i) highest = std::max(highest, found.path[i][1]);
      return highest;
    };
    CHECK(height() < 8.0);
    const auto h = made->heuristic(*parent, sub.get(), &found);
    CHECK_FALSE(h->stale());
    // A place beside the path refutes nothing.
    made->repairs().avoid(Configuration{9.9, 0.1, 0});
    CHECK_FALSE(h->stale());
    CHECK(height() < 8.0);
    made->repairs().take_lost_places();
    const std::size_t before = made->repairs().refuted_places().size();
    const auto revision = sub->graph->revision;
    made->repairs().avoid(Configuration{5, 5, 0});
    CHECK(h->stale());
    CHECK(sub->graph->revision > revision);
    // It says so to the next guide of C and to the guide of S; and twice is once.
    CHECK(made->repairs().refuted_places().size() == before + 1);
    const Configurations lost = made->repairs().take_lost_places();
    REQUIRE(lost.size() == 1);
    CHECK(std::ranges::equal(lost.front(), Configuration{5, 5}));
    const auto once = sub->graph->revision;
    made->repairs().avoid(Configuration{5, 5, 0});
    CHECK(sub->graph->revision == once);
    made->repairs().before_resolve();
    CHECK(height() > 8.5);
  }
}

TEST_CASE("a planner that ignores the grid has no place left out", "[strategy][sequence]") {
  const auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  const GuideKind& kind = *find_guide("workspace");
  const auto made = kind.make(Options::validate(*kind.component, {}));
  const auto sub = made->project(*parent);
  made->attach(*sub);
  sub->graph = nullptr;
  made->repairs().avoid(Configuration{5, 5, 0});
  CHECK(made->repairs().refuted_places().empty());
}

TEST_CASE("h of a space that is searched late continues from the state of the search", "[strategy][sequence]") {
  const auto problem =
      test::make_problem("empty", test::rectangle_world({}), test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  for (const std::string name : {"shrink", "identity", "widen"}) {
    CAPTURE(name);
    const GuideKind& kind = *find_guide(name);
    auto parent = make_instance(problem);
    parent->step = 0.5;
    const auto made = kind.make(Options::validate(*kind.component, {}));
    auto sub = made->project(*parent);
    made->attach(*sub);
    for (double x = 1.5; x <= 5.0; x += 0.5) {
      const Configuration q = {x, 5, 0};
      made->learn(test::reached(q));
    }
    const Solution found{Status::solved, rows({problem.start, problem.goal()}), {}};
    const auto h = made->heuristic(*parent, sub.get(), &found);
    Stream stream(1, "", "late");
    Configuration q(3);
    for (int i = 0; i < 100; ++i) {
      h->sample(stream, q);
      CHECK(q[0] > 4.8);
      CHECK(q[0] < 5.8);
    }
  }
}

TEST_CASE("a path that another space found is followed ahead of the tree, until it is refuted",
          "[strategy][sequence]") {
  const auto problem =
      test::make_problem("empty", test::rectangle_world({}), test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  const auto instance = make_instance(problem);
  instance->step = 0.5;
  InformedPath informed(*instance);
  CHECK_FALSE(informed.guides());
  informed.expect();
  const auto tell = [&](const Configuration& q, bool blocked) {
    informed.observe(blocked ? test::blocked(q) : test::reached(q), blocked);
  };
  tell({3, 5, 0}, false);
  informed.follow(rows({problem.start, problem.goal()}));
  REQUIRE(informed.guides());
  Stream stream(1, "", "informed");
  Configuration q(3);
  const auto drawn = [&] {
    informed.h().sample(stream, q);
    return q[0];
  };
  CHECK(drawn() > 2.8);
  CHECK(drawn() < 3.8);
  const auto before = informed.epoch();
  tell({3.5, 5, 0}, false);
  CHECK(informed.progress() == Approx(0.5).margin(0.1));
  CHECK(informed.epoch() > before);
  CHECK(drawn() > 3.3);
  // The planner lost its nodes: the search begins again at the start.
  informed.restart();
  CHECK(drawn() < 1.8);
  // Their progress is subtracted, and the remaining nodes are reported again.
  CHECK(informed.progress() == Approx(-2.0).margin(0.1));
  tell({1.5, 5, 0}, false);
  CHECK(informed.progress() == Approx(-1.5).margin(0.1));
  for (int i = 0; i < 60; ++i) {
    REQUIRE(informed.guides());
    tell({2, 5, 0}, true);
  }
  CHECK_FALSE(informed.guides());
  // Another one takes its place; none, where there is none.
  informed.follow(rows({problem.start, problem.goal()}));
  CHECK(informed.guides());
  informed.follow(Configurations(3));
  CHECK_FALSE(informed.guides());
}
